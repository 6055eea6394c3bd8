#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "daemon/drawing/picture.hpp"

namespace sweepd {

/// How space is seen: which way is to the right and which is up in the picture, with perspective or
/// without. Lengths are those of the points, mm as a rule.
class View {
 public:
  /// `right` and `up` are unit vectors at right angles; the eye looks against right x up.
  View(const Eigen::Vector3d& right, const Eigen::Vector3d& up) : right_(right), up_(up) {}

  /// From above, from the front (against Y), from the side (against X).
  [[nodiscard]] static View top();
  [[nodiscard]] static View front();
  [[nodiscard]] static View side();
  /// From the front, right and above, as pictures of robots are drawn.
  [[nodiscard]] static View oblique();
  /// Nearly against Z: X to the right, Y up, Z towards the eye and a little up.
  [[nodiscard]] static View nearly_flat();
  /// As oblique() with perspective, for what fills a ball of `radius` about `middle`.
  [[nodiscard]] static View perspective(const Eigen::Vector3d& middle, double radius);

  /// From now on the points all fit into `frame`, as large as they can, in the middle of it.
  void fit(std::span<const Eigen::Vector3d> points, const Frame& frame);

  [[nodiscard]] Spot spot(const Eigen::Vector3d& point) const;
  [[nodiscard]] std::vector<Spot> spots(std::span<const Eigen::Vector3d> points) const;
  /// px a mm, in the middle of the picture.
  [[nodiscard]] double scale() const { return scale_; }
  /// How far right and up in space a spot is, without perspective: for ticks.
  [[nodiscard]] Eigen::Vector2d place(const Spot& spot) const;

 private:
  [[nodiscard]] Eigen::Vector2d seen(const Eigen::Vector3d& point) const;

  Eigen::Vector3d right_;
  Eigen::Vector3d up_;
  Eigen::Vector3d middle_ = Eigen::Vector3d::Zero();
  double distance_ = 0;  // of the eye from the middle; 0: infinitely far
  double scale_ = 1;
  Spot origin_ = Spot::Zero();
};

/// X, Y and Z of the frame that is seen, as arrows from `corner`.
void draw_triad(Picture& picture, const View& view, const Spot& corner);

}  // namespace sweepd
