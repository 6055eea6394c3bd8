#include "identify/models/kinematic_model.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "identify/models/model_forms.hpp"

namespace identify {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Translation3d;
using Eigen::Vector3d;
using Group = KinematicModel::Group;

/// What a form leaves out is zero.
double value(const Group& group, std::string_view name) {
  const auto at = std::find_if(group.begin(), group.end(),
                               [&](const ModelNumber& number) { return number.name == name; });
  return at == group.end() ? 0 : at->number.value;
}

Vector3d vector(const Group& group, std::string_view x, std::string_view y, std::string_view z) {
  return {value(group, x), value(group, y), value(group, z)};
}

AngleAxisd about_x(double angle) {
  return {angle, Vector3d::UnitX()};
}
AngleAxisd about_y(double angle) {
  return {angle, Vector3d::UnitY()};
}
AngleAxisd about_z(double angle) {
  return {angle, Vector3d::UnitZ()};
}

Isometry3d roll_pitch_yaw(const Group& group) {
  return Translation3d(vector(group, "x", "y", "z")) * about_z(value(group, "yaw")) *
         about_y(value(group, "pitch")) * about_x(value(group, "roll"));
}

Isometry3d placement(const Group& group, ModelForm form) {
  if (group.empty()) return Isometry3d::Identity();
  if (form == ModelForm::urdf) return roll_pitch_yaw(group);
  Isometry3d pose = Isometry3d::Identity();
  pose.translation() = vector(group, "x", "y", "z");
  pose.linear() << vector(group, "r11", "r12", "r13").transpose(),
      vector(group, "r21", "r22", "r23").transpose(),
      vector(group, "r31", "r32", "r33").transpose();
  return pose;
}

Isometry3d exponential(const Group& group, double turn, bool linear) {
  if (linear) return Isometry3d(Translation3d(kLinear_mm * turn * vector(group, "vx", "vy", "vz")));
  const Vector3d w = vector(group, "wx", "wy", "wz");
  const Translation3d point(w.cross(vector(group, "vx", "vy", "vz")));
  return point * AngleAxisd(turn, w) * point.inverse();
}

/// A joint turned by `turn`, and the link after it (before it in modified DH and URDF).
Isometry3d link(const Group& group, ModelForm form, double turn, bool linear) {
  const auto number = [&](std::string_view name) { return value(group, name); };
  const double about_axis = linear ? 0 : number("positive") * turn;
  const double along_axis = linear ? kLinear_mm * number("positive") * turn : 0;
  switch (form) {
    case ModelForm::dh:
    case ModelForm::hayati:
      return transform({number("b") + along_axis, number("theta") + about_axis, number("a"),
                        number("alpha"), number("beta")});
    case ModelForm::modified_dh:
      return about_x(number("alpha")) * Translation3d(number("a"), 0, 0) * about_y(number("beta")) *
             about_z(number("theta") + about_axis) * Translation3d(0, 0, number("b") + along_axis);
    case ModelForm::s_model:
      return about_z(number("beta") + about_axis) *
             Translation3d(number("a"), 0, number("d") + along_axis) * about_x(number("alpha")) *
             about_y(number("hayati_beta")) * about_z(number("gamma")) *
             Translation3d(0, 0, number("b"));
    case ModelForm::exponentials:
      return exponential(group, turn, linear);
    case ModelForm::urdf:
      if (linear)
        return roll_pitch_yaw(group) *
               Translation3d(0, 0, number("axis_z") * (number("home") + kLinear_mm * turn));
      return roll_pitch_yaw(group) * about_z(number("axis_z") * (number("home") + turn));
  }
  return Isometry3d::Identity();
}

}  // namespace

std::string_view text(ModelForm form) noexcept {
  switch (form) {
    case ModelForm::dh:
      return "dh";
    case ModelForm::modified_dh:
      return "modified_dh";
    case ModelForm::hayati:
      return "hayati";
    case ModelForm::s_model:
      return "s_model";
    case ModelForm::exponentials:
      return "exponentials";
    case ModelForm::urdf:
      return "urdf";
  }
  return "";
}

Isometry3d forward_kinematics_without_tool(const KinematicModel& model, const Turns& turns) {
  Isometry3d pose = placement(model.groups.front(), model.form);
  for (std::size_t j = 0; j < model.joints(); ++j)
    pose = pose * link(model.groups[j + 1], model.form, turns[j],
                       j < model.linear.size() && model.linear[j]);
  return pose;
}

Isometry3d forward_kinematics(const KinematicModel& model, const Turns& turns) {
  return forward_kinematics_without_tool(model, turns) * placement(model.groups.back(), model.form);
}

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

bool complete(const std::vector<DhEstimate>& table) {
  return !table.empty() && std::none_of(table.begin(), table.end(), [](const DhEstimate& row) {
    const auto unknown = [](const DhNumber& number) {
      return number.knowledge == Knowledge::undetermined;
    };
    return unknown(row.b_mm) || unknown(row.theta_rad) || unknown(row.a_mm) ||
           unknown(row.alpha_rad) || unknown(row.beta_rad);
  });
}

template <typename Model, typename Visit>
void for_each_number(Model& model, Visit visit) {
  for (auto& group : model.groups)
    for (auto& entry : group) visit(entry);
}

/// The chain moved by `by` along one of the coordinates in which `covariance` is given.
Chain moved_along(const Chain& chain, Index coordinate, double by) {
  Chain moved = chain;
  const auto axes = static_cast<Index>(6 * chain.axes.size());
  const auto targets = static_cast<Index>(3 * chain.targets_mm.size());
  if (coordinate < axes) {
    ChainAxis& axis = moved.axes[static_cast<std::size_t>(coordinate / 6)];
    const Index k = coordinate % 6;
    (k < 3 ? axis.direction(k) : axis.point_mm(k - 3)) += by;
  } else if (coordinate < axes + targets) {
    const Index k = coordinate - axes;
    moved.targets_mm[static_cast<std::size_t>(k / 3)](k % 3) += by;
  } else {
    moved.tool = Eigen::AngleAxisd(by, Vector3d::Unit(coordinate - axes - targets)) * chain.tool;
  }
  return moved;
}

bool is_length(const Chain& chain, Index coordinate) {
  const auto axes = static_cast<Index>(6 * chain.axes.size());
  const auto targets = static_cast<Index>(3 * chain.targets_mm.size());
  return coordinate < axes ? coordinate % 6 >= 3 : coordinate < axes + targets;
}

void add_uncertainties(KinematicModel& model, const ModelForms& forms, const ModelSource& source) {
  constexpr double kAngleStep = 1e-6;
  constexpr double kLengthStep_mm = 1e-3;
  std::vector<ModelNumber*> numbers;
  for_each_number(model, [&](ModelNumber& entry) { numbers.push_back(&entry); });
  const Index columns = source.covariance.cols();
  MatrixXd jacobian(static_cast<Index>(numbers.size()), columns);
  for (Index p = 0; p < columns; ++p) {
    const double step = is_length(source.chain, p) ? kLengthStep_mm : kAngleStep;
    const auto above = forms.written(moved_along(source.chain, p, step), model.form);
    const auto below = forms.written(moved_along(source.chain, p, -step), model.form);
    Index row = 0;
    for_each_number(above,
                    [&](const ModelNumber& entry) { jacobian(row++, p) = entry.number.value; });
    row = 0;
    for_each_number(below, [&](const ModelNumber& entry) {
      const double change = jacobian(row, p) - entry.number.value;
      jacobian(row++, p) =
          (entry.quantity == Quantity::angle ? wrapped(change) : change) / (2 * step);
    });
  }
  const MatrixXd spread = jacobian.lazyProduct(source.covariance);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    DhNumber& number = numbers[i]->number;
    const double variance =
        spread.row(static_cast<Index>(i)).dot(jacobian.row(static_cast<Index>(i)));
    // The table's own numbers did not change, and keep their uncertainty.
    if (number.knowledge == Knowledge::identified && !(variance <= 0))
      number.sigma = std::sqrt(variance);
  }
}

bool is_finite(const KinematicModel& model) {
  bool all = true;
  for_each_number(model, [&](const ModelNumber& entry) {
    all = all && std::isfinite(entry.number.value) && std::isfinite(entry.number.sigma);
  });
  return all;
}

}  // namespace

std::vector<KinematicModel> kinematic_models(const ModelSource& given) {
  const bool whole = given.chain.axes.size() == given.dh.size() && !given.chain.targets_mm.empty();
  if (!whole || !complete(given.dh)) return {};
  ModelSource source = given;
  source.positive.resize(source.dh.size(), 1);
  source.home_rad.resize(source.dh.size());
  const ModelForms forms(source);
  std::vector<KinematicModel> models;
  for (const ModelForm form : kModelForms) {
    KinematicModel& model = models.emplace_back(forms.written(source.chain, form));
    if (source.covariance.size() > 0) add_uncertainties(model, forms, source);
    if (!is_finite(model)) return {};
  }
  return models;
}

}  // namespace identify
