// Recognition of encoded images whose end is missing.
#include "capture/codec/image_completeness.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace cartvo::capture {

bool isCutOffImage(std::string_view bytes) {
  using std::string_view_literals::operator""sv;
  if (bytes.starts_with("\x89PNG"sv)) return bytes.find("IEND"sv) == std::string_view::npos;
  const auto at = [bytes](std::size_t index) { return static_cast<std::uint8_t>(bytes[index]); };
  constexpr std::size_t kBmpHeader = 14;
  if (bytes.starts_with("BM"sv) && bytes.size() >= kBmpHeader)
    return (at(2) | at(3) << 8U | at(4) << 16U | static_cast<std::size_t>(at(5)) << 24U) > bytes.size();
  if (!bytes.starts_with("\xff\xd8"sv)) return false;
  std::size_t position = 2;
  constexpr std::size_t kSegmentHeader = 4;
  while (position + kSegmentHeader <= bytes.size() && bytes[position] == '\xff' &&
         bytes[position + 1] != '\xda') {
    if (bytes[position + 1] == '\xff') {
      ++position;  // fill bytes before a marker (ITU-T T.81, B.1.1.2)
      continue;
    }
    position += 2 + 256U * at(position + 2) + at(position + 3);
  }
  // Behind the headers, which may contain a thumbnail.
  return bytes.find("\xff\xd9"sv, std::min(position, bytes.size())) == std::string_view::npos;
}

}  // namespace cartvo::capture
