// Fuzz target for the file of rectification tables. It gets a valid checksum, because fuzzing does not find
// one.

#include <cstring>
#include <string_view>

#include "calib/rectification/rectification_tables.hpp"
#include "common/digest.hpp"
#include "tests/fuzz/fuzzing.hpp"

using namespace cartvo;

namespace {

constexpr std::uint64_t kFingerprint = 0x0123456789abcdef;
const cv::Size kSize(4, 3);

void check(const calib::PixelSources& sources) {
  const auto pixels = static_cast<std::size_t>(kSize.area());
  fuzz::require(sources.column.size() == pixels && sources.row.size() == pixels &&
                    sources.column_fraction.size() == pixels && sources.row_fraction.size() == pixels,
                "each pixel has a source");
  for (std::size_t i = 0; i < pixels; ++i) {
    fuzz::require(sources.column[i] <= kSize.width - 2 && sources.row[i] <= kSize.height - 2,
                  "the four pixels around a source exist");
  }
}

void read(const std::string& bytes) {
  const std::filesystem::path file = fuzz::writeScratch("tables", bytes);
  const auto tables =
      fuzz::parseOrReject([&] { return calib::readTables(file, kSize, kFingerprint); }, file.string());
  if (!tables) return;
  check(tables->left);
  check(tables->right);
  calib::writeTables(file, *tables);
  fuzz::require(calib::readTables(file, kSize, kFingerprint) == *tables, "tables are read back");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string bytes = fuzz::toText(data, size);
  read(bytes);
  constexpr std::size_t kChecksum = 8;
  if (bytes.size() < kChecksum) return 0;
  const std::size_t checked = bytes.size() - kChecksum;
  const std::uint64_t checksum = digestOf(std::string_view(bytes).substr(0, checked));
  std::memcpy(bytes.data() + checked, &checksum, kChecksum);
  read(bytes);
  return 0;
}
