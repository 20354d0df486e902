// The loop from the odometry's delay to the stamps and back, with an odometry that remembers for 10 s.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "daemon/visual_clock.hpp"

namespace cartvo {
namespace {

constexpr double kStep = 1.0 / 18.0;  // s

/// Stamps, and an odometry that finds what they are off by, as a mean over 10 s, a tenth too short.
class Loop {
 public:
  explicit Loop(double truth_ns) : truth_ns_(truth_ns) {}

  void drive(double seconds, double deviation) {
    for (double t = 0.0; t < seconds; t += kStep) {
      weight_ = weight_ * std::exp(-kStep / 10.0) + 1.0;
      found_ += (truth_ns_ - applied_ns_ - found_) / weight_;
      RigCheck rig;
      rig.delay = {0.9e-9 * found_, deviation};
      known_ = clock_.add(rig, applied_ns_, kStep);
      if (!known_) continue;
      const double most = 5e6 * kStep;  // PairClock slews by 0.5 %
      applied_ns_ += std::clamp(known_->value_ns - applied_ns_, -most, most);
    }
  }
  double error() const { return applied_ns_ - truth_ns_; }
  const std::optional<ClockWitness>& known() const { return known_; }

 private:
  double truth_ns_;
  double applied_ns_ = 0.0;
  double found_ = 0.0;
  double weight_ = 0.0;
  VisualClock clock_;
  std::optional<ClockWitness> known_;
};

TEST(VisualClock, FindsTheOffsetToTwoMillisecondsWithinTwentySeconds) {
  for (const double truth_ns : {-25e6, -10e6, 0.0, 3e6, 25e6}) {
    Loop loop(truth_ns);
    loop.drive(20.0, 3e-4);
    EXPECT_NEAR(loop.error(), 0.0, 2e6) << truth_ns;
    EXPECT_LE(std::abs(loop.error()), 2.0 * loop.known()->deviation_ns) << truth_ns;
    loop.drive(40.0, 3e-4);
    EXPECT_NEAR(loop.error(), 0.0, 0.2e6) << truth_ns;
  }
}

TEST(VisualClock, SaysNothingWhileTheOdometryDoesNotKnow) {
  Loop loop(5e6);
  loop.drive(20.0, 8e-3);
  EXPECT_FALSE(loop.known());
  VisualClock clock;
  EXPECT_FALSE(clock.add(std::nullopt, 0.0, kStep));
}

TEST(VisualClock, KeepsWhatItKnewWhileTheCartStands) {
  Loop loop(5e6);
  loop.drive(30.0, 3e-4);
  const ClockWitness before = *loop.known();
  loop.drive(60.0, 8e-3);
  EXPECT_NEAR(loop.known()->value_ns, before.value_ns, 0.1e6);
  EXPECT_GT(loop.known()->deviation_ns, before.deviation_ns + 0.3e6);
}

}  // namespace
}  // namespace cartvo
