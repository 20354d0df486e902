#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/model/rig.hpp"
#include "capture/pair_synchroniser.hpp"

namespace cartvo::benchmark {

/// The decoded pairs of a drive in memory, so that timing excludes reading files.
struct DriveInMemory {
  std::string name;
  calib::Rig rig;
  std::vector<capture::FramePair> pairs;
};

/// Loads at most `max_pairs` pairs from the start of an image folder, and its rig. Throws std::runtime_error
/// naming the file that cannot be read.
DriveInMemory loadDrive(const std::string& name, const std::filesystem::path& folder, int max_pairs);

/// Whether the images are already rectified, so that the rectifier has nothing to do.
bool isRectified(const DriveInMemory& drive);

/// Distorts a rectified drive as by two cameras with lenses, to measure the cost of rectification. Every
/// pixel has a source, because a pincushion lens sees less than a pinhole. The additional interpolation makes
/// the drive unfit for measuring accuracy.
DriveInMemory throughLenses(const DriveInMemory& rectified);

}  // namespace cartvo::benchmark
