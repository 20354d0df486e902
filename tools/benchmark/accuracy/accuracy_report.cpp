// Accuracies as tables and as JSON.
#include "tools/benchmark/accuracy/accuracy_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "common/statistics.hpp"
#include "common/units.hpp"
#include "tools/benchmark/accuracy/set_summary.hpp"
#include "tools/benchmark/error_ratios.hpp"
#include "tools/benchmark/validity_cells.hpp"
#include "tools/evaluate/report.hpp"

namespace cartvo::benchmark {
namespace {

using Json = nlohmann::ordered_json;

std::string bitrateName(double bitrate_mbps) {
  char text[32];
  std::snprintf(text, sizeof text, "%g Mbit/s", bitrate_mbps);
  return text;
}

std::string segmentCell(const SegmentErrors& errors) {
  if (errors.count == 0) return kNoValue;
  return fixed(100.0 * errors.translation, 2) + " / " + fixed(kDegreesPerRadian * errors.rotation, 4);
}

std::string driftCell(const Evaluation& evaluation) {
  if (!evaluation.final_drift_fraction) return kNoValue;
  return fixed(100.0 * *evaluation.final_drift_fraction, 2) + " / " + fixed(evaluation.final_drift, 2);
}

std::string endCell(const std::optional<EndError>& end) {
  if (!end) return kNoValue;
  return fixed(100.0 * end->translation, 2) + " / " + fixed(kDegreesPerRadian * end->rotation, 3);
}

std::string consistencyCell(const NormalisedErrors& errors) {
  if (errors.groups() == 0) return kNoValue;
  const Interval band = errors.band();
  return significant(errors.mean()) + (band.contains(errors.mean()) ? " [" : "* [") + fixed(band.low, 2) +
         ", " + fixed(band.high, 2) + "]";
}

std::string setCell(const SequenceAccuracy& a) {
  return a.kind == SequenceKind::real ? kNoValue : setName(a.set);
}

std::vector<std::string> cells(const SequenceAccuracy& a) {
  const Evaluation& e = a.evaluation;
  return withValidity(
      {a.bitrate_mbps > 0.0 ? a.sequence + ", " + bitrateName(a.bitrate_mbps) : a.sequence, setCell(a),
       a.estimator, std::to_string(a.pairs), fixed(e.path_length, 1), segmentCell(e.short_segments.all),
       segmentCell(e.long_segments.all),
       fixed(e.relative_translation, 4) + " / " + fixed(kDegreesPerRadian * e.relative_rotation, 4),
       driftCell(e), endCell(a.standing_end), a.standing > 0 ? fixed(a.standing_speed, 4) : kNoValue,
       std::to_string(a.invalid), std::to_string(a.lost), std::to_string(a.resets),
       consistencyCell(a.consistency.motion), consistencyCell(a.consistency.pose),
       consistencyCell(a.consistency.velocity),
       a.times_ms.empty()
           ? kNoValue
           : fixed(percentile(a.times_ms, 0.5), 1) + " / " + fixed(percentile(a.times_ms, 0.99), 1)},
      a.validity);
}

/// One row per estimator and set over its rendered worlds.
std::vector<SequenceAccuracy> pooled(const std::vector<SetSummary>& summaries) {
  std::vector<SequenceAccuracy> result;
  result.reserve(summaries.size());
  for (const SetSummary& summary : summaries) {
    const std::string name = "all " + std::to_string(summary.worlds.size()) + " worlds";
    result.push_back(summarise(name, summary.worlds));
  }
  return result;
}

/// Accuracy at a bit rate and on the lossless images.
struct BitratePoint {
  const SequenceAccuracy* encoded;
  const SequenceAccuracy* lossless;
};

std::vector<BitratePoint> bitratePoints(const std::vector<SequenceAccuracy>& accuracies) {
  std::vector<BitratePoint> points;
  for (const SequenceAccuracy& encoded : accuracies) {
    if (encoded.bitrate_mbps == 0.0) continue;
    for (const SequenceAccuracy& lossless : accuracies) {
      if (lossless.bitrate_mbps == 0.0 && lossless.sequence == encoded.sequence &&
          lossless.estimator == encoded.estimator)
        points.push_back({&encoded, &lossless});
    }
  }
  return points;
}

/// Relative increase of an error over the lossless one; nothing if the lossless error is not positive.
std::optional<double> growth(double error, double lossless) {
  if (!(lossless > 0.0)) return std::nullopt;
  return error / lossless - 1.0;
}

std::optional<double> segmentGrowth(const BitratePoint& point) {
  const SegmentErrors& encoded = point.encoded->evaluation.short_segments.all;
  const SegmentErrors& lossless = point.lossless->evaluation.short_segments.all;
  if (encoded.count == 0 || lossless.count == 0) return std::nullopt;
  return growth(encoded.translation, lossless.translation);
}

std::optional<double> relativeGrowth(const BitratePoint& point) {
  return growth(point.encoded->evaluation.relative_translation,
                point.lossless->evaluation.relative_translation);
}

std::string withGrowth(const std::string& value, const std::optional<double>& growth) {
  if (!growth) return value;
  const double percent = std::round(100.0 * *growth) + 0.0;  // no "-0"
  return value + (percent < 0.0 ? " (" : " (+") + fixed(percent, 0) + " %)";
}

std::string bitrateTable(const std::vector<BitratePoint>& points, ReportFormat format) {
  Table table({"sequence", "estimator", "H.264", "5–40 m: % / deg/m", "lossless", "RPE, m", "lossless",
               "> limit", "> bound"});
  for (const BitratePoint& point : points) {
    const Evaluation& encoded = point.encoded->evaluation;
    const Evaluation& lossless = point.lossless->evaluation;
    table.add({point.encoded->sequence, point.encoded->estimator, bitrateName(point.encoded->bitrate_mbps),
               withGrowth(segmentCell(encoded.short_segments.all), segmentGrowth(point)),
               segmentCell(lossless.short_segments.all),
               withGrowth(fixed(encoded.relative_translation, 4), relativeGrowth(point)),
               fixed(lossless.relative_translation, 4), std::to_string(point.encoded->validity.above_limit),
               std::to_string(point.encoded->validity.above_bound)});
  }
  return table.as(format);
}

constexpr const char* kLegend =
    "set: of worlds that choose a number (tuning) or report it (reporting); neither: of the scenario of one "
    "and the seed\nof the other. "
    "Errors of the left camera's path (cartvo-evaluate(1)): segments of 5 to 40 m and of 100 to 800 m (% and "
    "deg/m),\n"
    "from pair to pair (RPE, RMSE), final drift. end: error of the last pose, if the cart never moves. "
    "standing:\n"
    "highest speed reported at a true standstill. invalid: pairs that are not VALID; lost: pairs that were "
    "not formed;\n"
    "NEES: mean of the "
    "squared error\n"
    "over its covariance, per dimension: 1 is consistent, * is outside the 95 % band of consistent "
    "estimators (pose: an\n"
    "epoch counts as one sample). velocity: against the true one at the exposure. ms: time of a pair, "
    "without reading and\n"
    "decoding. Summaries: segments and motions of all worlds together; mean drift, largest end error and "
    "speed.\n";

Json consistencyJson(const NormalisedErrors& errors) {
  Json json{{"mean", nullptr},
            {"band_95_percent", nullptr},
            {"samples", errors.groups()},
            {"unusable", errors.unusable()}};
  if (errors.groups() == 0) return json;
  const Interval band = errors.band();
  json["mean"] = errors.mean();
  json["band_95_percent"] = {band.low, band.high};
  return json;
}

Json sequenceJson(const SequenceAccuracy& a) {
  Json json{{"sequence", a.sequence},
            {"kind", a.kind == SequenceKind::real ? "real" : "rendered"},
            {"set", a.kind == SequenceKind::real ? Json(nullptr) : Json(setName(a.set))},
            {"bitrate_mbps", nullptr},
            {"estimator", a.estimator},
            {"pairs", a.pairs},
            {"invalid", a.invalid},
            {"lost", a.lost},
            {"resets", a.resets},
            {"standing_pairs", a.standing},
            {"standing_highest_speed_m_s", nullptr},
            {"standing_end_m", nullptr},
            {"standing_end_deg", nullptr},
            {"evaluation", evaluationJson(a.evaluation)},
            {"nees_motion", consistencyJson(a.consistency.motion)},
            {"nees_pose", consistencyJson(a.consistency.pose)},
            {"nees_velocity", consistencyJson(a.consistency.velocity)},
            {"time_ms", nullptr}};
  json.update(validityJson(a.validity));
  if (a.bitrate_mbps > 0.0) json["bitrate_mbps"] = a.bitrate_mbps;
  if (a.standing > 0) json["standing_highest_speed_m_s"] = a.standing_speed;
  if (a.standing_end) {
    json["standing_end_m"] = a.standing_end->translation;
    json["standing_end_deg"] = kDegreesPerRadian * a.standing_end->rotation;
  }
  if (!a.times_ms.empty()) {
    json["time_ms"] = {{"median", percentile(a.times_ms, 0.5)}, {"p99", percentile(a.times_ms, 0.99)}};
  }
  return json;
}

/// The JSON of a summary; values that are not defined for several sequences together are null.
Json summaryJson(const SequenceAccuracy& summary) {
  Json json = sequenceJson(summary);
  json["evaluation"] = evaluationOfDrivesJson(summary.evaluation);
  return json;
}

Json optionalPercent(const std::optional<double>& fraction) {
  return fraction ? Json(100.0 * *fraction) : Json(nullptr);
}

}  // namespace

std::string accuracyTable(const std::vector<SequenceAccuracy>& accuracies, ReportFormat format) {
  Table table(withValidityColumns({"sequence", "set", "estimator", "pairs", "length, m", "5–40 m: % / deg/m",
                                   "100–800 m: % / deg/m", "RPE: m / deg", "drift: % / m", "end: cm / deg",
                                   "standing, m/s", "invalid", "lost", "resets", "NEES motion", "NEES pose",
                                   "NEES velocity", "ms: median / p99"}));
  for (const SequenceAccuracy& accuracy : accuracies)
    table.add(cells(accuracy));
  const std::vector<SetSummary> summaries = setSummaries(accuracies);
  for (const SequenceAccuracy& row : pooled(summaries))
    table.add(cells(row));
  std::string report = table.as(format) + "\n";
  for (const SetSummary& summary : summaries)
    report += summaryLine(summary) + "\n";
  report.append(summaries.empty() ? "" : "\n").append(kLegend).append(kValidityLegend);
  if (const std::vector<BitratePoint> points = bitratePoints(accuracies); !points.empty())
    report.append("\n").append(bitrateTable(points, format));
  return report;
}

Json accuracyJson(const std::vector<SequenceAccuracy>& accuracies) {
  Json json{{"sequences", Json::array()},
            {"summaries", Json::array()},
            {"sets", Json::array()},
            {"bitrates", Json::array()}};
  for (const SequenceAccuracy& accuracy : accuracies)
    json["sequences"].push_back(sequenceJson(accuracy));
  const std::vector<SetSummary> summaries = setSummaries(accuracies);
  for (const SequenceAccuracy& row : pooled(summaries))
    json["summaries"].push_back(summaryJson(row));
  for (const SetSummary& summary : summaries)
    json["sets"].push_back(setSummaryJson(summary));
  for (const BitratePoint& point : bitratePoints(accuracies)) {
    json["bitrates"].push_back({{"sequence", point.encoded->sequence},
                                {"estimator", point.encoded->estimator},
                                {"bitrate_mbps", point.encoded->bitrate_mbps},
                                {"segments_5_to_40_m_growth_percent", optionalPercent(segmentGrowth(point))},
                                {"rpe_growth_percent", optionalPercent(relativeGrowth(point))}});
  }
  return json;
}

}  // namespace cartvo::benchmark
