// Computation of rectification tables, and loading them from a file when it is valid.
#include "calib/rectification/rectification_tables.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "calib/model/lens.hpp"
#include "common/digest.hpp"

namespace cartvo::calib {
namespace {

/// Incremented with each change in how tables are computed or stored, so that older files are rebuilt.
constexpr std::uint64_t kTablesVersion = 1;

constexpr int kFractionBits = 8;

/// A raw coordinate in fixed point, clamped so that both the pixel and its right or lower neighbour exist.
std::uint32_t fixedPoint(double coordinate, int size) {
  const double largest = static_cast<double>(((size - 1) << kFractionBits) - 1);
  const double scaled = std::floor(coordinate * (1 << kFractionBits) + 0.5);
  return static_cast<std::uint32_t>(std::clamp(scaled, 0.0, largest));
}

PixelSources buildSources(const CameraModel& camera, const Eigen::Matrix3d& R_rectified_camera,
                          const Rectification& rectification) {
  const Lens lens(camera);
  const Eigen::Matrix3d R_camera_rectified = R_rectified_camera.transpose();
  const auto R = [&](int row, int column) { return R_camera_rectified(row, column); };
  const std::size_t pixels = static_cast<std::size_t>(rectification.size.area());
  PixelSources sources;
  for (std::vector<std::uint16_t>* whole : {&sources.column, &sources.row})
    whole->reserve(pixels);
  for (std::vector<std::uint8_t>* fraction : {&sources.column_fraction, &sources.row_fraction}) {
    fraction->reserve(pixels);
  }
  for (int v = 0; v < rectification.size.height; ++v) {
    const double y = (v - rectification.cy) / rectification.focal_length;
    for (int u = 0; u < rectification.size.width; ++u) {
      const double x = (u - rectification.cx) / rectification.focal_length;
      // Written out, since the order of Eigen's summation may depend on the processor.
      const NormalisedPoint raw =
          lens.distort({R(0, 0) * x + R(0, 1) * y + R(0, 2), R(1, 0) * x + R(1, 1) * y + R(1, 2),
                        R(2, 0) * x + R(2, 1) * y + R(2, 2)});
      const std::uint32_t column = fixedPoint(camera.fx * raw.x + camera.cx, camera.size.width);
      const std::uint32_t row = fixedPoint(camera.fy * raw.y + camera.cy, camera.size.height);
      sources.column.push_back(static_cast<std::uint16_t>(column >> kFractionBits));
      sources.row.push_back(static_cast<std::uint16_t>(row >> kFractionBits));
      sources.column_fraction.push_back(static_cast<std::uint8_t>(column));
      sources.row_fraction.push_back(static_cast<std::uint8_t>(row));
    }
  }
  return sources;
}

}  // namespace

std::uint64_t tablesFingerprint(const Rig& rig, const RectificationSettings& settings) {
  Digest digest;
  digest.add(kTablesVersion);
  const auto add = [&](double value) { digest.add(std::bit_cast<std::uint64_t>(value + 0.0)); };
  for (const CameraModel* camera : {&rig.left, &rig.right}) {
    add(camera->size.width);
    add(camera->size.height);
    for (const double value : {camera->fx, camera->fy, camera->cx, camera->cy})
      add(value);
    for (const double coefficient : camera->distortion)
      add(coefficient);
    add(static_cast<double>(camera->lens));
  }
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column)
      add(rig.T_right_left.matrix()(row, column));
  }
  add(settings.free_scaling);
  return digest.value();
}

RectificationTables buildTables(const Rig& rig, const RectificationSettings& settings) {
  const Rectification rectification = computeRectification(rig, settings);
  RectificationTables tables;
  tables.size = rectification.size;
  tables.fingerprint = tablesFingerprint(rig, settings);
  if (rectification.is_identity) return tables;
  tables.left = buildSources(rig.left, rectification.R_rectified_left, rectification);
  tables.right = buildSources(rig.right, rectification.R_rectified_right, rectification);
  return tables;
}

LoadedTables loadOrBuildTables(const Rig& rig, const RectificationSettings& settings,
                               const std::filesystem::path& file) {
  LoadedTables loaded;
  if (computeRectification(rig, settings).is_identity) {
    loaded.tables = buildTables(rig, settings);
    loaded.message = "the images are already rectified: no tables needed";
    return loaded;
  }
  if (!std::filesystem::exists(file)) {
    loaded.origin = TablesOrigin::first_built;
    loaded.message = "rectification tables built for the first time: " + file.string();
  } else {
    try {
      loaded.tables = readTables(file, rig.left.size, tablesFingerprint(rig, settings));
      loaded.message = "rectification tables loaded: " + file.string();
      return loaded;
    } catch (const TablesOfAnotherRig& error) {
      loaded.origin = TablesOrigin::rig_changed;
      loaded.message = std::string("rectification tables rebuilt: ") + error.what();
    } catch (const std::runtime_error& error) {
      loaded.origin = TablesOrigin::damaged;
      loaded.message = std::string("rectification tables rebuilt: ") + error.what();
    }
  }
  loaded.tables = buildTables(rig, settings);
  try {
    writeTables(file, loaded.tables);
  } catch (const std::runtime_error& error) {
    loaded.message += std::string("; the tables could not be saved: ") + error.what();
  }
  return loaded;
}

}  // namespace cartvo::calib
