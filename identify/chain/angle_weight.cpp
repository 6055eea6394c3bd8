#include "identify/chain/angle_weight.hpp"

#include <algorithm>
#include <cstddef>

namespace identify {

AngleWeight weight_by_speed(const std::vector<double>& squares,
                            const std::vector<double>& squared_speeds, double mean) {
  constexpr double kLeastShare = 0.01;  // of the mean, at rest
  constexpr int kRounds = 4;
  AngleWeight weight{mean};
  for (int round = 0; round < kRounds; ++round) {
    double w = 0, ws = 0, wss = 0, wv = 0, wsv = 0;
    for (std::size_t i = 0; i < squared_speeds.size(); ++i) {
      const double speed = squared_speeds[i];
      const double each = weight.still + weight.per_speed * speed;
      const double one = 1 / (each * each);
      w += one;
      ws += one * speed;
      wss += one * speed * speed;
      wv += one * squares[i];
      wsv += one * speed * squares[i];
    }
    const double determinant = w * wss - ws * ws;
    if (!(determinant > 1e-9 * w * wss)) break;
    weight.per_speed = std::max(0.0, (w * wsv - ws * wv) / determinant);
    weight.still = std::max(kLeastShare * mean, (wv - weight.per_speed * ws) / w);
  }
  return weight;
}

}  // namespace identify
