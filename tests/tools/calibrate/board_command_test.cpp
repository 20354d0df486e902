// The command `cartvo calibrate board`.
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/temporary_folder.hpp"
#include "support/tools/run_cartvo.hpp"

namespace cartvo {
namespace {

using ::testing::HasSubstr;

TEST(CalibrateBoardCommand, WritesABoardAndPrintsInstructions) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "board.pdf";
  const test::CommandResult run =
      test::runCartvo("calibrate board --board chessboard:9x6:0.025 --output " + file);
  EXPECT_EQ(run.exit_code, 0) << run.output;
  EXPECT_THAT(run.output, HasSubstr("chessboard:9x6:0.025, 250.0 x 175.0 mm on A4. Print it at 100 %"));
  EXPECT_TRUE(std::filesystem::exists(file));
}

TEST(CalibrateBoardCommand, PrintsJson) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "board.svg";
  const auto json = nlohmann::json::parse(
      test::pipeCartvo("calibrate board --board chessboard:9x6:0.025 --json --output " + file).output);
  EXPECT_EQ(json["output"], file);
  EXPECT_EQ(json["paper"], "A4");
  EXPECT_NEAR(json["pattern_mm"][0].get<double>(), 250.0, 1e-9);
}

TEST(CalibrateBoardCommand, RefusesBoardsThatCannotBePrinted) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "board.pdf";
  const test::CommandResult large =
      test::runCartvo("calibrate board --board charuco:11x8:0.03:0.022 --paper A4 --output " + file);
  EXPECT_EQ(large.exit_code, 1);
  EXPECT_THAT(large.output, HasSubstr("does not fit on A4"));
  const test::CommandResult unknown =
      test::runCartvo("calibrate board --board circles:4x11:0.02 --output " + file);
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_THAT(unknown.output, HasSubstr("unknown kind 'circles'"));
  EXPECT_EQ(test::runCartvo("calibrate board --output " + file).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(file));
}

}  // namespace
}  // namespace cartvo
