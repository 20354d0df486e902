// The tables of the thesis with the measured values, as text and as JSON.
#include "tools/benchmark/thesis/thesis_report.hpp"

#include <cmath>
#include <optional>

#include "common/image_size.hpp"
#include "common/units.hpp"
#include "daemon/service/configuration_names.hpp"
#include "tools/benchmark/thesis/thesis_values.hpp"

namespace cartvo::benchmark {
namespace {

using Json = nlohmann::ordered_json;

std::string percent(double fraction, int decimals) {
  return fixed(100.0 * fraction, decimals) + " %";
}

std::string signedPercent(double fraction) {
  const double rounded = std::round(1000.0 * fraction) / 1000.0 + 0.0;  // no "-0.0"
  return std::string(rounded < 0.0 ? "" : "+") + percent(rounded, 1);
}

/// Relative increase of the number of depths within 10 % of the truth by sub-pixel disparities.
double closeGain(const DepthSamples& samples) {
  const auto whole = static_cast<double>(closeDepths(samples.whole_pixel));
  return whole > 0.0 ? static_cast<double>(closeDepths(samples.sub_pixel)) / whole - 1.0 : 0.0;
}

std::string section(const std::string& title, ReportFormat format) {
  return format == ReportFormat::markdown ? "## " + title + "\n\n" : title + "\n";
}

std::string depthTable(const ThesisResults& results, ReportFormat format) {
  std::vector<std::string> header{"", "thesis"};
  std::vector<std::vector<std::string>> rows{{"R², sub-pixel disparity", fixed(kThesisDepthRSquared, 4)},
                                             {"R², whole pixels", fixed(kThesisDepthRSquaredWholePixels, 4)},
                                             {"slope, sub-pixel disparity", kNoValue},
                                             {"slope, whole pixels", kNoValue},
                                             {"gain in depths within 10 %", signedPercent(kThesisMatchGain)},
                                             {"matches", kNoValue},
                                             {"of features with a clear depth", kNoValue},
                                             {"wrong matches (over 2 px), left out", kNoValue}};
  for (const DepthResult& result : results.depth) {
    const DepthSamples& samples = result.samples;
    const DepthRegression sub_pixel = regressDepth(samples.sub_pixel);
    const DepthRegression whole = regressDepth(samples.whole_pixel);
    header.push_back(result.rig);
    const std::vector<std::string> column{
        fixed(sub_pixel.r_squared, 4),     fixed(whole.r_squared, 4),
        fixed(sub_pixel.slope, 4),         fixed(whole.slope, 4),
        signedPercent(closeGain(samples)), std::to_string(samples.sub_pixel.size()),
        std::to_string(samples.features),  std::to_string(samples.wrong)};
    for (std::size_t row = 0; row < rows.size(); ++row)
      rows[row].push_back(column[row]);
  }
  Table table(header);
  for (const std::vector<std::string>& row : rows)
    table.add(row);
  return section("Table 5-1: depth regression", format) + table.as(format) +
         "\nMeasured over true depth (rendered, up to 50 m), least squares. It is unknown which matches "
         "the thesis\ncounts for its +8.6 %; the measured gain counts depths within 10 % of the truth.\n";
}

std::string countTable(const ThesisResults& results, ReportFormat format) {
  Table table({"sequence", "threshold", "corners an image", "over images", "corners a window", "over images",
               "over windows", "starved windows", "features an image"});
  const auto add = [&](const std::string& sequence, const char* threshold, const FeatureCountSeries& series) {
    table.add({sequence, threshold, fixed(series.corners_mean, 0),
               std::string("± ") + fixed(series.corners_stddev, 0), fixed(series.window_mean, 1),
               std::string("± ") + fixed(series.window_stddev_over_images, 1),
               std::string("± ") + fixed(series.window_stddev, 1), percent(series.starved, 1),
               fixed(series.features_mean, 0)});
  };
  for (const FeatureCountResult& result : results.counts) {
    add(result.sequence, "fixed (4-13)", result.fixed);
    add(result.sequence, "adaptive (4-14)", result.adaptive);
  }
  if (results.counts.empty())
    return section("Figures 4-13, 4-14: feature counts", format) + "no real sequences\n";
  return section("Figures 4-13, 4-14: feature counts", format) + table.as(format) +
         "\nOver images, over windows: standard deviations, a window's the mean over the windows or images. "
         "Starved: fewer than half of the target number of corners (" +
         fixed(results.counts.front().adaptive.window_target, 0) +
         " a window). The values of the figures are unknown;\nthe counts of each image are in the JSON "
         "report.\n";
}

std::string stageTable(const ThesisResults& results, ReportFormat format) {
  const std::string title = section("Table 5-2: time of each stage, ms", format);
  if (results.times.empty()) return title + "no real sequences\n";
  const StageTimeResult& times = results.times.front();
  const std::string few = std::to_string(results.features), many = std::to_string(results.many_features);
  Table table({"stage", few + " features", "thesis, 1000", many + " features", "thesis, 9600"});
  for (int i = 0; i < vo::kStageCount; ++i) {
    const auto stage = static_cast<vo::Stage>(i);
    const std::optional<double> thesis = thesisStageMs(stage);
    const bool is_rectify = stage == vo::Stage::rectify;
    table.add({vo::stageName(stage), fixed(is_rectify ? times.rectification_ms : times.few.stage(stage), 2),
               thesis ? fixed(*thesis, 2) : kNoValue,
               fixed(is_rectify ? times.rectification_ms : times.many.stage(stage), 2), kNoValue});
  }
  const auto total = [&](const StageMedians& medians) {
    return fixed(medians.total - medians.stage(vo::Stage::rectify) + times.rectification_ms, 2);
  };
  table.add({"all", total(times.few), fixed(kThesisTotal1000Ms, 2), total(times.many),
             fixed(kThesisTotal9600Ms, 1)});
  return title + table.as(format) + "\nMedians over " + times.sequence + " (" + sizeText(times.image_size) +
         "); the thesis: 1241x376 on another machine. Rectification is measured with raw\nimages of that "
         "size if the "
         "images of the sequence are rectified.\n";
}

std::string rateTable(const ThesisResults& results, ReportFormat format) {
  const std::string title = section("Tables 5-3 to 5-7: RMSE of velocity and rates", format);
  if (results.rates.empty()) return title + "no real sequences\n";
  Table table({"sequence", "estimator", "pairs", "Vx, m/s", "Vy, m/s", "Vz, m/s", "pitch, deg/s",
               "yaw, deg/s", "roll, deg/s"});
  for (const RateResult& result : results.rates) {
    const RateErrors& errors = result.errors;
    table.add({result.sequence, daemon::nameOf(result.estimator, daemon::kEstimators),
               std::to_string(errors.pairs), fixed(errors.velocity.x(), 4), fixed(errors.velocity.y(), 4),
               fixed(errors.velocity.z(), 4), fixed(kDegreesPerRadian * errors.pitch, 3),
               fixed(kDegreesPerRadian * errors.yaw, 3), fixed(kDegreesPerRadian * errors.roll, 3)});
  }
  table.add({"thesis", kNoValue, kNoValue, kNoValue, kNoValue, kNoValue, kNoValue, kNoValue, kNoValue});
  return title + table.as(format) +
         "\nBody axes: x forward, y left, z up. The thesis used KITTI and New College; its values and parts "
         "of "
         "these\nare unknown. Any folder with images and poses.txt makes a row, see --data.\n";
}

Json seriesJson(const FeatureCountSeries& series) {
  return {{"corners", series.corners},
          {"features", series.features},
          {"corners_mean", series.corners_mean},
          {"corners_deviation", series.corners_stddev},
          {"features_mean", series.features_mean},
          {"window_mean", series.window_mean},
          {"window_deviation_over_images", series.window_stddev_over_images},
          {"window_deviation_over_windows", series.window_stddev},
          {"window_target", series.window_target},
          {"starved_windows_percent", 100.0 * series.starved}};
}

Json regressionJson(const std::vector<DepthSample>& samples) {
  const DepthRegression regression = regressDepth(samples);
  return {{"matches", regression.samples},
          {"r_squared", regression.r_squared},
          {"slope", regression.slope},
          {"within_10_percent", closeDepths(samples)}};
}

Json depthJson(const ThesisResults& results) {
  Json json{{"thesis",
             {{"r_squared_sub_pixel", kThesisDepthRSquared},
              {"r_squared_whole_pixel", kThesisDepthRSquaredWholePixels},
              {"match_gain_percent", 100.0 * kThesisMatchGain}}},
            {"measured", Json::array()}};
  for (const DepthResult& result : results.depth) {
    json["measured"].push_back({{"rig", result.rig},
                                {"features", result.samples.features},
                                {"wrong_matches", result.samples.wrong},
                                {"sub_pixel", regressionJson(result.samples.sub_pixel)},
                                {"whole_pixel", regressionJson(result.samples.whole_pixel)},
                                {"gain_within_10_percent_percent", 100.0 * closeGain(result.samples)}});
  }
  return json;
}

Json timesJson(const ThesisResults& results) {
  Json json{
      {"features", {results.features, results.many_features}},
      {"thesis", {{"total_ms", {kThesisTotal1000Ms, kThesisTotal9600Ms}}, {"stages_ms", Json::object()}}},
      {"measured", Json::array()}};
  for (int i = 0; i < vo::kStageCount; ++i) {
    const auto stage = static_cast<vo::Stage>(i);
    const std::optional<double> thesis = thesisStageMs(stage);
    json["thesis"]["stages_ms"][vo::stageName(stage)] = thesis ? Json(*thesis) : Json(nullptr);
  }
  for (const StageTimeResult& times : results.times) {
    Json stages = Json::object();
    for (int i = 0; i < vo::kStageCount; ++i) {
      const auto stage = static_cast<vo::Stage>(i);
      stages[vo::stageName(stage)] = {times.few.stage(stage), times.many.stage(stage)};
    }
    json["measured"].push_back({{"sequence", times.sequence},
                                {"image_size", {times.image_size.width, times.image_size.height}},
                                {"rectification_of_raw_ms", times.rectification_ms},
                                {"stages_ms", stages},
                                {"total_ms", {times.few.total, times.many.total}}});
  }
  return json;
}

Json ratesJson(const ThesisResults& results) {
  Json json{{"thesis", nullptr}, {"measured", Json::array()}};
  for (const RateResult& result : results.rates) {
    const RateErrors& errors = result.errors;
    json["measured"].push_back({{"sequence", result.sequence},
                                {"estimator", daemon::nameOf(result.estimator, daemon::kEstimators)},
                                {"pairs", errors.pairs},
                                {"Vx_m_s", errors.velocity.x()},
                                {"Vy_m_s", errors.velocity.y()},
                                {"Vz_m_s", errors.velocity.z()},
                                {"pitch_deg_s", kDegreesPerRadian * errors.pitch},
                                {"yaw_deg_s", kDegreesPerRadian * errors.yaw},
                                {"roll_deg_s", kDegreesPerRadian * errors.roll}});
  }
  return json;
}

}  // namespace

std::string thesisTables(const ThesisResults& results, ReportFormat format) {
  return depthTable(results, format) + "\n" + countTable(results, format) + "\n" +
         stageTable(results, format) + "\n" + rateTable(results, format);
}

Json thesisJson(const ThesisResults& results) {
  Json counts = Json::array();
  for (const FeatureCountResult& result : results.counts) {
    counts.push_back({{"sequence", result.sequence},
                      {"fixed", seriesJson(result.fixed)},
                      {"adaptive", seriesJson(result.adaptive)}});
  }
  return {{"table_5_1", depthJson(results)},
          {"figures_4_13_4_14", {{"thesis", nullptr}, {"measured", counts}}},
          {"table_5_2", timesJson(results)},
          {"tables_5_3_to_5_7", ratesJson(results)}};
}

}  // namespace cartvo::benchmark
