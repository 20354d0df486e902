// Reading of regular files, and of text with byte order marks.
#include "common/input_file.hpp"

#include <array>
#include <cerrno>
#include <cstddef>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "common/files/foreign_format.hpp"

namespace cartvo {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& reason) {
  throw std::runtime_error(file.string() + ": cannot be read: " + reason);
}

/// An open regular file.
class InputFile {
 public:
  explicit InputFile(const std::filesystem::path& file)
      : file_(file), descriptor_(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC)) {
    if (descriptor_ < 0) fail(file_, std::generic_category().message(errno));
    struct stat status {};
    const bool has_status = fstat(descriptor_, &status) == 0;
    if (has_status && S_ISREG(status.st_mode)) return;
    ::close(descriptor_);
    const bool is_folder = has_status && S_ISDIR(status.st_mode);
    fail(file_, is_folder ? "it is a folder; expected a file" : "it is a pipe or a device; expected a file");
  }
  ~InputFile() { ::close(descriptor_); }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  std::string read(std::uintmax_t max_bytes) const {
    constexpr std::size_t kPart = 1U << 16U;
    std::string bytes;
    std::array<char, kPart> part{};
    for (;;) {
      const ssize_t count = ::read(descriptor_, part.data(), part.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) fail(file_, std::generic_category().message(errno));
      if (count == 0) return bytes;
      bytes.append(part.data(), static_cast<std::size_t>(count));
      if (bytes.size() > max_bytes)
        fail(file_, "it is larger than " + std::to_string(max_bytes) + " bytes, the limit for such a file");
    }
  }

 private:
  const std::filesystem::path& file_;
  int descriptor_;
};

void appendUtf8(std::uint32_t character, std::string& text) {
  const auto append = [&text](std::uint32_t byte) { text += static_cast<char>(byte); };
  const auto append_rest = [&](int count) {
    while (count-- > 0)
      append(0x80U | (character >> (6U * static_cast<unsigned>(count)) & 0x3FU));
  };
  if (character < 0x80) {
    append(character);
  } else if (character < 0x800) {
    append(0xC0U | character >> 6U);
    append_rest(1);
  } else if (character < 0x10000) {
    append(0xE0U | character >> 12U);
    append_rest(2);
  } else {
    append(0xF0U | character >> 18U);
    append_rest(3);
  }
}

/// Converts UTF-16 without its mark; an unpaired surrogate becomes U+FFFD.
std::string utf8FromUtf16(std::string_view bytes, bool is_big_endian) {
  constexpr std::uint32_t kReplacement = 0xFFFD;
  const auto unit = [&](std::size_t index) {
    const auto first = static_cast<unsigned char>(bytes[index]);
    const auto second = static_cast<unsigned char>(bytes[index + 1]);
    return static_cast<std::uint32_t>(is_big_endian ? first << 8U | second : second << 8U | first);
  };
  std::string text;
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    std::uint32_t character = unit(i);
    if (character >= 0xD800 && character <= 0xDFFF) {
      const std::uint32_t low = i + 3 < bytes.size() ? unit(i + 2) : 0;
      const bool is_pair = character <= 0xDBFF && low >= 0xDC00 && low <= 0xDFFF;
      character = is_pair ? 0x10000 + ((character & 0x3FFU) << 10U) + (low & 0x3FFU) : kReplacement;
      if (is_pair) i += 2;
    }
    appendUtf8(character, text);
  }
  return text;
}

}  // namespace

void requireInputFile(const std::filesystem::path& file) {
  const InputFile opened(file);
}

std::string readInputFile(const std::filesystem::path& file, std::uintmax_t max_bytes) {
  return InputFile(file).read(max_bytes);
}

std::string readInputText(const std::filesystem::path& file, std::uintmax_t max_bytes) {
  if (const std::string format = foreignFormat(file); !format.empty()) fail(file, "it " + format);
  return withoutByteOrderMark(readInputFile(file, max_bytes));
}

std::string withoutByteOrderMark(std::string bytes) {
  if (bytes.starts_with("\xEF\xBB\xBF")) return bytes.substr(3);
  if (bytes.starts_with("\xFF\xFE")) return utf8FromUtf16(std::string_view(bytes).substr(2), false);
  if (bytes.starts_with("\xFE\xFF")) return utf8FromUtf16(std::string_view(bytes).substr(2), true);
  return bytes;
}

}  // namespace cartvo
