#pragma once

// The readers behind readImageFolder, one for each layout; not for use outside capture.

#include <charconv>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "capture/image_folder.hpp"

namespace cartvo {

bool isKittiFolder(const std::filesystem::path& folder);
ImageFolder readKittiFolder(const std::filesystem::path& folder);

/// The folder that holds cam0 and cam1, if `folder` is it or holds it as mav0.
std::optional<std::filesystem::path> findEurocFolder(const std::filesystem::path& folder);
ImageFolder readEurocFolder(const std::filesystem::path& folder);

/// Instants may lie that far from 0, ns: then their differences do not overflow.
inline constexpr std::int64_t kMostInstant_ns = 4'000'000'000'000'000'000;

/// One line of a text file with its number, for messages.
struct TextLine {
  int number = 0;
  std::string text;  ///< without surrounding white space; never empty
};

/// The lines that hold something, comments (#) left out. Throws std::runtime_error if the file cannot be
/// read.
std::vector<TextLine> readLines(const std::filesystem::path& file);

/// "FILE, line N: " for messages.
std::string place(const std::filesystem::path& file, const TextLine& line);

/// The whole of `text` as a number, or nothing.
template <typename Number>
std::optional<Number> parseNumber(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Throws std::runtime_error unless the instant lies after the one before it.
void checkIncreasing(const std::vector<std::int64_t>& before, std::int64_t instant_ns,
                     const std::filesystem::path& file, const TextLine& line);

}  // namespace cartvo
