// Tests of reading files of others: kinds of files, limits, byte order marks.
#include "common/input_file.hpp"

#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"

namespace cartvo {
namespace {

using ::testing::HasSubstr;
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

}  // namespace
}  // namespace cartvo
