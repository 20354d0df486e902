#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/rig.hpp"
#include "capture/pair_synchroniser.hpp"

namespace cartvo::benchmark {

/// A drive's pairs, decoded, so that what is timed reads no files.
struct DriveInMemory {
  std::string name;
  Rig rig;
  std::vector<FramePair> pairs;
};

/// The first `most` pairs of an image folder with its rig. Throws std::runtime_error naming the file that
/// cannot be read.
DriveInMemory loadDrive(const std::string& name, const std::filesystem::path& folder, int most);

/// Whether its images are rectified already, so that nothing is left to do for the rectifier.
bool isRectified(const DriveInMemory& drive);

/// The drive as two cameras with lenses would have taken it, for a rectified one, whose pairs otherwise do
/// not tell what rectification costs. No pixel lacks a source, as a pincushion lens sees less
/// than a pinhole. The images are interpolated a second time, so that errors are not the drive's.
DriveInMemory throughLenses(const DriveInMemory& rectified);

}  // namespace cartvo::benchmark
