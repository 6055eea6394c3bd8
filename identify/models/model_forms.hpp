#pragma once

#include <optional>
#include <vector>

#include "identify/dh/dh.hpp"
#include "identify/models/kinematic_model.hpp"

namespace identify {

/// Writes chains that differ little from `source.chain` down in every form. What has to be chosen
/// is chosen for that one, so that the numbers change smoothly. DH numbers are those of the table
/// for each; base, tool and the numbers of the other forms follow the chain that is given.
class ModelForms {
 public:
  explicit ModelForms(const ModelSource& source);

  /// Without uncertainties but for those of DH numbers.
  [[nodiscard]] KinematicModel written(const Chain& chain, ModelForm form) const;

 private:
  [[nodiscard]] std::size_t joints() const { return source_.chain.axes.size(); }
  [[nodiscard]] Line z_axis(const Chain& chain, std::size_t joint) const;
  [[nodiscard]] std::vector<AxisFrame> table_frames(const Chain& chain) const;
  [[nodiscard]] AxisFrame stone_frame(const Chain& chain, std::size_t joint) const;

  [[nodiscard]] ModelNumber positive(std::size_t joint) const;
  [[nodiscard]] std::vector<KinematicModel::Group> dh_groups(ModelForm form) const;
  [[nodiscard]] std::vector<KinematicModel::Group> stone_groups(const Chain& chain) const;
  [[nodiscard]] std::vector<KinematicModel::Group> twist_groups(const Chain& chain) const;
  [[nodiscard]] std::vector<KinematicModel::Group> urdf_groups(
      const std::vector<AxisFrame>& frames) const;
  [[nodiscard]] KinematicModel::Group urdf_placement(std::size_t group,
                                                     const Eigen::Isometry3d& pose) const;

  const ModelSource& source_;
  std::vector<Eigen::Vector3d> normals_;        // X of the table's frames 2 to n, but for beta
  std::vector<Eigen::Vector3d> stone_normals_;  // of the S-model's links 1 to n-1
  std::vector<bool> target_on_axis_;
  std::vector<std::optional<double>> held_yaw_;  // one a group of `urdf`
};

}  // namespace identify
