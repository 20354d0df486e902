// Tests of `cartvo export` as its users run it, on a small recording and on trajectory files. Tests of
// event logs of LCM, played back by LCM's own reader.
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcm/lcm-cpp.hpp>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "calib/format/rig_file.hpp"
#include "capture/codec/nal_units.hpp"
#include "capture/recording/stream_recorder.hpp"
#include "support/calib/rigs.hpp"
#include "support/error_message.hpp"
#include "support/file_text.hpp"
#include "support/temporary_folder.hpp"
#include "support/tools/exported_drive.hpp"
#include "support/tools/mcap_file.hpp"
#include "support/tools/run_cartvo.hpp"
#include "tools/export/lcm_log.hpp"
#include "tools/simulate/stream/stream_encoder.hpp"
#include "tools/trajectory/trajectory.hpp"

namespace cartvo {
namespace {

using testing::HasSubstr;

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr int kPictures = 24;
constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;

class ExportCommand : public ::testing::Test {
 protected:
  test::CommandResult run(const std::string& source, const std::string& format,
                          const std::string& output) const {
    return test::runCartvo("export " + (folder_ / source).string() + " --format " + format + " --output " +
                           (folder_ / output).string());
  }

  /// 1.2 s of two cameras at 20 Hz, with a key picture each second; no motion is found in it.
  void record() const {
    calib::Rig rig = test::rectifiedRig();
    rig.left.size = rig.right.size = {160, 96};
    rig.left.cx = rig.right.cx = 80.0;
    rig.left.cy = rig.right.cy = 48.0;
    calib::writeRig(folder_ / "rig.yaml", rig);
    capture::RecordingSettings settings;
    settings.folder = folder_ / "drive";
    settings.rig = test::contentsOf(folder_ / "rig.yaml");
    capture::StreamRecorder recorder(settings);
    simulate::StreamEncoder encoder({.bitrate_kbps = 500}, {160, 96}, 20.0);
    recorder.left().onStream({});
    recorder.right().onStream({});
    for (int i = 0; i < kPictures; ++i) {
      cv::Mat image(96, 160, CV_8UC1, cv::Scalar(60));
      cv::circle(image, {10 + 3 * i, 48}, 20, cv::Scalar(200), cv::FILLED);
      const simulate::EncodedPicture encoded = encoder.encode(image);
      capture::EncodedUnit unit;
      unit.data = encoded.data;
      unit.key = encoded.key_frame;
      unit.sequence = static_cast<std::uint64_t>(i);
      unit.pts = i * 4500;
      unit.exposure_ns = kStart_ns + i * 50'000'000;
      unit.first_arrival_ns = unit.arrival_ns = unit.exposure_ns + 20'000'000;
      recorder.left().onUnit(unit);
      recorder.right().onUnit(unit);
    }
  }

  void writeTrajectory() const {
    StampedPose pose;
    for (int i = 0; i < 3; ++i) {
      poses_.push_back(pose);
      poses_.back().time_ns = kStart_ns + i;
      pose.pose.translation().x() += 0.25;
    }
    writeTum(folder_ / "drive.tum", poses_, TrajectoryFrame::body);
  }

  test::TemporaryFolder folder_;
  mutable Trajectory poses_;
};

TEST_F(ExportCommand, CopiesThePicturesOfARecording) {
  record();
  const test::CommandResult run = this->run("drive", "mcap", "drive.mcap");
  ASSERT_EQ(run.exit_code, 0) << run.output;
  EXPECT_THAT(run.output, HasSubstr("pairs written to "));
  std::vector<std::string> pictures[2];
  std::uint64_t last = 0;
  for (const test::McapMessage& message :
       test::readMcapFile(test::contentsOf(folder_ / "drive.mcap")).messages) {
    EXPECT_GE(message.log_time, last) << "in the order of time";
    last = message.log_time;
    if (message.topic == "/left/video") pictures[0].push_back(message.data);
    if (message.topic == "/right/video") pictures[1].push_back(message.data);
  }
  for (const std::vector<std::string>& camera : pictures) {
    ASSERT_EQ(camera.size(), static_cast<std::size_t>(kPictures));
    int keys = 0;
    for (const std::string& picture : camera) {
      EXPECT_THAT(picture, AllOf(HasSubstr("_camera_optical"), HasSubstr("h264")));
      const std::vector<std::uint8_t> bytes(picture.begin(), picture.end());
      bool has_key = false;
      for (const capture::NalUnit& nal : capture::splitNalUnits(capture::VideoCodec::h264, bytes))
        has_key = has_key || nal.kind == capture::NalKind::key_slice;
      keys += has_key ? 1 : 0;
      if (!has_key) continue;
      EXPECT_FALSE(capture::parameterSets(capture::VideoCodec::h264, bytes).empty());
    }
    EXPECT_GE(keys, 2);
  }
}

TEST_F(ExportCommand, WritesEachFormatOfARecording) {
  record();
  for (const char* format : {"lcm-log", "tum", "kitti", "euroc", "csv"}) {
    const test::CommandResult run = this->run("drive", format, std::string("out/") + format);
    EXPECT_EQ(run.exit_code, 0) << format << ": " << run.output;
    EXPECT_FALSE(test::contentsOf(folder_ / "out" / format).empty()) << format;
  }
}

TEST_F(ExportCommand, WritesABagWithThePicturesOfARecording) {
  record();
  const test::CommandResult run = this->run("drive", "rosbag2-mcap", "out/bag");
  ASSERT_EQ(run.exit_code, 0) << run.output;
  const test::McapFile file = test::readMcapFile(test::contentsOf(folder_ / "out/bag/bag_0.mcap"));
  ASSERT_EQ(file.messages.size(), 2U * kPictures) << "no motion is found";
  std::uint64_t last = 0;
  for (const test::McapMessage& message : file.messages) {
    EXPECT_EQ(message.schema, "foxglove_msgs/msg/CompressedVideo");
    EXPECT_GE(message.log_time, last) << "in the order of time";
    last = message.log_time;
  }
  EXPECT_EQ(file.messages[1].topic, "/right/video");
  EXPECT_THAT(test::contentsOf(folder_ / "out/bag/metadata.yaml"), HasSubstr("message_count: 48"));
}

TEST_F(ExportCommand, ConvertsTrajectories) {
  writeTrajectory();
  for (const char* format : {"tum", "euroc"}) {
    ASSERT_EQ(run("drive.tum", format, format).exit_code, 0);
    const Trajectory read = readTrajectory(folder_ / format);
    ASSERT_EQ(read.size(), poses_.size());
    EXPECT_EQ(read.back().time_ns, poses_.back().time_ns) << format;
    EXPECT_TRUE(read.back().pose.isApprox(poses_.back().pose, 1e-8)) << format;
  }
  ASSERT_EQ(run("drive.tum", "kitti", "poses.txt").exit_code, 0);
  EXPECT_EQ(readTrajectory(folder_ / "poses.txt").size(), poses_.size());
  EXPECT_THAT(test::contentsOf(folder_ / "poses.txt"), ::testing::Not(HasSubstr("#")))
      << "KITTI's devkit reads no comments";
  EXPECT_EQ(run("drive.tum", "mcap", "drive.mcap").exit_code, 0);

  fs::create_directory(folder_ / "out");
  fs::copy(folder_ / "drive.tum", folder_ / "out/trajectory.tum");
  EXPECT_EQ(test::contentsOf(folder_ / "drive.tum"), test::contentsOf(folder_ / "tum"));
  EXPECT_EQ(run("out", "tum", "tum").exit_code, 0) << "an output folder of cartvo replay";
}

TEST_F(ExportCommand, PrintsJson) {
  record();
  writeTrajectory();
  const auto exported = [&](const std::string& source, const std::string& format) {
    return nlohmann::json::parse(test::pipeCartvo("export " + (folder_ / source).string() +
                                                  " --json --format " + format + " --output " +
                                                  (folder_ / "file").string())
                                     .output);
  };
  const std::string file = (folder_ / "file").string();
  EXPECT_EQ(exported("drive", "csv"),
            (nlohmann::json{{"output", file}, {"format", "csv"}, {"pairs", kPictures}}));
  EXPECT_EQ(exported("drive.tum", "euroc"),
            (nlohmann::json{{"output", file}, {"format", "euroc"}, {"poses", 3}}));
}

TEST_F(ExportCommand, PrintsNamesThatAreNotUtf8) {
  writeTrajectory();
  const test::CommandResult run =
      test::pipeCartvo("export " + (folder_ / "drive.tum").string() + " --json --format euroc --output '" +
                       (folder_ / "Stra\xdf"
                                  "e")
                           .string() +
                       "'");
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_EQ(nlohmann::json::parse(run.output)["output"], (folder_ / "Stra\xEF\xBF\xBD"
                                                                    "e")
                                                             .string());
}

TEST_F(ExportCommand, ReportsWhatItCannotExport) {
  writeTrajectory();
  writeKitti(folder_ / "poses.txt", poses_);
  std::ofstream(folder_ / "left.mp4") << "x";
  const auto fails = [&](const std::string& source, const std::string& format, const std::string& reason) {
    const test::CommandResult run = this->run(source, format, "new/file");
    EXPECT_EQ(run.exit_code, 1) << run.output;
    EXPECT_THAT(run.output, HasSubstr(reason));
    EXPECT_FALSE(fs::exists(folder_ / "new"));
  };
  fails("missing", "mcap", "missing: does not exist");
  fails("drive.tum", "csv", "drive.tum: is a trajectory, which has poses only");
  fails("drive.tum", "lcm-log", "drive.tum: is a trajectory, which has poses only");
  fails("drive.tum", "rosbag2-mcap", "drive.tum: is a trajectory, which has poses only");
  fails("poses.txt", "mcap", "poses.txt: is a trajectory in KITTI's format, which has no times");
  fails("left.mp4", "mcap", "left.mp4: is a video; run 'cartvo replay'");
  EXPECT_EQ(run("drive.tum", "bag", "x").exit_code, 2);
  EXPECT_THAT(run("drive.tum", "mcap", "drive.tum/x").output, HasSubstr("drive.tum"));
}

TEST(LcmLog, HasEachMessageAtItsArrival) {
  const test::TemporaryFolder folder;
  const Replay replay = *test::drivenSource().replay;
  writeLcmLog(folder / "drive.lcmlog", replay);
  lcm::LogFile log((folder / "drive.lcmlog").string(), "r");
  ASSERT_TRUE(log.good());
  std::size_t index = 0;
  for (const lcm::LogEvent* event = log.readNextEvent(); event != nullptr; event = log.readNextEvent()) {
    ASSERT_LT(index, replay.pairs.size());
    const odometry_t& expected = replay.pairs[index].message;
    EXPECT_EQ(event->channel, "CARTVO_ODOMETRY");
    EXPECT_EQ(event->timestamp, expected.arrival_utime);
    odometry_t message{};
    ASSERT_EQ(message.decode(event->data, 0, event->datalen), event->datalen);
    EXPECT_EQ(message.utime, expected.utime);
    EXPECT_EQ(message.sequence, static_cast<std::int64_t>(index));
    EXPECT_EQ(message.publication_utime, event->timestamp);
    EXPECT_GT(message.time_to_live_us, 0);
    EXPECT_EQ(message.status, expected.status);
    EXPECT_EQ(message.angular_velocity_body[2], expected.angular_velocity_body[2]);
    ++index;
  }
  EXPECT_EQ(index, replay.pairs.size());
}

TEST(LcmLog, OfAnImageFolderHasTheExposures) {
  const test::TemporaryFolder folder;
  Replay replay = *test::drivenSource().replay;
  for (ReplayedPair& pair : replay.pairs)
    pair.message.arrival_utime = 0;
  writeLcmLog(folder / "drive.lcmlog", replay);
  lcm::LogFile log((folder / "drive.lcmlog").string(), "r");
  EXPECT_EQ(log.readNextEvent()->timestamp, test::kDriveStart_ns / 1000);
}

TEST(LcmLog, IsPlayedByTheLogplayerAndRecordedByTheLogger) {
  if (test::runIsolated("true").exit_code != 0) GTEST_SKIP() << "no network namespace of its own here";
  const test::TemporaryFolder folder;
  writeLcmLog(folder / "drive.lcmlog", *test::drivenSource().replay);
  // The logger may start after the first playing, so it is repeated until the logger has recorded something.
  const test::CommandResult run = test::runIsolated(
      "cd " + folder.path().string() +
      "; lcm-logger --force --quiet --flush-interval=1 live.lcmlog >/dev/null & logger=$!; "
      "for i in $(seq 100); do lcm-logplayer drive.lcmlog; test -s live.lcmlog && break; done; "
      "kill -INT $logger; wait");
  lcm::LogFile log((folder / "live.lcmlog").string(), "r");
  ASSERT_TRUE(log.good()) << run.output;
  const lcm::LogEvent* event = log.readNextEvent();
  ASSERT_NE(event, nullptr) << run.output;
  EXPECT_EQ(event->channel, "CARTVO_ODOMETRY");
  odometry_t message{};
  EXPECT_EQ(message.decode(event->data, 0, event->datalen), event->datalen);
}

TEST(LcmLog, IsNotLeftHalfWritten) {
  std::ofstream full("/dev/full");
  if (!full) GTEST_SKIP() << "no /dev/full here";
  EXPECT_THAT(test::messageOf([] { writeLcmLog("/dev/full", *test::drivenSource().replay); }),
              HasSubstr("/dev/full: is not a regular file"));
}

}  // namespace
}  // namespace cartvo
