// Rendering costs minutes: each world is rendered once.
#include "tools/benchmark/world_cache.hpp"

#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "tools/simulate/content_files.hpp"

namespace cartvo::benchmark {
namespace fs = std::filesystem;
namespace {

/// Held by one process at a time; the kernel lets go of it when the process ends, however it does.
class FileLock {
 public:
  explicit FileLock(const fs::path& file)
      : descriptor_(::open(file.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644)) {
    if (descriptor_ < 0 || ::flock(descriptor_, LOCK_EX) != 0) {
      const std::string reason = std::generic_category().message(errno);
      if (descriptor_ >= 0) ::close(descriptor_);
      throw std::runtime_error(file.string() + ": cannot be locked: " + reason);
    }
  }
  ~FileLock() { ::close(descriptor_); }
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  int descriptor_;
};

}  // namespace

WorldCache::WorldCache(fs::path folder) : folder_(std::move(folder)) {}

fs::path WorldCache::folderOf(const world::RenderedWorld& world) const {
  return folder_ / world.cacheKey();  // letters, digits, dots and hyphens
}

fs::path WorldCache::rendered(const world::RenderedWorld& world, const simulate::Progress& progress) const {
  fs::path images = folderOf(world);
  if (fs::exists(images)) return images;
  fs::create_directories(folder_);
  fs::path lock_file = images;
  lock_file += ".lock";
  const FileLock lock(lock_file);
  if (!fs::exists(images)) simulate::renderFolder(images, world, progress);
  fs::remove(lock_file);
  return images;
}

}  // namespace cartvo::benchmark
