// Tests of folders that are removed unless they were filled.
#include "common/files/unfinished_folder.hpp"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "support/temporary_folder.hpp"

namespace cartvo {
namespace {

namespace fs = std::filesystem;

void fill(const fs::path& folder) {
  fs::create_directory(folder / "image_0");
  std::ofstream(folder / "image_0/000000.png") << "picture";
}

TEST(UnfinishedFolder, IsRemovedWithTheFoldersMadeForIt) {
  const test::TemporaryFolder folder;
  {
    const UnfinishedFolder unfinished(folder / "a/b");
    fill(folder / "a/b");
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(UnfinishedFolder, StaysIfItIsKept) {
  const test::TemporaryFolder folder;
  {
    UnfinishedFolder unfinished(folder / "a/b");
    fill(folder / "a/b");
    unfinished.keep();
  }
  EXPECT_TRUE(fs::exists(folder / "a/b/image_0/000000.png"));
}

TEST(UnfinishedFolder, LeavesAnEmptyFolderEmpty) {
  const test::TemporaryFolder folder;
  fs::create_directory(folder / "a");
  {
    const UnfinishedFolder unfinished(folder / "a");
    fill(folder / "a");
  }
  EXPECT_TRUE(fs::is_empty(folder / "a"));
}

TEST(UnfinishedFolder, LeavesTheFilesOfAnotherFolder) {
  const test::TemporaryFolder folder;
  fill(folder.path());
  {
    const UnfinishedFolder unfinished(folder.path());
    std::ofstream(folder / "new") << "new";
  }
  EXPECT_TRUE(fs::exists(folder / "image_0/000000.png"));
}

TEST(UnfinishedFolder, DoesNotReplaceAFile) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "file") << "x";
  EXPECT_THROW(UnfinishedFolder(folder / "file"), std::runtime_error);
  EXPECT_TRUE(fs::is_regular_file(folder / "file"));
}

}  // namespace
}  // namespace cartvo
