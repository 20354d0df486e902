// Recordings whose description or index is not as it was written. Rows of a recording's index.
#include "capture/recording/recording_index.hpp"

#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/recording/recording_folder.hpp"
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

TEST(RecordingIndex, ParsesFormattedRow) {
  IndexRow row;
  row.number = 7;
  row.time_ms = 350;
  row.order = 15;
  row.connection = 2;
  row.sequence = 9;
  row.pts = 40500;
  row.reference_us = 1'700'000'000'123'456;
  row.first_arrival_ns = 1'700'000'000'200'000'001;
  row.arrival_ns = 1'700'000'000'210'000'001;
  row.min_delay_arrival_ns = 1'700'000'000'199'000'001;
  row.exposure_ns = 1'700'000'000'123'456'789;
  row.exposure_stddev_ns = 1'000'000;
  row.instant_source = InstantSource::sender_report;
  row.size = 4711;
  row.checksum = 0xdeadbeef;
  row.key = true;
  row.data_lost = true;
  row.status = FrameStatus::damaged;
  const std::string text = formatIndexRow(row);
  const std::optional<IndexRow> read = parseIndexRow(text);
  ASSERT_TRUE(read);
  EXPECT_EQ(formatIndexRow(*read), text);
  EXPECT_EQ(read->status, FrameStatus::damaged);
  row.reference_us.reset();
  ASSERT_TRUE(parseIndexRow(formatIndexRow(row)));
  EXPECT_EQ(parseIndexRow(formatIndexRow(row))->reference_us, std::nullopt);
}

TEST(RecordingIndex, RejectsChangedLine) {
  const std::string text = formatIndexRow(IndexRow{});
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string changed = text;
    changed[i] = changed[i] == '7' ? '8' : '7';
    EXPECT_FALSE(parseIndexRow(changed)) << changed;
  }
  EXPECT_FALSE(parseIndexRow("1,2,3"));
  EXPECT_FALSE(parseIndexRow(""));
}

TEST(RecordingIndex, RejectsTimesOutOfRange) {
  IndexRow row;
  ASSERT_TRUE(parseIndexRow(formatIndexRow(row)));
  for (std::int64_t IndexRow::*const member : std::initializer_list<std::int64_t IndexRow::*>{
           &IndexRow::pts, &IndexRow::first_arrival_ns, &IndexRow::arrival_ns,
           &IndexRow::min_delay_arrival_ns, &IndexRow::exposure_ns, &IndexRow::exposure_stddev_ns,
           &IndexRow::time_ms}) {
    IndexRow impossible = row;
    // The difference of -2^62 and 2^62 overflows.
    for (const std::int64_t instant : {INT64_MAX, INT64_MIN, -(std::int64_t{1} << 62)}) {
      impossible.*member = instant;
      EXPECT_FALSE(parseIndexRow(formatIndexRow(impossible))) << instant;
    }
  }
  row.reference_us = INT64_MAX;
  EXPECT_FALSE(parseIndexRow(formatIndexRow(row)));
}

}  // namespace
}  // namespace cartvo::capture
