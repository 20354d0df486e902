// Recordings whose description or index is not as it was written. Rows of a recording's index.
#include "capture/recording/recording_index.hpp"

#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/recording/recording_folder.hpp"
#include "capture/recording/recording_source.hpp"
#include "capture/recording/stream_recorder.hpp"
#include "capture/stereo_source.hpp"
#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"
#include "tests/support/capture/encoded_sequence.hpp"

namespace cartvo::capture {
namespace {

using testing::HasSubstr;

TEST(RecordingDescription, NamesWhatIsExpectedInIt) {
  for (const char* text : {"[]", "2", "{}", R"({"format_version": 2, "software_version": 3})"}) {
    EXPECT_THAT(test::messageOf([&] { parseRecordingInfo(text, "recording.json"); }),
                HasSubstr("recording.json is damaged: expected an object with the integer format_version"))
        << text;
  }
}

TEST(RecordingDescription, IsNamedIfItIsMissing) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directory(folder / "000000");
  std::ofstream(folder / "000000/left.mkv") << "x";
  EXPECT_THAT(test::messageOf([&] { openSource(folder.path()); }),
              HasSubstr("has the parts of a recording, but no recording.json"));
}

TEST(RecordingIndex, MayHaveLineEndsOfWindows) {
  IndexRow row;
  row.number = 7;
  const std::string text = indexHeader() + "\r\n" + formatIndexRow(row);
  std::istringstream unix(indexHeader() + "\n" + formatIndexRow(row) + "\n"), windows(text + "\r\n");
  EXPECT_EQ(readRecordingIndex(unix, "left.csv").rows.size(), 1U);
  const RecordingIndex read = readRecordingIndex(windows, "left.csv");
  ASSERT_EQ(read.rows.size(), 1U) << read.damage;
  EXPECT_EQ(read.rows[0].number, 7U);
}

TEST(RecordingIndex, ParsesFormattedRow) {
  IndexRow row;
  row.number = 7;
  row.time_ms = 350;
  row.order = 15;
  row.connection = 2;
  row.sequence = 9;
  row.pts = 40500;
  row.reference_us = 1'700'000'000'123'456;
  row.first_arrival_ns = 1'700'000'000'200'000'001;
  row.arrival_ns = 1'700'000'000'210'000'001;
  row.min_delay_arrival_ns = 1'700'000'000'199'000'001;
  row.exposure_ns = 1'700'000'000'123'456'789;
  row.exposure_stddev_ns = 1'000'000;
  row.instant_source = InstantSource::sender_report;
  row.size = 4711;
  row.checksum = 0xdeadbeef;
  row.key = true;
  row.data_lost = true;
  row.status = FrameStatus::damaged;
  const std::string text = formatIndexRow(row);
  const std::optional<IndexRow> read = parseIndexRow(text);
  ASSERT_TRUE(read);
  EXPECT_EQ(formatIndexRow(*read), text);
  EXPECT_EQ(read->status, FrameStatus::damaged);
  row.reference_us.reset();
  ASSERT_TRUE(parseIndexRow(formatIndexRow(row)));
  EXPECT_EQ(parseIndexRow(formatIndexRow(row))->reference_us, std::nullopt);
}

TEST(RecordingIndex, RejectsChangedLine) {
  const std::string text = formatIndexRow(IndexRow{});
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string changed = text;
    changed[i] = changed[i] == '7' ? '8' : '7';
    EXPECT_FALSE(parseIndexRow(changed)) << changed;
  }
  EXPECT_FALSE(parseIndexRow("1,2,3"));
  EXPECT_FALSE(parseIndexRow(""));
}

TEST(RecordingIndex, RejectsTimesOutOfRange) {
  IndexRow row;
  ASSERT_TRUE(parseIndexRow(formatIndexRow(row)));
  for (std::int64_t IndexRow::*const member : std::initializer_list<std::int64_t IndexRow::*>{
           &IndexRow::pts, &IndexRow::first_arrival_ns, &IndexRow::arrival_ns,
           &IndexRow::min_delay_arrival_ns, &IndexRow::exposure_ns, &IndexRow::exposure_stddev_ns,
           &IndexRow::time_ms}) {
    IndexRow impossible = row;
    // The difference of -2^62 and 2^62 overflows.
    for (const std::int64_t instant : {INT64_MAX, INT64_MIN, -(std::int64_t{1} << 62)}) {
      impossible.*member = instant;
      EXPECT_FALSE(parseIndexRow(formatIndexRow(impossible))) << instant;
    }
  }
  row.reference_us = INT64_MAX;
  EXPECT_FALSE(parseIndexRow(formatIndexRow(row)));
}

constexpr int kPictures = 200;
constexpr int kReconnection = 120;  // of the right camera, after a gap of one second
constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;

/// A picture of one camera with its live time stamp.
struct Live {
  CameraSide side = CameraSide::left;
  bool connects = false;
  EncodedUnit unit;
};

/// Two cameras at 20 Hz with network jitter and sender reports, timestamped as live.
std::vector<Live> liveCameras(ClockChoice choice) {
  const std::vector<EncodedUnit> pictures =
      test::encodeSequence(VideoCodec::h264, cv::Size(64, 48), kPictures, 10, "");
  StereoTimestamper clock(choice);
  std::mt19937 random(1);
  std::exponential_distribution<double> delay_ms(0.5);
  std::vector<Live> live;
  for (int i = 0; i < kPictures; ++i) {
    for (const CameraSide side : {CameraSide::left, CameraSide::right}) {
      const bool right = side == CameraSide::right;
      if (right && i > kReconnection - 20 && i < kReconnection) continue;
      Live picture{side, i == 0 || (right && i == kReconnection), pictures[static_cast<std::size_t>(i)]};
      EncodedUnit& unit = picture.unit;
      const std::int64_t exposure_ns = kStart_ns + i * std::int64_t{50'000'000} + (right ? 7'000'000 : 0);
      unit.pts = i * 4500 - (right && i >= kReconnection ? kReconnection * 4500 : 0);
      unit.first_arrival_ns = exposure_ns + 30'000'000 + static_cast<std::int64_t>(1e6 * delay_ms(random));
      unit.arrival_ns = unit.first_arrival_ns + 1'000'000;
      if (i % 20 == 5) unit.reference_us = exposure_ns / 1000;
      if (picture.connects) clock.connect(side);
      const ExposureTimestamp instant =
          clock.stamp(side, {unit.pts, unit.reference_us, unit.first_arrival_ns});
      setTimestamp(unit, instant);
      live.push_back(std::move(picture));
    }
  }
  return live;
}

void record(const std::filesystem::path& folder, const std::vector<Live>& live) {
  RecordingSettings settings;
  settings.folder = folder;
  settings.segment_length = std::chrono::milliseconds(3000);
  StreamRecorder recorder(settings);
  for (const Live& picture : live) {
    StreamObserver& observer = picture.side == CameraSide::left ? recorder.left() : recorder.right();
    if (picture.connects) observer.onStream({VideoCodec::h264, {}});
    observer.onUnit(picture.unit);
  }
}

TEST(RecordingTimestamper, ReproducesLiveTimestamps) {
  for (const ClockChoice choice : {ClockChoice::automatic, ClockChoice::ntp, ClockChoice::arrival}) {
    const test::TemporaryFolder folder;
    const std::vector<Live> live = liveCameras(choice);
    record(folder / "drive", live);
    RecordingTimestamper clock(folder / "drive", choice);
    for (std::size_t i = 0; i < live.size(); ++i) {
      const std::optional<ExposureTimestamp> instant = clock.stamp(live[i].side, i + 1);
      ASSERT_TRUE(instant);
      EXPECT_EQ(instant->exposure_ns, live[i].unit.exposure_ns) << i;
      EXPECT_EQ(instant->exposure_stddev_ns, live[i].unit.exposure_stddev_ns) << i;
      EXPECT_EQ(instant->instant_source, live[i].unit.instant_source) << i;
    }
    EXPECT_FALSE(clock.stamp(CameraSide::left, live.size() + 1));
  }
}

TEST(RecordingTimestamper, IsIndependentOfReadingOrderOfCameras) {
  const test::TemporaryFolder folder;
  const std::vector<Live> live = liveCameras(ClockChoice::automatic);
  record(folder / "drive", live);
  SourceSettings settings;
  settings.clock = ClockChoice::automatic;
  StereoSource source = openSource(folder / "drive", settings);
  for (const CameraSide side : {CameraSide::right, CameraSide::left}) {
    CameraSource& camera = side == CameraSide::left ? *source.left : *source.right;
    for (std::size_t i = 0; i < live.size(); ++i) {
      if (live[i].side != side) continue;
      Frame frame;
      ASSERT_EQ(camera.read(frame, std::chrono::milliseconds(0)), ReadOutcome::frame);
      EXPECT_EQ(frame.exposure_ns, live[i].unit.exposure_ns);
      EXPECT_EQ(frame.min_delay_arrival_ns, live[i].unit.min_delay_arrival_ns);
      EXPECT_EQ(frame.order, i + 1);
    }
  }
}

TEST(RecordingTimestamper, UsesArrivalsOfPicturesLostFromVideo) {
  const test::TemporaryFolder folder;
  const std::vector<Live> live = liveCameras(ClockChoice::arrival);
  record(folder / "drive", live);
  std::filesystem::resize_file(folder / "drive/000000/left.mkv", 5000);
  const auto clock = std::make_shared<RecordingTimestamper>(folder / "drive", ClockChoice::arrival);
  RecordingSource source(folder / "drive", CameraSide::left, clock);
  Frame frame;
  int frames = 0;
  for (; source.read(frame, std::chrono::milliseconds(0)) == ReadOutcome::frame; ++frames)
    EXPECT_EQ(frame.exposure_ns, live[frame.order - 1].unit.exposure_ns);
  EXPECT_GT(frames, kPictures / 2);
  EXPECT_LT(frames, kPictures);
}

TEST(RecordingTimestamper, PicturesThatAreNotStampedAnewAreNamed) {
  const test::TemporaryFolder folder;
  std::vector<Live> live = liveCameras(ClockChoice::arrival);
  record(folder / "drive", live);
  live.resize(live.size() / 2);
  record(folder / "half", live);
  RecordingSource source(folder / "drive", CameraSide::left,
                         std::make_shared<RecordingTimestamper>(folder / "half", ClockChoice::arrival));
  Frame frame;
  while (source.read(frame, std::chrono::milliseconds(0)) == ReadOutcome::frame)
    continue;
  EXPECT_THAT(source.health().last_error, testing::HasSubstr(" pictures keep their recorded instants"));
}

}  // namespace

}  // namespace cartvo::capture
