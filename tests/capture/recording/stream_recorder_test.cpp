// Recording under kills, power cuts, and full and slow disks.

#include "capture/recording/stream_recorder.hpp"

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
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "capture/recording/recording_writer.hpp"
#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_timeout.hpp"
#include "tests/support/capture/recorded_units.hpp"

namespace cartvo::capture {
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
bool waitUntil(const Condition& condition) {
  const auto end = std::chrono::steady_clock::now() + test::kTestTimeout;
  while (!condition() && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return condition();
}

/// Runs `work` in a child process. Returns its exit code, or minus the signal that ended it.
template <typename Work>
int runInChildProcess(const Work& work) {
  const pid_t child = fork();
  if (child == 0) _exit(work());
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

TEST(StreamRecorder, LosesAtMostOneSecondWhenKilled) {
  const test::TemporaryFolder folder;
  const int exit_code = runInChildProcess([&] {
    StreamRecorder recorder(settingsFor(folder / "drive"));
    recordFortyPictures(recorder);
    std::this_thread::sleep_for(std::chrono::milliseconds(1000));
    raise(SIGKILL);
    return 0;
  });
  EXPECT_EQ(exit_code, -SIGKILL);
  EXPECT_EQ(recordedSequences(folder / "drive", CameraSide::left).size(), 40U);
  EXPECT_EQ(recordedSequences(folder / "drive", CameraSide::right).size(), 40U);
  EXPECT_FALSE(isBeingWritten(folder / "drive")) << "the kernel releases the lock with the process";
}

TEST(StreamRecorder, StopsWithOneMessageIfAFileCannotGrow) {
  const test::TemporaryFolder folder;
  const int exit_code = runInChildProcess([&] {
    constexpr rlim_t kLimit = 20'000;  // bytes
    const rlimit limit{kLimit, kLimit};
    signal(SIGXFSZ, SIG_IGN);
    if (setrlimit(RLIMIT_FSIZE, &limit) != 0) return 1;
    StreamRecorder recorder(settingsFor(folder / "drive"));
    recorder.left().onStream({VideoCodec::h264, {}});
    for (int i = 0; i < 450; ++i)
      recorder.left().onUnit(unitAt(i));
    recorder.finish();
    const std::string error = recorder.health().error;
    EXPECT_THAT(error, HasSubstr("recording stopped: cannot write"));
    EXPECT_THAT(error, HasSubstr("File too large"));
    return testing::Test::HasFailure() ? 1 : 0;
  });
  EXPECT_EQ(exit_code, 0);
}

TEST(StreamRecorder, WritesThroughNoLink) {
  for (const std::string planted : {"000000", "000000/left.csv", "000000/left.mkv"}) {
    const test::TemporaryFolder folder;
    StreamRecorder recorder(settingsFor(folder / "drive"));
    const fs::path link = folder / ("drive/" + planted);
    fs::create_directories(link.parent_path());
    fs::create_symlink(folder / "victim", link);
    recorder.left().onStream({VideoCodec::h264, {}});
    recorder.left().onUnit(unitAt(0));
    recorder.finish();
    EXPECT_THAT(recorder.health().error,
                HasSubstr(planted + ": is a symbolic link, through which another file would be written"));
    EXPECT_FALSE(fs::exists(folder / "victim")) << planted;
  }
}

TEST(StreamRecorder, RefusesFolderWithOtherFiles) {
  const test::TemporaryFolder folder;
  fs::create_directories(folder / "drive");
  fs::create_symlink(folder / "victim", folder / "drive/recording.json");
  EXPECT_THAT(test::messageOf([&] { const StreamRecorder recorder(settingsFor(folder / "drive")); }),
              HasSubstr("drive is not empty; name a new folder"));
  EXPECT_FALSE(fs::exists(folder / "victim"));
}

constexpr int kNotPermitted = 77;

/// Expects that `work` succeeds in a child process; skips the test where that may mount nothing.
template <typename Work>
void expectSuccessInChildProcess(const Work& work) {
  const int exit_code = runInChildProcess(work);
  if (exit_code == kNotPermitted) GTEST_SKIP() << "nothing can be mounted here";
  EXPECT_EQ(exit_code, 0);
}

/// Enters a new mount namespace. False if that is not permitted.
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

int recordUntilPowerCut(const test::TemporaryFolder& folder) {
  const std::string image = (folder / "image").string();
  const std::string cut = (folder / "cut").string();
  fs::create_directories(folder / "disk");
  fs::create_directories(folder / "after");
  std::ofstream(image).close();
  fs::resize_file(image, 32U << 20);
  if (!enterMountNamespace() || !run("/sbin/mkfs.ext4 -q -F " + image) ||
      !run("mount -o loop " + image + " " + (folder / "disk").string())) {
    return kNotPermitted;
  }
  {
    StreamRecorder recorder(settingsFor(folder / "disk/drive"));
    recordFortyPictures(recorder);
    std::this_thread::sleep_for(std::chrono::milliseconds(1000));
    fs::copy_file(image, cut);  // data on the disk only, without the kernel's page cache
  }
  if (!run("mount -o loop " + cut + " " + (folder / "after").string())) return 1;
  EXPECT_EQ(recordedSequences(folder / "after/drive", CameraSide::left).size(), 40U);
  EXPECT_EQ(recordedSequences(folder / "after/drive", CameraSide::right).size(), 40U);
  return testing::Test::HasFailure() ? 1 : 0;
}

TEST(StreamRecorder, LosesAtMostOneSecondInPowerCut) {
  const test::TemporaryFolder folder;
  expectSuccessInChildProcess([&] { return recordUntilPowerCut(folder); });
}

/// Records onto a disk of 300 kB until it is full.
int recordOntoSmallDisk(const fs::path& disk) {
  if (!enterMountNamespace()) return kNotPermitted;
  if (mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=300k") != 0) return kNotPermitted;
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
  EXPECT_GT(sequences.size(), 15U) << "data written earlier must remain";
  for (std::size_t i = 0; i < sequences.size(); ++i)
    EXPECT_EQ(sequences[i], i);
  return testing::Test::HasFailure() ? 1 : 0;
}

TEST(StreamRecorder, KeepsDataOnDiskThatFillsUp) {
  const test::TemporaryFolder folder;
  expectSuccessInChildProcess([&] { return recordOntoSmallDisk(folder.path()); });
}

/// Sends both cameras' pictures, one after another.
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
    return waitUntil([&] {
      send();
      return condition(recorder_.health());
    });
  }
  std::uint64_t sent() const { return static_cast<std::uint64_t>(sent_); }

 private:
  StreamRecorder& recorder_;
  int sent_ = 0;
};

void fillDisk(const fs::path& file, std::uintmax_t but) {
  std::ofstream others(file, std::ios::binary);
  const std::string part(1U << 16, 'x');
  while (others && fs::space(file.parent_path()).available > but)
    others << part << std::flush;
}

void expectGapThenKeyPicture(const std::vector<std::uint64_t>& sequences, std::uint64_t gap) {
  EXPECT_GE(sequences.size(), 20U);
  EXPECT_TRUE(std::is_sorted(sequences.begin(), sequences.end()));
  const auto after_gap = std::upper_bound(sequences.begin(), sequences.end(), gap);
  ASSERT_NE(after_gap, sequences.end()) << "pictures after the gap must be recorded";
  EXPECT_EQ(*after_gap % 15, 0U) << "recording must resume with a key picture";
}

/// Records onto a disk of 20 MB that another file fills up and frees again; `keep_free`: the quota's free
/// space, bytes.
int recordOntoDiskThatFillsUp(const fs::path& disk, std::uint64_t keep_free, const std::string& why) {
  if (!enterMountNamespace()) return kNotPermitted;
  if (mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=20m") != 0) return kNotPermitted;
  RecordingSettings settings = settingsFor(disk / "drive");
  settings.quota.keep_free_bytes = keep_free;
  settings.quota_interval = std::chrono::milliseconds(20);
  settings.resume_margin_bytes = 1'000'000;
  StreamRecorder recorder(settings);
  TwoCameras cameras(recorder);
  EXPECT_TRUE(cameras.sendUntil([](const RecorderHealth& health) { return health.units >= 40; }));
  // Leave half of the quota's space: on a full disk either the disk or the quota could report first.
  fillDisk(disk / "others", keep_free / 2);
  EXPECT_TRUE(cameras.sendUntil([](const RecorderHealth& health) { return !health.error.empty(); }));
  EXPECT_THAT(recorder.health().error, AllOf(HasSubstr("recording stopped: "), HasSubstr(why)));
  const std::uint64_t sent_at_stop = cameras.sent();
  cameras.send();
  cameras.connect();  // a camera may reconnect meanwhile
  fs::remove(disk / "others");
  EXPECT_TRUE(cameras.sendUntil([](const RecorderHealth& health) { return health.error.empty(); }));
  EXPECT_EQ(recorder.health().resumptions, 1U);
  recorder.finish();
  EXPECT_EQ(recorder.health().error, "");
  EXPECT_THAT(segmentNumbers(disk / "drive"), testing::ElementsAre(0, 1));
  for (const CameraSide side : {CameraSide::left, CameraSide::right})
    expectGapThenKeyPicture(recordedSequences(disk / "drive", side), sent_at_stop);
  return testing::Test::HasFailure() ? 1 : 0;
}

TEST(StreamRecorder, ResumesInNewSegmentWhenQuotaSpaceIsFreeAgain) {
  const test::TemporaryFolder folder;
  expectSuccessInChildProcess(
      [&] { return recordOntoDiskThatFillsUp(folder.path(), 5'000'000, "must be kept free"); });
}

TEST(StreamRecorder, ResumesInNewSegmentAfterFullDisk) {
  const test::TemporaryFolder folder;
  expectSuccessInChildProcess(
      [&] { return recordOntoDiskThatFillsUp(folder.path(), 0, "No space left on device"); });
}

TEST(StreamRecorder, DropsPicturesUpToKeyPictureOnSlowDiskWithoutBlocking) {
  const test::TemporaryFolder folder;
  RecordingSettings settings = settingsFor(folder / "drive");
  for (int i = 0; i < 20; ++i)
    settings.queue_bytes = i == 0 ? unitAt(0).data.size() : settings.queue_bytes + unitAt(i).data.size();
  StreamRecorder recorder(settings);
  fs::create_directories(folder / "drive/000000");
  const fs::path video = folder / "drive/000000/left.mkv";
  ASSERT_EQ(mkfifo(video.c_str(), 0600), 0);  // opening it blocks until there is a reader
  recorder.left().onStream({VideoCodec::h264, {}});
  for (int i = 0; i < 40; ++i)
    recorder.left().onUnit(unitAt(i));
  EXPECT_EQ(recorder.health().dropped_pictures, 20U)
      << "the queue has space for twenty pictures, and then for no key picture";
  EXPECT_EQ(recorder.health().error, "");

  std::string received;
  std::thread disk([&] {
    std::ifstream pipe(video, std::ios::binary);
    received.assign(std::istreambuf_iterator<char>(pipe), {});
  });
  EXPECT_TRUE(waitUntil([&] { return recorder.health().units == 20; }));
  for (int i = 40; i < 50; ++i)
    recorder.left().onUnit(unitAt(i));
  recorder.finish();
  disk.join();
  EXPECT_EQ(recorder.health().dropped_pictures, 25U) << "45 is the next key picture";
  EXPECT_EQ(recorder.health().units, 25U);
  fs::remove(video);
  std::ofstream(video, std::ios::binary) << received;
  const std::vector<std::uint64_t> sequences = recordedSequences(folder / "drive", CameraSide::left);
  ASSERT_EQ(sequences.size(), 25U);
  EXPECT_EQ(sequences[19], 19U);
  EXPECT_EQ(sequences[20], 45U);
}

TEST(StreamRecorder, RejectsFolderWithRecordingAndFolderThatCannotBeCreated) {
  const test::TemporaryFolder folder;
  { const StreamRecorder recorder(settingsFor(folder / "drive")); }
  EXPECT_THAT(test::messageOf([&] { StreamRecorder(settingsFor(folder / "drive")); }),
              HasSubstr("already contains a recording"));
  EXPECT_THAT(test::messageOf([&] { StreamRecorder(settingsFor("/proc/nowhere")); }),
              HasSubstr("cannot create the folder"));
}

TEST(StreamRecorder, BeginsStoppedWithoutQuotaSpace) {
  const test::TemporaryFolder folder;
  RecordingSettings settings = settingsFor(folder / "drive");
  settings.quota.keep_free_bytes = std::uint64_t{1} << 60;
  StreamRecorder recorder(settings);
  EXPECT_THAT(recorder.health().error, AllOf(HasSubstr("recording stopped: only "),
                                             HasSubstr("GB are free for"), HasSubstr("must be kept free")));
  recordFortyPictures(recorder);
  recorder.finish();
  EXPECT_EQ(recorder.health().units, 0U);
  EXPECT_EQ(recorder.health().missing_pictures, 80U);
}

TEST(RecordingWriter, ProtectsEndedSegmentFromQuotaUntilNextOneBegins) {
  const test::TemporaryFolder folder;
  {
    RecordingWriter writer(folder / "drive", {}, std::chrono::milliseconds(700));
    writer.beginConnection(CameraSide::left, {VideoCodec::h264, {}});
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
}  // namespace cartvo::capture
