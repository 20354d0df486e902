// Tests of the command line of `cartvo benchmark`.
#include <array>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/temporary_folder.hpp"
#include "support/test_data.hpp"
#include "support/tools/run_cartvo.hpp"

namespace cartvo {
namespace {

using ::testing::HasSubstr;

using test::CommandResult;

CommandResult runBenchmark(const std::string& arguments) {
  return test::runCartvo("benchmark " + arguments);
}

TEST(BenchmarkCommand, HelpHasExamplesAndOptions) {
  for (const char* benchmark : {"accuracy", "ablation", "offset", "sensitivity", "speed", "thesis"}) {
    const CommandResult run = runBenchmark(std::string(benchmark) + " --help");
    EXPECT_EQ(run.exit_code, 0);
    EXPECT_THAT(run.output, HasSubstr("Examples:"));
    EXPECT_THAT(run.output, HasSubstr("--format"));
  }
}

TEST(BenchmarkCommand, RejectsInvalidArguments) {
  const std::array<std::pair<const char*, const char*>, 15> wrong{{
      {"", "subcommand"},
      {"accuracy --scenarios nowhere", "nowhere"},
      {"accuracy --estimators guess", "guess"},
      {"accuracy --set both", "--set"},
      {"accuracy --format yaml", "yaml"},
      {"accuracy --bitrates-kbps 49", "--bitrates-kbps"},
      {"accuracy --features 3", "--features"},
      {"accuracy --quick --seconds 5", "--quick"},
      {"ablation --variants guess", "guess"},
      {"offset --models guess", "guess"},
      {"offset --sweeps wide", "wide"},
      {"offset --offsets-ms soon", "soon"},
      {"speed --sizes 680", "expected WIDTHxHEIGHT"},
      {"speed --sizes 680x42", "expected WIDTHxHEIGHT"},
      {"speed --pairs 5", "--pairs"},
  }};
  for (const auto& [arguments, named] : wrong) {
    const CommandResult run = runBenchmark(arguments);
    EXPECT_EQ(run.exit_code, 2) << arguments;
    EXPECT_THAT(run.output, HasSubstr(named));
  }
}

TEST(BenchmarkCommand, ReportsImpossibleRequestsBeforeTheWork) {
  for (const auto& [arguments, message] :
       {std::pair("accuracy --data /no/such/folder --scenarios none", "/no/such/folder: is no folder"),
        std::pair("accuracy --data none --scenarios none", "nothing to measure"),
        std::pair("accuracy --set tuning --scenarios rain", "scenario rain belongs to the reporting set"),
        std::pair("accuracy --set tuning --scenarios rain+lively",
                  "rain+lively belongs to the reporting set"),
        std::pair("accuracy --set reporting --seeds 1", "seed 1 belongs to the tuning set"),
        std::pair("robustness --scenarios tunnel", "give --set reporting"),
        std::pair("ablation --seeds 11", "seed 11 belongs to the reporting set"),
        std::pair("accuracy --data none --output /proc/nope/report",
                  "/proc/nope: the folder cannot be created"),
        std::pair("ablation --data none --scenarios none", "nothing to measure"),
        std::pair("offset --data none --scenarios none", "nothing to measure"),
        std::pair("robustness --data none --scenarios none", "nothing to measure"),
        std::pair("offset --data none --plot /proc/nope/plot.svg",
                  "/proc/nope: the folder cannot be created"),
        std::pair("offset --scenarios none --data . --plot plot.svg", "--plot draws rendered worlds"),
        std::pair("speed --data none --sizes none", "nothing to time"),
        std::pair("accuracy --data . --scenarios none", ".: contains no sequence"),
        std::pair("ablation --data . --scenarios none", ".: contains no sequence"),
        std::pair("offset --data . --scenarios none", ".: contains no sequence"),
        std::pair("speed --data . --sizes none", ".: contains no sequence"),
        std::pair("thesis --data .", ".: contains no sequence"),
        std::pair("thesis --data /no/such/folder", "/no/such/folder: is no folder")}) {
    const CommandResult run = runBenchmark(arguments);
    EXPECT_EQ(run.exit_code, 1) << arguments;
    EXPECT_THAT(run.output, HasSubstr(message));
  }
}

/// The JSON report of the benchmark on a data folder that contains only this sequence.
nlohmann::json reportOn(const std::filesystem::path& sequence, const std::string& arguments) {
  const test::TemporaryFolder folder;
  const std::filesystem::path data = folder / "data";
  std::filesystem::create_directory(data);
  std::filesystem::create_directory_symlink(std::filesystem::canonical(sequence), data / sequence.filename());
  const std::filesystem::path report = folder / "report.json";
  const CommandResult run =
      runBenchmark(arguments + " --json --data " + data.string() + " --output " + report.string());
  EXPECT_EQ(run.exit_code, 0) << run.output;
  std::ifstream file(report);
  return nlohmann::json::parse(file, nullptr, false);
}

TEST(BenchmarkCommand, MeasuresRealSequenceAndWritesJson) {
  CARTVO_NEEDS_DATA(sequence, "kitti_00");
  const nlohmann::json json =
      reportOn(sequence, "accuracy --scenarios none --features 300 --estimators thesis");
  EXPECT_EQ(json["benchmark"], "accuracy");
  EXPECT_EQ(json["features"], 300);
  ASSERT_EQ(json["sequences"].size(), 1u);
  EXPECT_EQ(json["sequences"][0]["sequence"], "kitti_00");
  EXPECT_EQ(json["sequences"][0]["pairs"], 21);
  EXPECT_NEAR(json["sequences"][0]["evaluation"]["path_length_m"], 17.3, 0.1);
  EXPECT_TRUE(json["summaries"].empty()) << "no world was rendered";
}

TEST(BenchmarkCommand, OffsetUsesEverySecondImageOfARealSequence) {
  CARTVO_NEEDS_DATA(sequence, "kitti_06");
  const nlohmann::json json = reportOn(
      sequence, "offset --scenarios none --models two-instants --alert-limits 100,1000,100,180");  // a car
  EXPECT_EQ(json["benchmark"], "offset");
  ASSERT_EQ(json["offsets"].size(), 2u);
  const nlohmann::json& synchronised = json["offsets"][0];
  const nlohmann::json& unsynchronised = json["offsets"][1];
  EXPECT_EQ(synchronised["offset_ms"], 0.0);
  EXPECT_NEAR(unsynchronised["offset_ms"].get<double>(), 103.8, 0.5);
  EXPECT_EQ(synchronised["pairs"], 26);
  EXPECT_EQ(unsynchronised["pairs"], 25);
  for (const nlohmann::json& one : json["offsets"]) {
    EXPECT_EQ(one["invalid"], 0);
    EXPECT_EQ(one["resets"], 0);
  }
  EXPECT_LT(unsynchronised["evaluation"]["final_drift_m"].get<double>(),
            2.0 * synchronised["evaluation"]["final_drift_m"].get<double>());
}

}  // namespace
}  // namespace cartvo
