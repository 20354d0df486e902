// The full-screen view of `cartvo watch`: state, motion, times, cameras, sentences.
#include "tools/watch/screen.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <string_view>

#include <fmt/format.h>
#include <unistd.h>

#include "common/command_line/terminal.hpp"
#include "common/printable_text.hpp"
#include "common/units.hpp"
#include "daemon/publish/message_names.hpp"
#include "tools/watch/watch.hpp"

namespace cartvo {
namespace {

constexpr std::int64_t kStep_ns = 500'000'000;
constexpr std::size_t kMaxSpeeds = 120;
constexpr std::size_t kMinColumns = 50, kMinRows = 16, kLabel = 12;
constexpr double kMaxMessageAge = 1.0;  // s

enum class Colour : std::uint8_t { none, good, bad, faint, strong };

/// A line and how it is shown; the escapes of colours take no columns.
struct Line {
  std::string text;
  Colour colour = Colour::none;
};

std::string coloured(const std::string& text, Colour colour) {
  constexpr std::array<const char*, 5> kEscapes{"", "\x1b[30;42m", "\x1b[30;43m", "\x1b[2m", "\x1b[1m"};
  return colour == Colour::none ? text : kEscapes[static_cast<std::size_t>(colour)] + text + "\x1b[0m";
}

std::string labelled(std::string_view label, const std::string& text) {
  return fmt::format(" {:<{}}{}", label, kLabel, text);
}

Line stateLine(const WatchedState& state) {
  if (state.message_age > kMaxMessageAge)
    return {fmt::format(" no message for {:.0f} s ", state.message_age), Colour::bad};
  const odometry_t& message = state.message;
  if (message.status != odometry_t::VALID)
    return {" not valid: " + invalidText(message, state.health ? state.health->bound_exceeded : "") + " ",
            Colour::bad};
  if (!isUsableWhenFresh(message))
    return {" VALID, but with impossible numbers or a reason against it: not to be used ", Colour::bad};
  const bool is_standing = (message.reasons & odometry_t::REASON_ZERO_VELOCITY) != 0;
  return {is_standing ? " valid: standstill " : " valid ", Colour::good};
}

/// A value that is not known in an invalid message.
std::string valueText(double value, int decimals) {
  return std::isfinite(value) ? fmt::format("{:+.{}f}", value, decimals) : "–";
}

std::string motionText(const odometry_t& message) {
  const double* velocity = message.velocity_body;
  return fmt::format("{} m/s forward, {} left, {} up", valueText(velocity[0], 2), valueText(velocity[1], 2),
                     valueText(velocity[2], 2));
}

std::string ratesText(const odometry_t& message) {
  const double* rates = message.angular_velocity_body;
  return fmt::format("roll {}, pitch {}, yaw {} deg/s", valueText(kDegreesPerRadian * rates[0], 1),
                     valueText(kDegreesPerRadian * rates[1], 1), valueText(kDegreesPerRadian * rates[2], 1));
}

/// The largest bound of the axes, of each quantity.
std::string boundsText(const odometry_t& message) {
  const auto largest = [](const double(&bounds)[3]) {
    return *std::max_element(std::begin(bounds), std::end(bounds));
  };
  if (!std::isfinite(largest(message.velocity_bound))) return "–";
  return fmt::format("±{:.2f} m/s, {:.1f} deg/s; last second {:.3f} m, {:.2f} deg; quality {}",
                     largest(message.velocity_bound), kDegreesPerRadian * largest(message.angular_rate_bound),
                     largest(message.motion_bound), kDegreesPerRadian * largest(message.rotation_bound),
                     message.quality);
}

std::string pathText(const WatchedState& state) {
  const double* position = state.message.position_world_body;
  return fmt::format("{:.1f} m driven; at {:+.2f}, {:+.2f}, {:+.2f} m", state.counts.path_length, position[0],
                     position[1], position[2]);
}

std::string timesText(const WatchedState& state) {
  const std::optional<double> latency = latencyMs(state.message);
  std::string text = "–";  // without a pair
  if (isOfPair(state.message)) text = latency ? fmt::format("{:.1f} ms", *latency) : "none: a recording";
  return fmt::format("{:.1f} pairs/s, latency {}", state.frame_rate, text);
}

std::string offsetText(const WatchedState& state) {
  if (!isOfPair(state.message)) return "–";
  return fmt::format("{:+.2f} ms{}", 1e-3 * static_cast<double>(state.message.offset_us),
                     state.health ? "  " + clockText(*state.health) : "");
}

Line cameraLine(std::string_view name, const camera_health_t& camera) {
  const bool is_good = camera.state == camera_health_t::STREAMING;
  std::string text = fmt::format("{}, {:.1f} pictures/s, {} damaged, {} reconnections",
                                 daemon::cameraStateName(camera.state), camera.frame_rate, camera.damaged,
                                 camera.reconnections);
  if (!is_good && !camera.last_error.empty()) text += ": " + printableExcerpt(camera.last_error, 200);
  return {labelled(name, text), is_good ? Colour::none : Colour::bad};
}

/// Text in lines of at most `columns`, divided at blanks.
std::vector<std::string> wrapped(const std::string& text, std::size_t columns) {
  std::vector<std::string> lines(1);
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find_first_of(" \n", at), text.size());
    const std::string word = text.substr(at, end - at);
    const bool fits = textColumns(lines.back()) + textColumns(word) + 1 <= columns;
    if (!fits && !lines.back().empty()) lines.emplace_back();
    lines.back() += (lines.back().empty() ? "" : " ") + word;
    if (end < text.size() && text[end] == '\n') lines.emplace_back();
    at = end + 1;
  }
  return lines;
}

std::vector<Line> contents(const WatchedState& state, const SpeedHistory& speeds, std::size_t columns) {
  const odometry_t& message = state.message;
  const OdometrySummary& counts = state.counts;
  constexpr std::size_t kSparkFrame = 28;  // label and the largest speed
  const std::size_t spark = columns > kSparkFrame ? std::min(columns - kSparkFrame, kMaxSpeeds) : 1;
  std::vector<Line> lines{
      {" cartvo watch  " + printableExcerpt(state.url, 200), Colour::strong},
      {"", Colour::none},
      stateLine(state),
      {"", Colour::none},
      {labelled("speed", motionText(message)), Colour::none},
      {labelled("last minute", speeds.sparkline(spark) + fmt::format(" to {:.2f} m/s", speeds.largest())),
       Colour::none},
      {labelled("rates", ratesText(message)), Colour::none},
      {labelled("bounds", boundsText(message)), Colour::none},
      {labelled("path", pathText(state)), Colour::none},
      {labelled("pairs", timesText(state)), Colour::none},
      {labelled("offset", offsetText(state)), Colour::none},
      {labelled("features", fmt::format("{}, tracked {}, inliers {}", message.features, message.tracked,
                                        message.inliers)),
       Colour::none},
      {labelled("messages",
                fmt::format("{}: {} valid, {} without a pair, {} lost, {} pose resets", counts.messages,
                            counts.valid, counts.no_pair, counts.lost, counts.resets)),
       Colour::none},
      {"", Colour::none}};
  if (state.health) {
    lines.push_back(
        {labelled("state", daemon::odometryStateName(state.health->odometry_state)), Colour::none});
    lines.push_back(cameraLine("left", state.health->left));
    lines.push_back(cameraLine("right", state.health->right));
  } else {
    lines.push_back({labelled("cameras", "no health message yet"), Colour::faint});
  }
  lines.push_back({"", Colour::none});
  if (state.advice.empty()) {
    lines.push_back({" no problem", Colour::faint});
  } else {
    for (const std::string& part : wrapped(state.advice, columns - 2))
      lines.push_back({" " + part, Colour::strong});
  }
  return lines;
}

bool mayColour() {
  const char* refused = std::getenv("NO_COLOR");
  return refused == nullptr || *refused == '\0';
}

}  // namespace

void SpeedHistory::add(double speed, std::int64_t now_ns) {
  if (last_ns_ && now_ns - *last_ns_ < kStep_ns) {
    if (std::isfinite(speed)) speeds_.back() = speed;
    return;
  }
  last_ns_ = now_ns;
  speeds_.push_back(speed);
  if (speeds_.size() > kMaxSpeeds) speeds_.pop_front();
}

double SpeedHistory::largest() const {
  double largest = 0.0;
  for (const double speed : speeds_) {
    if (std::isfinite(speed)) largest = std::max(largest, std::abs(speed));
  }
  return largest;
}

std::string SpeedHistory::sparkline(std::size_t columns) const {
  constexpr std::array<const char*, 8> kBars{"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  const double top = std::max(largest(), 0.1);  // m/s; below, a standstill's noise would fill the line
  std::string line;
  const std::size_t first = speeds_.size() > columns ? speeds_.size() - columns : 0;
  for (std::size_t i = first; i < speeds_.size(); ++i) {
    if (!std::isfinite(speeds_[i])) {
      line += " ";
      continue;
    }
    const auto bar = static_cast<std::size_t>(std::lround(7.0 * std::abs(speeds_[i]) / top));
    line += kBars[std::min<std::size_t>(bar, 7)];
  }
  return line;
}

std::vector<std::string> screenLines(const WatchedState& state, const SpeedHistory& speeds,
                                     std::size_t columns, std::size_t rows, bool is_coloured) {
  std::vector<Line> lines = contents(state, speeds, columns);
  if (rows > 1 && lines.size() > rows - 1) lines.resize(rows - 1);
  lines.push_back({" Ctrl-C ends with a summary", Colour::faint});
  std::vector<std::string> shown;
  for (const Line& line : lines) {
    const std::string cut = cutToColumns(line.text, columns);
    shown.push_back(is_coloured ? coloured(cut, line.colour) : cut);
  }
  return shown;
}

bool canShowScreen() {
  const char* terminal = std::getenv("TERM");
  if (terminal == nullptr || *terminal == '\0' || std::string_view(terminal) == "dumb") return false;
  const std::optional<TerminalSize> size = terminalSize(STDOUT_FILENO);
  return size && size->columns >= kMinColumns && size->rows >= kMinRows;
}

void Screen::draw(const WatchedState& state, const SpeedHistory& speeds) {
  const TerminalSize size = terminalSize(STDOUT_FILENO).value_or(TerminalSize{80, 24});
  // Alternate screen, no cursor; then from the upper left corner, line by line.
  std::string output = is_entered_ ? "" : "\x1b[?1049h\x1b[?25l";
  is_entered_ = true;
  output += "\x1b[H";
  const std::vector<std::string> lines = screenLines(state, speeds, size.columns, size.rows, mayColour());
  for (std::size_t i = 0; i < lines.size(); ++i)
    output += lines[i] + "\x1b[K" + (i + 1 < lines.size() ? "\r\n" : "");
  output += "\x1b[J";
  std::fputs(output.c_str(), stdout);
  std::fflush(stdout);
}

void Screen::leave() {
  if (!is_entered_) return;
  is_entered_ = false;
  std::fputs("\x1b[?25h\x1b[?1049l", stdout);
  std::fflush(stdout);
}

}  // namespace cartvo
