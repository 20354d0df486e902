// Tests of MCAP files by a strict reader of the tests' own, and by the readers of other projects.
#include <iterator>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <yaml-cpp/yaml.h>

#include "common/atomic_file.hpp"
#include "support/error_message.hpp"
#include "support/file_text.hpp"
#include "support/temporary_folder.hpp"
#include "support/tools/exported_drive.hpp"
#include "support/tools/mcap_file.hpp"
#include "support/tools/run_cartvo.hpp"
#include "tools/export/export_format.hpp"
#include "tools/export/mcap/foxglove_messages.hpp"
#include "tools/export/mcap/foxglove_schemas.hpp"
#include "tools/export/mcap/mcap_writer.hpp"
#include "tools/export/ros/ros_messages.hpp"

namespace cartvo {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

void exportTo(const ExportSource& source, ExportFormat format, const fs::path& file) {
  writeExport(source, format, file, [](std::size_t) {});
}

/// The topics of the messages, in the order of the file.
std::vector<std::string> topicsOf(const test::McapFile& file) {
  std::vector<std::string> topics;
  for (const test::McapMessage& message : file.messages)
    topics.push_back(message.topic);
  return topics;
}

TEST(McapWriter, WritesSeveralChunksWithIndicesAndChecksums) {
  const test::TemporaryFolder folder;
  AtomicFileWriter file(folder / "a.mcap");
  McapWriter writer(file, "profile");
  const std::uint16_t schema = writer.addSchema("name", "encoding", "data");
  const std::uint16_t even = writer.addChannel(schema, "/even", "raw"),
                      odd = writer.addChannel(schema, "/odd", "");
  writer.addChannel(schema, "/silent", "raw");
  for (std::uint64_t i = 0; i < 50; ++i)
    writer.write(i % 2 == 0 ? even : odd, 1000 - i, i, std::string(100'000, static_cast<char>(i)));
  writer.finish();
  file.commit();
  const test::McapFile read = test::readMcapFile(test::contentsOf(folder / "a.mcap"));
  EXPECT_EQ(read.profile, "profile");
  EXPECT_EQ(read.schemas.at("name"), "encoding:data");
  EXPECT_EQ(read.chunks, 5U);
  ASSERT_EQ(read.messages.size(), 50U);
  EXPECT_EQ(read.messages[49].topic, "/odd");
  EXPECT_EQ(read.messages[49].log_time, 951U);
  EXPECT_EQ(read.messages[49].publish_time, 49U);
  EXPECT_EQ(read.messages[49].data, std::string(100'000, 49));
}

TEST(McapWriter, IsReadStrictly) {
  const test::TemporaryFolder folder;
  exportTo(test::drivenSource(), ExportFormat::mcap, folder / "a.mcap");
  const std::string bytes = test::contentsOf(folder / "a.mcap");
  EXPECT_NO_THROW(test::readMcapFile(bytes));
  for (std::size_t i = 0; i < bytes.size(); i += 97) {
    std::string altered = bytes;
    altered[i] = static_cast<char>(altered[i] ^ 0x10);
    EXPECT_ANY_THROW(test::readMcapFile(altered)) << "byte " << i;
  }
}

TEST(FoxgloveFile, HasWhatTheDriveHas) {
  const test::TemporaryFolder folder;
  exportTo(test::drivenSource(), ExportFormat::mcap, folder / "drive.mcap");
  const test::McapFile file = test::readMcapFile(test::contentsOf(folder / "drive.mcap"));
  const std::vector<std::string> topics = topicsOf(file);
  EXPECT_EQ(std::count(topics.begin(), topics.end(), "/odometry"), test::kDrivePairs - 1) << "valid pairs";
  EXPECT_EQ(std::count(topics.begin(), topics.end(), "/pose"), test::kDrivePairs);
  EXPECT_EQ(std::count(topics.begin(), topics.end(), "/tf"), 3 * test::kDrivePairs);
  EXPECT_EQ(std::count(topics.begin(), topics.end(), "/log"), 2) << "invalid, then valid";
  EXPECT_THAT(topics, Not(Contains(HasSubstr("video"))));
  EXPECT_EQ(file.messages.front().log_time, test::kDriveStart_ns / 1000 * 1000 + 40'000'000U) << "arrival";
}

TEST(FoxgloveFile, OfATrajectoryHasPosesOnly) {
  const test::TemporaryFolder folder;
  ExportSource source = test::drivenSource();
  source.replay.reset();
  exportTo(source, ExportFormat::mcap, folder / "drive.mcap");
  const test::McapFile file = test::readMcapFile(test::contentsOf(folder / "drive.mcap"));
  EXPECT_EQ(file.messages.size(), 2U * test::kDrivePairs);
  EXPECT_THAT(topicsOf(file), Not(Contains("/odometry")));
  source.poses.front().time_ns = -1;
  EXPECT_THAT(test::messageOf([&] { exportTo(source, ExportFormat::mcap, folder / "old.mcap"); }),
              HasSubstr("drive: has instants before 1970"));
  EXPECT_FALSE(fs::exists(folder / "old.mcap"));
}

TEST(RosBag, HasValidPairsOnly) {
  const test::TemporaryFolder folder;
  exportTo(test::drivenSource(), ExportFormat::rosbag2_mcap, folder / "drive");
  const test::McapFile file = test::readMcapFile(test::contentsOf(folder / "drive/drive_0.mcap"));
  EXPECT_EQ(file.profile, "ros2");
  ASSERT_EQ(file.messages.size(), 2U * (test::kDrivePairs - 1));
  EXPECT_EQ(file.messages[0].schema, "nav_msgs/msg/Odometry");
  EXPECT_EQ(file.messages[0].encoding, "cdr");
  EXPECT_EQ(file.messages[0].data.size() % 4, 0U);
  EXPECT_EQ(file.messages[1].schema, "tf2_msgs/msg/TFMessage");
}

TEST(RosBag, HasMetadataOfItsMessages) {
  const test::TemporaryFolder folder;
  exportTo(test::drivenSource(), ExportFormat::rosbag2_mcap, folder / "a 'b\"/");
  const fs::path name = "a 'b\"_0.mcap";
  const test::McapFile file = test::readMcapFile(test::contentsOf(folder / "a 'b\"" / name));
  const YAML::Node bag = YAML::LoadFile(folder / "a 'b\"/metadata.yaml")["rosbag2_bagfile_information"];
  EXPECT_EQ(bag["version"].as<int>(), 5);
  EXPECT_EQ(bag["storage_identifier"].as<std::string>(), "mcap");
  EXPECT_EQ(bag["relative_file_paths"][0].as<std::string>(), name);
  EXPECT_EQ(bag["files"][0]["path"].as<std::string>(), name);
  for (const YAML::Node& part : {bag, bag["files"][0]}) {
    EXPECT_EQ(part["message_count"].as<std::size_t>(), file.messages.size());
    const auto start = part["starting_time"]["nanoseconds_since_epoch"].as<std::uint64_t>();
    EXPECT_EQ(start, file.messages.front().log_time);
    EXPECT_EQ(start + part["duration"]["nanoseconds"].as<std::uint64_t>(), file.messages.back().log_time);
  }
  const YAML::Node topics = bag["topics_with_message_count"];
  ASSERT_EQ(topics.size(), 2U) << "no video";
  EXPECT_EQ(topics[1]["topic_metadata"]["name"].as<std::string>(), "/tf");
  EXPECT_EQ(topics[1]["topic_metadata"]["type"].as<std::string>(), "tf2_msgs/msg/TFMessage");
  EXPECT_EQ(topics[1]["topic_metadata"]["serialization_format"].as<std::string>(), "cdr");
  EXPECT_EQ(topics[1]["message_count"].as<int>(), test::kDrivePairs - 1);
}

/// Reads files with the packages of tests/support/npm.
class OtherReaders : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string tests = (test::sourceFolder() / "tests").string();
    const test::CommandResult run = test::runCommand(tests + "/support/npm/install.sh " + packages_ + " " +
                                                     tests + "/tools/export/read_mcap.mjs 2>&1");
    if (run.exit_code != 0) GTEST_SKIP() << run.output;
  }

  Json read(ExportFormat format) const {
    exportTo(test::drivenSource(), format, folder_ / "drive.mcap");
    return readFile(exportedFiles(format, folder_ / "drive.mcap").front());
  }

  Json readFile(const fs::path& file) const {
    const test::CommandResult run =
        test::runCommand("node " + packages_ + "/read_mcap.mjs " + file.string() + " 2>&1");
    EXPECT_EQ(run.exit_code, 0) << run.output;
    return run.exit_code == 0 ? Json::parse(run.output) : Json();
  }

  /// A file with one message.
  Json readMessage(const std::string& type, const std::string& schema_encoding, const std::string& schema,
                   const std::string& encoding, const std::string& message) const {
    AtomicFileWriter file(folder_ / "message.mcap");
    McapWriter writer(file, "");
    writer.write(writer.addChannel(writer.addSchema(type, schema_encoding, schema), "/topic", encoding), 1, 1,
                 message);
    writer.finish();
    file.commit();
    const Json read = readFile(folder_ / "message.mcap");
    return read.is_null() ? read : read["messages"][0]["message"];
  }

  /// The last message of a topic.
  static Json last(const Json& read, const std::string& topic) {
    Json found;
    for (const Json& message : read["messages"]) {
      if (message["topic"] == topic) found = message;
    }
    return found["message"];
  }

  test::TemporaryFolder folder_;
  std::string packages_ = CARTVO_NPM_FOLDER;
};

TEST_F(OtherReaders, ReadFoxglovesMessages) {
  const Json read = this->read(ExportFormat::mcap);
  ASSERT_FALSE(read.is_null());
  const Json odometry = last(read, "/odometry");
  EXPECT_EQ(odometry["timestamp"]["seconds"], 1'700'000'000);
  EXPECT_EQ(odometry["timestamp"]["nanos"], 523'456'789);
  EXPECT_EQ(odometry["frame_id"], "odom");
  EXPECT_EQ(odometry["body_frame_id"], "base_link");
  EXPECT_NEAR(odometry["pose"]["position"]["y"].get<double>(), 0.8, 1e-9);
  EXPECT_NEAR(odometry["pose"]["orientation"]["z"].get<double>(), M_SQRT1_2, 1e-9);
  EXPECT_EQ(odometry["linear_velocity"]["x"], 2.0);
  EXPECT_EQ(odometry["angular_velocity"]["z"], 0.4);
  EXPECT_NEAR(odometry["pose_covariance"][7].get<double>(), 0.04, 1e-12) << "in world axes";
  EXPECT_EQ(odometry["velocity_covariance"][0], 0.25);
  const Json frame = last(read, "/tf");
  EXPECT_EQ(frame["parent_frame_id"], "left_camera_optical");
  EXPECT_EQ(frame["child_frame_id"], "right_camera_optical");
  EXPECT_NEAR(frame["translation"]["x"].get<double>(), 0.12, 1e-12) << "the baseline, to the right";
  EXPECT_EQ(last(read, "/log")["message"], "odometry valid");
  EXPECT_EQ(last(read, "/log")["level"], "INFO");
}

TEST_F(OtherReaders, ReadRosMessages) {
  const Json read = this->read(ExportFormat::rosbag2_mcap);
  ASSERT_FALSE(read.is_null());
  EXPECT_EQ(read["profile"], "ros2");
  const Json odometry = last(read, "/odometry");
  EXPECT_EQ(odometry["header"]["frame_id"], "odom");
  EXPECT_EQ(odometry["child_frame_id"], "base_link");
  EXPECT_EQ(odometry["header"]["stamp"]["sec"], 1'700'000'000);
  EXPECT_NEAR(odometry["pose"]["pose"]["position"]["y"].get<double>(), 0.8, 1e-9);
  EXPECT_NEAR(odometry["pose"]["covariance"][7].get<double>(), 0.04, 1e-12);
  EXPECT_EQ(odometry["twist"]["twist"]["linear"]["x"], 2.0);
  EXPECT_EQ(odometry["twist"]["covariance"][0], 0.25);
  const Json frames = last(read, "/tf")["transforms"];
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[0]["child_frame_id"], "base_link");
  EXPECT_NEAR(frames[1]["transform"]["translation"]["z"].get<double>(), 1.5, 1e-12);
  EXPECT_EQ(frames[2]["child_frame_id"], "right_camera_optical");
}

TEST_F(OtherReaders, ReadPictures) {
  const std::vector<std::uint8_t> picture{0, 0, 0, 1, 0x65};
  const Json foxglove =
      readMessage("foxglove.CompressedVideo", "protobuf", foxgloveSchema("foxglove.CompressedVideo"),
                  "protobuf", foxgloveVideo(test::kDriveStart_ns, "camera", picture, "h264"));
  ASSERT_FALSE(foxglove.is_null());
  EXPECT_EQ(foxglove["timestamp"]["nanos"], 123'456'789);
  EXPECT_EQ(foxglove["frame_id"], "camera");
  EXPECT_EQ(foxglove["data"], "AAAAAWU=") << "base64";
  EXPECT_EQ(foxglove["format"], "h264");
  const RosType type = rosVideoType();
  const Json ros = readMessage(type.name, "ros2msg", type.definition, "cdr",
                               rosVideo(test::kDriveStart_ns, "camera", picture, "h265"));
  ASSERT_FALSE(ros.is_null());
  EXPECT_EQ(ros["timestamp"]["nanosec"], 123'456'789);
  EXPECT_EQ(ros["frame_id"], "camera");
  EXPECT_EQ(ros["data"], Json(picture));
  EXPECT_EQ(ros["format"], "h265");
}

}  // namespace
}  // namespace cartvo
