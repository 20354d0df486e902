#pragma once

#include "lab/render/world_settings.hpp"

namespace cartvo::test {

/// A drive that renders in a few seconds: half the image size, 9 Hz, 0.7 s.
inline world::WorldSettings tinyWorld() {
  world::WorldSettings settings;
  settings.image_size = {340, 210};
  settings.focal_length = 240.0;
  settings.frame_rate = 9.0;
  settings.lead_in_seconds = 0.0;
  settings.seconds = 0.7;
  settings.edge_samples = 0;
  return settings;
}

}  // namespace cartvo::test
