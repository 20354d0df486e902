// The list of constants and the table of their effects.
#include "tools/benchmark/sensitivity/sensitivity_report.hpp"

#include <cmath>
#include <cstdio>
#include <span>

namespace cartvo::benchmark {
namespace {

std::string numberOf(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

double percentOf(double logarithm) {
  return 100.0 * std::expm1(logarithm);
}

std::string signedPercent(double logarithm) {
  char text[32];
  std::snprintf(text, sizeof text, "%+.1f", percentOf(logarithm));
  return text;
}

std::string signedCount(int count) {
  char text[16];
  std::snprintf(text, sizeof text, "%+d", count);
  return text;
}

std::string plusMinus(const std::string& value) {
  return std::string("±").append(value);
}

/// A cell with the values at the smaller and at the larger constant.
template <typename ToText>
std::string bothSides(const ConstantSensitivity& one, const ToText& text) {
  return (one.low ? text(*one.low) : kNoValue) + " / " + (one.high ? text(*one.high) : kNoValue);
}

nlohmann::ordered_json toJson(const RelativeResult& result) {
  return {{"segments_percent", percentOf(result.segments)},
          {"relative_percent", percentOf(result.relative)},
          {"nees_percent", percentOf(result.nees)},
          {"invalid", result.invalid},
          {"above_limit", result.above_limit}};
}

nlohmann::ordered_json sideJson(double value, const std::optional<RelativeResult>& result) {
  if (!result) return nullptr;
  nlohmann::ordered_json json = {{"value", value}};
  json.update(toJson(*result));
  return json;
}

nlohmann::ordered_json describe(const vo::TunedConstant& constant) {
  return {{"name", constant.name},
          {"unit", constant.unit},
          {"default", constant.value({})},
          {"range", {constant.low, constant.high}},
          {"source", constant.source}};
}

}  // namespace

std::string constantsTable(ReportFormat format) {
  const auto listed = [&](std::span<const vo::TunedConstant> constants, const char* what) {
    Table table({what, "default", "unit", "range", "source"});
    for (const vo::TunedConstant& constant : constants)
      table.add({constant.name, numberOf(constant.value({})), constant.unit,
                 numberOf(constant.low) + " to " + numberOf(constant.high), constant.source});
    return table.as(format) + "\n" + std::to_string(constants.size()) + " " + what + "s\n";
  };
  return listed(vo::tunedConstants(), "constant") + "\n" + listed(vo::productLimits(), "limit");
}

nlohmann::ordered_json constantsJson() {
  nlohmann::ordered_json json = {{"constants", nlohmann::ordered_json::array()},
                                 {"limits", nlohmann::ordered_json::array()}};
  for (const vo::TunedConstant& constant : vo::tunedConstants())
    json["constants"].push_back(describe(constant));
  for (const vo::TunedConstant& limit : vo::productLimits())
    json["limits"].push_back(describe(limit));
  return json;
}

std::string sensitivityTable(const Sensitivity& sensitivity, ReportFormat format) {
  Table table({"constant", "default", "values", "segments %", "pair to pair %", "NEES %", "invalid",
               "> limit", "effect"});
  for (const ConstantSensitivity& one : sensitivity.constants) {
    table.add({one.constant->name, numberOf(one.default_value),
               (one.low ? numberOf(one.low_value) : kNoValue) + " / " +
                   (one.high ? numberOf(one.high_value) : kNoValue),
               bothSides(one, [](const RelativeResult& side) { return signedPercent(side.segments); }),
               bothSides(one, [](const RelativeResult& side) { return signedPercent(side.relative); }),
               bothSides(one, [](const RelativeResult& side) { return signedPercent(side.nees); }),
               bothSides(one, [](const RelativeResult& side) { return signedCount(side.invalid); }),
               bothSides(one, [](const RelativeResult& side) { return signedCount(side.above_limit); }),
               fixed(one.effect, 1)});
  }
  const RelativeResult& chance = sensitivity.chance;
  table.add({"by chance", "", "", plusMinus(fixed(percentOf(chance.segments), 1)),
             plusMinus(fixed(percentOf(chance.relative), 1)), plusMinus(fixed(percentOf(chance.nees), 1)),
             plusMinus(std::to_string(chance.invalid)), plusMinus(std::to_string(chance.above_limit)),
             "1.0"});
  return table.as(format) + "\n" +
         "Changes with the constant at its smaller and larger value, geometric means over all sequences (" +
         std::to_string(sensitivity.pairs) +
         " pairs):\nerrors of segments of 5 to 40 m, errors from pair to pair, normalised errors of motions, "
         "invalid pairs\nand VALID messages above an alert limit. effect: the largest of them, in multiples "
         "of the largest change "
         "by "
         "chance (other\nrandom subsets, 2 % fewer and more landmarks).\n";
}

nlohmann::ordered_json sensitivityJson(const Sensitivity& sensitivity) {
  nlohmann::ordered_json json = {{"pairs", sensitivity.pairs},
                                 {"chance", toJson(sensitivity.chance)},
                                 {"constants", nlohmann::ordered_json::array()}};
  for (const ConstantSensitivity& one : sensitivity.constants) {
    nlohmann::ordered_json row = describe(*one.constant);
    row["effect"] = one.effect;
    row["smaller"] = sideJson(one.low_value, one.low);
    row["larger"] = sideJson(one.high_value, one.high);
    json["constants"].push_back(std::move(row));
  }
  return json;
}

}  // namespace cartvo::benchmark
