#pragma once

#include <filesystem>

#include "lab/render/rendered_world.hpp"
#include "tools/simulate/stream/encode_content.hpp"

namespace cartvo::benchmark {

/// A cache of rendered worlds on disk: image folders with their truth, as written by `cartvo simulate
/// --render`, each under its cache key. Entries are never deleted automatically; a minute of driving takes
/// 0.4 GB.
class WorldCache {
 public:
  explicit WorldCache(std::filesystem::path folder);

  /// Returns the folder of the images of `world`, and renders them if they are missing. If the same world is
  /// cached with synchronised cameras, only the right images are rendered. A second process that needs the
  /// same world waits for the first.
  std::filesystem::path rendered(const world::RenderedWorld& world, const simulate::Progress& progress) const;

 private:
  std::filesystem::path folderOf(const world::RenderedWorld& world) const;
  void render(const std::filesystem::path& images, const world::RenderedWorld& world,
              const simulate::Progress& progress) const;

  std::filesystem::path folder_;
};

}  // namespace cartvo::benchmark
