// Plans changes of settings.
#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "tools/camera/settings_change.hpp"

namespace cartvo {
namespace {

using Findings = std::array<const Finding*, 2>;  // of one setting; nothing: no such camera

bool canBeSet(const Finding* finding) {
  return finding != nullptr && !finding->value.empty() && finding->verdict != Verdict::not_reported;
}

/// Size and flip belong to the calibration: they are changed by name only.
bool isChangedByAll(const Setting& setting) {
  const std::array by_name{"width", "height", "flip"};
  return std::find(by_name.begin(), by_name.end(), setting.name) == by_name.end();
}

/// The time server that all cameras get: this computer if one of them has it, because a camera's port may
/// lead to no other; else that of the first camera that has one.
std::optional<std::string> commonTimeServer(const Findings& findings, const OdometryNeeds& needs) {
  std::optional<std::string> server;
  for (const Finding* finding : findings) {
    if (!canBeSet(finding)) continue;
    if (isThisComputer(finding->value, needs)) return finding->value;
    if (!server) server = finding->value;
  }
  return server;
}

/// The value that all cameras get; nothing if none is known.
std::optional<std::string> target(const Setting& setting, const Findings& findings, const CameraPair& cameras,
                                  const OdometryNeeds& needs, const std::optional<std::string>& wish) {
  if (wish) return wish;
  if (setting.rule == Rule::time_server) return commonTimeServer(findings, needs);
  std::vector<const CameraDocuments*> able;
  for (std::size_t i = 0; i < findings.size(); ++i)
    if (canBeSet(findings[i])) able.push_back(cameras[i]);
  // A good value of one camera stays, so that as little as possible changes.
  for (const Finding* finding : findings) {
    if (!canBeSet(finding) || !fits(setting, finding->value)) continue;
    const bool is_offered = std::all_of(able.begin(), able.end(), [&](const CameraDocuments* camera) {
      return offerProblem(setting, *camera, finding->value).empty();
    });
    if (is_offered) return finding->value;
  }
  return bestValue(setting, able);
}

/// The value that one camera gets: this computer is a time server at the address that the camera reaches.
std::optional<std::string> valueFor(std::size_t side, const Setting& setting,
                                    const std::optional<std::string>& common, const OdometryNeeds& needs) {
  const bool is_near = common && setting.rule == Rule::time_server && isThisComputer(*common, needs) &&
                       !needs.addresses_near[side].empty();
  return is_near ? needs.addresses_near[side] : common;
}

void planOne(ChangePlan& plan, const Findings& findings, const CameraPair& cameras,
             const OdometryNeeds& needs, const std::optional<std::string>& wish, bool is_named) {
  const Setting& setting = (findings[0] != nullptr ? findings[0] : findings[1])->setting;
  const bool switches_off = isSwitch(setting) && (!wish || fits(setting, *wish));
  const std::optional<std::string> common = target(setting, findings, cameras, needs, wish);
  for (std::size_t i = 0; i < findings.size(); ++i) {
    const Finding* finding = findings[i];
    if (finding == nullptr) continue;
    if (switches_off && finding->verdict == Verdict::good) continue;
    const std::optional<std::string> value =
        switches_off ? bestValue(setting, {cameras[i]}) : valueFor(i, setting, common, needs);
    if (!canBeSet(finding)) {
      if (is_named)
        plan.problems[i].push_back(setting.name +
                                   ": the camera does not report it, or it does not count now");
    } else if (!value) {
      if (!finding->isGood()) {
        const auto offered = offeredValues(setting, *cameras[i]);
        plan.problems[i].push_back(fmt::format(
            "{}: is {}, must be {}{}", setting.name, finding->value, wantedText(setting),
            offered.empty() ? "" : fmt::format("; the camera offers {}", fmt::join(offered, ", "))));
      }
    } else if (const std::string problem = offerProblem(setting, *cameras[i], *value); !problem.empty()) {
      plan.problems[i].push_back(setting.name + ": cannot be " + *value + ": " + problem);
    } else if (!sameValue(finding->value, *value)) {
      plan.changes[i].push_back({setting, finding->value, *value});
    }
  }
}

}  // namespace

std::string nameProblem(const Selection& selection) {
  const std::vector<Setting> settings = cameraSettings({}, 1.0);  // the names are always the same
  for (const auto& [name, value] : selection.settings) {
    const bool is_known = std::any_of(settings.begin(), settings.end(),
                                      [&name = name](const Setting& one) { return one.name == name; });
    if (is_known) continue;
    std::string names;
    for (const Setting& setting : settings)
      names += (names.empty() ? "" : ", ") + setting.name;
    return "there is no setting '" + name + "'; the settings are " + names;
  }
  return {};
}

ChangePlan planChanges(const CameraPair& cameras, const OdometryNeeds& needs, const Selection& selection) {
  if (const std::string problem = nameProblem(selection); !problem.empty()) throw std::runtime_error(problem);
  // A wanted frame rate also changes the key frame interval that is needed.
  OdometryNeeds wanted = needs;
  const auto rate = selection.settings.find("frame-rate");
  if (rate != selection.settings.end() && rate->second) {
    constexpr double kHighestRate = 240.0;  // Hz
    const double hertz = std::atof(rate->second->c_str());
    if (hertz >= 1.0 && hertz <= kHighestRate) wanted.frame_rate = hertz;
  }
  const auto findings = checkCameras(cameras, wanted);
  const std::vector<Setting> settings = cameraSettings(wanted, frameRateOf(wanted, cameras));
  ChangePlan plan;
  for (std::size_t i = 0; i < settings.size(); ++i) {
    const Setting& setting = settings[i];
    const auto named = selection.settings.find(setting.name);
    const bool is_named = named != selection.settings.end();
    if (!is_named && !(selection.all && isChangedByAll(setting))) continue;
    const Findings pair{findings[0].empty() ? nullptr : &findings[0][i],
                        findings[1].empty() ? nullptr : &findings[1][i]};
    const bool is_good =
        (pair[0] == nullptr || pair[0]->isGood()) && (pair[1] == nullptr || pair[1]->isGood());
    const std::optional<std::string> wish = is_named ? named->second : std::nullopt;
    if (is_good && !is_named) continue;
    planOne(plan, pair, cameras, wanted, wish, is_named);
  }
  return plan;
}

}  // namespace cartvo
