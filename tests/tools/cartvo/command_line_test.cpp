// Tests of what all commands of `cartvo` share: errors of the command line, help, standard output, plots.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/command_line/terminal.hpp"
#include "support/file_text.hpp"
#include "support/temporary_folder.hpp"
#include "support/tools/run_cartvo.hpp"
#include "tools/trajectory/trajectory.hpp"

namespace cartvo {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;
namespace fs = std::filesystem;

std::string errorOf(const std::string& arguments) {
  const test::CommandResult result = test::runCartvo(arguments);
  EXPECT_EQ(result.exit_code, 2) << arguments << ": " << result.output;
  EXPECT_THAT(result.output, StartsWith("cartvo: "));
  return result.output;
}

TEST(CommandLine, NamesAnUnknownCommandAndTheNearestOne) {
  EXPECT_THAT(errorOf("replya"), HasSubstr("no command 'cartvo replya'; did you mean 'cartvo replay'?"));
  EXPECT_THAT(errorOf("recording inf x"), HasSubstr("did you mean 'cartvo recording info'?"));
  EXPECT_THAT(errorOf("calibrate baord --board chessboard:9x6:0.025"),
              HasSubstr("did you mean 'cartvo calibrate board'?"));
  EXPECT_THAT(errorOf("xyzzy"), HasSubstr("the commands are simulate, replay, export, recording"));
}

TEST(CommandLine, SaysWhereTheBenchmarksAre) {
  EXPECT_THAT(errorOf("benchmark accuracy --quick"), HasSubstr("lab/lab accuracy --help"));
}

TEST(CommandLine, NamesAnUnknownOptionBeforeAMissingOne) {
  EXPECT_THAT(errorOf("replay drive --output out"),
              HasSubstr("has no option --output; did you mean --output-dir?"));
  EXPECT_THAT(errorOf("replay drive --feature=300 --output-dir out"), HasSubstr("did you mean --features?"));
  EXPECT_THAT(errorOf("simulate --wordl turns"), HasSubstr("did you mean --world?"));
  EXPECT_THAT(errorOf("watch --bogus-option"), HasSubstr("cartvo watch has no option --bogus-option"));
}

TEST(CommandLine, ErrorNamesTheCommandWhoseHelpExplainsIt) {
  EXPECT_THAT(errorOf("recording trim drive"),
              HasSubstr("'cartvo recording trim --help' explains the command"));
}

TEST(CommandLine, RejectsValuesThatAreNone) {
  EXPECT_THAT(errorOf("replay . --output-dir out --frame-rate nan"),
              HasSubstr("--frame-rate: expected a number, found 'nan'"));
  EXPECT_THAT(errorOf("replay . --output-dir out --offset-ms 1,5"),
              HasSubstr("--offset-ms: expected a number, found '1,5'"));
  EXPECT_THAT(errorOf("replay . --output-dir ''"),
              HasSubstr("--output-dir: expected a value, found an empty"));
  EXPECT_THAT(errorOf("replay '' --output-dir out"), HasSubstr("expected a value, found an empty one"));
}

TEST(CommandLine, ExplainsThatTheCurrentFolderWasRemoved) {
  const test::TemporaryFolder folder;
  const fs::path removed = folder / "removed", kept = fs::current_path();
  fs::create_directory(removed);
  fs::current_path(removed);
  fs::remove(removed);
  const test::CommandResult result =
      test::runCartvo("replay " + folder.path().string() + " --output-dir out");
  fs::current_path(kept);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.output,
              HasSubstr("out: cannot be accessed: No such file or directory; the current folder "
                        "was removed: change to one that exists"));
}

TEST(CommandLine, RejectsReadoutsThatAreNone) {
  for (const char* readouts : {"fast", "32,", "32,38,40", "500"})
    EXPECT_THAT(errorOf("replay . --output-dir out --readout-ms " + std::string(readouts)),
                HasSubstr("expected BOTH or LEFT,RIGHT"));
}

TEST(CommandLine, HelpIsACommandToo) {
  const test::CommandResult help = test::runCartvo("help recording trim");
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_EQ(help.output, test::runCartvo("recording trim --help").output);
  EXPECT_EQ(test::runCartvo("-V").output, test::runCartvo("--version").output);
}

TEST(CommandLine, HelpFitsIntoATerminal) {
  constexpr std::size_t kColumns = 120;
  for (const char* const command : {"replay", "calibrate", "simulate", "export"}) {
    std::istringstream lines(test::runCartvo(std::string(command) + " --help").output);
    for (std::string line; std::getline(lines, line);)
      EXPECT_LE(textColumns(line), kColumns) << line;
  }
}

TEST(StandardOutput, ThatCannotBeWrittenIsAFailure) {
  if (!fs::is_character_file("/dev/full")) GTEST_SKIP() << "needs /dev/full";
  const test::TemporaryFolder folder;
  Trajectory two(2);
  two[1].time_ns = 1'000'000'000;
  two[1].pose.translation().x() = 1.0;
  const std::string file = folder / "a.tum";
  writeTum(file, two);
  for (const std::string& command :
       {"evaluate " + file + " " + file, "evaluate " + file + " " + file + " --json",
        std::string("calibrate plan --hfov 70"), std::string("replay --help"), std::string("--version")}) {
    const test::CommandResult result =
        test::runCommand(test::cartvoProgram().string() + " " + command + " 2>&1 >/dev/full");
    EXPECT_EQ(result.exit_code, 1) << command;
    EXPECT_THAT(result.output, HasSubstr("cartvo: standard output cannot be written")) << command;
  }
}

TEST(StandardOutput, ThatIsClosedIsAFailureAndNoResultFile) {
  const test::TemporaryFolder folder;
  const std::string plot = folder / "plan.svg";
  const test::CommandResult closed =
      test::runCommand(test::cartvoProgram().string() + " calibrate plan --hfov 70 --plot " + plot + " >&-");
  EXPECT_EQ(closed.exit_code, 1);
  const std::string text = test::contentsOf(plot);
  EXPECT_THAT(text, AllOf(StartsWith("<svg"), ::testing::EndsWith("</svg>\n")));
}

TEST(Plot, HasTheFormatOfItsName) {
  const test::TemporaryFolder folder;
  const std::string plan = "calibrate plan --hfov 70 --plot ";
  const auto first_bytes = [&](const std::string& name) {
    const test::CommandResult result = test::runCartvo(plan + (folder / name).string());
    EXPECT_EQ(result.exit_code, 0) << result.output;
    std::ifstream stream(folder / name, std::ios::binary);
    std::string bytes(4, '\0');
    stream.read(bytes.data(), 4);
    return bytes;
  };
  EXPECT_EQ(first_bytes("a.svg"), "<svg");
  EXPECT_EQ(first_bytes("new/folder/a.png"), "\x89PNG");
  for (const char* name : {"a.pdf", "a.jpg", "a", "a.PNG.txt"}) {
    EXPECT_THAT(errorOf(plan + (folder / name).string()),
                AllOf(HasSubstr(name), HasSubstr("a plot is written as .svg or .png")));
    EXPECT_FALSE(fs::exists(folder / name));
  }
}

}  // namespace
}  // namespace cartvo
