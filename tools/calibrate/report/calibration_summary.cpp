// Summary of a calibration as text and as JSON.
#include "tools/calibrate/report/calibration_summary.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace cartvo {
namespace {

using Json = nlohmann::ordered_json;

Json modelJson(const calib::CandidateModel& candidate) {
  Json json{{"model", calib::modelName(candidate.model)}};
  if (!candidate.refusal.empty()) json["refused"] = candidate.refusal;
  if (candidate.calibration) {
    json["corner_deviation_px"] = candidate.calibration->corner_stddev;
    json["baseline_m"] = candidate.calibration->estimate.rig.baseline();
    Json parameters = Json::array();
    for (const calib::ParameterEstimate& parameter : candidate.calibration->parameters) {
      parameters.push_back({{"name", parameter.name.name},
                            {"unit", parameter.name.unit},
                            {"value", parameter.value},
                            {"deviation", parameter.stddev}});
    }
    json["parameters"] = parameters;
  }
  if (candidate.validation) {
    json["held_out_rms_px"] = candidate.validation->rms;
    json["held_out_vertical_disparity_rms_px"] = candidate.validation->vertical_disparity_rms;
    json["held_out_vertical_disparity_p95_px"] = candidate.validation->vertical_disparity_p95;
  }
  return json;
}

Json viewsJson(const calib::Calibration& calibration) {
  Json views = Json::array();
  for (std::size_t i = 0; i < calibration.views.size(); ++i) {
    const calib::ViewResiduals& residuals = calibration.residuals[i];
    views.push_back({{"name", calibration.views[i].name},
                     {"left_corners", residuals.left.size()},
                     {"right_corners", residuals.right.size()},
                     {"left_rms_px", calib::residualRms({residuals.left, {}})},
                     {"right_rms_px", calib::residualRms({{}, residuals.right})},
                     {"held_out_rms_px", calibration.validation().views[i].rms}});
  }
  return views;
}

std::string modelLine(const calib::CandidateModel& candidate, bool is_chosen) {
  std::string line = fmt::format("  {:<7}", calib::modelName(candidate.model));
  if (candidate.validation) {
    line += fmt::format(" {:>8.3f} px {:>13.3f} px", candidate.validation->rms,
                        candidate.validation->vertical_disparity_rms);
  } else {
    line += fmt::format(" {:>8}    {:>13}   ", "-", "-");
  }
  if (is_chosen) line += "  chosen";
  if (!candidate.refusal.empty()) line += "  refused: " + candidate.refusal;
  return line + "\n";
}

std::string cameraLine(const char* side, const calib::CameraModel& camera) {
  return fmt::format("  {:<6} fx {:.2f}  fy {:.2f}  cx {:.2f}  cy {:.2f} px\n", side, camera.fx, camera.fy,
                     camera.cx, camera.cy);
}

}  // namespace

double depthErrorOf(const calib::Calibration& calibration, double distance) {
  const calib::Rig& rig = calibration.rig();
  const double focal_length = (rig.left.fx + rig.left.fy + rig.right.fx + rig.right.fy) / 4.0;
  return calib::depthError(distance, calibration.validation().vertical_disparity_rms, focal_length,
                           rig.baseline());
}

std::string checkValueText(const calib::ValidationCheck& check) {
  return std::isfinite(check.value) ? fmt::format("{:.3g}", check.value) : "not seen";
}

std::string verdictText(const calib::Calibration& calibration) {
  if (!calibration.passed()) return "The calibration does not pass its validation.";
  const std::vector<std::string> reservations = calib::reservationsOf(calibration);
  if (reservations.empty()) return "The calibration passes its validation.";
  std::string text = "The calibration passes its validation, with reservations:";
  for (const std::string& reservation : reservations)
    text += "\n- " + reservation;
  return text;
}

std::string metresText(double metres) {
  return std::isfinite(metres) ? fmt::format("{:.3f} m", metres) : "not seen";
}

Json calibrationJson(const calib::Calibration& calibration) {
  Json json{{"board", calib::boardSpecText(calibration.board)},
            {"image_size", {calibration.image_size.width, calibration.image_size.height}},
            {"passed", calibration.passed()},
            {"reservations", calib::reservationsOf(calibration)},
            {"model", calib::modelName(calibration.result().model)},
            {"baseline_m", calibration.rig().baseline()},
            {"scale_deviation", calib::scaleStddev(calibration)}};
  for (const calib::ValidationCheck& check : calibration.checks) {
    json["checks"].push_back({{"name", check.name},
                              {"value", check.value},
                              {"limit", check.limit},
                              {"unit", check.unit},
                              {"passed", check.passed}});
  }
  for (const calib::CandidateModel& candidate : calibration.candidates)
    json["models"].push_back(modelJson(candidate));
  json["halves"] = {{"projection_rms_px", calibration.halves.projection_rms},
                    {"projection_p95_px", calibration.halves.projection_p95}};
  for (const calib::DepthDifference& depth : calibration.halves.depth) {
    json["depth"].push_back({{"distance_m", depth.distance},
                             {"error_of_vertical_disparity_m", depthErrorOf(calibration, depth.distance)},
                             {"halves_median_m", depth.median},
                             {"halves_p95_m", depth.p95}});
  }
  json["sync"] = {{"fault", calibration.sync.is_fault},
                  {"opposed_views", calibration.sync.opposed_views},
                  {"largest_shift_px", calibration.sync.max_shift}};
  json["coverage"] = {{"left", calibration.left_coverage.share()},
                      {"right", calibration.right_coverage.share()},
                      {"tilt_spread_rad", calibration.tilts.spread}};
  json["views"] = viewsJson(calibration);
  json["rejected_corners"] = calibration.rejected_corners;
  json["rejected"] = Json::array();
  for (const calib::RejectedView& view : calibration.rejected)
    json["rejected"].push_back({{"name", view.name}, {"reason", view.reason}});
  return json;
}

std::string calibrationText(const calib::Calibration& calibration) {
  std::string text =
      fmt::format("{} views used, {} rejected, {} single corners rejected\n", calibration.views.size(),
                  calibration.rejected.size(), calibration.rejected_corners);
  for (const calib::RejectedView& view : calibration.rejected)
    text += fmt::format("  rejected '{}': {}\n", view.name, view.reason);
  text += "model   held-out RMS  rectified rows RMS\n";
  for (std::size_t i = 0; i < calibration.candidates.size(); ++i)
    text += modelLine(calibration.candidates[i], i == calibration.chosen);
  const calib::Rig& rig = calibration.rig();
  text += "rig\n" + cameraLine("left", rig.left) + cameraLine("right", rig.right);
  text += fmt::format(
      "  baseline {:.2f} mm, turned by {:.3f} degrees; relative stddev of the scale {:.2f} %\n",
      1000.0 * rig.baseline(), Eigen::AngleAxisd(rig.T_right_left.linear()).angle() * 180.0 / M_PI,
      100.0 * calib::scaleStddev(calibration));
  text +=
      "depth   depth error if the rows' error were     two calibrations, each from every\n"
      "        along the row                           other view, differ by (median, 95 %)\n";
  for (const calib::DepthDifference& depth : calibration.halves.depth) {
    text += fmt::format("  {:>3.0f} m {:>10.3f} m {:>38} {:>11}\n", depth.distance,
                        depthErrorOf(calibration, depth.distance), metresText(depth.median),
                        metresText(depth.p95));
  }
  if (std::any_of(calibration.halves.depth.begin(), calibration.halves.depth.end(),
                  [](const calib::DepthDifference& at) { return !std::isfinite(at.p95); })) {
    text +=
        "  not seen: no point at that distance lies where both images had corners; hold the board in all "
        "parts of "
        "both images\n";
  }
  text += "validation\n";
  for (const calib::ValidationCheck& check : calibration.checks) {
    text += fmt::format("  {:<6} {}: {} (limit: {:.3g} {})\n", check.passed ? "passed" : "FAILED", check.name,
                        checkValueText(check), check.limit, check.unit);
  }
  if (calibration.sync.is_fault) {
    text += fmt::format(
        "  In {} views left and right residuals point in opposite directions, by up to {:.1f} px: the board "
        "moved\n"
        "  between the cameras' exposures. Hold it still, or calibrate from a recording, where only views of "
        "a "
        "still board\n  are used.\n",
        calibration.sync.opposed_views, calibration.sync.max_shift);
  }
  const std::string next =
      calib::nextViewAdvice(calibration.left_coverage, calibration.right_coverage, calibration.tilts);
  if (!next.empty()) text += "to improve it, " + next + "\n";
  return text + verdictText(calibration) + "\n";
}

}  // namespace cartvo
