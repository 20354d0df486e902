// The start of the pictures, and the ranges of the settings.
#include "lab/render/world_settings.hpp"

#include <cmath>
#include <stdexcept>

namespace cartvo::world {
namespace {

void require(bool holds, const std::string& what) {
  if (!holds) throw std::invalid_argument("rendered world: " + what);
}

}  // namespace

const WorldSettings& validated(const WorldSettings& s) {
  require(s.seconds > 0.0 && s.seconds <= 3600.0, "seconds must lie in (0, 3600]");
  require(s.frame_rate > 0.0 && s.frame_rate <= 240.0, "frame_rate must lie in (0, 240] Hz");
  require(s.liveliness >= 0.0 && s.liveliness <= 1.0, "liveliness must lie in [0, 1]");
  require(s.liveliness == 0.0 || canBeLively(s.scenario),
          "liveliness must be 0 in the scenario " + std::string(scenarioName(s.scenario)));
  require(s.lead_in_seconds >= 0.0, "lead_in_seconds must not be negative");
  require(startOf(s) >= 0.0 && startOf(s) <= 3600.0, "start_seconds must lie in [0, 3600]");
  require(std::abs(s.offset_s) <= 1.0, "offset_s must lie in [-1, 1] s");
  require(std::abs(s.offset_drift_ppm) <= 10000.0, "offset_drift_ppm must lie in [-10000, 10000]");
  for (const double readout : {s.left_readout, s.right_readout}) {
    require(std::abs(readout) * s.frame_rate <= 1.0,
            "left_readout and right_readout must not be longer than a frame period");
  }
  require(s.shake.frequency >= 0.0 && s.shake.frequency <= 50.0, "shake.frequency must lie in [0, 50] Hz");
  require(s.shake.frequency > 0.0 || s.shake.amplitude == 0.0,
          "shake.frequency must not be 0 in a vibration");
  require(s.shake.amplitude >= 0.0 && s.shake.amplitude <= 0.1, "shake.amplitude must lie in [0, 0.1] rad");
  require(s.image_size.width >= 32 && s.image_size.width <= 4096 && s.image_size.height >= 32 &&
              s.image_size.height <= 4096,
          "image_size must lie between 32x32 and 4096x4096");
  require(s.focal_length >= 0.4 * s.image_size.width,
          "focal_length must be at least 0.4 of the image's width");
  require(s.baseline > 0.0 && s.baseline <= 2.0, "baseline must lie in (0, 2] m");
  require(s.edge_samples >= 0 && s.edge_samples <= 64 && s.edge_samples % 4 == 0,
          "edge_samples must be a multiple of 4 in [0, 64]");
  require(s.noise >= 0.0, "noise must not be negative");
  require(s.threads >= 1 && s.threads <= 256, "threads must lie in [1, 256]");
  return s;
}

bool canBeLively(Scenario scenario) {
  return scenario != Scenario::motorway;
}

double startOf(const WorldSettings& settings) {
  constexpr double kUntilFullSpeed = 3.0;  // s
  if (settings.start_seconds) return *settings.start_seconds;
  return settings.liveliness > 0.0 ? settings.lead_in_seconds + kUntilFullSpeed : 0.0;
}

}  // namespace cartvo::world
