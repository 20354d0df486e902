// Files that are read: bounds, foreign formats, folders that were not finished.
#include "common/input_file.hpp"

#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "common/atomic_file.hpp"
#include "common/files/foreign_format.hpp"
#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"

namespace cartvo {
namespace {

namespace fs = std::filesystem;
using std::string_literals::operator""s;
using testing::HasSubstr;

constexpr std::uintmax_t kLimit = 100;

std::string textOf(const std::string& bytes) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "a.txt", std::ios::binary) << bytes;
  return readInputText(folder / "a.txt", kLimit);
}

TEST(InputFile, ReadsAFileUpToTheLimit) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "a") << std::string(kLimit, 'x');
  EXPECT_EQ(readInputFile(folder / "a", kLimit), std::string(kLimit, 'x'));
  EXPECT_THAT(test::messageOf([&] { readInputFile(folder / "a", kLimit - 1); }),
              HasSubstr("cannot be read: it is larger than 99 bytes"));
}

TEST(InputFile, RefusesWhatIsNoRegularFileWithoutWaiting) {
  const test::TemporaryFolder folder;
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_THAT(test::messageOf([&] { readInputFile(folder / "pipe", kLimit); }),
              HasSubstr("pipe: cannot be read: it is a pipe or a device; expected a file"));
  EXPECT_THAT(test::messageOf([&] { requireInputFile("/dev/zero"); }), HasSubstr("it is a pipe or a device"));
  EXPECT_THAT(test::messageOf([&] { requireInputFile(folder.path()); }), HasSubstr("it is a folder"));
  EXPECT_THAT(test::messageOf([&] { requireInputFile(folder / "no"); }),
              HasSubstr("no: cannot be read: No such file or directory"));
}

TEST(InputFile, RemovesByteOrderMarks) {
  EXPECT_EQ(textOf("1 2\n"), "1 2\n");
  EXPECT_EQ(textOf("\xEF\xBB\xBF"
                   "1 2\r\n"),
            "1 2\r\n");
  EXPECT_EQ(textOf(std::string("\xFF\xFE"
                               "1\0\xE4\0\n\0",
                               8)),
            "1\xC3\xA4\n");
  EXPECT_EQ(textOf(std::string("\xFE\xFF"
                               "\0001\x20\xAC",
                               6)),
            "1\xE2\x82\xAC");
  EXPECT_EQ(textOf(std::string("\xFE\xFF\xD8\x3D\xDE\x00\xD8\x3D", 8)), "\xF0\x9F\x98\x80\xEF\xBF\xBD");
}

class ForeignFormat : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_.path() / name, std::ios::binary) << bytes << std::string(600, '\0');
    return folder_.path() / name;
  }
  test::TemporaryFolder folder_;
};

TEST_F(ForeignFormat, IsNamedWithItsConversion) {
  const std::vector<std::array<std::string, 3>> files{{"a.bag", "#ROSBAG V2.0\n", "ROS 1 bag: "},
                                                      {"a.mcap", "\x89MCAP0\r\n", "MCAP"},
                                                      {"a.db3", "SQLite format 3\0"s, "ROS 2 bag"},
                                                      {"a.db", "SQLite format 3\0"s, "RTAB-Map"},
                                                      {"a.log", "\xed\xa1\xda\x01", "LCM log"},
                                                      {"a.zip", "PK\3\4", "unpack"},
                                                      {"a.tgz", "\x1f\x8b\x08", "unpack"},
                                                      {"a.svo", "\1\2", "ZED"},
                                                      {"a.svo2", "\x89MCAP0\r\n", "ZED"},
                                                      {"a.h5", "\x89HDF\r\n\x1a\n", "HDF5"},
                                                      {"a.tar", std::string(257, 'a') + "ustar", "unpack"},
                                                      {"a.pcap", "\xd4\xc3\xb2\xa1", "network"},
                                                      {"a.mp4", "version https://git-lfs", "git lfs pull"},
                                                      {"b.mp4", "<!DOCTYPE html>", "web page"}};
  for (const auto& [name, bytes, expected] : files)
    EXPECT_THAT(foreignFormat(write(name, bytes)), HasSubstr(expected)) << name;
}

TEST_F(ForeignFormat, OtherFilesHaveNone) {
  EXPECT_EQ(foreignFormat(write("a.yaml", "cartvo_rig: 1\n")), "");
  EXPECT_EQ(foreignFormat(write("a.mkv", "\x1a\x45\xdf\xa3")), "");
  EXPECT_EQ(foreignFormat(folder_.path()), "");
  EXPECT_EQ(foreignFormat(folder_.path() / "missing"), "");
  std::ofstream(folder_.path() / "empty.bag");
  EXPECT_EQ(foreignFormat(folder_.path() / "empty.bag"), "");
}

TEST_F(ForeignFormat, TextIsNoVideo) {
  const std::filesystem::path file = folder_.path() / "a.txt";
  for (const auto& [bytes, is_text] :
       std::vector<std::pair<std::string, bool>>{{"%YAML:1.0\n---\nimage_size: [ 320, 240 ]\n", true},
                                                 {"0.05\n0.10\r\n", true},
                                                 {"# Stra\xc3\x9f"
                                                  "e\n",
                                                  true},
                                                 {"#EXTM3U\n", false},
                                                 {"ffconcat version 1.0\n", false},
                                                 {"\x1a\x45\xdf\xa3", false},
                                                 {"", false}}) {
    std::ofstream(file, std::ios::binary) << bytes;
    EXPECT_EQ(isTextFile(file), is_text) << bytes;
  }
}

TEST_F(ForeignFormat, OfAFolderIsThatOfItsFirstLog) {
  write("a.png", "\x89PNG");
  EXPECT_EQ(foreignContents(folder_.path()), "");
  write("b_0.db3", "SQLite format 3\0"s);
  EXPECT_THAT(foreignContents(folder_.path()), HasSubstr("contains b_0.db3, which is a ROS 2 bag"));
}

TEST_F(ForeignFormat, IsSaidByReadersOfText) {
  try {
    readInputText(write("a.bag", "#ROSBAG V2.0\n"), 100);
    FAIL();
  } catch (const std::exception& error) {
    EXPECT_THAT(error.what(), HasSubstr("ROS 1 bag"));
  }
}

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
