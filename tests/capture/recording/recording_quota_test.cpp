// Deletion of old segments.

#include <chrono>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/recording/recording_folder.hpp"
#include "capture/recording/recording_writer.hpp"
#include "support/temporary_folder.hpp"
#include "tests/support/capture/recorded_units.hpp"

namespace cartvo::capture {
namespace {

namespace fs = std::filesystem;
using test::recordedSequences;
using test::segmentNumbers;
using test::unitAt;
using testing::HasSubstr;

/// Two recordings of three segments each.
class RecordingQuotaTest : public testing::Test {
 protected:
  void SetUp() override {
    for (const fs::path& recording : {old_, latest_}) {
      RecordingSettings settings = test::settingsFor(recording);
      settings.segment_length = std::chrono::milliseconds(700);
      StreamRecorder recorder(settings);
      recorder.left().onStream({VideoCodec::h264, {}});
      recorder.right().onStream({VideoCodec::h264, {}});
      for (int i = 0; i < 45; ++i) {
        recorder.left().onUnit(unitAt(i));
        recorder.right().onUnit(unitAt(i));
      }
    }
    quota_.recordings = folder_.path();
  }

  static std::uint64_t bytesIn(const fs::path& folder) {
    std::uint64_t bytes = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
      bytes += entry.is_regular_file() && entry.path().extension() != ".json" ? entry.file_size() : 0;
    return bytes;
  }

  test::TemporaryFolder folder_;
  const fs::path old_ = folder_ / "2026-01-01T00-00-00Z";
  const fs::path latest_ = folder_ / "2026-01-02T00-00-00Z";
  RecordingQuota quota_;
};

TEST_F(RecordingQuotaTest, DeletesOnlyAsManyOldestSegmentsAsNeeded) {
  quota_.maximum_bytes = bytesIn(folder_.path());
  EXPECT_EQ(enforceQuota(quota_, latest_, 2).deleted_segments, 0U);
  quota_.maximum_bytes -= 1;
  const std::uint64_t before = bytesIn(folder_.path());
  const QuotaOutcome outcome = enforceQuota(quota_, latest_, 2);
  EXPECT_EQ(outcome.deleted_segments, 1U);
  EXPECT_EQ(outcome.deleted_bytes, before - bytesIn(folder_.path()));
  EXPECT_THAT(segmentNumbers(old_), testing::ElementsAre(1, 2));
  EXPECT_EQ(recordedSequences(old_, CameraSide::left).size(), 30U);
}

TEST_F(RecordingQuotaTest, KeepsOpenSegmentsAndDeletesEmptyRecordings) {
  quota_.maximum_bytes = 1;
  enforceQuota(quota_, latest_, 1);
  EXPECT_THAT(segmentNumbers(latest_), testing::ElementsAre(1, 2));
  EXPECT_FALSE(fs::exists(old_));
}

TEST_F(RecordingQuotaTest, KeepsRecordingOfAnotherWriter) {
  const RecordingWriter other(folder_ / "2025", {}, std::chrono::seconds(60));
  fs::rename(old_ / "000000", folder_ / "2025/000000");
  quota_.maximum_bytes = 1;
  enforceQuota(quota_, latest_, 3);
  EXPECT_THAT(segmentNumbers(folder_ / "2025"), testing::ElementsAre(0));
}

TEST_F(RecordingQuotaTest, DeletesSegmentsBeyondMaximumAge) {
  for (const char* file : {"left.mkv", "left.csv", "right.mkv", "right.csv"})
    fs::last_write_time(old_ / "000000" / file, fs::file_time_type::clock::now() - std::chrono::hours(25));
  quota_.maximum_age = std::chrono::hours(24);
  EXPECT_EQ(enforceQuota(quota_, latest_, 3).deleted_segments, 1U);
  EXPECT_THAT(segmentNumbers(old_), testing::ElementsAre(1, 2));
}

TEST_F(RecordingQuotaTest, FreesDiskSpaceAndReportsShortage) {
  quota_.keep_free_bytes = std::uint64_t{1} << 60;
  const QuotaOutcome outcome = enforceQuota(quota_, latest_, 2);
  EXPECT_EQ(outcome.deleted_segments, 5U);
  EXPECT_THAT(outcome.shortage, HasSubstr("must be kept free"));
}

TEST_F(RecordingQuotaTest, KeepsFilesThatBelongToNoSegment) {
  std::ofstream(folder_ / "notes.txt") << "mine";
  std::ofstream(old_ / "000001/notes.txt") << "mine";
  fs::create_directories(folder_ / "other/000000");
  std::ofstream(folder_ / "other/000000/left.mkv") << "mine";
  const test::TemporaryFolder elsewhere;
  fs::rename(latest_ / "000000", elsewhere / "kept");
  fs::create_symlink(elsewhere / "kept", latest_ / "000000");
  quota_.maximum_bytes = 1;
  enforceQuota(quota_, folder_ / "3000", 0);
  EXPECT_TRUE(fs::exists(folder_ / "notes.txt"));
  EXPECT_TRUE(fs::exists(old_ / "000001/notes.txt"));
  EXPECT_TRUE(fs::exists(folder_ / "other/000000/left.mkv"));
  EXPECT_TRUE(fs::exists(elsewhere / "kept/left.mkv"));
}

TEST_F(RecordingQuotaTest, DeletesNothingWithoutFolder) {
  quota_.recordings.clear();
  quota_.maximum_bytes = 1;
  EXPECT_EQ(enforceQuota(quota_, latest_, 3).deleted_segments, 0U);
}

}  // namespace
}  // namespace cartvo::capture
