#pragma once

#include <string_view>

#include "identify/sweeps/sweep.hpp"

namespace sweepd {

/// Hears what is found in a stream, in its order: what is not overridden is not listened to. On the
/// thread that brings the telegrams.
class StreamSink {
 public:
  virtual ~StreamSink() = default;

  /// A sample, and its row of samples.csv ("t_s,ipoc,x,y,z,…") without an end of line.
  virtual void sample(const identify::Sample& /*sample*/, std::string_view /*row*/) {}
  virtual void sweep(const identify::Sweep& /*sweep*/) {}
};

}  // namespace sweepd
