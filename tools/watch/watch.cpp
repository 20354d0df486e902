// `cartvo watch`: receives odometry like a controller and prints a live line and a summary.
#include "tools/watch/watch.hpp"

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include <fmt/format.h>
#include <lcm/lcm-cpp.hpp>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "common/command_line/terminal.hpp"
#include "common/host_clock.hpp"
#include "common/printable_text.hpp"
#include "common/units.hpp"
#include "daemon/publish/lcm_connection.hpp"
#include "daemon/publish/message_names.hpp"
#include "daemon/service/awaited_signals.hpp"
#include "tools/cartvo/json_text.hpp"
#include "tools/watch/screen.hpp"

namespace cartvo {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int kPoll_ms = 50;
constexpr int kQueueCapacity = 1000;
constexpr std::size_t kUnlimitedColumns = 1000;
constexpr const char* kTwoPublishers =
    "two daemons publish on this channel: their sequence numbers alternate, and controllers receive both "
    "motions. Stop one, or give it another lcm.url";

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Prints the live line: redrawn in place on a terminal, else one line per second.
class LiveLine {
 public:
  explicit LiveLine(const WatchSettings& settings)
      : stream_(settings.to_error_output ? stderr : stdout),
        redraws_(!settings.plain && isatty(fileno(stream_)) != 0) {}
  ~LiveLine() {
    if (redraws_ && drawn_) std::fputs("\n", stream_);
  }
  LiveLine(const LiveLine&) = delete;
  LiveLine& operator=(const LiveLine&) = delete;

  void draw(const odometry_t& message, const OdometryStatistics& statistics, const std::string& clocks,
            const std::string& bound_exceeded) {
    if (drawn_ && secondsSince(last_) < (redraws_ ? 0.2 : 1.0)) return;
    drawn_ = true;
    last_ = Clock::now();
    const std::size_t columns = redraws_ ? lineColumns(stream_) : kUnlimitedColumns;
    const std::string line =
        liveLine(message, statistics.currentFrameRate(wallClockNow()), clocks, columns, bound_exceeded);
    std::fprintf(stream_, redraws_ ? "\r%s\x1b[K" : "%s\n", line.c_str());
    std::fflush(stream_);
  }

  /// Prints `text` on a line of its own if it differs from the last one.
  void printAdvice(const std::string& text) {
    if (text == last_advice_) return;
    last_advice_ = text;
    if (redraws_ && drawn_) std::fputs("\n", stream_);
    std::fprintf(stream_, "%s\n", text.empty() ? "no problem any more" : text.c_str());
    std::fflush(stream_);
  }

 private:
  std::FILE* stream_;
  std::string last_advice_;
  bool redraws_;
  bool drawn_ = false;
  Clock::time_point last_;
};

/// The full-screen view, if the terminal allows it and the settings do not ask for lines.
class LiveScreen {
 public:
  explicit LiveScreen(const WatchSettings& settings)
      : url_(settings.url), is_used_(!settings.plain && !settings.to_error_output && canShowScreen()) {}

  bool isUsed() const { return is_used_; }

  void addMessage(const odometry_t& message) {
    message_ = message;
    received_ = Clock::now();
    const bool is_valid = isUsableWhenFresh(message);
    speeds_.add(is_valid ? message.velocity_body[0] : std::nan(""), wallClockNow());
  }
  void draw(const OdometryStatistics& statistics, const std::optional<health_t>& health,
            const std::string& advice) {
    constexpr double kPeriod = 0.2;  // s
    if (drawn_ && secondsSince(*drawn_) < kPeriod) return;
    drawn_ = Clock::now();
    screen_.draw({url_, message_, secondsSince(received_), statistics.currentFrameRate(wallClockNow()),
                  statistics.counts(), health, advice},
                 speeds_);
  }
  /// Gives the terminal to the shell, until SIGCONT.
  void suspend() {
    screen_.leave();
    ::raise(SIGSTOP);
    drawn_.reset();
  }

 private:
  std::string url_;
  bool is_used_;
  odometry_t message_{};
  Clock::time_point received_;
  std::optional<Clock::time_point> drawn_;
  SpeedHistory speeds_;
  Screen screen_;
};

/// Decodes a message; returns false if it is of another definition of the type.
template <typename Message>
bool decode(const lcm::ReceiveBuffer& buffer, Message& message) {
  const auto bytes = static_cast<int>(buffer.data_size);
  return message.decode(buffer.data, 0, bytes) == bytes;
}

/// Receives odometry and health messages in order.
class OdometryReceiver {
 public:
  explicit OdometryReceiver(lcm::LCM& lcm) : lcm_(lcm) {
    lcm.subscribe(daemon::kOdometryChannel, &OdometryReceiver::onOdometry, this)
        ->setQueueCapacity(kQueueCapacity);
    lcm.subscribe(daemon::kHealthChannel, &OdometryReceiver::onHealth, this)
        ->setQueueCapacity(kQueueCapacity);
  }

  /// Waits up to 50 ms; returns whether an odometry message arrived.
  bool receive() {
    received_ = false;
    if (lcm_.handleTimeout(kPoll_ms) < 0) throw std::runtime_error("LCM: cannot receive messages");
    return received_;
  }
  const odometry_t& last() const { return last_; }
  /// Advice to the operator: messages that cannot be decoded, problem and self-check of the last
  /// health message. Empty if there is nothing.
  std::string advice() const {
    const std::string foreign = foreignDefinitionText(foreign_odometry_, foreign_health_);
    return foreign.empty() || advice_.empty() ? foreign + advice_ : foreign + "\n" + advice_;
  }
  /// Source and standard deviation of the time offset; empty before the first health message.
  const std::string& clocks() const { return clocks_; }
  /// The last health message; empty before the first.
  const std::optional<health_t>& health() const { return health_; }
  /// Whether messages came that could not be decoded.
  bool hasForeignMessages() const { return foreign_odometry_; }

 private:
  void onOdometry(const lcm::ReceiveBuffer* buffer, const std::string& /*channel*/) {
    odometry_t message{};
    if (decode(*buffer, message)) {
      last_ = message;
      received_ = true;
    } else {
      foreign_odometry_ = true;
    }
  }

  void onHealth(const lcm::ReceiveBuffer* buffer, const std::string& /*channel*/) {
    health_t message{};
    if (decode(*buffer, message)) {
      advice_ = adviceText(message);
      clocks_ = clockText(message);
      health_ = message;
    } else {
      foreign_health_ = true;
    }
  }

  lcm::LCM& lcm_;
  std::string advice_;
  std::string clocks_;
  std::optional<health_t> health_;
  odometry_t last_{};
  bool received_ = false;
  bool foreign_odometry_ = false, foreign_health_ = false;
};

/// A field of the live line.
struct LiveField {
  int dispensable;  ///< fields with higher values are left out first
  std::string text;
};

/// The fields below a value, in their order.
template <typename Fields>
std::string joined(const Fields& fields, int dispensable) {
  std::string line;
  for (const LiveField& field : fields) {
    if (field.dispensable < dispensable && !field.text.empty())
      line += (line.empty() ? "" : "  ") + field.text;
  }
  return line;
}

[[noreturn]] void failWithoutMessages(const WatchSettings& settings, bool has_foreign_messages) {
  if (has_foreign_messages) throw std::runtime_error(foreignDefinitionText(true, false));
  const daemon::MulticastRoute route = daemon::findMulticastRoute(settings.url);
  throw std::runtime_error(fmt::format(
      "no message on {} within {:.0f} s.\n"
      "  Is the daemon running?      systemctl status cartvod; it publishes at the full rate "
      "even without cameras\n"
      "  Does it use the same URL?   here: {}; daemon: lcm.url in its configuration, else LCM_DEFAULT_URL\n"
      "  Is the route the same?      here: {}; compare 'ip route get {}' on both computers\n"
      "  Is it on another computer?  the daemon needs ttl=1 in lcm.url, and the network must "
      "forward multicast",
      daemon::kOdometryChannel, settings.first_message, daemon::describeLcmUrl(settings.url), route.interface,
      route.address));
}

std::string delayText(const OdometrySummary& summary) {
  if (std::isnan(summary.latency_p50_ms)) return "latency           none: a recording was replayed\n";
  const std::string settled =
      std::isnan(summary.latency_settled_p99_ms)
          ? ""
          : fmt::format("  from 2 s on     p99 {:.1f} ms\n", summary.latency_settled_p99_ms);
  return fmt::format(
      "latency           p50 {:.1f} ms, p99 {:.1f} ms (last packet to publication)\n{}"
      "age at reception  p50 {:.1f} ms, p99 {:.1f} ms (from exposure, by both clocks)\n",
      summary.latency_p50_ms, summary.latency_p99_ms, settled, summary.age_p50_ms, summary.age_p99_ms);
}

}  // namespace

OdometryStatistics watchOdometry(const WatchSettings& settings) {
  LiveScreen screen(settings);
  // On a screen also what would leave the terminal in its state: Ctrl-backslash, Ctrl-Z, and a terminal that
  // closes.
  const daemon::AwaitedSignals signals(screen.isUsed()
                                           ? std::vector<int>{SIGTERM, SIGINT, SIGQUIT, SIGHUP, SIGTSTP}
                                           : std::vector<int>{SIGTERM, SIGINT});
  const std::unique_ptr<lcm::LCM> lcm = daemon::connectLcm(settings.url);
  if (const std::string warning = daemon::multicastWarning(daemon::findMulticastRoute(settings.url));
      !warning.empty()) {
    std::fprintf(stderr, "cartvo watch: %s\n", warning.c_str());
  }
  OdometryReceiver receiver(*lcm);
  LiveLine line(settings);
  OdometryStatistics statistics;
  Clock::time_point first = Clock::now();
  Clock::time_point last_pair = first;
  bool has_message = false;
  for (;;) {
    const std::optional<int> signal = signals.wait(std::chrono::nanoseconds(0));
    if (signal && *signal != SIGTSTP) break;
    if (signal) screen.suspend();
    if (receiver.receive()) {
      const odometry_t& message = receiver.last();
      if (!has_message) first = last_pair = Clock::now();
      has_message = true;
      statistics.addMessage(message, wallClockNow());
      if (isOfPair(message)) last_pair = Clock::now();
      if (screen.isUsed()) {
        screen.addMessage(message);
      } else {
        line.draw(message, statistics, receiver.clocks(),
                  receiver.health() ? receiver.health()->bound_exceeded : "");
      }
    }
    const std::string advice = statistics.hasTwoPublishers() ? kTwoPublishers : receiver.advice();
    if (!screen.isUsed()) line.printAdvice(advice);
    if (screen.isUsed() && has_message) screen.draw(statistics, receiver.health(), advice);
    if (!has_message && secondsSince(first) > settings.first_message)
      failWithoutMessages(settings, receiver.hasForeignMessages());
    if (has_message && settings.seconds > 0.0 && secondsSince(first) >= settings.seconds) break;
    if (statistics.hasPairs() && settings.until_silent > 0.0 &&
        secondsSince(last_pair) >= settings.until_silent)
      break;
  }
  if (!has_message) {
    throw std::runtime_error(fmt::format("interrupted after {:.1f} s without a message on {}",
                                         secondsSince(first), daemon::kOdometryChannel));
  }
  return statistics;
}

std::string foreignDefinitionText(bool odometry, bool health) {
  if (!odometry && !health) return {};
  const std::string channels = odometry && health
                                   ? std::string(daemon::kOdometryChannel) + " and " + daemon::kHealthChannel
                                   : (odometry ? daemon::kOdometryChannel : daemon::kHealthChannel);
  return "messages come on " + channels +
         ", but of another definition of the type: the sender is of another release than this cartvo (" +
         CARTVO_VERSION + "). Compare 'cartvod --version' and install the same release on both computers";
}

std::string adviceText(const health_t& message) {
  std::string text;
  if (!message.problem.empty()) text = "problem: " + message.problem;
  if (message.self_check.empty() || message.self_check == message.problem) return text;
  return text + (text.empty() ? "" : "\n") + "self-check: " + message.self_check;
}

std::string clockText(const health_t& message) {
  const std::string readouts = message.left_readout_deviation_ms > 0.0F
                                   ? fmt::format("  readout {:.1f} ±{:.1f}, {:.1f} ±{:.1f} ms",
                                                 message.left_readout_ms, message.left_readout_deviation_ms,
                                                 message.right_readout_ms, message.right_readout_deviation_ms)
                                   : std::string();
  return fmt::format("by {} ±{:.1f} ms{}", daemon::instantSourceName(message.right.instant_source),
                     message.clock_deviation_ms, readouts);
}

std::string invalidText(const odometry_t& message, const std::string& bound_exceeded) {
  std::string names = daemon::reasonNames(message.reasons);
  if ((message.reasons & odometry_t::REASON_BOUND) == 0 || bound_exceeded.empty()) return names;
  return names + ": " + printableExcerpt(bound_exceeded, 200);
}

std::string liveLine(const odometry_t& message, double frame_rate, const std::string& clocks,
                     std::size_t columns, const std::string& bound_exceeded) {
  const std::string rate = fmt::format("{:5.1f} fps", frame_rate);
  if (message.status == odometry_t::VALID && !isUsableWhenFresh(message))
    return cutToColumns(rate + "  VALID, but with impossible numbers or a reason against it: not to be used",
                        columns);
  if (message.status != odometry_t::VALID)
    return cutToColumns(rate + "  INVALID: " + invalidText(message, bound_exceeded), columns);
  const std::optional<double> latency = latencyMs(message);
  const std::array<LiveField, 8> fields{{
      {0, rate},
      {4, latency ? fmt::format("latency {:5.1f} ms", *latency) : "of a recording"},
      {1, fmt::format("speed {:6.2f} m/s", message.velocity_body[0])},
      {3, fmt::format("yaw {:+6.1f} deg/s", message.angular_velocity_body[2] * kDegreesPerRadian)},
      {7, fmt::format("features {:5d}", message.features)},
      {5, fmt::format("offset {:+5.1f} ms", static_cast<double>(message.offset_us) * 1e-3)},
      {2, "valid"},
      {6, clocks},
  }};
  for (int dispensable = 8; dispensable > 2; --dispensable) {
    std::string line = joined(fields, dispensable);
    if (textColumns(line) <= columns) return line;
  }
  return cutToColumns(joined(fields, 3), columns);
}

std::string summaryText(const OdometrySummary& summary) {
  const std::int64_t pairs = summary.messages - summary.no_pair;
  std::string text = fmt::format("messages          {} ({} lost, {} without a pair)\n", summary.messages,
                                 summary.lost, summary.no_pair);
  if (pairs == 0)
    return text + "no pair of frames came: 'journalctl -u cartvod' names the camera and the cause\n";
  return text +
         fmt::format(
             "valid             {} ({:.1f} % of the pairs)\n"
             "frame rate        {:.2f} pairs/s over {:.1f} s\n"
             "{}"
             "offset            median {:+.2f} ms (right minus left)\n"
             "path              {:.1f} m; {} pose resets, {} daemon restarts\n",
             summary.valid, 100.0 * static_cast<double>(summary.valid) / static_cast<double>(pairs),
             summary.frame_rate, summary.seconds, delayText(summary), summary.offset_median_ms,
             summary.path_length, summary.resets, summary.restarts) +
         (summary.senseless == 0
              ? ""
              : fmt::format("senseless         {} messages with impossible numbers, or VALID with "
                            "a reason against it: not of a working cartvod\n",
                            summary.senseless)) +
         (summary.two_publishers ? std::string(kTwoPublishers) + "\n" : "");
}

std::string summaryJson(const OdometrySummary& summary) {
  const nlohmann::ordered_json json = {
      {"messages", summary.messages},
      {"lost", summary.lost},
      {"no_pair", summary.no_pair},
      {"valid", summary.valid},
      {"valid_percent", validPercent(summary)},
      {"restarts", summary.restarts},
      {"resets", summary.resets},
      {"two_publishers", summary.two_publishers},
      {"senseless", summary.senseless},
      {"seconds", summary.seconds},
      {"frame_rate", summary.frame_rate},
      {"path_length_m", summary.path_length},
      {"latency_ms",
       {{"p50", summary.latency_p50_ms},
        {"p99", summary.latency_p99_ms},
        {"settled_p99", summary.latency_settled_p99_ms}}},
      {"age_ms", {{"p50", summary.age_p50_ms}, {"p99", summary.age_p99_ms}}},
      {"offset_median_ms", summary.offset_median_ms},
  };
  return jsonText(json);
}

double validPercent(const OdometrySummary& summary) {
  const std::int64_t pairs = summary.messages - summary.no_pair;
  return pairs == 0 ? 0.0 : 100.0 * static_cast<double>(summary.valid) / static_cast<double>(pairs);
}

}  // namespace cartvo
