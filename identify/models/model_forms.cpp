#include "identify/models/model_forms.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace identify {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Group = KinematicModel::Group;

constexpr double kOnAxis_mm = 1e-6;
constexpr double kGimbalLock_rad = 1e-3;

ModelNumber number(std::string_view name, Quantity quantity, double value,
                   Knowledge knowledge = Knowledge::identified) {
  return {name, quantity, {value, 0, knowledge}};
}

Knowledge unless(bool free) {
  return free ? Knowledge::by_convention : Knowledge::identified;
}

Group placement(const Isometry3d& pose, Knowledge of_rotation) {
  const Vector3d at = pose.translation();
  Group group = {number("x", Quantity::length, at.x()), number("y", Quantity::length, at.y()),
                 number("z", Quantity::length, at.z())};
  constexpr std::array<std::string_view, 9> kNames{"r11", "r12", "r13", "r21", "r22",
                                                   "r23", "r31", "r32", "r33"};
  for (std::size_t k = 0; k < kNames.size(); ++k)
    group.push_back(
        number(kNames[k], Quantity::ratio,
               pose.linear()(static_cast<Eigen::Index>(k / 3), static_cast<Eigen::Index>(k % 3)),
               of_rotation));
  return group;
}

Group twist_of_way(const Vector3d& v) {
  const auto zero = [](std::string_view name) {
    return number(name, Quantity::ratio, 0, Knowledge::by_convention);
  };
  return {zero("wx"),
          zero("wy"),
          zero("wz"),
          number("vx", Quantity::ratio, v.x()),
          number("vy", Quantity::ratio, v.y()),
          number("vz", Quantity::ratio, v.z())};
}

/// The place of a frame on an axis that has none.
void leave_place(Group& group) {
  for (ModelNumber& entry : group)
    if (entry.name == "x" || entry.name == "y" || entry.name == "z")
      entry.number.knowledge = Knowledge::by_convention;
}

bool has_linear(const std::vector<DhEstimate>& table) {
  return std::any_of(table.begin(), table.end(), [](const auto& row) { return row.linear; });
}

/// As the row that leads there has it.
void leave_place_of(const DhEstimate& row, Group& group) {
  for (ModelNumber& entry : group) {
    const DhNumber* number = entry.name == "z"                        ? &row.b_mm
                             : entry.name == "x" || entry.name == "y" ? &row.a_mm
                                                                      : nullptr;
    if (number != nullptr && number->knowledge == Knowledge::by_convention)
      entry.number.knowledge = Knowledge::by_convention;
  }
}

struct RollPitchYaw {
  double roll = 0;
  double pitch = 0;
  double yaw = 0;
  bool locked = false;  ///< yaw and roll about nearly the same line
};

/// R = Rz(yaw) Ry(pitch) Rx(roll). Yaw is taken out before the others are computed: so they make up
/// for what it is off where pitch is close to a right angle.
RollPitchYaw roll_pitch_yaw(const Matrix3d& rotation, const std::optional<double>& held_yaw) {
  const double level = std::hypot(rotation(0, 0), rotation(1, 0));
  RollPitchYaw angles;
  angles.locked = level < kGimbalLock_rad;
  if (held_yaw)
    angles.yaw = *held_yaw;
  else if (level > 0)
    angles.yaw = std::atan2(rotation(1, 0), rotation(0, 0));
  const Matrix3d rest =
      Eigen::AngleAxisd(-angles.yaw, Vector3d::UnitZ()).toRotationMatrix() * rotation;
  angles.pitch = std::atan2(-rest(2, 0), rest(0, 0));
  angles.roll = std::atan2(-rest(1, 2), rest(1, 1));
  return angles;
}

}  // namespace

ModelForms::ModelForms(const ModelSource& source) : source_(source) {
  const Chain& chain = source.chain;
  Isometry3d pose = first_frame({z_axis(chain, 0).direction, z_axis(chain, 0).point_mm(), {}});
  for (std::size_t i = 0; i + 1 < joints(); ++i) {
    const DhRow row = values(source.dh)[i];
    normals_.push_back(pose.linear() *
                       Vector3d(std::cos(row.theta_rad), std::sin(row.theta_rad), 0));
    pose = pose * transform(row);
  }
  for (std::size_t j = 0; j < joints(); ++j) {
    const Vector3d foot = z_axis(chain, j).closest_mm(chain.targets_mm.front());
    target_on_axis_.push_back((chain.targets_mm.front() - foot).norm() < kOnAxis_mm);
  }
  for (std::size_t i = 0; i + 1 < joints(); ++i) {
    const Relation relation = has_beta(source.dh[i]) ? Relation::parallel : source.dh[i].relation;
    stone_normals_.push_back(
        step_to(stone_frame(chain, i), z_axis(chain, i + 1), relation, normals_[i]).normal);
  }
  const KinematicModel urdf = written(chain, ModelForm::urdf);
  std::vector<std::optional<double>> held;
  for (const Group& group : urdf.groups) {
    held.emplace_back();
    for (const ModelNumber& entry : group)
      if (entry.name == "yaw" && entry.number.knowledge == Knowledge::by_convention)
        held.back() = entry.number.value;
  }
  held_yaw_ = std::move(held);
}

Line ModelForms::z_axis(const Chain& chain, std::size_t joint) const {
  const Line axis = Line::through(chain.axes[joint].point_mm, chain.axes[joint].direction);
  return source_.positive[joint] < 0 ? axis.reversed() : axis;
}

std::vector<AxisFrame> ModelForms::table_frames(const Chain& chain) const {
  const Line first = z_axis(chain, 0);
  const Isometry3d pose = first_frame({first.direction, first.point_mm(), {}});
  std::vector<AxisFrame> frames = {
      {pose.translation(), pose.linear().col(0), pose.linear().col(2)}};
  for (std::size_t i = 0; i + 1 < joints(); ++i)
    frames.push_back(step_to(frames[i], z_axis(chain, i + 1), source_.dh[i].relation, normals_[i],
                             source_.dh[i].b_mm.value)
                         .frame);
  return frames;
}

AxisFrame ModelForms::stone_frame(const Chain& chain, std::size_t joint) const {
  const Line axis = z_axis(chain, joint);
  const Vector3d& target = chain.targets_mm.front();
  const Vector3d foot = axis.closest_mm(target);
  if (!target_on_axis_[joint])
    return {foot, turned_across(target - foot, axis.direction), axis.direction};
  const Isometry3d any = first_frame({axis.direction, axis.point_mm(), {}});
  return {foot, any.linear().col(0), axis.direction};
}

ModelNumber ModelForms::positive(std::size_t joint) const {
  return number("positive", Quantity::ratio, source_.positive[joint], Knowledge::by_convention);
}

std::vector<Group> ModelForms::dh_groups(ModelForm form) const {
  std::vector<Group> groups;
  for (std::size_t j = 0; j < joints(); ++j) {
    const DhEstimate& row = source_.dh[j];
    const ModelNumber b{"b", Quantity::length, row.b_mm};
    const ModelNumber theta{"theta", Quantity::angle, row.theta_rad};
    Group group;
    if (form == ModelForm::modified_dh) {
      const DhNumber zero{0, 0, Knowledge::by_convention};
      const DhEstimate before =
          j > 0 ? source_.dh[j - 1] : DhEstimate{zero, zero, zero, zero, zero, Relation::unknown};
      group = {{"alpha", Quantity::angle, before.alpha_rad},
               {"a", Quantity::length, before.a_mm},
               {"beta", Quantity::angle, before.beta_rad},
               theta,
               b};
    } else {
      const bool hayati = form == ModelForm::hayati;
      if (!hayati || !has_beta(row) || row.linear || row.b_mm.value != 0) group.push_back(b);
      group.push_back(theta);
      group.push_back({"a", Quantity::length, row.a_mm});
      group.push_back({"alpha", Quantity::angle, row.alpha_rad});
      if (!hayati || has_beta(row)) group.push_back({"beta", Quantity::angle, row.beta_rad});
    }
    group.push_back(positive(j));
    groups.push_back(std::move(group));
  }
  return groups;
}

std::vector<Group> ModelForms::stone_groups(const Chain& chain) const {
  std::vector<Group> groups;
  for (std::size_t j = 0; j < joints(); ++j) {
    const bool last = j + 1 == joints();
    AxisStep step;
    double gamma = 0;
    double b = 0;
    if (!last) {
      step = step_to(stone_frame(chain, j), z_axis(chain, j + 1), source_.dh[j].relation,
                     stone_normals_[j]);
      const AxisFrame next = stone_frame(chain, j + 1);
      gamma = std::atan2(next.z.dot(step.frame.x.cross(next.x)), step.frame.x.dot(next.x));
      b = (next.origin_mm - step.frame.origin_mm).dot(next.z);
    }
    const bool coincident = source_.dh[j].relation == Relation::coincident;
    const Knowledge any = unless(last);
    const Knowledge link = unless(last || coincident);
    const Knowledge beta = unless(last || coincident || target_on_axis_[j]);
    const Knowledge d = unless(last || has_beta(source_.dh[j]));
    const Knowledge about_next = unless(last || coincident || target_on_axis_[j + 1]);
    Group group = {number("beta", Quantity::angle, step.row.theta_rad, beta),
                   number("d", Quantity::length, step.row.b_mm, d),
                   number("a", Quantity::length, step.row.a_mm, link),
                   number("alpha", Quantity::angle, step.row.alpha_rad, link)};
    if (has_beta(source_.dh[j]))
      group.push_back(number("hayati_beta", Quantity::angle, step.row.beta_rad, link));
    group.push_back(number("gamma", Quantity::angle, gamma, about_next));
    group.push_back(number("b", Quantity::length, b, any));
    // Frames on an axis without a place are anywhere.
    if (source_.dh[j].linear || (!last && source_.dh[j + 1].linear))
      for (ModelNumber& entry : group)
        if (entry.name != "alpha" && entry.name != "hayati_beta")
          entry.number.knowledge = Knowledge::by_convention;
    group.push_back(positive(j));
    groups.push_back(std::move(group));
  }
  return groups;
}

std::vector<Group> ModelForms::twist_groups(const Chain& chain) const {
  std::vector<Group> groups;
  for (const ChainAxis& axis : chain.axes) {
    if (axis.linear) {
      groups.push_back(twist_of_way(axis.direction.normalized()));
      continue;
    }
    const Line line = Line::through(axis.point_mm, axis.direction);
    const Vector3d& w = line.direction;
    const Vector3d& v = line.moment_mm;
    groups.push_back({number("wx", Quantity::ratio, w.x()), number("wy", Quantity::ratio, w.y()),
                      number("wz", Quantity::ratio, w.z()), number("vx", Quantity::length, v.x()),
                      number("vy", Quantity::length, v.y()),
                      number("vz", Quantity::length, v.z())});
  }
  return groups;
}

Group ModelForms::urdf_placement(std::size_t group, const Isometry3d& pose) const {
  const bool tool = group > joints();
  const auto angles =
      roll_pitch_yaw(pose.linear(), held_yaw_.empty() ? std::optional<double>() : held_yaw_[group]);
  // As the row that leads here: offsets along parallel axes and angles about coincident ones.
  const DhEstimate* row = !tool && group > 1 ? &source_.dh[group - 2] : nullptr;
  const Knowledge rotation = unless(tool && !source_.tool_identified);
  const Knowledge yaw =
      unless(angles.locked || rotation == Knowledge::by_convention ||
             (row != nullptr && row->theta_rad.knowledge == Knowledge::by_convention));
  const Vector3d at = pose.translation();
  return {number("x", Quantity::length, at.x()),
          number("y", Quantity::length, at.y()),
          number("z", Quantity::length, at.z(), unless(row != nullptr && has_beta(*row))),
          number("roll", Quantity::angle, angles.roll, rotation),
          number("pitch", Quantity::angle, angles.pitch, rotation),
          number("yaw", Quantity::angle, angles.yaw, yaw)};
}

std::vector<Group> ModelForms::urdf_groups(const std::vector<AxisFrame>& frames) const {
  std::vector<Group> groups;
  Isometry3d before = Isometry3d::Identity();
  for (std::size_t j = 0; j < joints(); ++j) {
    const double home = source_.home_rad[j].value_or(0);
    const Isometry3d here = frames[j].pose();
    const bool linear = source_.dh[j].linear;
    Isometry3d back = Isometry3d::Identity();  // from home to zero
    if (linear)
      back.translation().z() = -source_.positive[j] * kLinear_mm * home;
    else
      back = Eigen::AngleAxisd(-source_.positive[j] * home, Vector3d::UnitZ());
    Group group = urdf_placement(j + 1, before.inverse() * here * back);
    if (j == 0 && linear) leave_place(group);
    if (j > 0 && has_linear(source_.dh)) leave_place_of(source_.dh[j - 1], group);
    group.push_back(
        number("axis_z", Quantity::ratio, source_.positive[j], Knowledge::by_convention));
    group.push_back(
        linear ? number("home", Quantity::length, kLinear_mm * home, Knowledge::by_convention)
               : number("home", Quantity::angle, home, Knowledge::by_convention));
    groups.push_back(std::move(group));
    before = here;
  }
  return groups;
}

KinematicModel ModelForms::written(const Chain& chain, ModelForm form) const {
  Isometry3d tool = Isometry3d::Identity();
  tool.linear() = chain.tool;
  tool.translation() = chain.targets_mm.front();
  const Knowledge rotation = unless(!source_.tool_identified);
  KinematicModel model{form, {}, {}};
  for (const DhEstimate& row : source_.dh) model.linear.push_back(row.linear);
  const auto finish = [&](Group base, std::vector<Group> joint_groups, Group tool_group) {
    model.groups.push_back(std::move(base));
    for (Group& group : joint_groups) model.groups.push_back(std::move(group));
    model.groups.push_back(std::move(tool_group));
  };
  if (form == ModelForm::exponentials) {
    finish({}, twist_groups(chain), placement(tool, rotation));
    return model;
  }
  if (form == ModelForm::s_model) {
    const Isometry3d last = stone_frame(chain, joints() - 1).pose();
    Group to_tool = placement(last.inverse() * tool, rotation);
    // Zero by the choice of the frame.
    if (!target_on_axis_.back()) to_tool[1].number.knowledge = Knowledge::by_convention;
    to_tool[2].number.knowledge = Knowledge::by_convention;
    Group base = placement(stone_frame(chain, 0).pose(), Knowledge::identified);
    if (source_.dh.front().linear) leave_place(base);
    finish(std::move(base), stone_groups(chain), std::move(to_tool));
    return model;
  }
  const std::vector<AxisFrame> frames = table_frames(chain);
  const Isometry3d to_tool = frames.back().pose().inverse() * tool;
  if (form == ModelForm::urdf) {
    finish({}, urdf_groups(frames), urdf_placement(joints() + 1, to_tool));
    return model;
  }
  Group base = placement(frames.front().pose(), Knowledge::identified);
  if (source_.dh.front().linear) leave_place(base);
  finish(std::move(base), dh_groups(form), placement(to_tool, rotation));
  return model;
}

}  // namespace identify
