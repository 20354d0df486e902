// Tests of files that are replaced as a whole.
#include "common/atomic_file.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"

namespace cartvo {
namespace {

namespace fs = std::filesystem;

std::string contentsOf(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(AtomicFile, ReplacesTheContentsAndLeavesNoTemporaryFile) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "rig.yaml";
  writeFileAtomically(file, "old");
  writeFileAtomically(file, "new contents");
  EXPECT_EQ(contentsOf(file), "new contents");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);
}

TEST(AtomicFile, FailureNamesTheFile) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "missing" / "rig.yaml";
  EXPECT_NE(test::messageOf([&] { writeFileAtomically(file, "text"); }).find(file.string()),
            std::string::npos);
  EXPECT_FALSE(fs::exists(file));
}

}  // namespace
}  // namespace cartvo
