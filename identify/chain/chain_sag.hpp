#pragma once

#include <array>
#include <vector>

#include "identify/chain/chain.hpp"

namespace identify {

/// How a weight on a link pulls about a joint before it, by how the joints turned. A weight at r
/// from the axis of the joint that turns its link pulls about joint j, direction z_j, in proportion
/// to up . (z_j x r), summed with what hangs where that axis is: which turns with a link before,
/// and is a weight on that one. So of each link two numbers tell all that its weights do, across
/// its axis (base parameters: Khalil & Dombre, Modeling, Identification and Control of
/// Robots, 9.4).
class LinkLevers {
 public:
  /// The chain must outlive it. Linear joints turn nothing.
  LinkLevers(const Chain& chain, const Turns& turns);
  /// Of a weight on the link that joint `link` turns, at a unit length along `arm`, as it is at
  /// home. Joints are counted from 0; `link` is not before `joint`.
  [[nodiscard]] double lever(std::size_t joint, std::size_t link, const Eigen::Vector3d& arm) const;

 private:
  const Chain* chain_;
  std::array<Eigen::Matrix3d, kMostJoints> turned_;  ///< of each link
};

/// A chain's sags for joints that give way by `sag_rad` at their worst pose (standard deviations,
/// one a joint): under two weights on each link behind, as large as the links' lengths have them
/// where mass is spread evenly along the arm. Shares are in the largest of `sag_rad`. Nothing where
/// nobody knows which way is up. Linear joints do not give way, nor does one that stands upright.
[[nodiscard]] std::vector<ChainSag> sags_of(const Chain& chain, const std::vector<bool>& known,
                                            const std::vector<double>& sag_rad);

/// Of each sag of the chain, its lever where the joints turned so far less that at home.
[[nodiscard]] std::vector<double> sag_levers(const Chain& chain, const Turns& turns);

/// How far the joints really turned, those that give way with what they sag by.
[[nodiscard]] Turns sagged(const Chain& chain, const Turns& turns);

}  // namespace identify
