#include "capture/stream_recorder.hpp"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "capture/recording_writer.hpp"
#include "support/error_message.hpp"
#include "support/patience.hpp"
#include "support/temporary_folder.hpp"
#include "tests/capture/recorded_units.hpp"

namespace cartvo {
namespace {

namespace fs = std::filesystem;
using test::recordedSequences;
using test::segmentNumbers;
using test::settingsFor;
using test::unitAt;
using testing::AllOf;
using testing::HasSubstr;

void recordFortyPictures(StreamRecorder& recorder) {
  recorder.left().onStream({VideoCodec::h264, {}});
  recorder.right().onStream({VideoCodec::h264, {}});
  for (int i = 0; i < 40; ++i) {
    recorder.left().onUnit(unitAt(i));
    recorder.right().onUnit(unitAt(i));
  }
}

template <typename Condition>
bool becomesTrue(const Condition& condition) {
  const auto end = std::chrono::steady_clock::now() + test::kPatience;
  while (!condition() && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return condition();
}

/// Runs the work in a process of its own; its exit code, or minus the signal that ended it.
template <typename Work>
int inAProcess(const Work& work) {
  const pid_t child = fork();
  if (child == 0) _exit(work());
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

TEST(StreamRecorder, KilledLosesAtMostTheLastSecond) {
  const test::TemporaryFolder folder;
  const int ended = inAProcess([&] {
    StreamRecorder recorder(settingsFor(folder / "drive"));
    recordFortyPictures(recorder);
    std::this_thread::sleep_for(std::chrono::milliseconds(1000));
    raise(SIGKILL);
    return 0;
  });
  EXPECT_EQ(ended, -SIGKILL);
  EXPECT_EQ(recordedSequences(folder / "drive", CameraSide::left).size(), 40U);
  EXPECT_EQ(recordedSequences(folder / "drive", CameraSide::right).size(), 40U);
  EXPECT_FALSE(isBeingWritten(folder / "drive")) << "the lock went with its process";
}

TEST(StreamRecorder, OnAFullDiskStopsWithOneMessage) {
  const test::TemporaryFolder folder;
  fs::create_directories(folder / "drive/000000");
  fs::create_symlink("/dev/full", folder / "drive/000000/left.mkv");
  StreamRecorder recorder(settingsFor(folder / "drive"));
  recorder.left().onStream({VideoCodec::h264, {}});
  for (int i = 0; i < 450; ++i)
    recorder.left().onUnit(unitAt(i));
  recorder.finish();
  const std::string error = recorder.health().error;
  EXPECT_THAT(error, HasSubstr("recording stopped: cannot write"));
  EXPECT_THAT(error, HasSubstr("left.mkv: No space left on device"));
}

constexpr int kNotAllowedHere = 77;

/// A mount namespace of this process's own. False if that is not allowed.
bool enterMountNamespace() {
  const uid_t user = getuid();
  const gid_t group = getgid();
  if (unshare(user == 0 ? CLONE_NEWNS : CLONE_NEWUSER | CLONE_NEWNS) != 0) return false;
  if (user != 0) {
    std::ofstream("/proc/self/setgroups") << "deny";
    std::ofstream("/proc/self/uid_map") << "0 " << user << " 1";
    std::ofstream("/proc/self/gid_map") << "0 " << group << " 1";
  }
  return mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0;
}

bool run(const std::string& command) {
  return std::system((command + " >/dev/null 2>&1").c_str()) == 0;
}

int recordUntilThePowerIsCut(const test::TemporaryFolder& folder) {
  const std::string image = (folder / "image").string();
  const std::string cut = (folder / "cut").string();
  fs::create_directories(folder / "disk");
  fs::create_directories(folder / "after");
  std::ofstream(image).close();
  fs::resize_file(image, 32U << 20);
  if (!enterMountNamespace() || !run("/sbin/mkfs.ext4 -q -F " + image) ||
      !run("mount -o loop " + image + " " + (folder / "disk").string())) {
    return kNotAllowedHere;
  }
  {
    StreamRecorder recorder(settingsFor(folder / "disk/drive"));
    recordFortyPictures(recorder);
    std::this_thread::sleep_for(std::chrono::milliseconds(1000));
    fs::copy_file(image, cut);  // what has reached the disk, and nothing of what the kernel holds back
  }
  if (!run("mount -o loop " + cut + " " + (folder / "after").string())) return 1;
  EXPECT_EQ(recordedSequences(folder / "after/drive", CameraSide::left).size(), 40U);
  EXPECT_EQ(recordedSequences(folder / "after/drive", CameraSide::right).size(), 40U);
  return testing::Test::HasFailure() ? 1 : 0;
}

TEST(StreamRecorder, APowerCutCostsAtMostTheLastSecond) {
  const test::TemporaryFolder folder;
  const int ended = inAProcess([&] { return recordUntilThePowerIsCut(folder); });
  if (ended == kNotAllowedHere) GTEST_SKIP() << "disk images cannot be mounted here";
  EXPECT_EQ(ended, 0);
}

/// On a disk of 300 kB.
int recordOntoASmallDisk(const fs::path& disk) {
  if (!enterMountNamespace()) return kNotAllowedHere;
  if (mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=300k") != 0) return kNotAllowedHere;
  {
    StreamRecorder recorder(settingsFor(disk / "drive"));
    recorder.left().onStream({VideoCodec::h264, {}});
    for (int i = 0; i < 4000 && recorder.health().error.empty(); ++i) {
      recorder.left().onUnit(unitAt(i));
      if (i % 15 == 14) std::this_thread::sleep_for(std::chrono::milliseconds(30));
    }
    EXPECT_THAT(recorder.health().error,
                AllOf(HasSubstr("recording stopped: cannot write"), HasSubstr("No space left on device")));
  }
  const std::vector<std::uint64_t> sequences = recordedSequences(disk / "drive", CameraSide::left);
  EXPECT_GT(sequences.size(), 15U) << "what was written before is there";
  for (std::size_t i = 0; i < sequences.size(); ++i)
    EXPECT_EQ(sequences[i], i);
  return testing::Test::HasFailure() ? 1 : 0;
}

TEST(StreamRecorder, OnADiskThatFillsUpKeepsWhatItWrote) {
  const test::TemporaryFolder folder;
  const int ended = inAProcess([&] { return recordOntoASmallDisk(folder.path()); });
  if (ended == kNotAllowedHere) GTEST_SKIP() << "no mount namespaces here";
  EXPECT_EQ(ended, 0);
}

/// Both cameras' pictures, one after another.
class TwoCameras {
 public:
  explicit TwoCameras(StreamRecorder& recorder) : recorder_(recorder) { connect(); }
  void connect() {
    recorder_.left().onStream({VideoCodec::h264, {}});
    recorder_.right().onStream({VideoCodec::h264, {}});
  }
  void send() {
    recorder_.left().onUnit(unitAt(sent_));
    recorder_.right().onUnit(unitAt(sent_++));
  }
  bool sendUntil(const std::function<bool(const RecorderHealth&)>& condition) {
    return becomesTrue([&] {
      send();
      return condition(recorder_.health());
    });
  }
  std::uint64_t sent() const { return static_cast<std::uint64_t>(sent_); }

 private:
  StreamRecorder& recorder_;
  int sent_ = 0;
};

void fillUp(const fs::path& file, std::uintmax_t but) {
  std::ofstream others(file, std::ios::binary);
  const std::string part(1U << 16, 'x');
  while (others && fs::space(file.parent_path()).available > but)
    others << part << std::flush;
}

void expectGapWithKeyPictureBehind(const std::vector<std::uint64_t>& sequences, std::uint64_t gap) {
  EXPECT_GE(sequences.size(), 20U);
  EXPECT_TRUE(std::is_sorted(sequences.begin(), sequences.end()));
  const auto behind = std::upper_bound(sequences.begin(), sequences.end(), gap);
  ASSERT_NE(behind, sequences.end()) << "what came after it is there";
  EXPECT_EQ(*behind % 15, 0U) << "from a key picture on";
}

/// On a disk of 20 MB that others fill up, with `keep_free` bytes to be left to them, and clear again.
int recordOntoADiskThatOthersFill(const fs::path& disk, std::uint64_t keep_free, const std::string& why) {
  if (!enterMountNamespace()) return kNotAllowedHere;
  if (mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=20m") != 0) return kNotAllowedHere;
  RecordingSettings settings = settingsFor(disk / "drive");
  settings.quota.keep_free_bytes = keep_free;
  settings.quota_interval = std::chrono::milliseconds(20);
  settings.room_to_begin_again = 1'000'000;
  StreamRecorder recorder(settings);
  TwoCameras cameras(recorder);
  EXPECT_TRUE(cameras.sendUntil([](const RecorderHealth& health) { return health.units >= 40; }));
  // Not wholly, if something is to be left: else whether the disk or the quota speaks first is a matter of
  // luck.
  fillUp(disk / "others", keep_free / 2);
  EXPECT_TRUE(cameras.sendUntil([](const RecorderHealth& health) { return !health.error.empty(); }));
  EXPECT_THAT(recorder.health().error, AllOf(HasSubstr("recording stopped: "), HasSubstr(why)));
  const std::uint64_t sent_at_stop = cameras.sent();
  cameras.send();
  cameras.connect();  // as a camera may meanwhile
  fs::remove(disk / "others");
  EXPECT_TRUE(cameras.sendUntil([](const RecorderHealth& health) { return health.error.empty(); }));
  EXPECT_EQ(recorder.health().resumptions, 1U);
  recorder.finish();
  EXPECT_EQ(recorder.health().error, "");
  EXPECT_THAT(segmentNumbers(disk / "drive"), testing::ElementsAre(0, 1));
  for (const CameraSide side : {CameraSide::left, CameraSide::right})
    expectGapWithKeyPictureBehind(recordedSequences(disk / "drive", side), sent_at_stop);
  return testing::Test::HasFailure() ? 1 : 0;
}

TEST(StreamRecorder, BeginsAgainInANewSegmentWhenWhatMustBeLeftFreeIsFreeAgain) {
  const test::TemporaryFolder folder;
  const int ended = inAProcess(
      [&] { return recordOntoADiskThatOthersFill(folder.path(), 5'000'000, "are kept for others"); });
  if (ended == kNotAllowedHere) GTEST_SKIP() << "no mount namespaces here";
  EXPECT_EQ(ended, 0);
}

TEST(StreamRecorder, BeginsAgainInANewSegmentOnADiskThatWasFull) {
  const test::TemporaryFolder folder;
  const int ended =
      inAProcess([&] { return recordOntoADiskThatOthersFill(folder.path(), 0, "No space left on device"); });
  if (ended == kNotAllowedHere) GTEST_SKIP() << "no mount namespaces here";
  EXPECT_EQ(ended, 0);
}

TEST(StreamRecorder, OnASlowDiskHoldsNobodyUpAndLeavesOutUpToAKeyPicture) {
  const test::TemporaryFolder folder;
  fs::create_directories(folder / "drive/000000");
  const fs::path video = folder / "drive/000000/left.mkv";
  ASSERT_EQ(mkfifo(video.c_str(), 0600), 0);  // opening it waits for a reader
  RecordingSettings settings = settingsFor(folder / "drive");
  for (int i = 0; i < 20; ++i)
    settings.queue_bytes = i == 0 ? unitAt(0).data.size() : settings.queue_bytes + unitAt(i).data.size();
  StreamRecorder recorder(settings);
  recorder.left().onStream({VideoCodec::h264, {}});
  for (int i = 0; i < 40; ++i)
    recorder.left().onUnit(unitAt(i));
  EXPECT_EQ(recorder.health().left_out, 20U) << "room for twenty, and then for no key picture";
  EXPECT_EQ(recorder.health().error, "");

  std::string received;
  std::thread disk([&] {
    std::ifstream pipe(video, std::ios::binary);
    received.assign(std::istreambuf_iterator<char>(pipe), {});
  });
  EXPECT_TRUE(becomesTrue([&] { return recorder.health().units == 20; }));
  for (int i = 40; i < 50; ++i)
    recorder.left().onUnit(unitAt(i));
  recorder.finish();
  disk.join();
  EXPECT_EQ(recorder.health().left_out, 25U) << "45 is the next key picture";
  EXPECT_EQ(recorder.health().units, 25U);
  fs::remove(video);
  std::ofstream(video, std::ios::binary) << received;
  const std::vector<std::uint64_t> sequences = recordedSequences(folder / "drive", CameraSide::left);
  ASSERT_EQ(sequences.size(), 25U);
  EXPECT_EQ(sequences[19], 19U);
  EXPECT_EQ(sequences[20], 45U);
}

TEST(StreamRecorder, RefusesAFolderThatHoldsARecordingOrCannotBeMade) {
  const test::TemporaryFolder folder;
  { const StreamRecorder recorder(settingsFor(folder / "drive")); }
  EXPECT_THAT(test::messageOf([&] { StreamRecorder(settingsFor(folder / "drive")); }),
              HasSubstr("holds a recording already"));
  EXPECT_THAT(test::messageOf([&] { StreamRecorder(settingsFor("/proc/nowhere")); }),
              HasSubstr("cannot make the folder"));
}

TEST(StreamRecorder, BeginsStoppedOnADiskWithLessRoomThanMustBeLeft) {
  const test::TemporaryFolder folder;
  RecordingSettings settings = settingsFor(folder / "drive");
  settings.quota.keep_free_bytes = std::uint64_t{1} << 60;
  StreamRecorder recorder(settings);
  EXPECT_THAT(recorder.health().error, AllOf(HasSubstr("recording stopped: only "),
                                             HasSubstr("GB are free for"), HasSubstr("are kept for others")));
  recordFortyPictures(recorder);
  recorder.finish();
  EXPECT_EQ(recorder.health().units, 0U);
}

TEST(RecordingWriter, KeepsTheSegmentThatItEndedFromTheQuotaUntilANewOneBegins) {
  const test::TemporaryFolder folder;
  {
    RecordingWriter writer(folder / "drive", {}, std::chrono::milliseconds(700));
    writer.begin(CameraSide::left, {VideoCodec::h264, {}});
    for (int i = 0; i < 45; ++i)
      writer.write(CameraSide::left, unitAt(i));
    writer.endSegment();
    EXPECT_EQ(writer.oldestOpenSegment(), 2U);
    EXPECT_TRUE(writer.write(CameraSide::left, unitAt(45))) << "a key picture";
    EXPECT_EQ(writer.oldestOpenSegment(), 3U);
  }
  EXPECT_THAT(segmentNumbers(folder / "drive"), testing::ElementsAre(0, 1, 2, 3));
  EXPECT_EQ(recordedSequences(folder / "drive", CameraSide::left).size(), 46U);
}

}  // namespace
}  // namespace cartvo
