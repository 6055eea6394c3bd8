#include "identify/models/kinematic_model.hpp"

#include <algorithm>

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

}  // namespace identify
