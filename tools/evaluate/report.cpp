// Formats an evaluation as a text table and as JSON.

#include "tools/evaluate/report.hpp"

#include <cstdio>

#include "common/units.hpp"

namespace cartvo {
namespace {

template <typename... Values>
std::string line(const char* format, Values... values) {
  char text[160];
  std::snprintf(text, sizeof text, format, values...);
  return std::string(text) + "\n";
}

std::string segmentRow(const char* name, const SegmentErrors& errors, const char* remark = "") {
  return line("  %-12s %9d %12.3f %16.5f%s", name, errors.count, 100.0 * errors.translation,
              kDegreesPerRadian * errors.rotation, remark);
}

std::string segmentTable(const char* title, const SegmentGroup& group) {
  if (group.all.count == 0) return std::string(title) + ": the path is too short\n";
  std::string text = line("%-14s %9s %12s %16s", title, "segments", "transl. %", "rotation deg/m");
  for (const SegmentErrors& errors : group.each) {
    text += segmentRow((std::to_string(static_cast<int>(errors.length)) + " m").c_str(), errors);
  }
  return text + segmentRow("all", group.all);
}

std::string alignedRow(const AlignedAxes& aligned) {
  const Eigen::Vector3d rotation = kDegreesPerRadian * aligned.rotation;
  char remark[80];
  std::snprintf(remark, sizeof remark, "  (turned by %.3f, %.3f, %.3f deg)", rotation.x(), rotation.y(),
                rotation.z());
  return segmentRow("axes aligned", aligned.short_segments.all, remark);
}

nlohmann::ordered_json segmentJson(const SegmentErrors& errors) {
  nlohmann::ordered_json json;
  if (errors.length > 0.0) json["length_m"] = errors.length;
  json["count"] = errors.count;
  json["translation_percent"] = nullptr;
  json["rotation_deg_per_m"] = nullptr;
  if (errors.count > 0) {
    json["translation_percent"] = 100.0 * errors.translation;
    json["rotation_deg_per_m"] = kDegreesPerRadian * errors.rotation;
  }
  return json;
}

nlohmann::ordered_json groupJson(const SegmentGroup& group) {
  nlohmann::ordered_json json = segmentJson(group.all);
  json["by_length"] = nlohmann::ordered_json::array();
  for (const SegmentErrors& errors : group.each)
    json["by_length"].push_back(segmentJson(errors));
  return json;
}

nlohmann::ordered_json alignedJson(const AlignedAxes& aligned) {
  const Eigen::Vector3d rotation = kDegreesPerRadian * aligned.rotation;
  return {{"rotation_deg", {rotation.x(), rotation.y(), rotation.z()}},
          {"segments_5_to_40_m", groupJson(aligned.short_segments)}};
}

/// All problems in one text; empty: none.
std::string problemText(const Evaluation& evaluation) {
  std::string text;
  for (const std::string& problem : evaluation.problems)
    text += (text.empty() ? "" : "; ") + problem;
  return text;
}

}  // namespace

std::string evaluationTable(const Evaluation& evaluation) {
  std::string text;
  text += line("%-34s %zu, %s%s", "poses compared", evaluation.poses,
               evaluation.method == AssociationMethod::time ? "by time" : "row by row",
               evaluation.unmatched == 0
                   ? ""
                   : (", " + std::to_string(evaluation.unmatched) + " without a truth").c_str());
  text += line("%-34s %.3f m (estimated: %.3f m)", "path length", evaluation.path_length,
               evaluation.estimated_path_length);
  if (evaluation.scale) text += line("%-34s multiplied by %.6f", "scale of the estimate", *evaluation.scale);
  text += line("%-34s %.3f m, %.3f deg", "final drift", evaluation.final_drift,
               kDegreesPerRadian * evaluation.final_rotation);
  if (evaluation.final_drift_fraction) {
    text += line("%-34s %.3f %%", "final drift of the path", 100.0 * *evaluation.final_drift_fraction);
  }
  text += line("%-34s %.4f m, %.4f deg", "pose to pose (RPE, RMSE)", evaluation.relative_translation,
               kDegreesPerRadian * evaluation.relative_rotation);
  text += line("%-34s %.4f m", "position, aligned (ATE, RMSE)", evaluation.absolute_aligned);
  text += line("%-34s %.4f m", "position, same start (RMSE)", evaluation.absolute_origin);
  text += segmentTable("5 to 40 m", evaluation.short_segments);
  if (evaluation.aligned_axes) text += alignedRow(*evaluation.aligned_axes);
  text += segmentTable("100 to 800 m", evaluation.long_segments);
  for (const std::string& problem : evaluation.problems)
    text += "problem: " + problem + "\n";
  return text;
}

std::string validityTable(const ValidityFigures& figures, const pipeline::AlertLimits& limits) {
  std::string text;
  text += line("%-34s %zu of %zu, %.2f %%, longest gap %.2f s", "available: VALID messages", figures.valid,
               figures.messages, 100.0 * figures.availability(), figures.longest_gap);
  text += line("%-34s %s (%g m/s, %g deg/s, %g m, %g deg)", "VALID above an alert limit",
               shareOfJudged(figures, figures.above_limit).c_str(), limits.velocity,
               kDegreesPerRadian * limits.angular_rate, limits.motion, kDegreesPerRadian * limits.rotation);
  text += line("%-34s %s", "VALID above their bound", shareOfJudged(figures, figures.above_bound).c_str());
  text += line("%-34s %.3f m/s, %.2f deg/s", "largest error of a VALID message", figures.velocity_error,
               kDegreesPerRadian * figures.rate_error);
  return text;
}

nlohmann::ordered_json evaluationJson(const Evaluation& evaluation) {
  nlohmann::ordered_json json;
  json["association"] = evaluation.method == AssociationMethod::time ? "time" : "rows";
  json["poses"] = evaluation.poses;
  json["unmatched"] = evaluation.unmatched;
  json["path_length_m"] = evaluation.path_length;
  json["estimated_path_length_m"] = evaluation.estimated_path_length;
  json["scale"] = evaluation.scale.value_or(1.0);
  json["final_drift_m"] = evaluation.final_drift;
  json["final_drift_percent"] = nullptr;
  if (evaluation.final_drift_fraction) json["final_drift_percent"] = 100.0 * *evaluation.final_drift_fraction;
  json["final_rotation_deg"] = kDegreesPerRadian * evaluation.final_rotation;
  json["rpe_rmse_m"] = evaluation.relative_translation;
  json["rpe_rmse_deg"] = kDegreesPerRadian * evaluation.relative_rotation;
  json["ate_rmse_m"] = evaluation.absolute_aligned;
  json["origin_rmse_m"] = evaluation.absolute_origin;
  json["segments_5_to_40_m"] = groupJson(evaluation.short_segments);
  json["segments_100_to_800_m"] = groupJson(evaluation.long_segments);
  json["problem"] = problemText(evaluation);
  json["axes_aligned"] = nullptr;
  if (evaluation.aligned_axes) json["axes_aligned"] = alignedJson(*evaluation.aligned_axes);
  return json;
}

}  // namespace cartvo
