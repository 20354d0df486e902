// Builds the JSON summary of a replay.

#include "tools/replay/summary.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include <opencv2/core/version.hpp>

#include "common/statistics.hpp"
#include "common/units.hpp"
#include "daemon/service/configuration_names.hpp"
#include "tools/trajectory/trajectory.hpp"

namespace cartvo {
namespace {

using Json = nlohmann::ordered_json;

/// The reasons of a pair, or that a bound exceeds its alert limit.
vo::OdometryReasons reasonsOf(const ReplayedPair& pair) {
  if ((pair.message.reasons & odometry_t::REASON_BOUND) != 0) return vo::OdometryReason::bound;
  return pair.reasons;
}

/// Gross faults of the rig that were named, each with its first pair and the number of its pairs.
Json stereoFaultsJson(const Replay& replay) {
  Json faults = Json::object();
  for (const vo::StereoFaultText& text : vo::kStereoFaults) {
    const auto has_fault = [&](const ReplayedPair& pair) { return pair.stereo_fault == text.fault; };
    const auto first = std::find_if(replay.pairs.begin(), replay.pairs.end(), has_fault);
    if (first == replay.pairs.end()) continue;
    faults[text.name] = {{"first_pair", first - replay.pairs.begin()},
                         {"pairs", std::count_if(first, replay.pairs.end(), has_fault)}};
  }
  return faults;
}

/// In the order of the enumeration.
const char* kindName(capture::SourceKind kind) {
  static constexpr std::array kNames{"recording", "kitti",      "kitti_raw", "euroc",
                                     "lists",     "one_folder", "videos"};
  return kNames.at(static_cast<std::size_t>(kind));
}

Json pairsJson(const Replay& replay) {
  Json invalid = Json::array();
  Json by_reason = Json::object();
  for (std::size_t index = 0; index < replay.pairs.size(); ++index) {
    const ReplayedPair& pair = replay.pairs[index];
    if (pair.valid) continue;
    invalid.push_back(index);
    for (const vo::OdometryReasonText& text : vo::kOdometryReasons)
      if (reasonsOf(pair).has(text.reason)) by_reason[text.name] = by_reason.value(text.name, 0) + 1;
  }
  Json json;
  json["pairs"] = replay.pairs.size();
  json["valid"] = replay.pairs.size() - invalid.size();
  json["invalid"] = invalid.size();
  json["invalid_by_reason"] = by_reason;
  json["invalid_pairs"] = invalid;
  json["resets"] = replay.pairs.back().reset_counter;
  return json;
}

Json framesJson(const pipeline::PipelineCounts& counts) {
  return {{"dropped_no_partner", counts.dropped_no_partner},
          {"dropped_damaged", counts.dropped_damaged},
          {"dropped_out_of_order", counts.dropped_out_of_order},
          {"dropped_overflow", counts.dropped_overflow},
          {"dropped_clock", counts.dropped_clock}};
}

/// Statistics over the pairs after the first one, which has no motion.
template <typename Value>
Json timesJson(const Replay& replay, Value value) {
  std::vector<double> milliseconds;
  const std::size_t first = replay.pairs.size() > 1 ? 1 : 0;
  for (std::size_t i = first; i < replay.pairs.size(); ++i) {
    milliseconds.push_back(1000.0 * value(replay.pairs[i].times));
  }
  return {{"median", percentile(milliseconds, 0.5)},
          {"p99", percentile(milliseconds, 0.99)},
          {"max", *std::max_element(milliseconds.begin(), milliseconds.end())}};
}

Json timesJson(const Replay& replay) {
  Json json;
  json["total"] = timesJson(replay, [](const pipeline::StageTimes& times) { return times.total; });
  for (int i = 0; i < vo::kStageCount; ++i) {
    const auto stage = static_cast<vo::Stage>(i);
    json[vo::stageName(stage)] =
        timesJson(replay, [stage](const pipeline::StageTimes& times) { return times.stage(stage); });
  }
  return json;
}

Json scaled(const vo::EstimateWithStddev& estimate, double unit) {
  return {{"value", estimate.value * unit}, {"deviation", estimate.stddev * unit}};
}

/// Readouts of the rig, and those estimated at the last pair that has them; null where there is none.
Json readoutsJson(const Replay& replay) {
  const auto last = std::find_if(replay.pairs.rbegin(), replay.pairs.rend(),
                                 [](const ReplayedPair& pair) { return pair.readouts.has_value(); });
  const auto stated = [](const calib::CameraModel& camera) {
    return camera.readout ? Json(1e3 * *camera.readout) : Json(nullptr);
  };
  Json json{{"rig_left_ms", stated(replay.rig.rig.left)}, {"rig_right_ms", stated(replay.rig.rig.right)}};
  const bool is_estimated = last != replay.pairs.rend();
  json["left_ms"] = is_estimated ? scaled(last->readouts->left, 1e3) : Json(nullptr);
  json["right_ms"] = is_estimated ? scaled(last->readouts->right, 1e3) : Json(nullptr);
  return json;
}

/// Rig calibration errors of the last pair that has them; null if none has.
Json selfCheckJson(const Replay& replay) {
  const auto last = std::find_if(replay.pairs.rbegin(), replay.pairs.rend(),
                                 [](const ReplayedPair& pair) { return pair.rig.has_value(); });
  if (last == replay.pairs.rend()) return nullptr;
  const vo::RigCalibrationError& rig = *last->rig;
  return {{"right_late_ms", scaled(rig.delay, 1e3)},
          {"right_pitch_deg", scaled(rig.pitch, kDegreesPerRadian)},
          {"right_yaw_deg", scaled(rig.yaw, kDegreesPerRadian)},
          {"right_roll_deg", scaled(rig.roll, kDegreesPerRadian)},
          {"observability",
           {{"late", rig.observability.delay},
            {"pitch", rig.observability.pitch},
            {"yaw", rig.observability.yaw},
            {"roll", rig.observability.roll}}}};
}

Json stillRegionsJson(const vo::ImageRegions& regions) {
  Json json = Json::array();
  for (const vo::ImageRegion& region : regions)
    json.push_back({{"x", region.x}, {"y", region.y}, {"width", region.width}, {"height", region.height}});
  return json;
}

/// Source of a recording's timestamps; null for other sources.
Json clockJson(const ReplaySettings& settings, const Replay& replay) {
  if (replay.kind != capture::SourceKind::recording) return nullptr;
  Json json;
  json["choice"] = daemon::nameOf(settings.clock, kReplayClocks);
  json["stamped_anew"] = replay.clock.has_value();
  if (!replay.clock) return json;
  const auto milliseconds = [](const std::optional<capture::OffsetEstimate>& estimate) -> Json {
    return estimate ? Json(1e-6 * estimate->value_ns) : Json(nullptr);
  };
  json["deviation_ms"] = 1e-6 * replay.clock->offset.stddev_ns;
  json["offset_beyond_arrival_ms"] = 1e-6 * replay.clock->offset.value_ns;
  json["by_reports_ms"] = milliseconds(replay.clock->ntp);
  json["by_pictures_ms"] = milliseconds(replay.clock->visual);
  json["problem"] = replay.clock->problem.empty() ? replay.clock->advice : replay.clock->problem;
  return json;
}

/// Time offset of two videos; null for other sources.
Json timingJson(const Replay& replay) {
  if (!replay.timing) return nullptr;
  const VideoTiming& timing = *replay.timing;
  return {{"offset_ms", 1e3 * timing.offset},
          {"deviation_ms", 1e3 * timing.stddev},
          {"skew_ppm", timing.skew ? Json(1e6 * *timing.skew) : Json(nullptr)},
          {"found_by", timing.found_by},
          {"agreement", timing.agreement ? Json(*timing.agreement) : Json(nullptr)}};
}

/// T_body_camera as 12 numbers, the rows of its 3x4 matrix, as in a rig file.
Json bodyFromCameraJson(const calib::Rig& rig) {
  Json numbers = Json::array();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 4; ++j)
      numbers.push_back(rig.T_body_camera.matrix()(i, j));
  }
  return numbers;
}

}  // namespace

std::string invalidPairsText(const Replay& replay) {
  const Json counts = pairsJson(replay)["invalid_by_reason"];
  std::string text;
  for (const vo::OdometryReasonText& reason : vo::kOdometryReasons)
    if (counts.contains(reason.name))
      text += (text.empty() ? "not valid: " : ", ") + counts[reason.name].dump() + " " + reason.words;
  return text.empty() ? text : text + "\n";
}

std::string nothingValidText(const Replay& replay) {
  for (const ReplayedPair& pair : replay.pairs)
    if (pair.valid) return {};
  const auto pairs_with = [&](vo::OdometryReason reason) {
    return std::count_if(replay.pairs.begin(), replay.pairs.end(),
                         [&](const ReplayedPair& pair) { return reasonsOf(pair).has(reason); });
  };
  // The first pair of each epoch is invalid for whatever reason made the epoch begin: its reason counts
  // least.
  const vo::OdometryReasonText* most = &vo::kOdometryReasons.front();
  for (const vo::OdometryReasonText& text : vo::kOdometryReasons) {
    const auto pairs = pairs_with(text.reason);
    const auto most_pairs = most->reason == vo::OdometryReason::first_pair ? 0 : pairs_with(most->reason);
    const bool bound_wins = text.reason == vo::OdometryReason::bound && pairs == most_pairs;
    if (pairs > most_pairs || (bound_wins && pairs > 0)) most = &text;
  }
  return "none of the " + std::to_string(replay.pairs.size()) + " pairs is valid; " + most->name + " in " +
         std::to_string(pairs_with(most->reason)) + ": " + most->advice;
}

Json replaySummary(const ReplaySettings& settings, const Replay& replay) {
  const calib::Rig& rig = replay.rig.rig;
  Json json;
  json["source"] = settings.source.string();
  if (!settings.right_video.empty()) json["right_video"] = settings.right_video.string();
  json["kind"] = kindName(replay.kind);
  json["rig"] = {{"name", rig.name},
                 {"origin", replay.rig.origin},
                 {"image_size", {rig.left.size.width, rig.left.size.height}},
                 {"baseline_m", rig.baseline()},
                 {"T_body_camera", bodyFromCameraJson(rig)}};
  json["poses_of"] = {{"poses.txt", frameName(TrajectoryFrame::left_camera)},
                      {"trajectory.tum", frameName(bodyTrajectoryFrame(replay))}};
  json["estimator"] = daemon::nameOf(settings.odometry.estimator, daemon::kEstimators);
  json["online_rig_refinement"] = daemon::nameOf(settings.odometry.rig_refinement, daemon::kRigRefinements);
  json["features"] = settings.odometry.features;
  json["seed"] = settings.odometry.seed;
  json.update(pairsJson(replay));
  json["stereo_faults"] = stereoFaultsJson(replay);
  json["frames"] = framesJson(replay.counts);
  json["problems"] = replay.problems;
  json["duration_s"] =
      1e-9 * static_cast<double>(replay.pairs.back().exposure_ns - replay.pairs.front().exposure_ns);
  json["path_length_m"] = pathLength(leftCameraTrajectory(replay));
  json["clock"] = clockJson(settings, replay);
  json["video_timing"] = timingJson(replay);
  json["readouts"] = readoutsJson(replay);
  json["self_check"] = selfCheckJson(replay);
  json["self_check_sentence"] = replay.self_check;
  json["still_regions"] = stillRegionsJson(replay.still_regions);
  json["time_ms"] = timesJson(replay);
  json["versions"] = {{"cartvo", CARTVO_VERSION}, {"opencv", CV_VERSION}};
  return json;
}

}  // namespace cartvo
