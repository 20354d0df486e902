// Names of other systems' files, and their conversion.
#include "common/files/foreign_format.hpp"

#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/input_file.hpp"
#include "support/temporary_folder.hpp"

namespace cartvo {
namespace {

using std::string_literals::operator""s;
using testing::HasSubstr;

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

}  // namespace
}  // namespace cartvo
