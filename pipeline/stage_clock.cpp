// Measures the processing time of a pair's stages; vo_core itself has no clock.

#include "pipeline/stage_clock.hpp"

namespace cartvo::pipeline {
namespace {

double seconds(std::chrono::steady_clock::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

}  // namespace

void StageClock::startPair() {
  times_ = {};
  pair_start_ = Clock::now();
}

void StageClock::begin(vo::Stage stage) {
  starts_[static_cast<std::size_t>(stage)] = Clock::now();
}

void StageClock::end(vo::Stage stage) {
  const auto index = static_cast<std::size_t>(stage);
  times_.stages[index] += seconds(Clock::now() - starts_[index]);
}

StageTimes StageClock::endPair() {
  times_.total = seconds(Clock::now() - pair_start_);
  return times_;
}

}  // namespace cartvo::pipeline
