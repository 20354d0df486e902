// Texts and JSON of `cartvo camera`.
#include "tools/camera/camera_report.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace cartvo {
namespace {

std::size_t indexOf(const ReportedCamera& camera) {
  return camera.side == "right" ? 1 : 0;
}

std::string headText(const ReportedCamera& camera) {
  std::string text = fmt::format("{} camera, {}\n", camera.side, camera.address);
  if (!camera.documents) return text + "  " + camera.error + "\n";
  const CameraIdentity& identity = camera.documents->identity;
  text += fmt::format("  {}, serial number {}, firmware {} {}\n", identity.model, identity.serial_number,
                      identity.firmware, identity.firmware_date);
  return text;
}

nlohmann::json cameraJson(const ReportedCamera& camera) {
  nlohmann::json json{{"side", camera.side}, {"address", camera.address}};
  if (!camera.documents) {
    json["error"] = camera.error;
    return json;
  }
  const CameraIdentity& identity = camera.documents->identity;
  json["name"] = identity.name;
  json["model"] = identity.model;
  json["serial_number"] = identity.serial_number;
  json["mac_address"] = identity.mac_address;
  json["firmware"] = identity.firmware;
  json["firmware_date"] = identity.firmware_date;
  return json;
}

nlohmann::json valueJson(const Finding& finding) {
  return finding.value.empty() ? nlohmann::json() : nlohmann::json(finding.value);
}

std::string findingText(const Finding& finding) {
  const Setting& setting = finding.setting;
  const std::string name = fmt::format("  {:<10} {:<22}", verdictText(finding.verdict), setting.name);
  switch (finding.verdict) {
    case Verdict::good:
    case Verdict::not_reported:
      return fmt::format("{} {}\n", name, finding.value.empty() ? "not reported" : finding.value);
    case Verdict::wrong:
      return fmt::format("{} {}: {} should be {}\n{:>36}{}\n", name, finding.value, setting.title,
                         wantedText(setting), "", setting.reason);
    case Verdict::unlike:
      return fmt::format("{} {}: {} should be the same on both cameras\n{:>36}{}\n", name, finding.value,
                         setting.title, "", setting.reason);
    case Verdict::unknown:
      break;
  }
  return fmt::format(
      "{} the camera does not report it: look at {} in its web page; it should be {}\n{:>36}{}\n", name,
      setting.title, wantedText(setting), "", setting.reason);
}

}  // namespace

/// In the order of the enumeration.
std::string verdictText(Verdict verdict) {
  static constexpr std::array kTexts{"good", "wrong", "unlike", "unknown", "-"};
  return kTexts.at(static_cast<std::size_t>(verdict));
}

CameraPair pairOf(const ReportedPair& cameras) {
  CameraPair pair{};
  for (const ReportedCamera& camera : cameras)
    if (camera.documents) pair[indexOf(camera)] = &*camera.documents;
  return pair;
}

std::string showText(const ReportedPair& cameras, const OdometryNeeds& needs) {
  const auto findings = checkCameras(pairOf(cameras), needs);
  std::string text;
  for (const ReportedCamera& camera : cameras) {
    text += headText(camera);
    for (const Finding& finding : findings[indexOf(camera)])
      if (!finding.value.empty())
        text +=
            fmt::format("  {:<22} {:<14} {}\n", finding.setting.name, finding.value, finding.setting.title);
  }
  return text;
}

nlohmann::json showJson(const ReportedPair& cameras, const OdometryNeeds& needs) {
  const auto findings = checkCameras(pairOf(cameras), needs);
  nlohmann::json list = nlohmann::json::array();
  for (const ReportedCamera& camera : cameras) {
    nlohmann::json json = cameraJson(camera);
    for (const Finding& finding : findings[indexOf(camera)])
      json["settings"][finding.setting.name] = valueJson(finding);
    list.push_back(std::move(json));
  }
  return {{"cameras", std::move(list)}};
}

bool CheckReport::isGood() const {
  const auto good = [](const std::vector<Finding>& list) {
    return std::all_of(list.begin(), list.end(), [](const Finding& finding) { return finding.isGood(); });
  };
  return !same_camera && good(findings[0]) && good(findings[1]);
}

CheckReport checkReport(const ReportedPair& cameras, const OdometryNeeds& needs) {
  const CameraPair pair = pairOf(cameras);
  return {&cameras, checkCameras(pair, needs), compareCameras(pair), areSameCamera(pair)};
}

std::string checkText(const CheckReport& report, bool verbose) {
  std::string text;
  for (const ReportedCamera& camera : *report.cameras) {
    text += headText(camera);
    if (!camera.documents) continue;
    const std::vector<Finding>& findings = report.findings[indexOf(camera)];
    const auto good = std::count_if(findings.begin(), findings.end(),
                                    [](const Finding& finding) { return finding.verdict == Verdict::good; });
    for (const Finding& finding : findings)
      if (verbose || !finding.isGood()) text += findingText(finding);
    text += fmt::format("  {} settings are good\n", good);
  }
  for (const std::string& difference : report.differences)
    text += "look at: " + difference + "\n";
  return text;
}

nlohmann::json checkJson(const CheckReport& report) {
  nlohmann::json list = nlohmann::json::array();
  for (const ReportedCamera& camera : *report.cameras) {
    nlohmann::json json = cameraJson(camera);
    for (const Finding& finding : report.findings[indexOf(camera)]) {
      json["settings"].push_back(
          {{"name", finding.setting.name},
           {"title", finding.setting.title},
           {"verdict",
            finding.verdict == Verdict::not_reported ? "not reported" : verdictText(finding.verdict)},
           {"value", valueJson(finding)},
           {"wanted", wantedText(finding.setting)},
           {"reason", finding.setting.reason}});
    }
    list.push_back(std::move(json));
  }
  const bool all_read =
      std::all_of(report.cameras->begin(), report.cameras->end(),
                  [](const ReportedCamera& camera) { return camera.documents.has_value(); });
  return {{"good", report.isGood() && all_read},
          {"differences", report.differences},
          {"cameras", std::move(list)}};
}

std::string planText(const ReportedPair& cameras, const ChangePlan& plan) {
  std::string text;
  for (const ReportedCamera& camera : cameras) {
    const std::size_t index = indexOf(camera);
    text += headText(camera);
    for (const Change& change : plan.changes[index])
      text += fmt::format("  {:<22} {} -> {}\n", change.setting.name, change.from, change.to);
    for (const std::string& problem : plan.problems[index])
      text += "  cannot change " + problem + "\n";
    if (plan.changes[index].empty()) text += "  nothing to change\n";
  }
  return text;
}

nlohmann::json appliedJson(const AppliedChanges& applied) {
  const auto plan_json = [](const ChangePlan& plan, std::size_t index) {
    nlohmann::json changes = nlohmann::json::array();
    for (const Change& change : plan.changes[index])
      changes.push_back({{"name", change.setting.name}, {"from", change.from}, {"to", change.to}});
    return nlohmann::json{{"changes", std::move(changes)}, {"problems", plan.problems[index]}};
  };
  nlohmann::json list = nlohmann::json::array();
  for (const ReportedCamera& camera : *applied.cameras) {
    const std::size_t index = indexOf(camera);
    nlohmann::json json = cameraJson(camera);
    json["planned"] = plan_json(*applied.plan, index);
    json["left_over"] = applied.rest ? plan_json(*applied.rest, index) : nlohmann::json();
    json["results"] = nlohmann::json::array();
    if (const std::optional<ApplyResult>& result = applied.results[index]) {
      for (const ChangeResult& one : result->results)
        json["results"].push_back({{"name", one.change.setting.name},
                                   {"to", one.change.to},
                                   {"taken", one.is_taken},
                                   {"problem", one.problem}});
      json["needs_reboot"] = result->needs_reboot;
      json["failure"] = result->failure;
    }
    list.push_back(std::move(json));
  }
  return {{"cameras", std::move(list)}};
}

}  // namespace cartvo
