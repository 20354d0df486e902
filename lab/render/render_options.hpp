#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "lab/render/world_settings.hpp"

namespace cartvo {

class Command;

/// Command-line options of `cartvo-render`.
struct RenderOptions {
  std::string world = "campus";
  double seconds = 6.0;  ///< about two pairs a second are rendered on two cores
  world::WorldSettings drive;
  std::string size = "680x420";
  std::optional<double> offset_ms;         ///< empty: see worldSettings
  std::optional<double> offset_drift_ppm;  ///< empty: see worldSettings
  std::string readout_ms;                  ///< empty: see worldSettings
  double shake_degrees = 0.0;
  std::filesystem::path output = "drive";
  bool print_key = false;
};

/// The settings of the options. By default cameras are as users' cameras: they run free, such that the
/// offset passes through a whole frame period from minus a quarter of it (through as much as 10000 ppm permit
/// in a short drive), and read their rows in 32 ms, or in 0.96 of a shorter frame period. If one of offset
/// and drift is given, the other is 0.
world::WorldSettings worldSettings(const RenderOptions& options);

/// Adds the options to `command`; `options` must outlive it.
void addRenderOptions(Command command, RenderOptions& options);

}  // namespace cartvo
