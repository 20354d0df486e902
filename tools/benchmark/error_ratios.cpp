// Errors relative to a reference, and their cells and JSON.
#include "tools/benchmark/error_ratios.hpp"

#include <algorithm>
#include <cmath>

#include "common/units.hpp"
#include "tools/evaluate/report.hpp"
#include "tools/report/table.hpp"

namespace cartvo::benchmark {
namespace {

std::string pairOf(double a, double b) {
  return significant(a) + " / " + significant(b);
}

std::string ratioPair(double a, double b) {
  return fixed(a, 2) + " / " + fixed(b, 2);
}

}  // namespace

double ErrorRatios::largest() const {
  return std::max({segment_translation, segment_rotation, relative_translation, relative_rotation});
}

std::optional<ErrorRatios> ratiosOf(const Evaluation& one, const Evaluation& reference) {
  const SegmentErrors& segments = one.short_segments.all;
  const SegmentErrors& reference_segments = reference.short_segments.all;
  const ErrorRatios ratios{segments.translation / reference_segments.translation,
                           segments.rotation / reference_segments.rotation,
                           one.relative_translation / reference.relative_translation,
                           one.relative_rotation / reference.relative_rotation};
  if (!std::isfinite(ratios.segment_translation + ratios.segment_rotation + ratios.relative_translation +
                     ratios.relative_rotation))
    return std::nullopt;
  return ratios;
}

nlohmann::ordered_json ratiosJson(const std::optional<ErrorRatios>& ratios) {
  if (!ratios) return nullptr;
  return {{"segment_translation", ratios->segment_translation},
          {"segment_rotation", ratios->segment_rotation},
          {"relative_translation", ratios->relative_translation},
          {"relative_rotation", ratios->relative_rotation}};
}

ErrorCells errorCells(const Evaluation& evaluation, const std::optional<ErrorRatios>& ratios) {
  const SegmentErrors& segments = evaluation.short_segments.all;
  ErrorCells cells{
      kNoValue, kNoValue,
      pairOf(1e3 * evaluation.relative_translation, kDegreesPerRadian * evaluation.relative_rotation),
      kNoValue};
  if (segments.count > 0)
    cells.segments = pairOf(100.0 * segments.translation, kDegreesPerRadian * segments.rotation);
  if (ratios) {
    cells.segment_ratios = ratioPair(ratios->segment_translation, ratios->segment_rotation);
    cells.relative_ratios = ratioPair(ratios->relative_translation, ratios->relative_rotation);
  }
  return cells;
}

nlohmann::ordered_json evaluationOfDrivesJson(const Evaluation& evaluation) {
  nlohmann::ordered_json json = evaluationJson(evaluation);
  for (const char* key : {"final_rotation_deg", "ate_rmse_m", "origin_rmse_m"})
    json[key] = nullptr;
  return json;
}

std::string neesCell(const NormalisedErrors& errors) {
  return errors.groups() == 0 ? kNoValue : significant(errors.mean());
}

nlohmann::ordered_json neesJson(const NormalisedErrors& errors) {
  return errors.groups() == 0 ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(errors.mean());
}

}  // namespace cartvo::benchmark
