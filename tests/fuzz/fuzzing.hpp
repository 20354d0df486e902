#pragma once

// What the fuzz targets share. A target hands its input to a parser of ours and holds the parser to what its
// header promises: an error that names the file, or a value that may be relied upon. Anything else, a crash,
// a sanitizer's report, a hang, another exception or a broken promise, is a finding.

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

/// A broken promise: ends the process, so that libFuzzer keeps the input.
[[noreturn]] inline void fail(const std::string& promise) {
  std::fprintf(stderr, "FINDING: %s\n", promise.c_str());
  std::abort();
}

inline void require(bool holds, const std::string& promise) {
  if (!holds) fail(promise);
}

/// What `read` returns; nothing if it refuses the input as readers do: by std::runtime_error or
/// std::invalid_argument with a message that holds `name`.
template <typename Read>
auto accepted(const Read& read, std::string_view name) -> std::optional<decltype(read())> {
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

/// A folder of this process alone, under $TMPDIR.
inline const std::filesystem::path& scratchFolder() {
  static const test::TemporaryFolder folder;
  return folder.path();
}

/// Writes a file, and the folders it lies in, within the scratch folder; returns its whole path.
inline std::filesystem::path writeScratch(const std::filesystem::path& name, std::string_view content) {
  std::filesystem::path file = scratchFolder() / name;
  std::filesystem::create_directories(file.parent_path());
  std::ofstream output(file, std::ios::binary);
  output << content << std::flush;
  if (!output) throw std::logic_error("cannot write " + file.string());
  return file;
}

inline std::string textOf(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// The lines of a text, without their ends.
inline std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

/// Where an input stands for several files: what lies between lines that are "=====".
inline std::vector<std::string> partsOf(const std::string& text) {
  std::vector<std::string> parts(1);
  for (const std::string& line : linesOf(text)) {
    if (line == "=====") {
      parts.emplace_back();
    } else {
      parts.back() += line + "\n";
    }
  }
  return parts;
}

/// Takes numbers and pieces off the front of an input; zeros and empty pieces once it is used up.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : rest_(data, size) {}

  bool empty() const { return rest_.empty(); }

  std::uint8_t byte() {
    const std::span<const std::uint8_t> taken = piece(1);
    return taken.empty() ? std::uint8_t{0} : taken.front();
  }

  std::span<const std::uint8_t> piece(std::size_t most) {
    const std::span<const std::uint8_t> taken = rest_.first(std::min(most, rest_.size()));
    rest_ = rest_.subspan(taken.size());
    return taken;
  }

 private:
  std::span<const std::uint8_t> rest_;
};

}  // namespace cartvo::fuzz

// NOLINTNEXTLINE(readability-identifier-naming): the name that libFuzzer calls
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
