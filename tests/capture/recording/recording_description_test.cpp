// Recordings whose description or index is not as it was written.

#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/recording/recording_folder.hpp"
#include "capture/recording/recording_index.hpp"
#include "capture/stereo_source.hpp"
#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"

namespace cartvo::capture {
namespace {

using testing::HasSubstr;

TEST(RecordingDescription, NamesWhatIsExpectedInIt) {
  for (const char* text : {"[]", "2", "{}", R"({"format_version": 2, "software_version": 3})"}) {
    EXPECT_THAT(test::messageOf([&] { parseRecordingInfo(text, "recording.json"); }),
                HasSubstr("recording.json is damaged: expected an object with the integer format_version"))
        << text;
  }
}

TEST(RecordingDescription, IsNamedIfItIsMissing) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directory(folder / "000000");
  std::ofstream(folder / "000000/left.mkv") << "x";
  EXPECT_THAT(test::messageOf([&] { openSource(folder.path()); }),
              HasSubstr("has the parts of a recording, but no recording.json"));
}

TEST(RecordingIndex, MayHaveLineEndsOfWindows) {
  IndexRow row;
  row.number = 7;
  const std::string text = indexHeader() + "\r\n" + formatIndexRow(row);
  std::istringstream unix(indexHeader() + "\n" + formatIndexRow(row) + "\n"), windows(text + "\r\n");
  EXPECT_EQ(readRecordingIndex(unix, "left.csv").rows.size(), 1U);
  const RecordingIndex read = readRecordingIndex(windows, "left.csv");
  ASSERT_EQ(read.rows.size(), 1U) << read.damage;
  EXPECT_EQ(read.rows[0].number, 7U);
}

}  // namespace
}  // namespace cartvo::capture
