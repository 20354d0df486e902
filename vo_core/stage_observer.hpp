#pragma once

#include <cstdint>

namespace cartvo::vo {

/// The stages of one pair, in the order of the thesis' Table 5-2 where they occur there.
enum class Stage : std::uint8_t {
  rectify,
  pyramid,
  optical_flow,
  disparity,
  reproject,
  motion,
  detect,
  weights,
  minimum_distance
};
constexpr int kStageCount = 9;
/// Name of a stage in files and outputs.
const char* stageName(Stage stage);

/// Interface that is notified when a stage begins and ends. Callers with a clock measure durations by it;
/// vo_core has no clock.
class StageObserver {
 public:
  virtual ~StageObserver() = default;
  virtual void begin(Stage stage) = 0;
  virtual void end(Stage stage) = 0;
};

/// Observer that does nothing.
class NullStageObserver final : public StageObserver {
 public:
  void begin(Stage /*stage*/) override {}
  void end(Stage /*stage*/) override {}
};

/// Notifies the observer of a stage that lasts as long as this object.
class StageScope {
 public:
  StageScope(StageObserver& observer, Stage stage) : observer_(observer), stage_(stage) {
    observer_.begin(stage_);
  }
  ~StageScope() { observer_.end(stage_); }
  StageScope(const StageScope&) = delete;
  StageScope& operator=(const StageScope&) = delete;

 private:
  StageObserver& observer_;
  Stage stage_;
};

}  // namespace cartvo::vo
