// Tests of the cache of encoded streams: round trip, damaged files, limit.
#include "tools/simulate/stream/stream_cache.hpp"

#include <chrono>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "support/temporary_folder.hpp"
#include "tools/simulate/stream/stream_file.hpp"

namespace cartvo::simulate {
namespace {

namespace fs = std::filesystem;

EncodedStream smallStream(std::uint8_t value) {
  EncodedStream stream;
  stream.size = {160, 120};
  stream.frame_rate = 18.0;
  stream.bytes.assign(1000, value);
  stream.lead_in = {{.instant_ns = 0, .begin = 0, .size = 400, .key_frame = true}};
  stream.units = {{.instant_ns = 7, .begin = 400, .size = 600, .key_frame = true}};
  return stream;
}

EncodedPair smallPair() {
  return {.left = smallStream(1), .right = smallStream(2)};
}

TEST(StreamCache, LoadsTheStoredStreams) {
  const test::TemporaryFolder folder;
  const StreamCache cache(folder / "cache", 1'000'000);
  EXPECT_FALSE(cache.load("drive"));
  cache.store("drive", smallPair());
  EXPECT_EQ(cache.load("drive"), smallPair());
  EXPECT_FALSE(cache.load("another drive"));
}

TEST(StreamCache, RemovesDamagedFile) {
  const test::TemporaryFolder folder;
  const StreamCache cache(folder.path(), 1'000'000);
  const fs::path file = cache.fileFor("drive");
  for (const int position : {0, 60, 900, -3}) {
    cache.store("drive", smallPair());
    std::fstream(file, std::ios::in | std::ios::out | std::ios::binary)
        .seekp(position, position < 0 ? std::ios::end : std::ios::beg)
        .put('\x7f');
    EXPECT_FALSE(cache.load("drive")) << "byte " << position;
    EXPECT_FALSE(fs::exists(file));
  }
  cache.store("drive", smallPair());
  fs::resize_file(file, 700);
  EXPECT_FALSE(cache.load("drive"));
}

TEST(StreamCache, RemovesLeastRecentlyUsedFiles) {
  const test::TemporaryFolder folder;
  const StreamCache cache(folder.path(), 2 * streamFileContents(smallPair(), "1").size() + 10);
  const auto age = [&cache](const char* key, int hours) {
    fs::last_write_time(cache.fileFor(key), fs::file_time_type::clock::now() - std::chrono::hours(hours));
  };
  cache.store("1", smallPair());
  age("1", 3);
  cache.store("2", smallPair());
  age("2", 2);
  EXPECT_TRUE(cache.load("1"));  // now 2 is the least recently used
  cache.store("3", smallPair());
  EXPECT_TRUE(cache.load("1"));
  EXPECT_FALSE(cache.load("2"));
  EXPECT_TRUE(cache.load("3"));
}

TEST(StreamCache, RendersADriveOnceAndRemovesTheLeastRecentlyUsedOne) {
  const test::TemporaryFolder folder;
  const StreamCache cache(folder.path(), 10'000);
  int rendered = 0;
  const auto render = [&rendered](const fs::path& path) {
    ++rendered;
    fs::create_directories(path / "image_0");
    std::ofstream(path / "image_0" / "000000.png") << std::string(8000, 'x');
  };
  const fs::path drive = cache.driveFolder("drive", render);
  EXPECT_EQ(cache.driveFolder("drive", render), drive);
  EXPECT_EQ(rendered, 1);
  EXPECT_TRUE(fs::exists(drive / "image_0" / "000000.png"));

  fs::last_write_time(drive, fs::file_time_type::clock::now() - std::chrono::hours(1));
  cache.store("streams", smallPair());
  EXPECT_FALSE(fs::exists(drive)) << "8000 bytes and those of the streams are too many";
  EXPECT_TRUE(cache.load("streams"));
}

}  // namespace
}  // namespace cartvo::simulate
