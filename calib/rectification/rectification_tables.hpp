#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "calib/model/rig.hpp"
#include "calib/rectification/rectification.hpp"

namespace cartvo::calib {

/// Source position in the raw image of each rectified pixel, row by row, in fixed point with 8 fractional
/// bits: (column + column_fraction / 256, row + row_fraction / 256), rounded to the nearest 1/256 px
/// (cv::remap rounds to 1/32 px). Always column <= width - 2 and row <= height - 2 of the raw image, so that
/// the four pixels around the source exist; a source outside the image is moved to its border.
struct PixelSources {
  std::vector<std::uint16_t> column;
  std::vector<std::uint16_t> row;
  std::vector<std::uint8_t> column_fraction;
  std::vector<std::uint8_t> row_fraction;

  bool operator==(const PixelSources&) const = default;
};

/// The tables of both cameras. Empty for a rig whose images are already rectified.
struct RectificationTables {
  cv::Size size;                  ///< of raw and rectified images, px
  std::uint64_t fingerprint = 0;  ///< of the rig and settings, see tablesFingerprint
  PixelSources left;
  PixelSources right;

  bool operator==(const RectificationTables&) const = default;
};

/// A hash of everything that the tables depend on: the cameras, their relative pose and the settings, but not
/// the rig's name or its mount.
std::uint64_t tablesFingerprint(const Rig& rig, const RectificationSettings& settings);

/// Computes the tables. Throws std::invalid_argument if the rig cannot be rectified.
RectificationTables buildTables(const Rig& rig, const RectificationSettings& settings);

/// Writes the tables atomically: magic, version, size, fingerprint, the arrays, and a checksum of
/// everything before it; little-endian.
void writeTables(const std::filesystem::path& file, const RectificationTables& tables);

/// Thrown for a file with valid tables of another rig or other settings.
class TablesOfAnotherRig : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reads the tables of a rig with this image size and fingerprint. Reads at most as many bytes as `size`
/// requires. Throws TablesOfAnotherRig, or std::runtime_error naming the file and its fault.
RectificationTables readTables(const std::filesystem::path& file, cv::Size size, std::uint64_t fingerprint);

/// Origin of loaded tables.
enum class TablesOrigin : std::uint8_t {
  loaded,       ///< read from the file
  first_built,  ///< computed, since there was no file
  rig_changed,  ///< computed, since the file was of another rig
  damaged,      ///< computed, since the file was damaged
};

/// Tables, their origin, and a message for the log.
struct LoadedTables {
  RectificationTables tables;
  TablesOrigin origin = TablesOrigin::loaded;
  /// Log message: what was done and why; also states if the file could not be written.
  std::string message;
};

/// Reads the tables of a rig from `file`; if it is missing or unusable, computes them and writes them there.
/// A file that cannot be written is reported in `message` only.
LoadedTables loadOrBuildTables(const Rig& rig, const RectificationSettings& settings,
                               const std::filesystem::path& file);

/// Raw rows of a grid of rectified pixels, as shares of the readout. The share of a raw row is
/// (row + 1/2) / rows - 1/2: -1/2 at the upper edge of the raw image, 1/2 at its lower edge.
struct RowShareGrid {
  int columns = 0;           ///< nodes in a row of the grid; 0: no grid
  std::vector<float> nodes;  ///< of the pixels (step * column, step * row), row by row
};

/// The grids of both cameras.
struct StereoRowShares {
  RowShareGrid left, right;
};

/// Shares of the readout for every `step` px of the rectified images, to the first node at or beyond the last
/// pixel, at least two nodes along each side. Exact at the nodes, also at those beyond the image. A source
/// outside the raw image counts as at most 2 `step` rows outside, so that interpolation between the nodes is
/// right up to the image's edge. No grids if the raw images are already rectified: raw and rectified rows are
/// the same.
StereoRowShares rowShares(const Rig& rig, const Rectification& rectification, int step);

}  // namespace cartvo::calib
