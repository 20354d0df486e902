// Tests of drives that are recordings: written by recordFolder(), played as RecordedDrive.
#include "tools/simulate/recorded_drive.hpp"

#include <chrono>
#include <fstream>
#include <stdexcept>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "capture/recording/recording_folder.hpp"
#include "support/error_message.hpp"
#include "support/file_text.hpp"
#include "support/pattern_content.hpp"
#include "support/temporary_folder.hpp"
#include "support/tools/run_cartvo.hpp"
#include "support/tools/running_cartvo.hpp"
#include "tools/simulate/content_files.hpp"

namespace cartvo::simulate {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const EncoderSettings kEncoder{.bitrate_kbps = 400, .key_frame_interval = 0.2};

std::string errorOf(const fs::path& folder) {
  return test::messageOf([&] { const RecordedDrive drive(folder, 0.0, kEncoder); });
}

class RecordedDriveTest : public testing::Test {
 protected:
  RecordedDriveTest() { recordFolder(drive_, content_, streams_); }

  test::TemporaryFolder folder_;
  fs::path drive_ = folder_ / "drive";
  test::PatternContent content_{{.size = {128, 96}, .pairs = 12, .offset_s = 0.0125}};
  EncodedPair streams_ = encodeContent(content_, kEncoder, {});
};

TEST_F(RecordedDriveTest, IsThatWhichWasEncoded) {
  const RecordedDrive read(drive_, 0.0, kEncoder);
  EXPECT_EQ(read.rig().baseline(), content_.rig().baseline());
  EXPECT_NEAR(read.frameRate(), content_.frameRate(), 1e-6);
  ASSERT_EQ(read.pairCount(), 12);
  const EncodedPair& pair = *read.streams();
  for (int i = 0; i < 12; ++i) {
    EXPECT_EQ(read.leftInstant(i), content_.leftInstant(i));
    EXPECT_EQ(read.rightInstant(i), content_.rightInstant(i));
    const auto at = static_cast<std::size_t>(i);
    EXPECT_EQ(pair.left.units[at].key_frame, streams_.left.units[at].key_frame);
    EXPECT_THAT(pair.left.data(pair.left.units[at]),
                testing::ElementsAreArray(streams_.left.data(streams_.left.units[at])));
    EXPECT_THAT(pair.right.data(pair.right.units[at]),
                testing::ElementsAreArray(streams_.right.data(streams_.right.units[at])));
  }
  EXPECT_FALSE(pair.left.lead_in.empty());
  const Trajectory truth = content_.truth(), read_truth = read.truth();
  ASSERT_EQ(read_truth.size(), truth.size());
  EXPECT_TRUE(read_truth.back().pose.isApprox(truth.back().pose, 1e-6));
}

TEST_F(RecordedDriveTest, EndsAfterTheGivenSeconds) {
  const double seconds = 1e-9 * static_cast<double>(content_.leftInstant(5)) - 1e-6;
  EXPECT_EQ(RecordedDrive(drive_, seconds, kEncoder).pairCount(), 5);
}

TEST_F(RecordedDriveTest, IsWrittenToTheSameBytes) {
  recordFolder(folder_ / "again", content_, streams_);
  for (const auto& entry : fs::recursive_directory_iterator(drive_)) {
    if (!entry.is_regular_file()) continue;
    const fs::path relative = fs::relative(entry.path(), drive_);
    EXPECT_TRUE(test::contentsOf(entry.path()) == test::contentsOf(folder_ / "again" / relative)) << relative;
  }
}

TEST_F(RecordedDriveTest, WithoutTruthHasNone) {
  fs::remove(drive_ / "truth.tum");
  const RecordedDrive read(drive_, 0.0, kEncoder);
  EXPECT_TRUE(read.truth().empty());
  EXPECT_TRUE(read.denseTruth().empty());
}

TEST_F(RecordedDriveTest, LeavesOutDamagedPictures) {
  const fs::path index = drive_ / "000000" / "left.csv";
  fs::resize_file(index, fs::file_size(index) / 2);
  const RecordedDrive read(drive_, 0.0, kEncoder);
  EXPECT_GT(read.pairCount(), 2);
  EXPECT_LT(read.pairCount(), 12);
  EXPECT_TRUE(read.streams()->left.units.front().key_frame);
}

TEST_F(RecordedDriveTest, ErrorsNameTheProblem) {
  EXPECT_THAT(errorOf(folder_ / "none"), HasSubstr((folder_ / "none").string()));
  capture::RecordingInfo info = capture::readRecordingInfo(drive_);
  info.rig.clear();
  capture::writeRecordingInfo(drive_, info);
  EXPECT_EQ(errorOf(drive_), drive_.string() + ": the recording contains no rig");
  EXPECT_THROW(recordFolder(drive_, content_, streams_), std::runtime_error) << "it is not empty";
}

TEST_F(RecordedDriveTest, IsReplayedByCartvo) {
  const test::CommandResult run =
      test::runCartvo("replay " + drive_.string() + " --output-dir " + (folder_ / "out").string());
  EXPECT_EQ(run.exit_code, 0) << run.output;
  EXPECT_THAT(run.output, HasSubstr("12 pairs"));
}

TEST(SampleDrive, IsPlayedWithoutOptions) {
  const test::TemporaryFolder folder;
  test::RunningCartvo cartvo(
      "simulate --left-address 127.0.0.1:0 --right-address 127.0.0.1:0 --start-when-watched --output-dir " +
          (folder / "output").string(),
      folder / "text");
  while (cartvo.output().find("waiting until clients play") == std::string::npos && cartvo.isRunning())
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  cartvo.interrupt();
  EXPECT_EQ(cartvo.wait(), 0) << cartvo.output();
  std::ifstream file(folder / "output" / "cameras.json");
  EXPECT_THAT(nlohmann::json::parse(file)["content"].get<std::string>(),
              HasSubstr("share/cartvo/sample_drive"));
}

}  // namespace
}  // namespace cartvo::simulate
