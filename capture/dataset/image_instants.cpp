// Instants of images: from a frame rate, from times.txt or from the images' names; their intervals.
#include "capture/dataset/image_instants.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "capture/dataset/image_files.hpp"
#include "capture/dataset/image_folder_layouts.hpp"
#include "common/exact_text.hpp"
#include "common/printable_text.hpp"
#include "common/statistics.hpp"

namespace cartvo::capture {
namespace {

namespace fs = std::filesystem;

/// Reads times.txt, seconds, as ns.
std::vector<std::int64_t> readTimes(const fs::path& file) {
  std::vector<std::int64_t> instants;
  for (const TextLine& line : readLines(file)) {
    const std::optional<long double> seconds = parseNumber<long double>(line.text);
    if (!seconds || !std::isfinite(*seconds) || std::abs(*seconds) > 1e-9L * kMaxTimestampNs) {
      throw std::runtime_error(fileAndLine(file, line) + "expected one number (seconds) instead of '" +
                               printableExcerpt(line.text) + "'");
    }
    const auto instant_ns = static_cast<std::int64_t>(std::llround(*seconds * 1e9L));
    requireIncreasing(instants, instant_ns, file, line);
    instants.push_back(instant_ns);
  }
  requirePlausibleInterval(instants, file, TimeUnit::seconds);
  return instants;
}

/// "FILE has no partner among the right images (3 in all)" for the images of one side without a partner.
std::string unpairedText(const std::vector<fs::path>& images, const char* other_side) {
  const std::string count =
      images.size() == 1 ? "" : " (nor have " + std::to_string(images.size() - 1) + " more)";
  return images.front().string() + " has no partner among the " + other_side + " images" + count;
}

/// Orders the right images as their left partners. Throws std::runtime_error naming images of one side that
/// the other side does not have.
void matchByName(ImageFolder& folder) {
  const NamedPairs named = pairByName(folder.left.images, folder.right.images);
  std::string message;
  if (!named.left_only.empty()) message = unpairedText(named.left_only, "right");
  if (!named.right_only.empty())
    message += (message.empty() ? "" : ", and ") + unpairedText(named.right_only, "left");
  if (!message.empty()) {
    throw std::runtime_error(
        message +
        ". Left and right images belong together by their names: copy what is missing, or "
        "give each camera's instants in times_0.txt and times_1.txt");
  }
  std::transform(named.pairs.begin(), named.pairs.end(), folder.right.images.begin(),
                 [](const NamedPairs::Pair& pair) { return pair.right; });
}

/// The last number in the name of an image; nothing if there is none.
std::optional<std::int64_t> numberOf(const fs::path& image) {
  std::string name = image.stem().string();
  name.resize(name.find_last_of("0123456789") + 1);
  const std::size_t digits = name.find_last_not_of("0123456789") + 1;
  const auto number = parseNumber<std::int64_t>(std::string_view(name).substr(digits));
  constexpr std::int64_t kMaxNumber = 1'000'000'000;
  return number && *number <= kMaxNumber ? number : std::nullopt;
}

/// Instants of images at a frame rate (Hz), by the numbers in their names, or by their places if these
/// numbers do not increase.
std::vector<std::int64_t> instantsAtRate(const std::vector<fs::path>& images, double frame_rate) {
  std::vector<std::int64_t> numbers;
  for (const fs::path& image : images) {
    const std::optional<std::int64_t> number = numberOf(image);
    if (number && (numbers.empty() || *number > numbers.back())) numbers.push_back(*number);
  }
  const bool are_numbered = numbers.size() == images.size();
  std::vector<std::int64_t> instants;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const auto frame = are_numbered ? numbers[i] - numbers.front() : static_cast<std::int64_t>(i);
    instants.push_back(std::llround(1e9 * static_cast<double>(frame) / frame_rate));
  }
  return instants;
}

struct TimesFiles {
  fs::path left, right;  ///< empty if there are none
  bool areShared() const { return left == right; }
};

TimesFiles findTimes(const std::vector<fs::path>& places) {
  for (const fs::path& place : places) {
    TimesFiles own{place / "times_0.txt", place / "times_1.txt"};
    if (fs::exists(own.left) && fs::exists(own.right)) return own;
    if (fs::exists(place / "times.txt")) return {place / "times.txt", place / "times.txt"};
  }
  return {};
}

void readTimesFiles(ImageFolder& folder, const TimesFiles& times) {
  folder.left.instants_ns = readTimes(times.left);
  folder.right.instants_ns = times.areShared() ? folder.left.instants_ns : readTimes(times.right);
  if (times.areShared()) matchByName(folder);
  requireInstantForEachImage(folder.left, folder.left.images.front().parent_path(), times.left);
  requireInstantForEachImage(folder.right, folder.right.images.front().parent_path(), times.right);
  if (const std::string warning = frameNumberWarning(folder.left.instants_ns, times.left); !warning.empty())
    folder.warnings.push_back(warning);
}

/// The instant that a number is, ns: `whole` digits, and those after the point, if any.
std::optional<std::int64_t> instantOfNumber(std::string_view whole, std::string_view decimals) {
  constexpr std::size_t kSecondsDigits = 10, kNanosecondsDigits = 19;
  const bool is_seconds = whole.size() == kSecondsDigits && !decimals.empty();
  const bool is_integer =
      decimals.empty() && (whole.size() == 13 || whole.size() == 16 || whole.size() == 19);
  if (!is_seconds && !is_integer) return std::nullopt;
  std::string digits = std::string(whole) + std::string(decimals);
  digits.resize(kNanosecondsDigits, '0');
  const auto instant_ns = parseNumber<std::int64_t>(digits);
  return instant_ns && *instant_ns <= kMaxTimestampNs ? instant_ns : std::nullopt;
}

bool isDigit(char character) {
  return std::isdigit(static_cast<unsigned char>(character)) != 0;
}

/// The digits of `name` from `begin` on.
std::string_view digitsFrom(std::string_view name, std::size_t begin) {
  std::size_t end = begin;
  while (end < name.size() && isDigit(name[end]))
    ++end;
  return name.substr(begin, end - begin);
}

std::optional<std::int64_t> instantInName(std::string_view name) {
  for (std::size_t begin = 0; begin < name.size(); ++begin) {
    const std::string_view whole = digitsFrom(name, begin);
    if (whole.empty()) continue;
    const std::size_t point = begin + whole.size();
    const std::string_view decimals =
        point < name.size() && name[point] == '.' ? digitsFrom(name, point + 1) : std::string_view();
    if (const auto instant_ns = instantOfNumber(whole, decimals)) return instant_ns;
    begin = point;
  }
  return std::nullopt;
}

/// Orders the images by their instants.
void sortByInstants(ImageSequence& sequence) {
  std::vector<std::size_t> order(sequence.images.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return sequence.instants_ns[a] < sequence.instants_ns[b]; });
  ImageSequence sorted = sequence;
  for (std::size_t i = 0; i < order.size(); ++i) {
    sorted.images[i] = sequence.images[order[i]];
    sorted.instants_ns[i] = sequence.instants_ns[order[i]];
    if (i > 0 && sorted.instants_ns[i] == sorted.instants_ns[i - 1]) {
      throw std::runtime_error(sorted.images[i].string() + ": has the instant of " +
                               sorted.images[i - 1].filename().string() +
                               " in its name; expected instants that differ");
    }
  }
  sequence = std::move(sorted);
  requirePlausibleInterval(sequence.instants_ns, sequence.images.front().parent_path(),
                           TimeUnit::nanoseconds);
}

constexpr double kMinInterval = 1e-3, kMaxInterval = 2.0;  // s
constexpr double kUsualInterval = 0.05;                    // s

struct NamedUnit {
  const char* name;
  double seconds;
};
constexpr std::array<NamedUnit, 4> kUnits{
    {{"seconds", 1.0}, {"milliseconds", 1e-3}, {"microseconds", 1e-6}, {"nanoseconds", 1e-9}}};

std::string intervalText(double seconds) {
  return roundedText(seconds, 3) + " s";
}

/// The unit in which an interval of so many units is plausible, and nearest to the usual one; null if none.
const NamedUnit* plausibleUnit(double units) {
  const NamedUnit* best = nullptr;
  const auto distance = [units](const NamedUnit& unit) {
    return std::abs(std::log(units * unit.seconds / kUsualInterval));
  };
  for (const NamedUnit& unit : kUnits) {
    if (isPlausibleInterval(units * unit.seconds) && (best == nullptr || distance(unit) < distance(*best)))
      best = &unit;
  }
  return best;
}

double medianInterval(const std::vector<std::int64_t>& instants_ns) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < instants_ns.size(); ++i)
    intervals.push_back(1e-9 * static_cast<double>(instants_ns[i] - instants_ns[i - 1]));
  return quantile(std::move(intervals), 0.5);
}

}  // namespace

std::vector<std::int64_t> instantsInNames(const std::vector<fs::path>& images) {
  std::vector<std::int64_t> instants;
  for (const fs::path& image : images) {
    const std::optional<std::int64_t> instant_ns = instantInName(image.stem().string());
    if (!instant_ns) return {};
    instants.push_back(*instant_ns);
  }
  return instants;
}

void readInstants(ImageFolder& folder, const std::vector<fs::path>& places, double frame_rate) {
  if (frame_rate > 0.0) {
    matchByName(folder);
    folder.left.instants_ns = folder.right.instants_ns = instantsAtRate(folder.left.images, frame_rate);
    return;
  }
  if (const TimesFiles times = findTimes(places); !times.left.empty()) return readTimesFiles(folder, times);
  folder.left.instants_ns = instantsInNames(folder.left.images);
  folder.right.instants_ns = instantsInNames(folder.right.images);
  if (folder.left.instants_ns.empty() || folder.right.instants_ns.empty()) {
    throw std::runtime_error(
        places.front().string() +
        " contains neither times.txt nor both times_0.txt and times_1.txt, with the instant of each image in "
        "seconds, nor have the images instants in their names, such as 1225719884.662058.png; at a fixed "
        "rate give --frame-rate HZ instead");
  }
  sortByInstants(folder.left);
  sortByInstants(folder.right);
}

bool isPlausibleInterval(double interval) {
  return interval >= kMinInterval && interval <= kMaxInterval;
}

void requirePlausibleInterval(const std::vector<std::int64_t>& instants_ns, const std::filesystem::path& file,
                              TimeUnit unit) {
  if (instants_ns.size() < 2) return;
  const double interval = medianInterval(instants_ns);
  if (isPlausibleInterval(interval)) return;
  const NamedUnit& read = unit == TimeUnit::seconds ? kUnits.front() : kUnits.back();
  std::string message = file.string() + ": the instants are read as " + read.name +
                        ", and the median of their intervals is " + intervalText(interval) +
                        "; expected a camera's, " + intervalText(kMinInterval) + " to " +
                        intervalText(kMaxInterval);
  const double units = interval / read.seconds;
  if (const NamedUnit* const other = plausibleUnit(units)) {
    message += std::string(". In ") + other->name + " they would be " + intervalText(units * other->seconds) +
               ": convert the instants from " + other->name + " to " + read.name;
  }
  throw std::runtime_error(message);
}

std::string frameNumberWarning(const std::vector<std::int64_t>& instants_ns,
                               const std::filesystem::path& file) {
  constexpr std::size_t kMinCount = 5;
  constexpr std::int64_t kSecond = 1'000'000'000;
  if (instants_ns.size() < kMinCount || instants_ns.front() < 0 || instants_ns.front() > kSecond) return {};
  for (std::size_t i = 0; i < instants_ns.size(); ++i) {
    const std::int64_t expected = instants_ns.front() + static_cast<std::int64_t>(i) * kSecond;
    if (instants_ns[i] % kSecond != 0 || instants_ns[i] != expected) return {};
  }
  return file.string() +
         ": the instants are 1 s apart, like frame numbers; if they are numbers, give the frame rate by "
         "--frame-rate";
}

}  // namespace cartvo::capture
