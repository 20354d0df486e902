// Computation of rectification tables, the file that keeps them, and shares of rows.
#include "calib/rectification/rectification_tables.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>

#include "calib/model/lens.hpp"
#include "common/atomic_file.hpp"
#include "common/digest.hpp"
#include "common/image_size.hpp"

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

int lastNode(int pixels, int step) {
  return std::max(1, (pixels - 1 + step - 1) / step);
}

RowShareGrid buildGrid(const CameraModel& camera, const Eigen::Matrix3d& R_rectified_camera,
                       const Rectification& rectification, int step) {
  const Lens lens(camera);
  const Eigen::Matrix3d R_camera_rectified = R_rectified_camera.transpose();
  const double rows = camera.size.height;
  const double largest = 0.5 + 2.0 * step / rows;
  const int last_column = lastNode(rectification.size.width, step);
  const int last_row = lastNode(rectification.size.height, step);
  RowShareGrid grid;
  grid.columns = last_column + 1;
  for (int row = 0; row <= last_row; ++row) {
    for (int column = 0; column <= last_column; ++column) {
      const Eigen::Vector3d ray((step * column - rectification.cx) / rectification.focal_length,
                                (step * row - rectification.cy) / rectification.focal_length, 1.0);
      const double raw_row = camera.fy * lens.distort(R_camera_rectified * ray).y + camera.cy;
      grid.nodes.push_back(static_cast<float>(std::clamp((raw_row + 0.5) / rows - 0.5, -largest, largest)));
    }
  }
  return grid;
}

static_assert(std::endian::native == std::endian::little, "the arrays are written in the host's byte order");

constexpr std::string_view kMagic = "cartvoRT";
constexpr std::uint32_t kLayoutVersion = 2;
constexpr std::size_t kBytesPerPixel = 6;

template <typename Value>
void append(std::string& bytes, const Value& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <typename Value>
void append(std::string& bytes, const std::vector<Value>& values) {
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value));
}

/// Reads consecutive values from bytes. The caller checks that there are enough of them.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}

  template <typename Value>
  Value read() {
    Value value;
    std::memcpy(&value, bytes_.data(), sizeof value);
    bytes_.remove_prefix(sizeof value);
    return value;
  }

  template <typename Value>
  std::vector<Value> read(std::size_t count) {
    std::vector<Value> values(count);
    std::memcpy(values.data(), bytes_.data(), count * sizeof(Value));
    bytes_.remove_prefix(count * sizeof(Value));
    return values;
  }

 private:
  std::string_view bytes_;
};

PixelSources readSources(Reader& reader, std::size_t pixels) {
  PixelSources sources;
  sources.column = reader.read<std::uint16_t>(pixels);
  sources.row = reader.read<std::uint16_t>(pixels);
  sources.column_fraction = reader.read<std::uint8_t>(pixels);
  sources.row_fraction = reader.read<std::uint8_t>(pixels);
  return sources;
}

/// Whether the four pixels around each source exist. The checksum does not protect against a forged file.
bool isWithin(const PixelSources& sources, cv::Size size) {
  const auto below = [](const std::vector<std::uint16_t>& values, int limit) {
    std::uint16_t largest = 0;
    for (const std::uint16_t value : values)
      largest = std::max(largest, value);
    return largest < limit;
  };
  return below(sources.column, size.width - 1) && below(sources.row, size.height - 1);
}

std::string readBytes(const std::filesystem::path& file, std::size_t expected) {
  std::ifstream stream(file, std::ios::binary);
  std::string bytes(expected + 1, '\0');  // one more, to detect a file that is too long
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
  return bytes;
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

StereoRowShares rowShares(const Rig& rig, const Rectification& rectification, int step) {
  if (rectification.is_identity) return {};
  return {buildGrid(rig.left, rectification.R_rectified_left, rectification, step),
          buildGrid(rig.right, rectification.R_rectified_right, rectification, step)};
}

void writeTables(const std::filesystem::path& file, const RectificationTables& tables) {
  std::string bytes;
  bytes.reserve(64 + 2 * kBytesPerPixel * static_cast<std::size_t>(tables.size.area()));
  bytes.append(kMagic);
  append(bytes, kLayoutVersion);
  append(bytes, static_cast<std::uint32_t>(tables.size.width));
  append(bytes, static_cast<std::uint32_t>(tables.size.height));
  append(bytes, tables.fingerprint);
  for (const PixelSources* sources : {&tables.left, &tables.right}) {
    append(bytes, sources->column);
    append(bytes, sources->row);
    append(bytes, sources->column_fraction);
    append(bytes, sources->row_fraction);
  }
  append(bytes, digestOf(bytes));
  writeFileAtomically(file, bytes);
}

RectificationTables readTables(const std::filesystem::path& file, cv::Size size, std::uint64_t fingerprint) {
  const auto fail = [&](const std::string& what) -> void {
    throw std::runtime_error(file.string() + ": " + what);
  };
  constexpr std::size_t kHeader = 28, kChecksum = 8;
  const auto pixels = static_cast<std::size_t>(size.area());
  const std::size_t length = kHeader + 2 * kBytesPerPixel * pixels + kChecksum;
  const std::string bytes = readBytes(file, length);
  if (bytes.size() < kHeader + kChecksum) fail("is cut short or not readable");
  if (!bytes.starts_with(kMagic)) fail("does not hold rectification tables");

  Reader reader(std::string_view(bytes).substr(kMagic.size()));
  if (reader.read<std::uint32_t>() != kLayoutVersion) fail("was written by another version of cartvo");
  const auto width = reader.read<std::uint32_t>(), height = reader.read<std::uint32_t>();
  if (width != static_cast<std::uint32_t>(size.width) || height != static_cast<std::uint32_t>(size.height)) {
    throw TablesOfAnotherRig(file.string() + ": is for images of " + std::to_string(width) + "x" +
                             std::to_string(height) + ", the rig's are " + sizeText(size));
  }
  if (bytes.size() != length) fail("is cut short or too long");
  const std::string_view hashed = std::string_view(bytes).substr(0, bytes.size() - kChecksum);
  Reader checksum(std::string_view(bytes).substr(hashed.size()));
  if (checksum.read<std::uint64_t>() != digestOf(hashed)) {
    fail("is damaged: its checksum does not match");
  }
  RectificationTables tables;
  tables.size = size;
  tables.fingerprint = reader.read<std::uint64_t>();
  if (tables.fingerprint != fingerprint) {
    throw TablesOfAnotherRig(file.string() + ": is another rig's, or the rig's calibration has changed");
  }
  tables.left = readSources(reader, pixels);
  tables.right = readSources(reader, pixels);
  if (!isWithin(tables.left, size) || !isWithin(tables.right, size)) fail("points outside the raw image");
  return tables;
}

}  // namespace cartvo::calib
