// Judging of streams, with synthetic ones.
#include "tools/doctor/cameras/stream_checks.hpp"

#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/doctor/findings.hpp"

namespace cartvo::doctor {
namespace {

using test::findingOf;
using test::Saw;

constexpr double kRate = 18.0;  // Hz
const cv::Size kSize{680, 420};
const StreamNeeds kNeeds{kSize, kRate};

/// How a synthetic stream differs from a good one.
struct StreamCase {
  double rate = kRate;      // Hz, by the camera's clock
  double pace = 1.0;        // host seconds per second of the camera's
  double jitter = 0.0;      // s, of every fifth arrival
  double clock = 0.0;       // s, the camera's clock minus the host's
  double clock_step = 0.0;  // s, by which that clock is set in the middle
  int key_interval = 18;    // pictures
  std::size_t bytes = 28'000;
  bool has_reports = true;
};

constexpr int kPictures = 181;

StreamMeasurement measured(const StreamCase& stream) {
  constexpr std::int64_t kStart_ns = 1'000'000'000'000'000'000;
  StreamMeasurement measurement;
  measurement.codec = capture::VideoCodec::h264;
  measurement.size = kSize;
  measurement.decode_times.assign(kPictures, 0.003);
  for (int i = 0; i < kPictures; ++i) {
    const double time = i / stream.rate;
    const double exposure = stream.pace * time;
    const double latency = 0.1 + (i % 5 == 4 ? stream.jitter : 0.0);
    ReceivedPicture picture;
    picture.time_ns = std::llround(1e9 * time);
    picture.first_arrival_ns = kStart_ns + std::llround(1e9 * (exposure + latency));
    if (stream.has_reports) {
      const double step = i > kPictures / 2 ? stream.clock_step : 0.0;
      picture.reference_us = kStart_ns / 1000 + std::llround(1e6 * (exposure + stream.clock + step));
    }
    picture.sequence = static_cast<std::uint64_t>(i);
    picture.bytes = stream.bytes;
    picture.key = i % stream.key_interval == 0;
    measurement.pictures.push_back(picture);
  }
  return measurement;
}

Findings checked(const StreamMeasurement& measurement, const StreamNeeds& needs) {
  FindingList list("left camera");
  checkStream(measurement, needs, list);
  return list.take();
}

Findings checked(const StreamCase& stream) {
  return checked(measured(stream), kNeeds);
}

TEST(StreamChecks, AcceptAGoodStream) {
  const Findings findings = checked(StreamCase{});
  EXPECT_EQ(worstVerdict(findings), Verdict::ok) << areaText(findings);
  EXPECT_THAT(findingOf(findings, "frame rate"), Saw(Verdict::ok, "18.000 Hz by the camera's clock, 18.000"));
  EXPECT_THAT(findingOf(findings, "key frame interval"), Saw(Verdict::ok, "1.00 s"));
  EXPECT_THAT(findingOf(findings, "bit rate"), Saw(Verdict::ok, "40"));
  EXPECT_THAT(findingOf(findings, "clock"), Saw(Verdict::ok, "+100.0 ms"));
}

TEST(StreamChecks, CompareTheRateToAThousandth) {
  EXPECT_THAT(findingOf(checked({.rate = 18.017}), "frame rate"), Saw(Verdict::ok, "18.017"));
  EXPECT_THAT(findingOf(checked({.rate = 18.05}), "frame rate"), Saw(Verdict::look_at, "18.050"));
  const Findings any = checked(measured({.rate = 18.05}), {kSize, std::nullopt});
  EXPECT_THAT(findingOf(any, "frame rate"), Saw(Verdict::ok, "18.050"));
}

TEST(StreamChecks, FindACameraThatDoesNotReachItsRate) {
  EXPECT_THAT(findingOf(checked({.pace = 1.1}), "pace"), Saw(Verdict::broken, "0.909"));
}

TEST(StreamChecks, FindAWrongSize) {
  EXPECT_THAT(findingOf(checked(measured({}), {{1280, 720}, kRate}), "size"),
              Saw(Verdict::broken, "680x420"));
  EXPECT_THAT(findingOf(checked(measured({}), {{}, kRate}), "size"), Saw(Verdict::ok, "680x420"));
}

TEST(StreamChecks, LookAtEncoding) {
  EXPECT_THAT(findingOf(checked({.key_interval = 90}), "key frame interval"),
              Saw(Verdict::look_at, "5.00 s"));
  EXPECT_THAT(findingOf(checked({.key_interval = 1000}), "key frame interval"),
              Saw(Verdict::look_at, "more than 10.00 s"));
  EXPECT_THAT(findingOf(checked({.bytes = 1000}), "bit rate"), Saw(Verdict::look_at, "145 kbit/s"));
  StreamMeasurement reordered = measured({});
  for (std::size_t i = 1; i + 1 < reordered.pictures.size(); i += 2)
    std::swap(reordered.pictures[i].time_ns, reordered.pictures[i + 1].time_ns);
  EXPECT_THAT(findingOf(checked(reordered, kNeeds), "B-frames"), Saw(Verdict::look_at, "yes"));
}

TEST(StreamChecks, LookAtLossesAndDelays) {
  StreamMeasurement lossy = measured({});
  lossy.pictures[20].data_lost = true;
  lossy.pictures.erase(lossy.pictures.begin() + 19);
  const Findings findings = checked(lossy, kNeeds);
  EXPECT_THAT(findingOf(findings, "losses"), Saw(Verdict::look_at, "1 of 180 pictures"));
  EXPECT_THAT(findingOf(findings, "intervals"), Saw(Verdict::look_at, "longest 111 ms"));
  EXPECT_THAT(findingOf(findings, "frame rate"), Saw(Verdict::ok, "18.000 Hz")) << "gaps do not change it";
  EXPECT_THAT(findingOf(checked({.jitter = 0.08}), "arrivals"), Saw(Verdict::look_at, "80.0 ms"));
}

TEST(StreamChecks, LookAtTheCamerasClock) {
  EXPECT_THAT(findingOf(checked({.has_reports = false}), "sender reports"), Saw(Verdict::look_at, "none"));
  EXPECT_THAT(findingOf(checked({.clock = -7200.0}), "clock"), Saw(Verdict::look_at, "+7200100.0 ms"));
  EXPECT_THAT(findingOf(checked({.clock = 0.3}), "clock"), Saw(Verdict::look_at, "-200.0 ms"));
  EXPECT_THAT(findingOf(checked({.clock_step = 0.05}), "sender reports"), Saw(Verdict::look_at, "50.0 ms"));
}

TEST(StreamChecks, LookAtSlowDecoding) {
  StreamMeasurement slow = measured({});
  slow.decode_times.assign(10, 0.04);
  EXPECT_THAT(findingOf(checked(slow, kNeeds), "decoding"), Saw(Verdict::look_at, "40.0 ms"));
}

TEST(StreamChecks, SayWhyThereIsNoStream) {
  StreamMeasurement none;
  EXPECT_THAT(checked(none, kNeeds).front(), Saw(Verdict::broken, "no picture"));
  none.problem = "it cannot serve another viewer";
  EXPECT_THAT(checked(none, kNeeds).front(), Saw(Verdict::broken, "another viewer"));
  none.is_refused = true;
  EXPECT_EQ(checked(none, kNeeds).front().subject, "login");
}

TEST(StreamChecks, DoNotMeasureTheRateOfTwoPictures) {
  StreamMeasurement brief = measured({});
  brief.pictures.resize(2);
  const Findings findings = checked(brief, kNeeds);
  EXPECT_THAT(findingOf(findings, "frame rate"), Saw(Verdict::not_checked, "too few"));
  EXPECT_THAT(findingOf(findings, "key frame interval"), Saw(Verdict::not_checked, "more than 0.06 s"));
}

TEST(StreamChecks, JudgeAStreamThatIsNotEncoded) {
  StreamMeasurement raw = measured({});
  raw.codec.reset();
  for (ReceivedPicture& picture : raw.pictures)
    picture.first_arrival_ns = 0;
  const Findings findings = checked(raw, kNeeds);
  EXPECT_EQ(worstVerdict(findings), Verdict::ok) << areaText(findings);
  EXPECT_EQ(findingOf(findings, "bit rate").verdict, Verdict::not_checked);
}

TEST(StreamChecks, CompareBothCameras) {
  FindingList alike("both cameras"), unlike("both cameras"), one("both cameras");
  compareStreams({measured({}), measured({})}, alike);
  EXPECT_EQ(worstVerdict(alike.findings()), Verdict::ok);
  compareStreams({measured({}), measured({.rate = 17.8, .clock = -0.05})}, unlike);
  EXPECT_THAT(findingOf(unlike.findings(), "frame rates"), Saw(Verdict::look_at, "right 17.800 Hz"));
  EXPECT_THAT(findingOf(unlike.findings(), "clocks"), Saw(Verdict::look_at, "+50.0 ms"));
  compareStreams({measured({}), {}}, one);
  EXPECT_TRUE(one.findings().empty());
}

}  // namespace
}  // namespace cartvo::doctor
