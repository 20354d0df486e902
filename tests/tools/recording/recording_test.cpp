// Tests of `cartvo recording`: info, verify and trim on a small recording.
#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include "capture/recording/recording_source.hpp"
#include "capture/recording/stream_recorder.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_timeout.hpp"
#include "tests/support/tools/run_cartvo.hpp"
#include "tools/simulate/stream/stream_encoder.hpp"

namespace cartvo {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr int kPictures = 40;
constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;

cv::Mat picture(int index) {
  cv::Mat image(96, 160, CV_8UC1, cv::Scalar(60));
  cv::circle(image, {10 + 3 * index, 48}, 20, cv::Scalar(200), cv::FILLED);
  return image;
}

/// A recording of 2 s of two cameras at 20 Hz with a key picture each second; picture 12 of the right camera
/// is lost and the right camera reconnects at picture 20.
class RecordingCommand : public testing::Test {
 protected:
  void SetUp() override {
    capture::RecordingSettings settings;
    settings.folder = folder_ / "drive";
    settings.configuration = "cameras: {}\n";
    settings.rig = "name: roof\n";
    capture::StreamRecorder recorder(settings);
    feed(recorder);
  }

  static std::size_t lines(const std::string& file) {
    std::ifstream stream(file);
    return static_cast<std::size_t>(
        std::count(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>(), '\n'));
  }

  static void feed(capture::StreamRecorder& recorder) {
    simulate::StreamEncoder encoder({.bitrate_kbps = 500}, {160, 96}, 20.0);
    recorder.left().onStream({});
    recorder.right().onStream({});
    for (int i = 0; i < kPictures; ++i) {
      const simulate::EncodedPicture encoded = encoder.encode(picture(i));
      capture::EncodedUnit unit;
      unit.data = encoded.data;
      unit.key = encoded.key_frame;
      unit.sequence = static_cast<std::uint64_t>(i);
      unit.pts = i * 4500;
      unit.exposure_ns = kStart_ns + i * 50'000'000;
      unit.first_arrival_ns = unit.arrival_ns = unit.exposure_ns + 20'000'000;
      recorder.left().onUnit(unit);
      if (i == 12) continue;
      if (unit.key && i > 0) recorder.right().onStream({});
      unit.status = i > 12 && i < 20 ? capture::FrameStatus::damaged : capture::FrameStatus::good;
      recorder.right().onUnit(unit);
    }
  }

  test::CommandResult run(const std::string& action, const std::string& options) const {
    return test::runCartvo("recording " + action + " " + (folder_ / "drive").string() + " " + options);
  }

  nlohmann::json jsonOf(const std::string& action) const {
    return nlohmann::json::parse(
        test::pipeCartvo("recording " + action + " " + (folder_ / "drive").string() + " --json").output);
  }

  test::TemporaryFolder folder_;
};

TEST_F(RecordingCommand, InfoShowsContents) {
  const test::CommandResult text = run("info", "");
  EXPECT_EQ(text.exit_code, 0);
  EXPECT_THAT(text.output,
              AllOf(HasSubstr("format 2, by cartvo " CARTVO_VERSION), HasSubstr("2.0 s in 1 segment,"),
                    HasSubstr("160x96"), HasSubstr("H.264"), HasSubstr("arrival 100 %")));
  const nlohmann::json json = jsonOf("info");
  EXPECT_EQ(json["left"]["pictures"], 40);
  EXPECT_EQ(json["left"]["missed"], 0);
  EXPECT_EQ(json["right"]["pictures"], 39);
  EXPECT_EQ(json["right"]["missed"], 1);
  EXPECT_EQ(json["right"]["damaged"], 7);
  EXPECT_GE(json["right"]["connections"], 2);
  EXPECT_NEAR(json["right"]["frame_rate"].get<double>(), 20.0, 0.01);
  EXPECT_EQ(json["being_written"], false);
}

TEST_F(RecordingCommand, InfoReportsInterruptedRecordingAndMaximumLoss) {
  EXPECT_THAT(run("info", "").output, Not(HasSubstr("NOT ENDED")));
  EXPECT_TRUE(jsonOf("info")["unended"].empty());

  const std::string cut = (folder_ / "cut").string();
  const pid_t child = fork();
  if (child == 0) {
    capture::StreamRecorder recorder({.folder = cut, .configuration = "", .rig = ""});
    feed(recorder);
    const auto end = std::chrono::steady_clock::now() + test::kTestTimeout;
    while (lines(cut + "/000000/left.csv") + lines(cut + "/000000/right.csv") < 81 &&
           std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    raise(SIGKILL);
  }
  waitpid(child, nullptr, 0);
  const test::CommandResult text = test::runCartvo("recording info " + cut);
  EXPECT_EQ(text.exit_code, 0);
  EXPECT_THAT(text.output, AllOf(HasSubstr("2.0 s in 1 segment,"),
                                 HasSubstr("NOT ENDED: 000000/left.mkv has no trailer, as after a power cut"),
                                 HasSubstr("NOT ENDED: 000000/right.mkv"),
                                 HasSubstr("its last picture is from 2023-11-14 22:13:21 UTC; at most 1.0 s "
                                           "before the interruption are lost")));
  const auto json = nlohmann::json::parse(test::runCartvo("recording info --json " + cut).output);
  ASSERT_EQ(json["unended"].size(), 2U);
  EXPECT_EQ(json["unended"][1]["camera"], "right");
  EXPECT_EQ(json["unended"][1]["segment"], 0);
  EXPECT_EQ(json["unended"][1]["last_arrival_ns"], kStart_ns + 39 * 50'000'000 + 20'000'000);
  EXPECT_EQ(json["unended"][1]["most_lost_s"], 1.0);
}

TEST_F(RecordingCommand, VerifyDetectsDamage) {
  const test::CommandResult whole = run("verify", "");
  EXPECT_EQ(whole.exit_code, 0);
  EXPECT_THAT(whole.output,
              AllOf(HasSubstr("left: 40 pictures decoded, 0 of them damaged; 0 lost, 0 altered"),
                    HasSubstr("whole")));
  const std::filesystem::path video = folder_ / "drive/000000/right.mkv";
  std::filesystem::resize_file(video, std::filesystem::file_size(video) / 2);
  const test::CommandResult damaged = run("verify", "");
  EXPECT_EQ(damaged.exit_code, 1);
  EXPECT_THAT(damaged.output,
              AllOf(HasSubstr("000000/right.mkv is damaged or truncated"), HasSubstr("DAMAGED")));
  const nlohmann::json json = jsonOf("verify");
  EXPECT_EQ(json["whole"], false);
  EXPECT_EQ(json["left"]["lost"], 0);
  EXPECT_GT(json["right"]["lost"], 0);
}

TEST_F(RecordingCommand, TrimCopiesPartUnchanged) {
  const std::string output = (folder_ / "part").string();
  const test::CommandResult trimmed = run("trim", "--from 1.2 --to 1.6 --output-dir " + output);
  EXPECT_EQ(trimmed.exit_code, 0) << trimmed.output;
  std::vector<std::uint64_t> sequences;
  capture::RecordingSource source(output, capture::CameraSide::left);
  capture::Frame frame;
  while (source.read(frame, std::chrono::milliseconds(0)) == capture::ReadOutcome::frame) {
    sequences.push_back(frame.sequence);
    EXPECT_EQ(frame.exposure_ns, kStart_ns + static_cast<std::int64_t>(frame.sequence) * 50'000'000);
    EXPECT_EQ(frame.status, capture::FrameStatus::good);
  }
  ASSERT_FALSE(sequences.empty());
  EXPECT_LE(sequences.front(), 24U) << "starts at a key picture";
  EXPECT_EQ(sequences.back(), 32U);
  EXPECT_EQ(source.health().last_error, "");
  EXPECT_EQ(test::runCartvo("recording verify " + output).exit_code, 0);
  EXPECT_THAT(run("trim", "--output-dir " + output).output, HasSubstr("already contains a recording"));
}

TEST_F(RecordingCommand, TrimTakesMinutesAndStatesWhatItCopied) {
  const test::CommandResult trimmed =
      run("trim", "--from 0:01.2 --to 0:00:01.6 --output-dir " + (folder_ / "part").string());
  EXPECT_EQ(trimmed.exit_code, 0) << trimmed.output;
  EXPECT_THAT(trimmed.output,
              ::testing::ContainsRegex("right pictures, [01]\\.[0-9] to 1\\.6 s, written to"));
  for (const char* time : {"1:60", "-1", "nan", "1:2:3:4", "1:-2", ":", "1e400"}) {
    const test::CommandResult wrong = run("trim", std::string("--from=") + time + " --output-dir x");
    EXPECT_EQ(wrong.exit_code, 2) << time;
    EXPECT_THAT(wrong.output, HasSubstr("is no time, such as 90, 1.5 or 1:30")) << time;
  }
}

TEST_F(RecordingCommand, TrimPrintsJson) {
  const std::string output = (folder_ / "part").string();
  const auto json =
      nlohmann::json::parse(run("trim", "--from 1.2 --to 1.6 --json --output-dir " + output).output);
  EXPECT_EQ(json["output"], output);
  EXPECT_GT(json["left"]["pictures"].get<int>(), 0);
  EXPECT_GT(json["right"]["pictures"].get<int>(), 0);
  EXPECT_LE(json["to_s"].get<double>(), 1.6);
}

TEST_F(RecordingCommand, TrimPrintsPlainLinesOfProgressIntoPipes) {
  const std::string output = test::runWithAllProgress("recording trim " + (folder_ / "drive").string() +
                                                      " --output-dir " + (folder_ / "part").string())
                                 .output;
  EXPECT_THAT(output, HasSubstr("] 1/79 pictures, "));
  EXPECT_THAT(output, testing::ContainsRegex("79/79 pictures, [0-9.]+/s, 0:00 left\n"));
  EXPECT_THAT(output, Not(HasSubstr("\033")));
}

TEST_F(RecordingCommand, FailedTrimLeavesNothingBehind) {
  const std::filesystem::path output = folder_ / "part";
  const test::CommandResult failed =
      test::runCommand("trap '' XFSZ; ulimit -f 4; " + test::cartvoProgram().string() + " recording trim " +
                       (folder_ / "drive").string() + " --output-dir " + output.string() + " 2>&1");
  EXPECT_EQ(failed.exit_code, 1) << failed.output;
  EXPECT_FALSE(std::filesystem::exists(output));
  EXPECT_EQ(run("trim", "--output-dir " + output.string()).exit_code, 0);
}

TEST_F(RecordingCommand, TrimRefusesAFolderWithOtherFiles) {
  std::filesystem::create_directory(folder_ / "photos");
  std::ofstream(folder_ / "photos/cat.jpg") << "cat";
  EXPECT_THAT(run("trim", "--output-dir " + (folder_ / "photos").string()).output, HasSubstr("is not empty"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "photos/cat.jpg"));
}

TEST_F(RecordingCommand, RejectsInvalidArguments) {
  EXPECT_EQ(test::runCartvo("recording").exit_code, 2);
  EXPECT_EQ(test::runCartvo("recording trim x").exit_code, 2);
  EXPECT_EQ(run("trim", "--from 2 --to 1 --output-dir x").exit_code, 2);
  EXPECT_EQ(test::runCartvo("recording info /nowhere").exit_code, 1);
  const test::CommandResult late = run("trim", "--from 100 --output-dir " + (folder_ / "late").string());
  EXPECT_EQ(late.exit_code, 1);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "late"));
}

}  // namespace
}  // namespace cartvo
