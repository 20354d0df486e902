// Problems of light, second by second.
#include "tools/replay/light_by_seconds.hpp"

#include <algorithm>

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

}  // namespace cartvo
