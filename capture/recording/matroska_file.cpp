// Header check of Matroska files.

#include "capture/recording/matroska_file.hpp"

#include <bit>
#include <cstdint>
#include <fstream>
#include <optional>
#include <stdexcept>

#include "common/input_file.hpp"

namespace cartvo::capture {
namespace {

constexpr std::uint32_t kEbmlHeader = 0x1A45DFA3;
constexpr std::uint32_t kSegment = 0x18538067;
constexpr std::uint64_t kMaxHeaderBytes = 4096;  ///< usually 40

/// Reads an identifier of four bytes, as both elements have.
std::optional<std::uint32_t> readIdentifier(std::istream& input) {
  std::uint32_t identifier = 0;
  for (int i = 0; i < 4; ++i) {
    const int byte = input.get();
    if (byte < 0) return std::nullopt;
    identifier = identifier << 8 | static_cast<std::uint32_t>(byte);
  }
  return identifier;
}

/// Reads a variable-size integer (RFC 8794): the leading zero bits give the number of further bytes. Nothing
/// if all value bits are ones, which means an unknown size.
std::optional<std::uint64_t> readSize(std::istream& input) {
  const int first = input.get();
  if (first <= 0) return std::nullopt;
  const int extra_bytes = std::countl_zero(static_cast<std::uint8_t>(first));
  std::uint64_t size = static_cast<std::uint64_t>(first) & (0x7FU >> extra_bytes);
  for (int i = 0; i < extra_bytes; ++i) {
    const int byte = input.get();
    if (byte < 0) return std::nullopt;
    size = size << 8 | static_cast<std::uint64_t>(byte);
  }
  const std::uint64_t unknown = (std::uint64_t{1} << (7 * (extra_bytes + 1))) - 1;
  return size == unknown ? std::nullopt : std::optional(size);
}

}  // namespace

bool isMatroskaFinalised(const std::filesystem::path& matroska_file) {
  try {
    requireInputFile(matroska_file);
  } catch (const std::runtime_error&) {
    return false;
  }
  std::ifstream input(matroska_file, std::ios::binary);
  if (readIdentifier(input) != kEbmlHeader) return false;
  const std::optional<std::uint64_t> header = readSize(input);
  if (!header || *header > kMaxHeaderBytes) return false;
  input.ignore(static_cast<std::streamsize>(*header));
  return readIdentifier(input) == kSegment && readSize(input).has_value();
}

}  // namespace cartvo::capture
