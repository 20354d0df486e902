#pragma once

#include <filesystem>

#include "tools/simulate/encode_content.hpp"
#include "tools/world/rendered_world.hpp"

namespace cartvo::benchmark {

/// Rendered worlds kept on disk as image folders with their truth, as `cartvo simulate --render` writes them,
/// each under its cache key. They are never removed by themselves: a minute of drive takes 0.4 GB.
class WorldCache {
 public:
  explicit WorldCache(std::filesystem::path folder);

  /// The folder of `world`'s images, rendered now if they are not there yet: only the right camera's where
  /// the same world is there with cameras that are exposed at once. A second process that wants the same
  /// world waits for the first.
  std::filesystem::path rendered(const world::RenderedWorld& world, const simulate::Progress& progress) const;

 private:
  std::filesystem::path folderOf(const world::RenderedWorld& world) const;
  void render(const std::filesystem::path& images, const world::RenderedWorld& world,
              const simulate::Progress& progress) const;

  std::filesystem::path folder_;
};

}  // namespace cartvo::benchmark
