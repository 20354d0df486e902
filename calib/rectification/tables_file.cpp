// File with rectification tables: header, arrays, checksum; all numbers little-endian.
//
//   offset  bytes  contents
//        0      8  magic "cartvoRT"
//        8      4  layout version
//       12      4  width
//       16      4  height
//       20      8  fingerprint of rig and settings
//       28         left, then right: columns (2 bytes each), rows (2), column fractions (1), row fractions
//       (1)
//      end      8  digestOf() everything before it
#include <algorithm>
#include <bit>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>

#include "calib/rectification/rectification_tables.hpp"
#include "common/atomic_file.hpp"
#include "common/digest.hpp"
#include "common/image_size.hpp"

namespace cartvo::calib {
namespace {

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
