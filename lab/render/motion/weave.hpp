#pragma once

#include <array>

#include "lab/render/scene/path.hpp"
#include "lab/render/world_settings.hpp"

namespace cartvo::world {

/// Lateral deviation of a lively drive from its path: two sines of the distance along the path, the same in
/// each lap. Zero in a calm drive.
class Weave {
 public:
  Weave(const Path& path, const WorldSettings& settings);

  double lateral(double distance) const;    ///< m to the left of the path, at most kMaximum
  double slope(double distance) const;      ///< derivative of lateral by the distance
  double curvature(double distance) const;  ///< second derivative, 1/m

  static constexpr double kMaximum = 0.4;  ///< m

 private:
  struct Sine {
    double amplitude = 0.0;    ///< m
    double wave_number = 0.0;  ///< rad/m
    double phase = 0.0;        ///< rad
  };
  std::array<Sine, 2> sines_;
};

}  // namespace cartvo::world
