#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core/types.hpp>

namespace cartvo::world {

/// Scenario of a drive and what makes it difficult.
enum class Scenario : std::uint8_t {
  campus,       ///< a lap among buildings and trees with some traffic: the normal case
  loop,         ///< the same on a loop of about 300 m; the cart stops at its start
  turns,        ///< a winding lane with one tight turn after another
  traffic,      ///< vehicles ahead and oncoming, which cover up to about 40 % of the view
  standing,     ///< standstill while vehicles pass and pull in ahead
  stop_and_go,  ///< repeated acceleration and braking to a standstill
  exposure,     ///< repeated exposure jumps of three stops
  underpass,    ///< dark underpasses: the light changes by several stops
  glare,        ///< a low sun, often in the image, with veiling glare
  dusk,         ///< little light: high gain, strong sensor noise, no shadows
  low_texture,  ///< smooth asphalt, plain plaster, few objects
  bumpy,        ///< a rough road: strong pitch, roll and heave
  reversing,    ///< repeated forward drive, standstill, backward drive
  motorway,     ///< fast in a wide bend on smooth asphalt, all else far away: few near points
  rough,        ///< no road: pitch and roll of some degrees, kicks in yaw and pitch within a frame period
  rough_road,   ///< a road with potholes: vertical accelerations of 3 g at the cameras
  garage,       ///< a parking garage: lamps, a low ceiling, columns, equal bays
  hedges,       ///< a narrow winding path with tall hedges close on both sides
  rain,         ///< drops on both lenses, an overcast sky
  flicker,      ///< a low sun behind the trees of an avenue: light and shadow alternate
  slope,        ///< a road up and down steep hills
  bridge,       ///< a high bridge with railings of equal bars before a far background
  crowd,        ///< slow, among many walking people
  wind,         ///< trees and bushes that sway, leaves blown over the road
  tunnel,       ///< out of a dark tunnel into daylight
};

/// All scenarios in the order of the enumeration.
std::vector<Scenario> allScenarios();

/// Name of a scenario as on the command line: that of the enumerator.
std::string_view scenarioName(Scenario scenario);

/// The scenario of a name. Throws std::invalid_argument that lists all names if there is none.
Scenario scenarioFromName(std::string_view name);

/// Whether a drive of the scenario may be lively: not at the speed of a motorway.
bool canBeLively(Scenario scenario);

/// A vibration of the cameras' mount about its own place, in pitch and roll.
struct Shake {
  double frequency = 0.0;  ///< Hz
  double amplitude = 0.0;  ///< rad, of pitch; that of roll is 0.6 of it
};

/// Settings of a drive and its two cameras. The same settings give the same bytes.
struct WorldSettings {
  Scenario scenario = Scenario::campus;
  std::uint64_t seed = 1;        ///< of campus, traffic and sensor noise
  double seconds = 60.0;         ///< length of the drive, s
  double liveliness = 0.0;       ///< of the drive, 0: calm, to 1: weaves, meets kerbs, accelerates briskly
  double lead_in_seconds = 2.0;  ///< standstill at the start of the drive, s
  /// Instant of the drive at which the pictures begin, s; none: 0 for a calm drive, a lively one is in
  /// motion.
  std::optional<double> start_seconds;
  double frame_rate = 18.0;       ///< of each camera, Hz
  double offset_s = 0.0;          ///< right minus left exposure at the start, s
  double offset_drift_ppm = 0.0;  ///< relative excess of the right camera's period, 1e-6
  double left_readout = 0.0;      ///< s, as in vo::Shutter; 0: a global shutter
  double right_readout = 0.0;     ///< s
  Shake shake;                    ///< of the mount, from the end of the lead-in on
  cv::Size image_size{680, 420};  ///< px
  double focal_length = 480.0;    ///< nominal, px; the two cameras differ from it by 0.1 to 0.2 %
  double baseline = 0.115;        ///< m
  int edge_samples = 4;           ///< additional rays per pixel at edges: 0 to 64, multiple of 4
  double noise = 1.0;             ///< factor on the sensor noise; 0: none
  int threads = 2;                ///< for rendering; the images do not depend on it
};

/// Instant of the drive at which the pictures begin, s.
double startOf(const WorldSettings& settings);

/// The settings; throws std::invalid_argument that names the first one out of range.
const WorldSettings& validated(const WorldSettings& settings);

}  // namespace cartvo::world
