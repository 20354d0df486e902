// `cartvo replay --publish` as a controller and `cartvo watch` receive it, in a network namespace of its own.
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "calib/format/rig_file.hpp"
#include "support/calib/rigs.hpp"
#include "support/file_text.hpp"
#include "support/places.hpp"
#include "support/temporary_folder.hpp"
#include "support/tools/run_cartvo.hpp"

namespace cartvo {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

constexpr int kPairs = 12;

/// A folder of grey pairs at 10 Hz: no motion is found, but each pair is published.
void writePairs(const fs::path& folder) {
  std::ofstream times(folder / "times.txt");
  for (int i = 0; i < kPairs; ++i) {
    for (const char* camera : {"image_0", "image_1"}) {
      fs::create_directories(folder / camera);
      const std::string name = (i < 10 ? "00000" : "0000") + std::to_string(i) + ".png";
      cv::imwrite((folder / camera / name).string(), cv::Mat(480, 640, CV_8UC1, cv::Scalar(128)));
    }
    times << 0.1 * i << "\n";
  }
  calib::writeRig(folder / "rig.yaml", test::rectifiedRig());
}

bool canIsolate() {
  return test::runIsolated("true").exit_code == 0;
}

TEST(LivePublisher, PublishesAtTheRecordedPaceWithInstantsOfNow) {
  if (!canIsolate()) GTEST_SKIP() << "no network namespace of its own here";
  const test::TemporaryFolder folder;
  writePairs(folder.path());
  const std::string cartvo = test::cartvoProgram().string(), here = folder.path().string();
  const std::string url = " --url \"udpm://239.255.76.67:7668?ttl=0\"";
  const test::CommandResult run = test::runIsolated(
      "cd " + here + "; " + cartvo + " watch --json --output-dir watched --wait 60 --until-silent 2" + url +
      " >watch.json 2>watch.txt & sleep 1; " + cartvo + " replay . --output-dir out --publish --speed 0.5" +
      url + " >replay.txt 2>&1; wait");
  const std::string text = test::contentsOf(folder / "watch.json");
  ASSERT_FALSE(text.empty()) << run.output;
  const auto summary = nlohmann::json::parse(text);
  EXPECT_EQ(summary["messages"], kPairs);
  std::ifstream written(folder / "watched/summary.json");
  EXPECT_EQ(nlohmann::json::parse(written), summary);
  EXPECT_TRUE(fs::exists(folder / "watched/trajectory.tum"));
  EXPECT_EQ(summary["lost"], 0);
  EXPECT_NEAR(summary["seconds"].get<double>(), 0.2 * (kPairs - 1), 0.5) << "half the pace of 10 Hz";
  EXPECT_GE(summary["age_ms"]["p50"].get<double>(), 0.0) << "not from the future";
  EXPECT_LT(summary["age_ms"]["p50"].get<double>(), 250.0) << "as young as live messages";
}

TEST(LivePublisher, OptionsNeedPublish) {
  for (const char* option : {"--speed 2", "--loop", "--url udpm://239.255.76.67:7667?ttl=0"}) {
    const test::CommandResult run = test::runCartvo(std::string("replay x --output-dir y ") + option);
    EXPECT_EQ(run.exit_code, 2) << option;
    EXPECT_THAT(run.output, HasSubstr("--publish"));
  }
}

TEST(Watch, RequiresValidPairsForItsExitCode) {
  if (!canIsolate()) GTEST_SKIP() << "no network namespace of its own here";
  const test::TemporaryFolder folder;
  writePairs(folder.path());
  const std::string cartvo = test::cartvoProgram().string(), here = folder.path().string();
  const test::CommandResult run = test::runIsolated(
      "cd " + here + "; (sleep 1; " + cartvo + " replay . --output-dir out --publish >replay.txt 2>&1) & " +
      cartvo + " watch --plain --wait 60 --until-silent 1 --require-valid 50");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.output, HasSubstr("0.0 % of the pairs were valid, --require-valid asks for 50.0 %"));
}

}  // namespace
}  // namespace cartvo
