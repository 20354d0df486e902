// Integrates the cart's speed and spring-mass model once and keeps the result as splines over time.
#include "lab/render/motion/drive.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "lab/render/motion/speed_profile.hpp"
#include "lab/render/scenario_traits.hpp"
#include "lab/render/surface/hash.hpp"
#include "lab/render/surface/noise.hpp"
#include "lab/render/world_settings.hpp"

namespace cartvo::world {
namespace {

// Heights along two wheel tracks: each cell of the way has a level of its own, in part common to both tracks,
// with a short ramp from that of the cell before, and in some cells a bump.

constexpr double kCell = 1.3;        // m along the path
constexpr double kRamp = 0.16;       // m: a tyre rolls over a kerb as over a ramp
constexpr double kBump = 0.55;       // m along the path
constexpr double kBumpShare = 0.35;  // of the cells
constexpr double kCommon = 0.8;      // share of a level that both tracks have

/// Kerbs, joints and bumps that the wheels of a lively drive meet, as heights along the two wheel tracks.
/// None in a calm drive.
class Obstacles {
 public:
  explicit Obstacles(const WorldSettings& settings)
      : seed_(hashOf({static_cast<std::uint32_t>(settings.seed),
                      static_cast<std::uint32_t>(settings.scenario), 512U})),
        size_(settings.liveliness * traitsOf(settings.scenario).obstacles) {}

  /// Height below a wheel, m, `distance` m along the path.
  double height(double distance, bool left) const {
    if (size_ == 0.0) return 0.0;
    const double whole = std::floor(distance / kCell);
    const auto cell = static_cast<std::int32_t>(whole);
    const double within = distance - whole * kCell;
    const std::uint32_t track = left ? 1 : 0;
    // The tracks meet the same kerb at different places: few kerbs lie square to the way.
    const double t = std::clamp((within - 0.25 * random(cell, track, 1)) / kRamp, 0.0, 1.0);
    const double before = level(cell - 1, left);
    const double ground = before + (level(cell, left) - before) * t * t * (3.0 - 2.0 * t);
    if (random(cell, 2, 2) >= kBumpShare) return ground;
    const double along = within - (kCell - kBump) * (0.6 + 0.4 * random(cell, track, 3));
    if (along <= 0.0 || along >= kBump) return ground;
    return ground + 0.5 * size_ * random(cell, track, 4) *
                        (0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * along / kBump));
  }

 private:
  double level(std::int32_t cell, bool left) const {
    return size_ * (kCommon * random(cell, 2, 0) + (1.0 - kCommon) * random(cell, left ? 1 : 0, 0));
  }
  double random(std::int32_t cell, std::uint32_t track, std::uint32_t value) const {
    return 0x1.0p-32 * hashOf({seed_, static_cast<std::uint32_t>(cell), track, value});
  }

  std::uint32_t seed_ = 0;
  double size_ = 0.0;  ///< m, height of the highest kerb
};

constexpr double kWheelbase = 1.65;  // m
constexpr double kTrack = 0.9;       // m
constexpr int kSubsteps = 4;         // integration steps of the springs in one kSpeedStep

/// A damped spring that follows `target`: x'' = w^2 (target - x) - 2 d w x'.
struct Spring {
  double frequency = 10.0;  ///< rad/s
  double damping = 0.35;
  double x = 0.0;
  double rate = 0.0;

  void step(double target, double seconds) {
    rate += seconds * (frequency * frequency * (target - x) - 2.0 * damping * frequency * rate);
    x += seconds * rate;
  }
};

/// Of the springs above the wheels, rad/s. A lively cart has stiff ones.
double springFrequency(double liveliness) {
  return Spring().frequency + 4.0 * liveliness;
}

/// Deviation of the road's height below a wheel, m, `distance` m along the path and `lateral` m to its left.
double roughness(double distance, double lateral, double amplitude, std::uint32_t seed) {
  return amplitude *
         noise(static_cast<float>(distance), static_cast<float>(lateral), 0.3F, {9.6F, 0.6F, 0.62F}, seed);
}

/// The springs above the four wheels, on the road's roughness and on obstacles.
class Wheels {
 public:
  explicit Wheels(const WorldSettings& settings)
      : seed_(hashOf({static_cast<std::uint32_t>(settings.seed), 501U})),
        roughness_(traitsOf(settings.scenario).roughness),
        obstacles_(settings) {
    for (int wheel = 0; wheel < 4; ++wheel)
      springs_[wheel] = {.frequency = springFrequency(settings.liveliness), .x = height(0.0, wheel)};
  }

  void step(double distance, double seconds) {
    for (int wheel = 0; wheel < 4; ++wheel)
      springs_[wheel].step(height(distance, wheel), seconds);
  }

  double heave() const { return 0.5 * (springs_[0].x + springs_[1].x); }
  double pitch() const { return (heave() - 0.5 * (springs_[2].x + springs_[3].x)) / kWheelbase; }
  double roll() const {
    return (0.5 * (springs_[1].x + springs_[3].x) - 0.5 * (springs_[0].x + springs_[2].x)) / kTrack;
  }

 private:
  double height(double distance, int wheel) const {
    const double along = distance + ((wheel & 2) != 0 ? kWheelbase : 0.0);
    const bool left = (wheel & 1) != 0;
    return roughness(along, left ? 0.5 * kTrack : -0.5 * kTrack, roughness_, seed_) +
           obstacles_.height(along, left);
  }

  std::uint32_t seed_;
  double roughness_;  ///< m
  Obstacles obstacles_;
  std::array<Spring, 4> springs_;  ///< right rear, left rear, right front, left front
};

/// Kicks of a rough road in one axis: impulses of acceleration, one at a random instant of each second.
class Kicks {
 public:
  /// `maximum_rate`: largest velocity (m/s or rad/s) after a kick. `axis` selects the random numbers.
  Kicks(std::uint64_t seed, std::uint32_t axis, double maximum_rate)
      : seed_(static_cast<std::uint32_t>(seed)), axis_(axis), maximum_rate_(maximum_rate) {}

  /// Acceleration, m/s^2 or rad/s^2.
  double at(double seconds) const {
    const auto second = static_cast<std::uint32_t>(seconds);
    const double since = seconds - second - 0.9 * random(second, 0);
    if (since < 0.0 || since > kDuration) return 0.0;
    const double strength = 2.0 * random(second, 1) - 1.0;
    const double shape = std::sin(M_PI * since / kDuration);
    return maximum_rate_ * strength * 2.0 / kDuration * shape * shape;
  }

 private:
  static constexpr double kDuration = 0.06;  // s

  double random(std::uint32_t second, std::uint32_t value) const {
    return 0x1.0p-32 * hashOf({seed_, axis_, second, value});
  }

  std::uint32_t seed_, axis_;
  double maximum_rate_;
};

/// The body's motion in one axis after the kicks of a rough road.
struct Kicked {
  Kicks kicks;
  Spring spring{15.0, 0.4};

  void step(double time, double seconds) {
    spring.rate += seconds * kicks.at(time);
    spring.step(0.0, seconds);
  }
};

/// Largest velocities after a kick.
struct KickRates {
  double heave = 0.0;              ///< m/s
  double roll = 0.0, pitch = 0.0;  ///< rad/s
  double yaw = 0.0;                ///< rad/s
};

KickRates kickRates(Scenario scenario) {
  if (scenario == Scenario::rough) return {.pitch = 2.5, .yaw = 2.5};
  if (scenario == Scenario::rough_road) return {.heave = 1.3, .roll = 0.8, .pitch = 0.8};
  return {};
}

}  // namespace

Drive::Drive(const Path& path, const WorldSettings& settings)
    : path_(path),
      terrain_(traitsOf(settings.scenario).terrain),
      weave_(path, settings),
      speed_(kSpeedStep, speedProfile(path, weave_, settings)) {
  constexpr double kPitchPerAcceleration = -0.011;  // rad/(m/s^2): the nose rises under acceleration
  constexpr double kRollPerAcceleration = 0.014;    // rad/(m/s^2): the body rolls outward in a bend
  Wheels wheels(settings);
  Spring squat{7.0, 0.45};
  Spring lean{7.0, 0.45};
  const double softness = std::pow(Spring().frequency / springFrequency(settings.liveliness), 2);
  const KickRates rates = kickRates(settings.scenario);
  Kicked kicked_yaw{Kicks(settings.seed, 502, rates.yaw)};
  Kicked kicked_pitch{Kicks(settings.seed, 503, rates.pitch)};
  Kicked kicked_heave{Kicks(settings.seed, 504, rates.heave)};
  Kicked kicked_roll{Kicks(settings.seed, 505, rates.roll)};
  const bool has_yaw = rates.yaw > 0.0;
  std::vector<double> yaw, heave, pitch, roll;
  const int steps = speedSteps(settings);
  constexpr double kStep = kSpeedStep / kSubsteps;
  for (int i = 0; i < steps * kSubsteps; ++i) {
    const double time = i * kStep;
    const double along = speed_.integral(time);
    const double v = speed_.value(time);
    const double acceleration = (speed_.value(time + kStep) - v) / kStep;
    wheels.step(along, kStep);
    squat.step(softness * kPitchPerAcceleration * acceleration, kStep);
    lean.step(softness * kRollPerAcceleration * v * v * (path.at(along).curvature + weave_.curvature(along)),
              kStep);
    if (time > settings.lead_in_seconds) {
      for (Kicked* kicked : {&kicked_yaw, &kicked_pitch, &kicked_heave, &kicked_roll})
        kicked->step(time, kStep);
    }
    if (i % kSubsteps != 0) continue;
    heave.push_back(wheels.heave() + kicked_heave.spring.x);
    pitch.push_back(wheels.pitch() + squat.x + kicked_pitch.spring.x);
    roll.push_back(wheels.roll() + lean.x + kicked_roll.spring.x);
    if (has_yaw) yaw.push_back(kicked_yaw.spring.x);
  }
  heave_ = UniformSpline(kSpeedStep, std::move(heave));
  pitch_ = UniformSpline(kSpeedStep, std::move(pitch));
  roll_ = UniformSpline(kSpeedStep, std::move(roll));
  if (has_yaw) yaw_ = UniformSpline(kSpeedStep, std::move(yaw));
  if (settings.liveliness > 0.0) course_ = weavingCourse(steps);
}

Drive::Course Drive::weavingCourse(int steps) const {
  std::vector<double> x, y, yaw;
  for (int i = 0; i < steps; ++i) {
    const double along = distance(i * kSpeedStep);
    const PathPoint at = path_.at(along);
    const Eigen::Vector2d place = at.beside(weave_.lateral(along));
    x.push_back(place.x());
    y.push_back(place.y());
    const double heading = std::atan2(at.tangent.y(), at.tangent.x()) + std::atan(weave_.slope(along));
    yaw.push_back(yaw.empty() ? heading : yaw.back() + std::remainder(heading - yaw.back(), 2.0 * M_PI));
  }
  return {UniformSpline(kSpeedStep, std::move(x)), UniformSpline(kSpeedStep, std::move(y)),
          UniformSpline(kSpeedStep, std::move(yaw))};
}

PathPoint Drive::placeAt(double seconds) const {
  if (!course_) return path_.at(distance(seconds));
  const double yaw = course_->yaw.value(seconds);
  return {.position = {course_->x.value(seconds), course_->y.value(seconds)},
          .tangent = {std::cos(yaw), std::sin(yaw)}};
}

Eigen::Isometry3d Drive::T_map_body(double seconds) const {
  Eigen::Isometry3d sprung = Eigen::Isometry3d::Identity();
  sprung.translation().z() = heave_.value(seconds);
  sprung.linear() = (Eigen::AngleAxisd(pitch_.value(seconds), Eigen::Vector3d::UnitY()) *
                     Eigen::AngleAxisd(roll_.value(seconds), Eigen::Vector3d::UnitX()))
                        .toRotationMatrix();
  if (yaw_) sprung.rotate(Eigen::AngleAxisd(yaw_->value(seconds), Eigen::Vector3d::UnitZ()));
  return groundPose(terrain_, placeAt(seconds), 0.0, kWheelbase) * sprung;
}

}  // namespace cartvo::world
