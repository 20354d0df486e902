// Times as tables and as JSON.
#include "tools/benchmark/speed/speed_report.hpp"

#include <algorithm>

#include "common/image_size.hpp"

namespace cartvo::benchmark {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string> rowName(const SpeedResult& result) {
  return {result.drive, sizeText(result.size), std::to_string(result.features),
          std::to_string(result.threads)};
}

std::vector<std::string> joined(std::vector<std::string> first, const std::vector<std::string>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

std::string timesTable(const std::vector<SpeedResult>& results, ReportFormat format) {
  Table table({"drive", "images", "features", "threads", "used", "rectified: median, ms", "p99", "max",
               "x KLT", "raw: median, ms", "p99", "max", "x KLT + remap", "pairs/s"});
  for (const SpeedResult& result : results) {
    const Distribution &rectified = result.rectified, &raw = result.raw;
    table.add(joined(
        rowName(result),
        {fixed(result.used, 0), fixed(rectified.median, 2), fixed(rectified.p99, 2),
         fixed(rectified.maximum, 2), fixed(result.rectified_ratio, 2), fixed(raw.median, 2),
         fixed(raw.p99, 2), fixed(raw.maximum, 2), fixed(result.raw_ratio, 2), fixed(1e3 / raw.median, 0)}));
  }
  return table.as(format);
}

std::string stagesTable(const std::vector<SpeedResult>& results, ReportFormat format) {
  std::vector<std::string> header{"drive", "images", "features", "threads"};
  for (int i = 0; i < vo::kStageCount; ++i)
    header.emplace_back(vo::stageName(static_cast<vo::Stage>(i)));
  Table table(header);
  for (const SpeedResult& result : results) {
    std::vector<std::string> row = rowName(result);
    for (const double stage : result.stages)
      row.push_back(fixed(stage, 2));
    table.add(std::move(row));
  }
  return table.as(format);
}

std::string referenceTable(const std::vector<SpeedResult>& results, ReportFormat format) {
  Table table({"drive", "images", "features", "threads", "remap, ms", "pyramids, ms", "KLT, ms"});
  for (const SpeedResult& result : results) {
    table.add(joined(rowName(result), {fixed(result.reference.remap, 2), fixed(result.reference.pyramids, 2),
                                       fixed(result.reference.klt, 2)}));
  }
  return table.as(format);
}

/// Times over one amount, with all other parameters equal.
struct Curve {
  std::string what;
  std::vector<double> amounts, times;
};

template <typename Name, typename Amount>
void gather(std::vector<Curve>& curves, const SpeedResult& result, const Name& name, const Amount& amount) {
  const std::string what = name(result);
  auto curve = std::find_if(curves.begin(), curves.end(), [&](const Curve& one) { return one.what == what; });
  if (curve == curves.end()) curve = curves.insert(curves.end(), {what, {}, {}});
  curve->amounts.push_back(amount(result));
  curve->times.push_back(result.rectified.median);
}

/// The growth of the times, with its heading; empty if no quantity has several values.
std::string growthSection(const std::vector<SpeedResult>& results, ReportFormat format) {
  std::vector<Curve> curves;
  const auto threads = [](const SpeedResult& result) {
    return ", threads: " + std::to_string(result.threads);
  };
  for (const SpeedResult& result : results) {
    gather(
        curves, result,
        [&](const SpeedResult& r) {
          return r.drive + " " + sizeText(r.size) + threads(r) + ", over features";
        },
        [](const SpeedResult& r) { return static_cast<double>(r.features); });
  }
  for (const SpeedResult& result : results) {
    gather(
        curves, result,
        [&](const SpeedResult& r) {
          return r.drive + ", " + std::to_string(r.features) + " features" + threads(r) + ", over pixels";
        },
        [](const SpeedResult& r) { return static_cast<double>(r.size.area()); });
  }
  Table table({"time of rectified images", "from, ms", "to, ms", "exponent"});
  bool has_growth = false;
  for (const Curve& curve : curves) {
    const auto [least, most] = std::minmax_element(curve.amounts.begin(), curve.amounts.end());
    if (*least == *most) continue;
    has_growth = true;
    table.add({curve.what, fixed(curve.times[least - curve.amounts.begin()], 2),
               fixed(curve.times[most - curve.amounts.begin()], 2),
               fixed(growthExponent(curve.amounts, curve.times), 2)});
  }
  return has_growth ? "\nGrowth: time ~ amount^exponent\n\n" + table.as(format) : "";
}

constexpr const char* kLegend =
    "Time of a pair from both images in memory to the pose, without reading files. rectified: without "
    "rectification;\n"
    "raw: with rectification of both images. used: features used for the motion. x: as multiples of the time "
    "of OpenCV on\n"
    "the same images in the same run, on one thread: calcOpticalFlowPyrLK with 1,000 points, 21x21, 4 "
    "levels, 30\n"
    "iterations or 0.01 px; and that with two remaps. Ratios are valid on a busy machine, milliseconds are "
    "not.\n";

Json json(const Distribution& distribution) {
  return {{"median", distribution.median}, {"p99", distribution.p99}, {"max", distribution.maximum}};
}

Json json(const SpeedResult& result) {
  Json stages;
  for (int i = 0; i < vo::kStageCount; ++i)
    stages[vo::stageName(static_cast<vo::Stage>(i))] = result.stages[i];
  return {{"drive", result.drive},
          {"width", result.size.width},
          {"height", result.size.height},
          {"features", result.features},
          {"threads", result.threads},
          {"pairs", result.pairs},
          {"used", result.used},
          {"rectified_ms", json(result.rectified)},
          {"raw_ms", json(result.raw)},
          {"rectified_ratio", result.rectified_ratio},
          {"raw_ratio", result.raw_ratio},
          {"stages_ms", stages},
          {"reference_ms",
           {{"remap", result.reference.remap},
            {"pyramids", result.reference.pyramids},
            {"klt", result.reference.klt}}}};
}

}  // namespace

std::string speedTables(const std::vector<SpeedResult>& results, ReportFormat format) {
  return timesTable(results, format) + "\n" + kLegend +
         "\nStages, median, ms (nested ones count in both):\n\n" + stagesTable(results, format) +
         "\nThe reference, median:\n\n" + referenceTable(results, format) + growthSection(results, format);
}

Json speedJson(const std::vector<SpeedResult>& results) {
  Json rows = Json::array();
  for (const SpeedResult& result : results)
    rows.push_back(json(result));
  return {{"speeds", rows}};
}

}  // namespace cartvo::benchmark
