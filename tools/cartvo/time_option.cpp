// Options whose values are times.
#include "tools/cartvo/time_option.hpp"

#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include "common/command_line/parser.hpp"
#include "common/exact_text.hpp"

namespace cartvo {
namespace {

std::optional<double> number(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number = error == std::errc{} && end == text.data() + text.size() && std::isfinite(value);
  return is_number && value >= 0.0 ? std::optional(value) : std::nullopt;
}

/// The seconds of S, M:SS or H:MM:SS; none if the text is no such time.
std::optional<double> secondsOf(std::string_view text) {
  constexpr double kSixty = 60.0;
  constexpr int kMaxParts = 3;
  double seconds = 0.0;
  for (int part = 1; part <= kMaxParts; ++part) {
    const std::size_t colon = text.find(':');
    const std::optional<double> value = number(text.substr(0, colon));
    if (!value || (part > 1 && *value >= kSixty)) return std::nullopt;
    seconds = kSixty * seconds + *value;
    if (colon == std::string_view::npos) return seconds;
    text.remove_prefix(colon + 1);
  }
  return std::nullopt;
}

Option::Transformation timeAbove(bool zero_is_allowed) {
  return [zero_is_allowed](std::string& text) -> std::string {
    const std::optional<double> seconds = secondsOf(text);
    if (!seconds || (*seconds == 0.0 && !zero_is_allowed))
      return "'" + text + "' is no time" + (zero_is_allowed ? "" : " above 0") + ", such as 90, 1.5 or 1:30";
    text = exactText(*seconds);
    return {};
  };
}

}  // namespace

Option::Transformation timeInSeconds() {
  return timeAbove(true);
}

Option::Transformation positiveTimeInSeconds() {
  return timeAbove(false);
}

}  // namespace cartvo
