// Errors over readouts, time offsets and vibrations as tables and as JSON.
#include "tools/benchmark/shutter/shutter_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>

#include "common/units.hpp"
#include "tools/benchmark/grouping.hpp"
#include "tools/benchmark/validity_cells.hpp"

namespace cartvo::benchmark {
namespace {

using Json = nlohmann::ordered_json;

std::string shakeName(const world::Shake& shake) {
  if (shake.amplitude == 0.0) return kNoValue;
  char text[48];
  std::snprintf(text, sizeof text, "%g Hz, %.3g deg", shake.frequency, kDegreesPerRadian * shake.amplitude);
  return text;
}

std::vector<std::string> cells(const ShutterAccuracy& one, const std::vector<ShutterAccuracy>& all) {
  const SequenceAccuracy& a = one.accuracy;
  const ErrorCells errors = errorCells(a.evaluation, ratiosToGlobal(one, all));
  return withValidity(
      {one.sequence, readoutName(one.seen.readout), clockName(one.seen.clock), shakeName(one.seen.shake),
       readoutModelName(one.model), errors.segments, errors.segment_ratios, errors.relative,
       errors.relative_ratios, neesCell(a.consistency.motion), neesCell(a.consistency.velocity),
       std::isfinite(one.rates.relative()) ? fixed(100.0 * one.rates.relative(), 1) : kNoValue},
      a.validity);
}

constexpr const char* kLegend =
    "readout: time from the exposure of the upper edge of an image to that of the lower one, left / right "
    "if\n"
    "they differ. right camera: its time offset, and how much slower its clock is. shaken: vibration of the\n"
    "mount. model: known: the odometry has the true readout; estimated: it begins with 32 ms and 40 %;\n"
    "ignored: it assumes a global shutter. Errors of the left camera's path (cartvo-evaluate(1)): segments\n"
    "of 5 to 40 m (% and deg/m), from pair to pair (RPE, RMSE, mm and deg). x: as multiples of the errors\n"
    "with a global shutter on the same drive. NEES: mean of the squared error of motions and of\n"
    "published velocities over its covariance, per dimension: 1 is consistent. rates: RMS error of the\n"
    "published angular velocity at the exposure over the RMS of the true one.\n";

Json rowJson(const ShutterAccuracy& one, const std::vector<ShutterAccuracy>& all) {
  const SequenceAccuracy& a = one.accuracy;
  Json json{{"sequence", one.sequence},
            {"left_readout_ms", 1e3 * one.seen.readout.left},
            {"right_readout_ms", 1e3 * one.seen.readout.right},
            {"offset_ms", 1e3 * one.seen.clock.offset_s},
            {"drift_ppm", one.seen.clock.drift_ppm},
            {"shake_hz", one.seen.shake.frequency},
            {"shake_deg", kDegreesPerRadian * one.seen.shake.amplitude},
            {"model", readoutModelName(one.model)},
            {"pairs", a.pairs},
            {"resets", a.resets},
            {"evaluation", evaluationOfDrivesJson(a.evaluation)},
            {"ratio_to_global", ratiosJson(ratiosToGlobal(one, all))},
            {"nees_motion", neesJson(a.consistency.motion)},
            {"nees_velocity", neesJson(a.consistency.velocity)},
            {"relative_rate_error", nullptr}};
  json.update(validityJson(a.validity));
  if (std::isfinite(one.rates.relative())) json["relative_rate_error"] = one.rates.relative();
  return json;
}

std::vector<ShutterAccuracy> withAllWorlds(std::vector<ShutterAccuracy> accuracies) {
  std::vector<ShutterAccuracy> together = allWorlds(accuracies);
  std::move(together.begin(), together.end(), std::back_inserter(accuracies));
  return accuracies;
}

}  // namespace

std::optional<ErrorRatios> ratiosToGlobal(const ShutterAccuracy& one,
                                          const std::vector<ShutterAccuracy>& all) {
  const auto reference = std::find_if(all.begin(), all.end(), [&](const ShutterAccuracy& other) {
    return other.sequence == one.sequence && other.seen.readout.isGlobal() &&
           other.seen.clock == one.seen.clock && other.seen.isShakenAs(one.seen);
  });
  if (reference == all.end()) return std::nullopt;
  return ratiosOf(one.accuracy.evaluation, reference->accuracy.evaluation);
}

std::vector<ShutterAccuracy> allWorlds(const std::vector<ShutterAccuracy>& accuracies) {
  const auto same = [](const ShutterAccuracy& a, const ShutterAccuracy& b) {
    return a.seen == b.seen && a.model == b.model;
  };
  std::vector<ShutterAccuracy> results;
  for (const std::vector<ShutterAccuracy>& group : grouped(accuracies, same)) {
    if (group.size() > 1)
      results.push_back(summarise("all " + std::to_string(group.size()) + " worlds", group));
  }
  return results;
}

std::string readoutName(const StereoReadout& readout) {
  char text[64];
  if (readout.left == readout.right) {
    std::snprintf(text, sizeof text, "%.4g ms", 1e3 * readout.left);
  } else {
    std::snprintf(text, sizeof text, "%.4g / %.4g ms", 1e3 * readout.left, 1e3 * readout.right);
  }
  return text;
}

std::string shutterTable(const std::vector<ShutterAccuracy>& accuracies, ReportFormat format) {
  Table table(
      withValidityColumns({"sequence", "readout", "right camera", "shaken", "model", "5–40 m: % / deg/m", "x",
                           "RPE: mm / deg", "x", "NEES motion", "NEES velocity", "rates, %"}));
  const std::vector<ShutterAccuracy> all = withAllWorlds(accuracies);
  for (const ShutterAccuracy& one : all)
    table.add(cells(one, all));
  const auto model = [](const ShutterAccuracy& one) { return "readout " + readoutModelName(one.model); };
  return table.as(format) + "\n" + validityTotals(accuracies, model) + "\n" + kLegend + kValidityLegend;
}

Json shutterJson(const std::vector<ShutterAccuracy>& accuracies) {
  const std::vector<ShutterAccuracy> all = withAllWorlds(accuracies);
  Json json{{"shutters", Json::array()}};
  for (const ShutterAccuracy& one : all)
    json["shutters"].push_back(rowJson(one, all));
  return json;
}

}  // namespace cartvo::benchmark
