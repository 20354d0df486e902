#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "calib/rectification.hpp"
#include "calib/rig.hpp"

namespace cartvo {

/// Where each rectified pixel comes from in the raw image, row by row, in fixed point with 8 fractional bits:
/// the source lies at (column + column_fraction / 256, row + row_fraction / 256), rounded to the nearest
/// 1/256 px (cv::remap's maps round to 1/32 px). Always column <= width - 2 and row <= height - 2 of the raw
/// image, so that the four pixels around the source exist; a source outside the image is moved to its border.
struct PixelSources {
  std::vector<std::uint16_t> column;
  std::vector<std::uint16_t> row;
  std::vector<std::uint8_t> column_fraction;
  std::vector<std::uint8_t> row_fraction;

  bool operator==(const PixelSources&) const = default;
};

/// Both cameras' tables. Empty for a rig whose images are rectified already.
struct RectificationTables {
  cv::Size size;                  ///< of raw and rectified images, px
  std::uint64_t fingerprint = 0;  ///< of the rig and settings they were computed from
  PixelSources left;
  PixelSources right;

  bool operator==(const RectificationTables&) const = default;
};

/// A hash of all that the tables depend on: the cameras, their relative pose, the settings. Not the rig's
/// name or its place on the cart.
std::uint64_t tablesFingerprint(const Rig& rig, const RectificationSettings& settings);

RectificationTables buildTables(const Rig& rig, const RectificationSettings& settings);

/// Writes the tables, atomically: magic, version, size, fingerprint, the arrays, and an XXH3 checksum over
/// all before it; little-endian.
void writeTables(const std::filesystem::path& file, const RectificationTables& tables);

/// The file holds whole tables, but of another rig or other settings.
class TablesOfAnotherRig : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The tables of a rig of this image size and fingerprint. Throws TablesOfAnotherRig, or std::runtime_error
/// naming the file and what is wrong with it. Reads no more bytes than `size` calls for.
RectificationTables readTables(const std::filesystem::path& file, cv::Size size, std::uint64_t fingerprint);

/// Where loaded tables come from.
enum class TablesOrigin : std::uint8_t {
  loaded,       ///< from the file
  first_built,  ///< there was no file
  rig_changed,  ///< the file was another rig's: rebuilt
  damaged,      ///< the file could not be used: rebuilt
};

struct LoadedTables {
  RectificationTables tables;
  TablesOrigin origin = TablesOrigin::loaded;
  std::string
      explanation;  ///< a sentence for the log: what was done and why; also if the file was not writable
};

/// The tables of a rig, from `file` if they are there and whole, else computed and kept there. A file that
/// cannot be written is said in `explanation` and harms nothing.
LoadedTables loadOrBuildTables(const Rig& rig, const RectificationSettings& settings,
                               const std::filesystem::path& file);

}  // namespace cartvo
