#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core/types.hpp>

namespace cartvo::world {

/// What happens during a drive. The comment of each says what is made hard.
enum class Scenario : std::uint8_t {
  campus,       ///< a lap among buildings and trees, some traffic: the usual day
  loop,         ///< the same on a loop of some 300 m; the cart stops where it began
  turns,        ///< a winding lane: one tight turn after the other
  traffic,      ///< vehicles ahead and oncoming; at times they cover some 40 % of the view
  standing,     ///< the cart stands while vehicles pass and pull in before it
  stop_and_go,  ///< pulls away and brakes to a stand, again and again
  exposure,     ///< the cameras' exposure jumps by three stops, again and again
  underpass,    ///< into dark underpasses and out again: the light falls and rises by several stops
  glare,        ///< a low sun that often stands in the picture, with what it scatters in the lens
  dusk,         ///< little light: high gain, strong sensor noise, no shadows
  low_texture,  ///< fresh smooth asphalt, plain plaster, few things to see
  bumpy,        ///< a road in bad repair: strong pitch, roll and heave
  reversing,    ///< forward, a stand, backward, again and again
  motorway,     ///< fast in a wide bend, on smooth asphalt, all else far away: hardly a near point
};

/// Every scenario in the order of the enumeration.
const std::vector<Scenario>& allScenarios();

/// The name people type: that of the enumerator.
std::string_view scenarioName(Scenario scenario);

/// The reverse. Throws std::invalid_argument naming the scenarios there are.
Scenario scenarioFromName(std::string_view name);

/// One drive and the two cameras that see it. The same settings give the same bytes.
struct WorldSettings {
  Scenario scenario = Scenario::campus;
  std::uint64_t seed = 1;         ///< of the campus, its traffic and the sensors' noise
  double seconds = 60.0;          ///< length of the drive, s
  double lead_in_seconds = 2.0;   ///< the cart stands still this long first, s
  double frame_rate = 18.0;       ///< of each camera, Hz
  double offset_s = 0.0;          ///< right minus left instant at the start, s
  double offset_drift_ppm = 0.0;  ///< the right camera's clock: its period is longer by this, 1e-6
  cv::Size image_size{680, 420};  ///< px
  double focal_length = 480.0;    ///< nominal, px; the two cameras differ from it by some tenths of a percent
  double baseline = 0.115;        ///< m
  int edge_samples = 4;           ///< further rays through a pixel that holds an edge: 0 to 64, by 4
  double noise = 1.0;             ///< factor on the sensor noise; 0: none
  int threads = 2;                ///< that render; the images do not depend on it
};

}  // namespace cartvo::world
