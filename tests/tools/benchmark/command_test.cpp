// `cartvo benchmark` as people call it.
#include <array>
#include <cstdio>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "support/temporary_folder.hpp"
#include "support/test_data.hpp"

namespace cartvo {
namespace {

using ::testing::HasSubstr;

struct Finished {
  int exit_code = -1;
  std::string said;  ///< on both outputs
};

Finished runBenchmark(const std::string& arguments) {
  const std::string command = std::string(CARTVO_PROGRAM) + " benchmark " + arguments + " 2>&1";
  Finished run;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return run;
  std::array<char, 4096> part{};
  for (std::size_t count = 0; (count = fread(part.data(), 1, part.size(), pipe)) > 0;)
    run.said.append(part.data(), count);
  const int status = pclose(pipe);
  run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return run;
}

TEST(BenchmarkCommand, ExplainsItself) {
  for (const char* benchmark : {"accuracy", "thesis"}) {
    const Finished run = runBenchmark(std::string(benchmark) + " --help");
    EXPECT_EQ(run.exit_code, 0);
    EXPECT_THAT(run.said, HasSubstr("Examples:"));
    EXPECT_THAT(run.said, HasSubstr("--format"));
  }
}

TEST(BenchmarkCommand, RefusesWrongArguments) {
  const std::array<std::pair<const char*, const char*>, 7> wrong{{
      {"", "subcommand"},
      {"accuracy --scenarios nowhere", "nowhere"},
      {"accuracy --estimators guess", "guess"},
      {"accuracy --format yaml", "yaml"},
      {"accuracy --bitrates 0", "--bitrates"},
      {"accuracy --features 3", "--features"},
      {"accuracy --quick --seconds 5", "--quick"},
  }};
  for (const auto& [arguments, named] : wrong) {
    const Finished run = runBenchmark(arguments);
    EXPECT_EQ(run.exit_code, 2) << arguments;
    EXPECT_THAT(run.said, HasSubstr(named));
  }
}

TEST(BenchmarkCommand, SaysBeforeTheWorkWhatCannotBeDone) {
  for (const auto& [arguments, said] :
       {std::pair("accuracy --data /no/such/folder --scenarios none", "/no/such/folder: is no folder"),
        std::pair("accuracy --data none --scenarios none", "nothing to measure"),
        std::pair("accuracy --data none --output /no/such/folder/report",
                  "there is no folder /no/such/folder"),
        std::pair("thesis --data /no/such/folder", "/no/such/folder: is no folder")}) {
    const Finished run = runBenchmark(arguments);
    EXPECT_EQ(run.exit_code, 1) << arguments;
    EXPECT_THAT(run.said, HasSubstr(said));
  }
}

TEST(BenchmarkCommand, MeasuresARealSequenceAndWritesJson) {
  CARTVO_NEEDS_DATA(sequence, "kitti_00");
  const test::TemporaryFolder folder;
  std::filesystem::create_directory(folder / "data");
  std::filesystem::create_directory_symlink(std::filesystem::canonical(sequence), folder / "data/kitti_00");
  const std::filesystem::path report = folder / "report.json";
  const Finished run =
      runBenchmark("accuracy --scenarios none --features 300 --estimators thesis --format json --data " +
                   (folder / "data").string() + " --output " + report.string());
  EXPECT_EQ(run.exit_code, 0) << run.said;
  std::ifstream file(report);
  const nlohmann::json json = nlohmann::json::parse(file);
  EXPECT_EQ(json["benchmark"], "accuracy");
  EXPECT_EQ(json["features"], 300);
  ASSERT_EQ(json["sequences"].size(), 1u);
  EXPECT_EQ(json["sequences"][0]["sequence"], "kitti_00");
  EXPECT_EQ(json["sequences"][0]["pairs"], 21);
  EXPECT_NEAR(json["sequences"][0]["evaluation"]["path_length_m"], 17.3, 0.1);
  EXPECT_TRUE(json["summaries"].empty()) << "there was no world";
}

}  // namespace
}  // namespace cartvo
