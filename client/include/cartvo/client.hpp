#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <limits>
#include <string>

#include <cartvo/odometry_t.hpp>
#include <lcm/lcm-cpp.hpp>

// Client library for controllers: takes the newest message of CARTVO_ODOMETRY, checks it, extrapolates its
// motion to now, and ends in a stated safe output when there is none. C++17; needs LCM only.
//
// A controller needs OdometryClient; its parts can be used alone, for example where messages come from a
// log. docs/controllers.md explains their use. Units: SI, unless a name says otherwise. Axes: body x forward,
// y left, z up; the world is the body at the first pair of the epoch. utime: us since the Unix epoch, system
// clock. No function throws, unless stated. No class is thread-safe.

namespace cartvo::client {

constexpr const char* kOdometryChannel = "CARTVO_ODOMETRY";
constexpr const char* kDefaultLcmUrl = "udpm://239.255.76.67:7667?ttl=0";

/// The URL of the environment variable LCM_DEFAULT_URL, which LCM's own programs and cartvo follow too, else
/// kDefaultLcmUrl.
std::string defaultLcmUrl();

using SteadyClock = std::chrono::steady_clock;

/// Current system time, us since the Unix epoch.
std::int64_t nowUtime();

// Check of one message.

/// Limits of what a controller accepts. Wider than those of cartvod (50 m/s, 4 rad/s), so that only a wrong
/// message exceeds them.
struct OdometryLimits {
  double speed = 100.0;                           ///< m/s, each axis
  double turn_rate = 10.0;                        ///< rad/s, each axis
  double distance = 1e7;                          ///< m, each coordinate of the position
  std::int64_t max_time_to_live_us = 10'000'000;  ///< the most that cartvod can be configured to
  std::int64_t max_age_us = 1'000'000;            ///< the controller's own, whatever the time to live
  std::int64_t max_future_us = 10'000;            ///< difference between the clocks of two computers

  /// The controller's own alert limits: the largest bounds of the message, each axis, that it acts on. Only
  /// those below cartvod's (odometry.alert_limits) have an effect; infinity: cartvod's alone.
  double velocity_bound = std::numeric_limits<double>::infinity();      ///< m/s
  double angular_rate_bound = std::numeric_limits<double>::infinity();  ///< rad/s
  double motion_bound = std::numeric_limits<double>::infinity();    ///< m, translation over the last second
  double rotation_bound = std::numeric_limits<double>::infinity();  ///< rad, rotation over the last second
};

/// Why a message cannot be used; the first that applies.
enum class OdometryVerdict : std::uint8_t {
  usable,
  invalid,       ///< the daemon says so
  contradicted,  ///< VALID, but with a reason other than standstill or a quality of 0, or another status than
                 ///< the two defined
  senseless,     ///< a number that is not finite, not possible, or negative where it cannot be
  uncertain,     ///< a bound exceeds the controller's own alert limit
  corrupted,     ///< changed since it was published: the check sum is another
  late,          ///< older than its time to live or than the controller accepts
  future,        ///< exposed after now: a clock is wrong
};

/// The verdict in words, for logs.
const char* verdictText(OdometryVerdict verdict);

/// Whether pose, velocities, covariances and bounds are finite and possible ones.
bool hasPossibleMotion(const odometry_t& message, const OdometryLimits& limits = {});

/// Whether each bound is at most the controller's own limit.
bool isCertainEnough(const odometry_t& message, const OdometryLimits& limits);

/// CRC-32 (IEEE 802.3, as in Ethernet and zlib) of the message's LCM encoding without its last field, crc32,
/// which cartvod sets to it.
std::int32_t contentCrc(const odometry_t& message);
/// Whether the message is as it was published.
bool isIntact(const odometry_t& message);

/// Whether the message says VALID, and nothing in it speaks against that.
bool isConsistent(const odometry_t& message);

/// Age of the message at `now_utime`, us; negative: from the future. The extremes of int64 are limited, so
/// that no instant makes it overflow.
std::int64_t ageUs(const odometry_t& message, std::int64_t now_utime);

/// Whether a controller may use the message at `now_utime`, or why not.
OdometryVerdict judge(const odometry_t& message, std::int64_t now_utime, const OdometryLimits& limits = {});

// Motion at another instant.

/// Standard deviations of the acceleration that a constant twist does not know. The defaults are those of a
/// cart that brakes, steers and bounces on its suspension.
struct MotionNoise {
  double acceleration = 2.0;          ///< m/s^2, each axis
  double angular_acceleration = 2.0;  ///< rad/s^2, each axis
};

/// Pose and twist with covariances (6x6, row-major, x y z and rotation about x y z, body axes, perturbation
/// on the right side), as in odometry_t.
struct Motion {
  std::int64_t utime = 0;                                   ///< instant that the motion is of
  std::array<double, 3> position{};                         ///< of the body in the world, m
  std::array<double, 4> orientation{{1.0, 0.0, 0.0, 0.0}};  ///< of the body in the world, w x y z
  std::array<double, 3> velocity{};                         ///< of the body's origin, body axes, m/s
  std::array<double, 3> angular_velocity{};                 ///< body axes, rad/s
  std::array<double, 36> pose_covariance{};
  std::array<double, 36> twist_covariance{};
};

/// The motion of the message at `utime` with a constant twist in body axes; an earlier `utime` than the
/// message's counts as the message's. Covariances grow by the twist's covariance and by an acceleration of
/// `noise` that lasts from the message on:
///
///   pose:  Ad P Ad^T + (J dt) Q (J dt)^T + (a dt^2 / 2)^2      twist:  Q + (a dt)^2
///
/// with the covariances P of the pose and Q of the twist, which count as independent, the adjoint Ad of the
/// inverse motion and the right Jacobian J of the motion. `message` must be usable (see `judge`).
Motion extrapolate(const odometry_t& message, std::int64_t utime, const MotionNoise& noise = {});

// Selection of the newest message.

/// Keeps the newest of the received messages. UDP can repeat and reorder messages. A message is newer if its
/// sequence is higher than that of the same source, or if the daemon has restarted: another source or a lower
/// sequence that was published later. Others are ignored, unless nothing newer came for `silence`: then the
/// daemon's clock may have been set back.
class NewestOdometry {
 public:
  explicit NewestOdometry(std::chrono::milliseconds silence = std::chrono::seconds(1)) : silence_(silence) {}

  /// Takes a message that was received at `reception`. Returns whether it is newer and was kept.
  bool add(const odometry_t& message, SteadyClock::time_point reception);

  /// The newest message; zeros before the first.
  const odometry_t& message() const { return message_; }

  /// Number of messages kept.
  std::uint64_t kept() const { return kept_; }

  /// Number of messages lost since the first one of this daemon run: gaps in the sequence.
  std::int64_t lost() const { return lost_; }

  /// Number of messages ignored because they were older than the newest one, or repeated it.
  std::uint64_t ignored() const { return ignored_; }

  /// Number of times that the pose began again: the reset counter changed or the daemon restarted. Poses of
  /// two epochs are not related; velocities are not affected.
  std::int64_t epoch() const { return epoch_; }

  /// Whether two programs publish odometry: within the last two seconds the source changed, or the sequence
  /// went back, more than once. Their poses are not related, and either may be the wrong one.
  bool hasTwoPublishers(SteadyClock::time_point now) const;

 private:
  void countSince(const odometry_t& message, SteadyClock::time_point reception);

  std::chrono::milliseconds silence_;
  odometry_t message_{};
  std::uint64_t kept_ = 0, ignored_ = 0;
  std::int64_t lost_ = 0, epoch_ = 0;
  SteadyClock::time_point last_reception_, last_restart_, second_restart_;
};

// Input of a control loop.

struct ControllerSettings {
  OdometryLimits limits;
  MotionNoise noise;
  std::chrono::milliseconds ramp_down{500};  ///< from full authority to none; 0: at once
  std::chrono::milliseconds ramp_up{500};    ///< from no authority to full; 0: at once
  std::chrono::milliseconds silence{1000};   ///< see NewestOdometry
};

enum class InputState : std::uint8_t {
  waiting,   ///< no usable message came yet; velocities are NaN, authority is 0
  measured,  ///< the motion is that of now
  ramping,   ///< no usable message any more: the motion is the last one, authority falls to 0
  safe,      ///< authority is 0; velocities are NaN, so that none is taken for a standstill
};

/// The state in words, for logs.
const char* stateText(InputState state);

/// Input of a control loop in one cycle.
struct ControllerInput {
  InputState state = InputState::waiting;
  /// 0 to 1: the share of the odometry in the controller's command. It falls from 1 to 0 within
  /// `ramp_down` once there is no usable message, and rises within `ramp_up` when there is one again.
  double authority = 0.0;
  Motion motion;            ///< covariances are NaN where velocities are
  std::int64_t age_us = 0;  ///< of the message that the motion is from; 0 before the first
  std::int64_t epoch = 0;   ///< of `motion`, see NewestOdometry: forget poses of the epoch before
  OdometryVerdict verdict = OdometryVerdict::invalid;  ///< on the newest message, which may be another
  bool two_publishers = false;                         ///< another program publishes too: nothing is usable

  /// The command to send: `wanted`, computed from `motion`, by the share of `authority`, and for the rest
  /// `safe`, the command without odometry. It is `safe` at authority 0 or if `wanted` is not finite, so that
  /// the output always ends there within `ramp_down`.
  double command(double wanted, double safe = 0.0) const;
};

/// Turns messages into the input of a control loop. The last usable message is extrapolated for at most its
/// time to live, also while the daemon reports INVALID, because one lost pair does not make it wrong. It is
/// given up at once if the daemon reports a frozen camera or cameras that do not fit together, since it may
/// be wrong too, and if two programs publish.
class ControllerOdometry {
 public:
  explicit ControllerOdometry(const ControllerSettings& settings = {})
      : settings_(settings), newest_(settings.silence) {}

  /// Takes a message that was received at `reception`, `now_utime` by the system clock. Returns whether it
  /// is intact and newer than the ones before.
  bool add(const odometry_t& message, std::int64_t now_utime, SteadyClock::time_point reception);

  /// The input at `now`, `now_utime` by the system clock. Called once per cycle, because it moves the ramp.
  ControllerInput input(std::int64_t now_utime, SteadyClock::time_point now);

  const NewestOdometry& newest() const { return newest_; }

  /// Number of messages that were left out because they were not intact.
  std::uint64_t corrupted() const { return corrupted_; }

 private:
  bool canUse(std::int64_t now_utime, SteadyClock::time_point now) const;
  void moveAuthority(bool usable, SteadyClock::time_point now);

  ControllerSettings settings_;
  NewestOdometry newest_;
  odometry_t usable_{};            ///< the last usable message
  std::int64_t usable_epoch_ = 0;  ///< its epoch
  bool has_usable_ = false;
  std::uint64_t corrupted_ = 0;
  bool was_measured_ = false;  ///< an input was `measured` before
  Motion motion_;              ///< of the last input that was `measured`
  std::int64_t motion_epoch_ = 0;
  double authority_ = 0.0;
  SteadyClock::time_point last_input_{};
};

/// Subscriber to CARTVO_ODOMETRY for a control loop:
///
///   lcm::LCM lcm(defaultLcmUrl());     // check lcm.good()
///   OdometryClient odometry(lcm);
///   each cycle:  odometry.update(0);
///                const ControllerInput input = odometry.input();
///                send(input.command(gain * (target - input.motion.angular_velocity[2])));
class OdometryClient {
 public:
  /// Subscribes with `lcm`, which is borrowed and must outlive the client.
  explicit OdometryClient(lcm::LCM& lcm, const ControllerSettings& settings = {});
  ~OdometryClient();
  OdometryClient(const OdometryClient&) = delete;
  OdometryClient& operator=(const OdometryClient&) = delete;

  /// Waits up to `timeout_ms` for a newer odometry message, then handles all queued messages (at most 1000),
  /// because LCM keeps the old messages of a full queue and drops the new ones. Returns whether there was
  /// one. Messages of other channels, such as LCM's self-test at a program's start, do not count. If LCM
  /// fails it waits for the rest of the time.
  bool update(int timeout_ms);

  /// The input of the control loop now. Call it once per cycle.
  ControllerInput input() { return odometry_.input(nowUtime(), SteadyClock::now()); }

  const NewestOdometry& newest() const { return odometry_.newest(); }

  /// See ControllerOdometry.
  std::uint64_t corrupted() const { return odometry_.corrupted(); }

  /// Number of messages that could not be decoded: the daemon is of a release with another odometry_t.
  std::uint64_t undecodable() const { return undecodable_; }

 private:
  void onData(const lcm::ReceiveBuffer* buffer, const std::string& channel);

  lcm::LCM& lcm_;
  lcm::Subscription* subscription_;
  ControllerOdometry odometry_;
  std::uint64_t undecodable_ = 0;
};

}  // namespace cartvo::client
