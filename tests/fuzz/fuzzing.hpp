#pragma once

// Helpers of the fuzz targets. A target passes its input to one of our parsers and checks the contract of its
// header: an error that names the file, or a valid value. Anything else (a crash, a sanitizer's report, a
// time-out, another exception, a violated contract) is a finding.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/temporary_folder.hpp"

namespace cartvo::fuzz {

/// Reports a violated contract and aborts, so that libFuzzer keeps the input.
[[noreturn]] inline void fail(const std::string& contract) {
  std::fprintf(stderr, "FINDING: %s\n", contract.c_str());
  std::abort();
}

inline void require(bool holds, const std::string& contract) {
  if (!holds) fail(contract);
}

/// Result of `read`; nothing if it rejects the input by std::runtime_error or std::invalid_argument. Requires
/// that the message contains `name`.
template <typename Read>
auto parseOrReject(const Read& read, std::string_view name) -> std::optional<decltype(read())> {
  std::string message;
  try {
    return read();
  } catch (const std::runtime_error& error) {
    message = error.what();
  } catch (const std::invalid_argument& error) {
    message = error.what();
  }
  require(message.find(name) != std::string::npos,
          "an error names '" + std::string(name) + "'; this one does not: " + message);
  return std::nullopt;
}

/// Temporary folder of this process, under $TMPDIR.
inline const std::filesystem::path& scratchFolder() {
  static const test::TemporaryFolder folder;
  return folder.path();
}

/// Writes a file and its parent folders in the scratch folder; returns the full path.
inline std::filesystem::path writeScratch(const std::filesystem::path& name, std::string_view content) {
  std::filesystem::path file = scratchFolder() / name;
  std::filesystem::create_directories(file.parent_path());
  std::ofstream output(file, std::ios::binary);
  output << content << std::flush;
  if (!output) throw std::logic_error("cannot write " + file.string());
  return file;
}

inline std::string toText(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// The lines of a text, without end of line.
inline std::vector<std::string> splitLines(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

/// Splits an input that represents several files, at lines "=====".
inline std::vector<std::string> splitParts(const std::string& text) {
  std::vector<std::string> parts(1);
  for (const std::string& line : splitLines(text)) {
    if (line == "=====") {
      parts.emplace_back();
    } else {
      parts.back() += line + "\n";
    }
  }
  return parts;
}

/// Reads numbers and spans from an input; zeros and empty spans at its end.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : rest_(data, size) {}

  bool empty() const { return rest_.empty(); }

  std::uint8_t readByte() {
    const std::span<const std::uint8_t> bytes = readSpan(1);
    return bytes.empty() ? std::uint8_t{0} : bytes.front();
  }

  std::span<const std::uint8_t> readSpan(std::size_t max_size) {
    const std::span<const std::uint8_t> bytes = rest_.first(std::min(max_size, rest_.size()));
    rest_ = rest_.subspan(bytes.size());
    return bytes;
  }

 private:
  std::span<const std::uint8_t> rest_;
};

}  // namespace cartvo::fuzz

// NOLINTNEXTLINE(readability-identifier-naming): the name that libFuzzer calls
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
