#pragma once

#include <vector>

#include <Eigen/Core>

#include "identify/sweeps/stroke_curve.hpp"
#include "identify/sweeps/stroke_moments.hpp"

namespace identify {

/// How many of the 64 equal parts of a stroke's turn (rad) hold a sample: readings at a few stops
/// are at a few places, however many they are.
[[nodiscard]] Eigen::Index places_of(const Eigen::ArrayXd& turns, double from, double to);

/// The nodes at which a stroke's moments are made. Twelve hold what a model says over an eighth of
/// a circle; so longer strokes are cut.
class StrokeSections {
 public:
  static constexpr Eigen::Index kMostNodes = 12;

  /// One section's nodes, and the polynomials of the others' zeros that are one there.
  struct Section {
    Eigen::ArrayXd places;  ///< from minus one to one in it
    /// One column a node: its polynomial, in Chebyshev polynomials. L_k(x_j) = 1 where j = k, else
    /// 0.
    Eigen::MatrixXd lagrange;
  };

  /// Chebyshev's, for samples that are spread evenly along the turn.
  StrokeSections(const StrokeMoments& stroke, Eigen::Index samples);
  /// Where the samples are: Gauss' nodes of their weights along the turn, at which sums of positive
  /// weights are positive (Golub & Welsch, Mathematics of Computation 23, 1969). At most so many a
  /// section.
  StrokeSections(const StrokeMoments& stroke, const Eigen::ArrayXd& turns,
                 const Eigen::ArrayXd& weights, Eigen::Index most = kMostNodes);
  /// Those that a stroke's moments have.
  static StrokeSections of(const StrokeMoments& stroke);

  [[nodiscard]] const std::vector<Section>& sections() const { return sections_; }
  [[nodiscard]] double turn(std::size_t section, double place) const {
    return from_ + length_ * (static_cast<double>(section) + (place + 1) / 2);
  }
  [[nodiscard]] std::size_t at(double turn_rad) const;
  /// Of these turns, from minus one to one in their section.
  [[nodiscard]] Eigen::ArrayXd places(std::size_t section,
                                      const Eigen::Ref<const Eigen::ArrayXd>& turns) const;
  /// Whether a stroke with moments at these nodes has samples around each of them.
  [[nodiscard]] bool suit(const StrokeMoments& stroke) const;
  /// Whether no node of a stroke's moments has its mean beside all samples.
  [[nodiscard]] static bool positive(const StrokeMoments& stroke);

 private:
  explicit StrokeSections(const StrokeMoments& stroke);
  [[nodiscard]] double place_in(std::size_t section, double turn_rad) const;

  double from_;
  double length_ = 0;
  std::vector<Section> sections_;
};

}  // namespace identify
