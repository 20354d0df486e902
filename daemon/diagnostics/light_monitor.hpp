#pragma once

#include <array>
#include <string>

#include <cartvo/odometry_t.hpp>

#include "pipeline/pair_processor.hpp"

namespace cartvo::daemon {

/// Finds whether light and texture of the pictures explain why pairs are INVALID. Not thread-safe.
class LightMonitor {
 public:
  /// Adds a pair, published as `message`.
  void add(const pipeline::PairResult& result, const odometry_t& message);

  /// Whether both pictures showed enough to compare them, when they were measured last.
  bool hasTexture() const;

  /// "left camera: the picture is dark: ..."; empty unless most pairs since the last call are INVALID for
  /// reasons that the light of a camera explains (by night with lamps the odometry may well be VALID), or for
  /// want of features.
  std::string consumeProblem();

 private:
  std::array<pipeline::PictureLight, 2> light_{};  ///< as measured last
  int pairs_ = 0, featureless_ = 0;                ///< all, and INVALID with too few features
  std::array<int, 2> unlit_{};  ///< of them INVALID for reasons that each camera's light explains
};

}  // namespace cartvo::daemon
