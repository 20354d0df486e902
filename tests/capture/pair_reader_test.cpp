// Pairs of two sources that end.
#include "capture/pair_reader.hpp"

#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace cartvo::capture {
namespace {

constexpr std::int64_t kPeriod_ns = 50'000'000;

/// A camera that times out before each of its frames.
class SlowCamera : public CameraSource {
 public:
  SlowCamera(int frames, std::int64_t first_ns) : frames_(frames), first_ns_(first_ns) {}

  ReadOutcome read(Frame& frame, std::chrono::milliseconds /*timeout*/) override {
    if (next_ == frames_) return ReadOutcome::ended;
    if (waits_ = !waits_; waits_) return ReadOutcome::timed_out;
    frame = {};
    frame.exposure_ns = first_ns_ + next_ * kPeriod_ns;
    frame.sequence = static_cast<std::uint64_t>(next_++);
    return ReadOutcome::frame;
  }
  CameraHealth health() const override { return {}; }
  void interrupt() noexcept override { next_ = frames_; }

  int delivered() const { return next_; }

 private:
  int frames_;
  std::int64_t first_ns_;
  int next_ = 0;
  bool waits_ = false;
};

TEST(PairReader, ReadsBothSourcesToTheirEnds) {
  SlowCamera left(40, 0);
  SlowCamera right(60, 10'000'000);  // more frames than wait for a partner
  PairReader reader(left, right, {.period_ns = kPeriod_ns});
  std::vector<FramePair> pairs;
  while (std::optional<FramePair> pair = reader.next())
    pairs.push_back(std::move(*pair));
  ASSERT_EQ(pairs.size(), 40u);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    EXPECT_EQ(pairs[i].left.sequence, i);
    EXPECT_EQ(pairs[i].offsetNs(), 10'000'000);
  }
  EXPECT_EQ(left.delivered(), 40);
  EXPECT_EQ(right.delivered(), 60);
  EXPECT_FALSE(reader.next()) << "the end stays";
  EXPECT_EQ(reader.synchroniser().counts(CameraSide::right).received, 60u);
}

TEST(PairReader, ReadsNoFurtherThanTheNextPairNeeds) {
  SlowCamera left(40, 0);
  SlowCamera right(40, 0);
  PairReader reader(left, right, {.period_ns = kPeriod_ns});
  ASSERT_TRUE(reader.next());
  EXPECT_LE(left.delivered(), 3);
  EXPECT_LE(right.delivered(), 3);
}

TEST(PairReader, EndsWithInterruptedSources) {
  SlowCamera left(40, 0);
  SlowCamera right(40, 0);
  PairReader reader(left, right, {.period_ns = kPeriod_ns});
  ASSERT_TRUE(reader.next());
  left.interrupt();
  right.interrupt();
  int pairs = 0;
  while (reader.next())
    ++pairs;
  EXPECT_LE(pairs, 2);
}

TEST(PairReader, HasNoPairsOfEmptySources) {
  SlowCamera left(0, 0);
  SlowCamera right(3, 0);
  EXPECT_FALSE(PairReader(left, right, {}).next());
}

}  // namespace
}  // namespace cartvo::capture
