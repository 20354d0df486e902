#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/recording_index.hpp"
#include "capture/recording_source.hpp"
#include "capture/stereo_source.hpp"
#include "capture/stream_recorder.hpp"
#include "capture/video_decoder.hpp"
#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"
#include "tests/capture/encoded_sequence.hpp"
#include "tests/capture/seen_frame.hpp"

namespace cartvo {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const cv::Size kSize(320, 200);
constexpr std::chrono::milliseconds kAtOnce{0};

using test::seen;
using test::SeenFrame;

std::vector<SeenFrame> decodedLive(const StreamFormat& format, const std::vector<EncodedUnit>& units) {
  VideoDecoder decoder(format, 1);
  std::vector<SeenFrame> frames;
  for (const EncodedUnit& unit : units) {
    decoder.send(unit);
    while (const std::optional<Frame> frame = decoder.receive())
      frames.push_back(seen(*frame));
  }
  return frames;
}

std::vector<SeenFrame> replayed(CameraSource& source) {
  std::vector<SeenFrame> frames;
  Frame frame;
  while (source.read(frame, kAtOnce) == ReadOutcome::frame)
    frames.push_back(seen(frame));
  return frames;
}

void record(const fs::path& folder, const StreamFormat& format, const std::vector<EncodedUnit>& units) {
  StreamRecorder recorder({folder, "camera: left\n", "rig: one\n"});
  for (StreamObserver* side : {&recorder.left(), &recorder.right()}) {
    side->onStream(format);
    for (const EncodedUnit& unit : units)
      side->onUnit(unit);
  }
  EXPECT_EQ(recorder.health().error, "");
  EXPECT_EQ(recorder.health().units, 2 * units.size());
}

std::vector<EncodedUnit> camera(VideoCodec codec = VideoCodec::h264) {
  std::vector<EncodedUnit> units = test::encodeSequence(codec, kSize, 45, 15, "");
  units[20].status = FrameStatus::damaged;
  units[7].instant_source = InstantSource::arrival;
  return units;
}

std::string contents(const fs::path& file) {
  std::ifstream input(file, std::ios::binary);
  std::ostringstream text;
  text << input.rdbuf();
  return text.str();
}

TEST(Recording, ReplaysTheSameFramesInstantsAndStatus) {
  for (const VideoCodec codec : {VideoCodec::h264, VideoCodec::h265}) {
    const test::TemporaryFolder folder;
    const std::vector<EncodedUnit> units = camera(codec);
    record(folder / "drive", {codec, {}}, units);
    RecordingSource source(folder / "drive", "right");
    EXPECT_EQ(replayed(source), decodedLive({codec, {}}, units));
    EXPECT_EQ(source.health().last_error, "");
    EXPECT_EQ(source.health().state, CameraState::ended);
    EXPECT_EQ(source.health().frames, units.size());
  }
}

TEST(Recording, KeepsWhatItWasGiven) {
  const test::TemporaryFolder folder;
  record(folder / "drive", {VideoCodec::h264, {}}, camera());
  const StereoSource source = openSource(folder / "drive");
  EXPECT_EQ(source.kind, SourceKind::recording);
  EXPECT_EQ(source.configuration_text, "camera: left\n");
  EXPECT_EQ(source.rig_text, "rig: one\n");
  EXPECT_EQ(readRecordingInfo(folder / "drive").software_version, CARTVO_VERSION);
}

TEST(Recording, ParameterSetsOnlyInTheSessionDescriptionAreKept) {
  const test::TemporaryFolder folder;
  std::vector<EncodedUnit> units = camera();
  StreamFormat format;
  format.parameter_sets = {units[0].data.begin(), units[0].data.begin() + 60};
  // Parameter sets come first and are short: cut them off each key picture.
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
  RecordingSource source(folder / "drive", "left");
  EXPECT_EQ(replayed(source), decodedLive(format, units));
}

TEST(Recording, APlayerOpensIt) {
  const test::TemporaryFolder folder;
  record(folder / "drive", {VideoCodec::h264, {}}, camera());
  const fs::path output = folder / "probe.txt";
  const std::string command =
      "ffprobe -v error -count_frames -show_entries stream=nb_read_frames,width,height -of csv=p=0 " +
      (folder / "drive/left.mkv").string() + " > " + output.string() + " 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(contents(output), "320,200,45\n");
}

TEST(Recording, WaitsForTheFirstKeyPicture) {
  const test::TemporaryFolder folder;
  std::vector<EncodedUnit> units = camera();
  {
    StreamRecorder recorder({folder / "drive", "", ""});
    recorder.left().onStream({VideoCodec::h264, {}});
    for (std::size_t i = 10; i < units.size(); ++i)
      recorder.left().onUnit(units[i]);
    EXPECT_EQ(recorder.health().units, 30U);
  }
  RecordingSource source(folder / "drive", "left");
  EXPECT_EQ(replayed(source).front().sequence, 15U);
}

TEST(Recording, ACutVideoReplaysUpToTheCutAndSaysSo) {
  const test::TemporaryFolder folder;
  const std::vector<EncodedUnit> units = camera();
  record(folder / "drive", {VideoCodec::h264, {}}, units);
  const fs::path video = folder / "drive/left.mkv";
  fs::resize_file(video, fs::file_size(video) / 2);
  RecordingSource source(folder / "drive", "left");
  const std::vector<SeenFrame> frames = replayed(source);
  const std::vector<SeenFrame> all = decodedLive({VideoCodec::h264, {}}, units);
  EXPECT_GT(frames.size(), 5U);
  ASSERT_LT(frames.size(), 40U);
  EXPECT_TRUE(std::equal(frames.begin(), frames.end(), all.begin()));
  EXPECT_THAT(source.health().last_error, HasSubstr("left.mkv is"));
  EXPECT_THAT(source.health().last_error,
              HasSubstr("replayed the " + std::to_string(frames.size()) + " pictures"));
}

TEST(Recording, ACutIndexReplaysUpToTheCutAndSaysSo) {
  const test::TemporaryFolder folder;
  record(folder / "drive", {VideoCodec::h264, {}}, camera());
  const fs::path index = folder / "drive/left.csv";
  fs::resize_file(index, fs::file_size(index) - 3);
  RecordingSource source(folder / "drive", "left");
  EXPECT_EQ(replayed(source).size(), 44U);
  EXPECT_THAT(source.health().last_error, HasSubstr("left.csv, line 46 is damaged or cut short"));
}

TEST(Recording, OverwrittenVideoIsNoReasonToCrash) {
  const test::TemporaryFolder folder;
  record(folder / "drive", {VideoCodec::h264, {}}, camera());
  const fs::path video = folder / "drive/left.mkv";
  {
    std::fstream file(video, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(fs::file_size(video) / 3));
    file << std::string(4000, '\x55');
  }
  RecordingSource source(folder / "drive", "left");
  const std::vector<SeenFrame> frames = replayed(source);
  EXPECT_LE(frames.size(), 45U);
}

TEST(Recording, IsThereUpToTheLastSecondWithoutAProperEnd) {
  const test::TemporaryFolder folder;
  const std::vector<EncodedUnit> units = camera();
  StreamRecorder recorder({folder / "drive", "", ""});
  recorder.left().onStream({VideoCodec::h264, {}});
  for (std::size_t i = 0; i < 30; ++i)
    recorder.left().onUnit(units[i]);
  std::this_thread::sleep_for(std::chrono::milliseconds(600));
  recorder.left().onUnit(units[30]);
  // As after kill -9: the files as they are on disk, while the recorder still holds them open.
  fs::copy(folder / "drive", folder / "after", fs::copy_options::recursive);
  RecordingSource source(folder / "after", "left");
  EXPECT_EQ(replayed(source).size(), 31U);
}

TEST(Recording, AFullDiskStopsTheRecordingWithOneMessage) {
  const test::TemporaryFolder folder;
  fs::create_directories(folder / "drive");
  fs::create_symlink("/dev/full", folder / "drive/left.mkv");
  StreamRecorder recorder({folder / "drive", "", ""});
  const std::vector<EncodedUnit> units = camera();
  recorder.left().onStream({VideoCodec::h264, {}});
  for (int round = 0; round < 40; ++round) {
    for (const EncodedUnit& unit : units)
      recorder.left().onUnit(unit);
  }
  const std::string error = recorder.health().error;
  EXPECT_THAT(error, HasSubstr("recording stopped: cannot write"));
  EXPECT_THAT(error, HasSubstr("left.mkv: No space left on device"));
  recorder.left().onUnit(units[0]);
  EXPECT_EQ(recorder.health().error, error);
}

TEST(Recording, RefusesAFolderThatHoldsOne) {
  const test::TemporaryFolder folder;
  record(folder / "drive", {VideoCodec::h264, {}}, camera());
  EXPECT_THAT(test::messageOf([&] {
                StreamRecorder({folder / "drive", "", ""});
              }),
              HasSubstr("holds a recording already"));
  EXPECT_THAT(test::messageOf([&] {
                StreamRecorder({"/proc/nowhere", "", ""});
              }),
              HasSubstr("cannot make the folder"));
}

TEST(Recording, ADamagedDescriptionIsAClearError) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "recording.json") << "{\"format_version\": 1,";
  EXPECT_THAT(test::messageOf([&] { openSource(folder.path()); }), HasSubstr("recording.json is damaged"));
  std::ofstream(folder / "recording.json")
      << R"({"format_version": 99, "software_version": "9.9", "configuration": "", "rig": ""})";
  EXPECT_THAT(test::messageOf([&] { openSource(folder.path()); }),
              HasSubstr("has format 99, but this program reads up to 1"));
}

TEST(RecordingIndex, ARowSurvivesTheRoundTrip) {
  const IndexRow row{7,
                     350,
                     9,
                     40500,
                     1700000000123456789,
                     1700000000200000001,
                     InstantSource::sender_report,
                     4711,
                     true,
                     FrameStatus::damaged};
  const std::optional<IndexRow> read = parseIndexRow(toText(row));
  ASSERT_TRUE(read);
  EXPECT_EQ(toText(*read), toText(row));
  EXPECT_EQ(read->status, FrameStatus::damaged);
  EXPECT_FALSE(parseIndexRow("1,2,3"));
  EXPECT_FALSE(parseIndexRow("7,350,9,40500,1,1,somewhere,4711,1,good"));
}

}  // namespace
}  // namespace cartvo
