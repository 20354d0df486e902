// Renders each world once and keeps its images on disk, because rendering takes minutes.
#include "tools/benchmark/world_cache.hpp"

#include <cerrno>
#include <cstdio>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "capture/dataset/image_folder.hpp"
#include "tools/simulate/content_files.hpp"

namespace cartvo::benchmark {
namespace fs = std::filesystem;
namespace {

/// An exclusive lock between processes. The kernel releases it when the process ends for any reason.
class FileLock {
 public:
  explicit FileLock(const fs::path& file)
      : descriptor_(::open(file.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644)) {
    if (descriptor_ < 0 || ::flock(descriptor_, LOCK_EX) != 0) {
      const std::string reason = std::generic_category().message(errno);
      if (descriptor_ >= 0) ::close(descriptor_);
      throw std::runtime_error(file.string() + ": cannot be locked for rendering: " + reason);
    }
  }
  ~FileLock() { ::close(descriptor_); }
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  int descriptor_;
};

/// A world whose left images are read from disk: they do not depend on the time offset of the right camera.
class WithLeftImages final : public simulate::Content {
 public:
  WithLeftImages(const world::RenderedWorld& world, fs::path left_images)
      : world_(world), left_images_(std::move(left_images)) {}

  calib::Rig rig() const override { return world_.rig(); }
  double frameRate() const override { return world_.frameRate(); }
  int pairCount() const override { return world_.pairCount(); }
  std::int64_t leftInstant(int index) const override { return world_.leftInstant(index); }
  std::int64_t rightInstant(int index) const override { return world_.rightInstant(index); }
  Trajectory truth() const override { return world_.truth(); }
  std::string cacheKey() const override { return world_.cacheKey(); }
  void images(int index, cv::Mat& left, cv::Mat& right) const override {
    char name[24];
    std::snprintf(name, sizeof name, "%06d.png", index);
    left = capture::readGreyImage(left_images_ / name);
    right = world_.image(index, capture::CameraSide::right);
  }

 private:
  const world::RenderedWorld& world_;
  fs::path left_images_;
};

}  // namespace

WorldCache::WorldCache(fs::path folder) : folder_(std::move(folder)) {}

fs::path WorldCache::folderOf(const world::RenderedWorld& world) const {
  return folder_ / world.cacheKey();  // a valid file name: letters, digits, dots and hyphens
}

void WorldCache::render(const fs::path& images, const world::RenderedWorld& world,
                        const simulate::Progress& progress) const {
  world::WorldSettings synchronised = world.settings();
  synchronised.offset_s = synchronised.offset_drift_ppm = 0.0;
  const fs::path left_images = folderOf(world::RenderedWorld(synchronised)) / "image_0";
  if (fs::exists(left_images)) {
    simulate::renderFolder(images, WithLeftImages(world, left_images), progress);
  } else {
    simulate::renderFolder(images, world, progress);
  }
}

fs::path WorldCache::rendered(const world::RenderedWorld& world, const simulate::Progress& progress) const {
  fs::path images = folderOf(world);
  if (fs::exists(images)) return images;
  fs::create_directories(folder_);
  fs::path lock_file = images;
  lock_file += ".lock";
  const FileLock lock(lock_file);
  if (!fs::exists(images)) render(images, world, progress);
  fs::remove(lock_file);
  return images;
}

}  // namespace cartvo::benchmark
