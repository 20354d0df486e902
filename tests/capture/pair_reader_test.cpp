// Pairs of two sources that end. Texts of what a camera sends and what is left out. Pictures that repeat,
// of textured scenes and behind a covered lens.
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "capture/pair_synchroniser.hpp"
#include "capture/stream_remarks.hpp"

namespace cartvo::capture {
namespace {

using Clock = FrozenPictureDetector::Clock;
using Kind = StreamRemarks::Kind;
using std::chrono::seconds;
using testing::HasSubstr;

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

TEST(StreamRemarks, NameTheFirstOfWhatACameraNeverSends) {
  StreamRemarks remarks;
  EXPECT_EQ(remarks.text(), "");
  remarks.setTotal(Kind::channel, 1, "2");
  EXPECT_THAT(remarks.text(), HasSubstr("packets on channel 2"));
}

TEST(StreamRemarks, NameLostPicturesFromTheHundredthOn) {
  for (const auto& [kind, text] : {std::pair{Kind::undecodable, "pictures that cannot be decoded"},
                                   {Kind::incomplete, "pictures that are incomplete or of another size"},
                                   {Kind::missed, "pictures that its driver lost"}}) {
    StreamRemarks remarks;
    remarks.setTotal(kind, 99);
    EXPECT_EQ(remarks.text(), "") << text;
    remarks.add(kind);
    EXPECT_EQ(remarks.count(kind), 100U);
    EXPECT_THAT(remarks.text(), HasSubstr(std::string(text) + " (100 or more)"));
  }
}

TEST(FrozenPictureDetector, CountsSinceTheFirstOfEqualPicturesWithTexture) {
  cv::Mat picture(64, 96, CV_8UC1);
  cv::RNG(1).fill(picture, cv::RNG::UNIFORM, 0, 255);
  FrozenPictureDetector detector;
  const Clock::time_point start{};
  EXPECT_EQ(detector.update(picture, start), seconds(0));
  EXPECT_EQ(detector.update(picture, start + seconds(6)), seconds(6));
  picture.at<unsigned char>(0, 0) ^= 1;
  EXPECT_EQ(detector.update(picture, start + seconds(7)), seconds(0));
}

TEST(FrozenPictureDetector, TakesUniformPicturesForThoseOfACoveredLens) {
  const cv::Mat covered(64, 96, CV_8UC1, cv::Scalar(16));
  FrozenPictureDetector detector;
  const Clock::time_point start{};
  detector.update(covered, start);
  EXPECT_EQ(detector.update(covered, start + seconds(60)), seconds(0));
}

}  // namespace
}  // namespace cartvo::capture
