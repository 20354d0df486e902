// Recordings are replayed as they were received, and as far as possible after damage.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/codec/video_decoder.hpp"
#include "capture/recording/recording_folder.hpp"
#include "capture/recording/recording_reader.hpp"
#include "capture/recording/recording_source.hpp"
#include "capture/recording/stream_recorder.hpp"
#include "capture/stereo_source.hpp"
#include "support/error_message.hpp"
#include "support/file_text.hpp"
#include "support/temporary_folder.hpp"
#include "tests/support/capture/encoded_sequence.hpp"
#include "tests/support/capture/frame_digest.hpp"

namespace cartvo::capture {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const cv::Size kSize(320, 200);
constexpr std::chrono::milliseconds kAtOnce{0};

using test::digestOf;
using test::FrameDigest;

std::vector<FrameDigest> decodedLive(const StreamFormat& format, const std::vector<EncodedUnit>& units) {
  VideoDecoder decoder(format, 1);
  std::vector<FrameDigest> frames;
  for (const EncodedUnit& unit : units) {
    decoder.send(unit);
    while (const std::optional<Frame> frame = decoder.receive())
      frames.push_back(digestOf(*frame));
  }
  return frames;
}

std::vector<FrameDigest> replayed(CameraSource& source) {
  std::vector<FrameDigest> frames;
  Frame frame;
  while (source.read(frame, kAtOnce) == ReadOutcome::frame)
    frames.push_back(digestOf(frame));
  return frames;
}

RecordingSettings settingsFor(const fs::path& folder) {
  RecordingSettings settings;
  settings.folder = folder;
  settings.configuration = "camera: left\n";
  settings.rig = "rig: one\n";
  return settings;
}

void record(const RecordingSettings& settings, const StreamFormat& format,
            const std::vector<EncodedUnit>& units) {
  StreamRecorder recorder(settings);
  recorder.left().onStream(format);
  recorder.right().onStream(format);
  for (const EncodedUnit& unit : units) {
    recorder.left().onUnit(unit);
    recorder.right().onUnit(unit);
  }
  recorder.finish();
  EXPECT_EQ(recorder.health().error, "");
  EXPECT_EQ(recorder.health().units, 2 * units.size());
}

void record(const fs::path& folder, const StreamFormat& format, const std::vector<EncodedUnit>& units) {
  record(settingsFor(folder), format, units);
}

void overwrite(const fs::path& file, std::uintmax_t from, std::size_t count) {
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  stream.seekp(static_cast<std::streamoff>(from));
  stream << std::string(count, '\x55');
}

bool isGood(const FrameDigest& frame) {
  return frame.status == FrameStatus::good;
}

std::vector<EncodedUnit> camera(VideoCodec codec = VideoCodec::h264) {
  std::vector<EncodedUnit> units = test::encodeSequence(codec, kSize, 45, 15, "");
  units[20].status = FrameStatus::damaged;
  units[7].instant_source = InstantSource::arrival;
  return units;
}

TEST(Recording, ReplaysSameFramesInstantsAndStatus) {
  for (const VideoCodec codec : {VideoCodec::h264, VideoCodec::h265}) {
    const test::TemporaryFolder folder;
    const std::vector<EncodedUnit> units = camera(codec);
    record(folder / "drive", {codec, {}}, units);
    RecordingSource source(folder / "drive", CameraSide::right);
    EXPECT_EQ(replayed(source), decodedLive({codec, {}}, units));
    EXPECT_EQ(source.health().last_error, "");
    EXPECT_EQ(source.health().state, CameraState::ended);
    EXPECT_EQ(source.health().frames, units.size());
  }
}

TEST(Recording, KeepsConfigurationAndRig) {
  const test::TemporaryFolder folder;
  record(folder / "drive", {VideoCodec::h264, {}}, camera());
  const StereoSource source = openSource(folder / "drive");
  EXPECT_EQ(source.kind, SourceKind::recording);
  EXPECT_EQ(source.rig_text, "rig: one\n");
  const RecordingInfo info = readRecordingInfo(folder / "drive");
  EXPECT_EQ(info.configuration, "camera: left\n");
  EXPECT_EQ(info.software_version, CARTVO_VERSION);
}

TEST(Recording, KeepsParameterSetsOfSessionDescription) {
  const test::TemporaryFolder folder;
  std::vector<EncodedUnit> units = camera();
  StreamFormat format;
  format.parameter_sets = {units[0].data.begin(), units[0].data.begin() + 60};
  // Parameter sets come first and are short: remove them from each key picture.
  const std::vector<std::uint8_t> slice_start = {0, 0, 1, 0x65};
  for (EncodedUnit& unit : units) {
    if (!unit.key) continue;
    const auto slice =
        std::search(unit.data.begin(), unit.data.end(), slice_start.begin(), slice_start.end());
    ASSERT_NE(slice, unit.data.end());
    if (unit.sequence == 0) format.parameter_sets.assign(unit.data.begin(), slice);
    unit.data.erase(unit.data.begin(), slice);
  }
  record(folder / "drive", format, units);
  RecordingSource source(folder / "drive", CameraSide::left);
  EXPECT_EQ(replayed(source), decodedLive(format, units));
}

TEST(Recording, CanBePlayedByFfmpeg) {
  const test::TemporaryFolder folder;
  record(folder / "drive", {VideoCodec::h264, {}}, camera());
  const fs::path output = folder / "probe.txt";
  const std::string command =
      "ffprobe -v error -count_frames -show_entries stream=nb_read_frames,width,height -of csv=p=0 " +
      (folder / "drive/000000/left.mkv").string() + " > " + output.string() + " 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(test::contentsOf(output), "320,200,45\n");
}

TEST(Recording, KeepsAttributesOfEachPicture) {
  const test::TemporaryFolder folder;
  std::vector<EncodedUnit> units = camera();
  units[3].reference_us = 1'700'000'000'123'456;
  units[3].first_arrival_ns = units[3].arrival_ns - 2'000'000;
  units[3].min_delay_arrival_ns = units[3].arrival_ns - 3'000'000;
  units[3].exposure_stddev_ns = 1'234'567;
  units[3].data_lost = true;
  record(folder / "drive", {VideoCodec::h264, {}}, units);
  RecordingReader reader(folder / "drive", CameraSide::right);
  RecordedUnit read;
  for (int i = 0; i <= 3; ++i)
    ASSERT_TRUE(reader.next(read));
  EXPECT_EQ(read.connection, 1U);
  EXPECT_EQ(read.unit.order, 8U) << "one after the left camera's";
  EXPECT_EQ(read.unit.pts, units[3].pts);
  EXPECT_EQ(read.unit.reference_us, units[3].reference_us);
  EXPECT_EQ(read.unit.first_arrival_ns, units[3].first_arrival_ns);
  EXPECT_EQ(read.unit.arrival_ns, units[3].arrival_ns);
  EXPECT_EQ(read.unit.min_delay_arrival_ns, units[3].min_delay_arrival_ns);
  EXPECT_EQ(read.unit.exposure_ns, units[3].exposure_ns);
  EXPECT_EQ(read.unit.exposure_stddev_ns, units[3].exposure_stddev_ns);
  EXPECT_TRUE(read.unit.data_lost);
  EXPECT_FALSE(read.unit.key);
}

TEST(Recording, ReplaysSegmentsAsOneSequence) {
  const test::TemporaryFolder folder;
  const std::vector<EncodedUnit> units = camera();  // 2.25 s, a key picture every 0.75 s
  RecordingSettings settings = settingsFor(folder / "drive");
  settings.segment_length = std::chrono::milliseconds(700);
  record(settings, {VideoCodec::h264, {}}, units);
  EXPECT_EQ(recordingSegments(folder / "drive").size(), 3U);
  RecordingSource source(folder / "drive", CameraSide::left);
  EXPECT_EQ(replayed(source), decodedLive({VideoCodec::h264, {}}, units));
  EXPECT_EQ(source.health().last_error, "");
}

TEST(Recording, SkipsMissingSegments) {
  const test::TemporaryFolder folder;
  const std::vector<EncodedUnit> units = camera();
  RecordingSettings settings = settingsFor(folder / "drive");
  settings.segment_length = std::chrono::milliseconds(700);
  record(settings, {VideoCodec::h264, {}}, units);
  fs::remove_all(folder / "drive/000000");
  RecordingSource source(folder / "drive", CameraSide::left);
  const std::vector<FrameDigest> frames = replayed(source);
  ASSERT_EQ(frames.size(), 30U);
  EXPECT_EQ(frames.front().sequence, 15U);
  EXPECT_EQ(source.health().last_error, "") << "the quota deletes whole segments";
}

TEST(Recording, BeginsSegmentOnChangeOfCodec) {
  const test::TemporaryFolder folder;
  std::vector<EncodedUnit> later = camera(VideoCodec::h265);
  for (EncodedUnit& unit : later) {
    unit.sequence += 45;
    unit.arrival_ns += 3'000'000'000;
    unit.exposure_ns += 3'000'000'000;
  }
  {
    StreamRecorder recorder(settingsFor(folder / "drive"));
    recorder.left().onStream({VideoCodec::h264, {}});
    for (const EncodedUnit& unit : camera())
      recorder.left().onUnit(unit);
    recorder.left().onStream({VideoCodec::h265, {}});
    for (const EncodedUnit& unit : later)
      recorder.left().onUnit(unit);
  }
  RecordingSource source(folder / "drive", CameraSide::left);
  std::vector<FrameDigest> expected = decodedLive({VideoCodec::h264, {}}, camera());
  for (const FrameDigest& frame : decodedLive({VideoCodec::h265, {}}, later))
    expected.push_back(frame);
  EXPECT_EQ(replayed(source), expected);
}

TEST(Recording, WaitsForFirstKeyPicture) {
  const test::TemporaryFolder folder;
  std::vector<EncodedUnit> units = camera();
  {
    StreamRecorder recorder(settingsFor(folder / "drive"));
    recorder.left().onStream({VideoCodec::h264, {}});
    for (std::size_t i = 10; i < units.size(); ++i)
      recorder.left().onUnit(units[i]);
    recorder.finish();
    EXPECT_EQ(recorder.health().units, 30U);
  }
  RecordingSource source(folder / "drive", CameraSide::left);
  const std::vector<FrameDigest> frames = replayed(source);
  ASSERT_FALSE(frames.empty());
  EXPECT_EQ(frames.front().sequence, 15U);
}

/// Three segments of 15 pictures, every fifth one a key picture.
class DamagedRecording : public testing::Test {
 protected:
  void SetUp() override {
    units_ = test::encodeSequence(VideoCodec::h264, kSize, 45, 5, "");
    RecordingSettings settings = settingsFor(folder_ / "drive");
    settings.segment_length = std::chrono::milliseconds(740);
    record(settings, {VideoCodec::h264, {}}, units_);
    ASSERT_EQ(recordingSegments(folder_ / "drive").size(), 3U);
    whole_ = decodedLive({VideoCodec::h264, {}}, units_);
  }

  /// Replays the left camera; each good frame must equal the recorded one.
  std::vector<FrameDigest> replay() {
    RecordingSource source(folder_ / "drive", CameraSide::left);
    std::vector<FrameDigest> frames = replayed(source);
    for (const FrameDigest& frame : frames) {
      EXPECT_TRUE(!isGood(frame) || frame == whole_.at(frame.sequence)) << frame.sequence;
    }
    error_ = source.health().last_error;
    return frames;
  }

  static bool hasGood(const std::vector<FrameDigest>& frames, std::uint64_t sequence) {
    return std::any_of(frames.begin(), frames.end(),
                       [&](const FrameDigest& f) { return f.sequence == sequence && isGood(f); });
  }

  fs::path file(const std::string& name) const { return folder_ / "drive" / name; }

  test::TemporaryFolder folder_;
  std::vector<EncodedUnit> units_;
  std::vector<FrameDigest> whole_;
  std::string error_;
};

TEST_F(DamagedRecording, ReplaysBeforeAndAfterTruncationOfVideo) {
  fs::resize_file(file("000001/left.mkv"), fs::file_size(file("000001/left.mkv")) / 2);
  const std::vector<FrameDigest> frames = replay();
  EXPECT_TRUE(hasGood(frames, 14) && hasGood(frames, 16) && hasGood(frames, 30) && hasGood(frames, 44));
  EXPECT_FALSE(hasGood(frames, 29));
  EXPECT_THAT(error_, HasSubstr("000001/left.mkv is damaged or truncated"));
  EXPECT_THAT(error_, HasSubstr("pictures cannot be read, the first at "));
}

TEST_F(DamagedRecording, ReplaysAfterOverwrittenPartOfVideo) {
  // The last cluster of the file is after the damage.
  overwrite(file("000001/left.mkv"), fs::file_size(file("000001/left.mkv")) / 3, 300);
  const std::vector<FrameDigest> frames = replay();
  EXPECT_TRUE(hasGood(frames, 14) && hasGood(frames, 15) && hasGood(frames, 30) && hasGood(frames, 44));
  EXPECT_THAT(error_, HasSubstr("000001/left.mkv is damaged"));
}

TEST_F(DamagedRecording, DetectsChangedPicture) {
  const fs::path video = file("000001/left.mkv");
  const std::string bytes = test::contentsOf(video);
  // The middle of picture 17's data, after its header.
  const std::vector<std::uint8_t>& data = units_[17].data;
  const std::string middle(data.begin() + 30, data.begin() + 60);
  const std::size_t place = bytes.find(middle);
  ASSERT_NE(place, std::string::npos);
  overwrite(video, place, 8);
  const std::vector<FrameDigest> frames = replay();
  EXPECT_EQ(frames.size(), 45U);
  EXPECT_TRUE(hasGood(frames, 16) && hasGood(frames, 20));
  EXPECT_FALSE(hasGood(frames, 17) || hasGood(frames, 19)) << "up to the next key picture";
  EXPECT_THAT(error_, HasSubstr("1 pictures differ from their checksum, the first at "));
}

TEST_F(DamagedRecording, ReplaysBeforeAndAfterTruncationOfIndex) {
  const fs::path index = file("000001/left.csv");
  fs::resize_file(index, fs::file_size(index) - 3);
  const std::vector<FrameDigest> frames = replay();
  EXPECT_TRUE(hasGood(frames, 28) && hasGood(frames, 30));
  EXPECT_FALSE(hasGood(frames, 29));
  EXPECT_THAT(error_, HasSubstr("000001/left.csv, line 16 is damaged or truncated: 1 pictures have no line"));
}

TEST_F(DamagedRecording, ReplaysAfterOverwrittenPartOfIndex) {
  overwrite(file("000001/left.csv"), 1100, 10);
  const std::vector<FrameDigest> frames = replay();
  EXPECT_TRUE(hasGood(frames, 15) && hasGood(frames, 29)) << error_;
  EXPECT_GE(frames.size(), 43U);
  EXPECT_THAT(error_, HasSubstr("left.csv, line "));
}

TEST_F(DamagedRecording, ReplaysOtherSegmentsIfFilesOfOneAreMissing) {
  fs::remove(file("000001/left.csv"));
  EXPECT_EQ(replay().size(), 30U);
  EXPECT_THAT(error_, HasSubstr("000001/left.csv: cannot be read: No such file or directory"));
  fs::remove(file("000001/left.mkv"));
  fs::remove(file("000000/left.mkv"));
  EXPECT_EQ(replay().size(), 15U);
  EXPECT_THAT(error_, HasSubstr("000000/left.mkv: cannot be read: No such file or directory"));
}

TEST_F(DamagedRecording, ReplaysOnlyIntactFramesWhereverFilesAreTruncated) {
  for (const char* name : {"000002/left.mkv", "000002/left.csv"}) {
    const std::uintmax_t size = fs::file_size(file(name));
    for (int part = 19; part >= 0; --part) {
      fs::resize_file(file(name), size * static_cast<std::uintmax_t>(part) / 20);
      const std::vector<FrameDigest> frames = replay();
      EXPECT_GE(frames.size(), 30U) << name << ", " << part;
      EXPECT_NE(error_, "") << name << ", " << part;
    }
    fs::remove_all(folder_ / "drive");
    SetUp();
  }
}

TEST_F(DamagedRecording, IsRejectedWithoutAnyPicture) {
  for (int segment = 0; segment < 3; ++segment)
    fs::resize_file(file("00000" + std::to_string(segment) + "/left.mkv"), 10);
  EXPECT_THAT(
      test::messageOf([&] { RecordingSource(folder_ / "drive", CameraSide::left); }),
      testing::AllOf(HasSubstr("contains no picture of the left camera"), HasSubstr("000000/left.mkv")));
}

TEST(Recording, RejectsDamagedDescription) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "recording.json") << "{\"format_version\": 2,";
  EXPECT_THAT(test::messageOf([&] { openSource(folder.path()); }), HasSubstr("recording.json is damaged"));
  std::ofstream(folder / "recording.json")
      << R"({"format_version": 99, "software_version": "9.9", "configuration": "", "rig": ""})";
  EXPECT_THAT(test::messageOf([&] { openSource(folder.path()); }),
              HasSubstr("has format 99, but this program reads format 2"));
}

TEST(Recording, RejectsDescriptionWithNumbersOutOfRange) {
  const auto with = [](const std::string& version, const std::string& started) {
    return test::messageOf([&] {
      parseRecordingInfo(R"({"format_version": )" + version + R"(, "started_ns": )" + started +
                             R"(, "software_version": "", "configuration": "", "rig": ""})",
                         "recording.json");
    });
  };
  EXPECT_EQ(with("2", "17"), "");
  EXPECT_THAT(with("2", "17e53"), HasSubstr("recording.json is damaged: started_ns is not an integer"));
  EXPECT_THAT(with("2", "18446744073709551615"), HasSubstr("started_ns is not an integer"));
  EXPECT_THAT(with("2", "\"17\""), HasSubstr("started_ns is not an integer"));
  EXPECT_THAT(with("2e99", "17"), HasSubstr("format_version is not an integer"));
  EXPECT_THAT(with("4294967298", "17"), HasSubstr("but this program reads format 2"));
}

}  // namespace
}  // namespace cartvo::capture
