// Problems of light, second by second.
#include "tools/replay/light_by_seconds.hpp"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

namespace cartvo {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

}  // namespace

void LightBySeconds::add(const pipeline::PairResult& result, const odometry_t& message) {
  const std::int64_t exposure_ns = result.estimate.exposure_ns;
  if (begin_ns_ && exposure_ns - *begin_ns_ >= kSecond_ns) endSecond();
  if (!begin_ns_) begin_ns_ = exposure_ns;
  monitor_.add(result, message);
}

void LightBySeconds::endSecond() {
  ++seconds_;
  begin_ns_.reset();
  const std::string problem = monitor_.consumeProblem();
  if (problem.empty()) return;
  const auto known = std::find_if(problems_.begin(), problems_.end(),
                                  [&](const auto& entry) { return entry.first == problem; });
  if (known == problems_.end())
    problems_.emplace_back(problem, 1);
  else
    ++known->second;
}

std::vector<std::string> LightBySeconds::consumeProblems() {
  if (begin_ns_) endSecond();
  std::vector<std::string> texts;
  for (const auto& [problem, seconds] : problems_)
    texts.push_back(fmt::format("{} ({} of {} s)", problem, seconds, seconds_));
  return texts;
}

namespace {

constexpr double kLeast = 1.0;  // s that a fault lasts to be named

std::string kindOf(std::string message) {
  std::erase_if(message, [](unsigned char c) { return std::isdigit(c) != 0 || c == '.' || c == '-'; });
  return message;
}

}  // namespace

void DriveSelfCheck::add(const std::string& message, double seconds) {
  const double step = seconds - end_;
  end_ = seconds;
  if (message.empty()) return;
  const std::string kind = kindOf(message);
  auto fault = std::find_if(faults_.begin(), faults_.end(), [&](const Fault& f) { return f.kind == kind; });
  if (fault == faults_.end()) fault = faults_.insert(fault, Fault{kind, message, seconds, seconds});
  fault->message = message;
  fault->last = seconds;
  fault->lasted += step;
}

std::string DriveSelfCheck::sentence() const {
  std::vector<Fault> faults = faults_;
  std::erase_if(faults, [&](const Fault& fault) { return fault.lasted < std::min(kLeast, 0.5 * end_); });
  std::stable_sort(faults.begin(), faults.end(),
                   [](const Fault& a, const Fault& b) { return a.lasted > b.lasted; });
  std::string all;
  for (const Fault& fault : faults) {
    all += (all.empty() ? "" : "; ") + fault.message;
    if (fault.last < end_) all += fmt::format(" (from {:.1f} to {:.1f} s)", fault.first, fault.last);
  }
  return all;
}

}  // namespace cartvo
