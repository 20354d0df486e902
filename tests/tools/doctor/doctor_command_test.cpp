// `cartvo doctor` as a user runs it.
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/temporary_folder.hpp"
#include "support/tools/run_cartvo.hpp"

namespace cartvo {
namespace {

using test::CommandResult;
using testing::HasSubstr;

TEST(DoctorCommand, CallsAMissingConfigurationBroken) {
  const test::TemporaryFolder folder;
  const CommandResult text = test::runCartvo("doctor " + (folder / "cartvod.yaml").string());
  EXPECT_EQ(text.exit_code, 4) << text.output;
  EXPECT_THAT(text.output, HasSubstr("broken       configuration: " + (folder / "cartvod.yaml").string()));
  EXPECT_THAT(text.output, HasSubstr("1 broken, "));
  const CommandResult json = test::pipeCartvo("doctor --json " + (folder / "cartvod.yaml").string());
  EXPECT_EQ(json.exit_code, 4);
  EXPECT_EQ(nlohmann::json::parse(json.output)["verdict"], "broken");
}

TEST(DoctorCommand, RefusesAReportThatCannotBeWrittenBeforeAnyCheck) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "file") << "not a folder";
  const CommandResult result =
      test::runCartvo("doctor /nonexistent.yaml --report " + (folder / "file/a.html").string());
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.output, testing::Not(HasSubstr("broken")));
}

TEST(DoctorCommand, RefusesAWrongCommandLine) {
  EXPECT_EQ(test::runCartvo("doctor --seconds 0").exit_code, 2);
  EXPECT_EQ(test::runCartvo("doctor --http-port 70000").exit_code, 2);
  EXPECT_EQ(test::runCartvo("doctor a b").exit_code, 2);
}

}  // namespace
}  // namespace cartvo
