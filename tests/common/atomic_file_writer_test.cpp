// Tests of files that are written piece by piece: they appear when they are complete, or not at all.
#include "common/atomic_file_writer.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"

namespace cartvo {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

std::string contentsOf(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::ptrdiff_t filesIn(const fs::path& folder) {
  return std::distance(fs::directory_iterator(folder), {});
}

TEST(AtomicFileWriter, AppearsWhenItIsComplete) {
  const test::TemporaryFolder folder;
  AtomicFileWriter writer(folder / "a/b/file");
  writer.write("one ");
  {
    std::ofstream library(writer.openPath(), std::ios::app);
    library << "two";
  }
  EXPECT_FALSE(fs::exists(folder / "a/b/file"));
  writer.commit();
  EXPECT_EQ(contentsOf(folder / "a/b/file"), "one two");
  EXPECT_EQ(filesIn(folder / "a/b"), 1);
}

TEST(AtomicFileWriter, LeavesNothingIfItIsNotComplete) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "old") << "old";
  {
    AtomicFileWriter fresh(folder / "a/b/file"), replacing(folder / "old");
    fresh.write("half");
    replacing.write("half");
  }
  EXPECT_EQ(contentsOf(folder / "old"), "old");
  EXPECT_EQ(filesIn(folder.path()), 1) << "the folders that were made are gone";
}

TEST(AtomicFileWriter, ReplacesAFileBehindALinkAndKeepsItsMode) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "old") << "old";
  fs::permissions(folder / "old", fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("old", folder / "link");
  AtomicFileWriter writer(folder / "link");
  writer.write("new");
  writer.commit();
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(contentsOf(folder / "old"), "new");
  EXPECT_EQ(fs::status(folder / "old").permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(filesIn(folder.path()), 2);
}

TEST(AtomicFileWriter, RefusesWhatIsNoRegularFile) {
  const test::TemporaryFolder folder;
  const auto open = [](const fs::path& file) {
    return test::messageOf([&] { const AtomicFileWriter writer(file); });
  };
  EXPECT_THAT(open(folder.path()), HasSubstr("is a folder"));
  ASSERT_EQ(::mkfifo((folder / "fifo").c_str(), 0600), 0);
  EXPECT_THAT(open(folder / "fifo"), HasSubstr("fifo: is not a regular file"));
  std::ofstream(folder / "file") << "x";
  EXPECT_THAT(open(folder / "file/below"), HasSubstr("file/below: "));
}

}  // namespace
}  // namespace cartvo
