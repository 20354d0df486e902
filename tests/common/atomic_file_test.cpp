// Tests of the writing of files: what a path may name, and what must stay as it was. Tests of files that
// are written piece by piece: they appear when they are complete, or not at all.
#include "common/atomic_file.hpp"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/error_message.hpp"
#include "support/file_text.hpp"
#include "support/temporary_folder.hpp"

namespace cartvo {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

struct stat statusOf(const fs::path& file) {
  struct stat status {};
  EXPECT_EQ(::lstat(file.c_str(), &status), 0) << file;
  return status;
}

class AtomicFile : public ::testing::Test {
 protected:
  fs::path operator/(const std::string& name) const { return folder_.path() / name; }
  std::ptrdiff_t entries() const { return std::distance(fs::directory_iterator(folder_.path()), {}); }

  /// Makes a character device as in /dev; returns false if this process may not.
  bool makeDevice(const std::string& name, unsigned minor) const {
    constexpr unsigned kMemoryDevices = 1;
    return ::mknod((*this / name).c_str(), S_IFCHR | 0666, makedev(kMemoryDevices, minor)) == 0;
  }

  test::TemporaryFolder folder_;
};

constexpr unsigned kNull = 3, kFull = 7;

TEST_F(AtomicFile, ReplacesTheContentsAndLeavesNoTemporaryFile) {
  const fs::path file = *this / "rig.yaml";
  writeFileAtomically(file, "old");
  writeFileAtomically(file, "new contents");
  EXPECT_EQ(test::contentsOf(file), "new contents");
  EXPECT_EQ(entries(), 1);
}

TEST_F(AtomicFile, LeavesNothingIfASignalEndsTheProgram) {
  const fs::path file = *this / "rig.yaml";
  for (const char* before : {"", "old"}) {
    if (*before != '\0') writeFileAtomically(file, before);
    const pid_t child = fork();
    if (child == 0) {
      // The second half of the contents ends the program with SIGXFSZ.
      constexpr rlim_t kLimit = 10'000;
      const rlimit limit{kLimit, kLimit}, no_core{0, 0};
      ::setrlimit(RLIMIT_CORE, &no_core);
      ::setrlimit(RLIMIT_FSIZE, &limit);
      ::signal(SIGXFSZ, SIG_DFL);
      writeFileAtomically(file, std::string(2 * kLimit, 'x'));
      _exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status));
    EXPECT_EQ(entries(), *before == '\0' ? 0 : 1);
    EXPECT_EQ(test::contentsOf(file), before);
  }
}

TEST_F(AtomicFile, CreatesMissingFoldersOfResultFilesOnly) {
  EXPECT_THAT(test::messageOf([&] { writeFileAtomically(*this / "new" / "folder" / "k6.json", "{}"); }),
              HasSubstr("k6.json: no file can be made in the folder"));
  EXPECT_FALSE(fs::exists(*this / "new"));
  writeResultFile(*this / "new" / "folder" / "k6.json", "{}");
  EXPECT_EQ(test::contentsOf(*this / "new" / "folder" / "k6.json"), "{}");
}

TEST_F(AtomicFile, FollowsLinksAndCreatesTheirMissingTarget) {
  fs::create_directory(*this / "repository");
  writeFileAtomically(*this / "repository" / "rig.yaml", "old");
  fs::create_symlink("repository/rig.yaml", *this / "rig.yaml");
  fs::create_symlink(*this / "rig.yaml", *this / "again.yaml");
  fs::create_symlink("not/yet.json", *this / "later.json");

  writeFileAtomically(*this / "again.yaml", "new");
  writeResultFile(*this / "later.json", "{}");

  EXPECT_TRUE(fs::is_symlink(*this / "rig.yaml"));
  EXPECT_TRUE(fs::is_symlink(*this / "again.yaml"));
  EXPECT_TRUE(fs::is_symlink(*this / "later.json"));
  EXPECT_EQ(test::contentsOf(*this / "repository" / "rig.yaml"), "new");
  EXPECT_EQ(test::contentsOf(*this / "not" / "yet.json"), "{}");
}

TEST_F(AtomicFile, RejectsLinksThatLeadNowhere) {
  fs::create_symlink("b", *this / "a");
  fs::create_symlink("a", *this / "b");
  EXPECT_THAT(test::messageOf([&] { writeFileAtomically(*this / "a", "text"); }),
              AllOf(HasSubstr((*this / "a").string()), HasSubstr("Too many levels of symbolic links")));
  EXPECT_TRUE(fs::is_symlink(*this / "a"));
}

TEST_F(AtomicFile, KeepsModeAndOwnerOfAnExistingFile) {
  const fs::path file = *this / "rig.yaml";
  writeFileAtomically(file, "old");
  ASSERT_EQ(::chmod(file.c_str(), 0640), 0);
  constexpr uid_t kOther = 65534;
  const bool is_root = ::geteuid() == 0;
  if (is_root) {
    ASSERT_EQ(::chown(file.c_str(), kOther, kOther), 0);
  }
  writeFileAtomically(file, "new");
  EXPECT_EQ(test::contentsOf(file), "new");
  EXPECT_EQ(statusOf(file).st_mode & 07777U, 0640U);
  if (is_root) {
    EXPECT_EQ(statusOf(file).st_uid, kOther);
    EXPECT_EQ(statusOf(file).st_gid, kOther);
  }
}

TEST_F(AtomicFile, GivesANewFileTheModeOfTheUmask) {
  const mode_t before = ::umask(027);
  writeFileAtomically(*this / "rig.yaml", "text");
  ::umask(before);
  EXPECT_EQ(statusOf(*this / "rig.yaml").st_mode & 07777U, 0640U);
}

TEST_F(AtomicFile, KeepsTheOtherNamesOfAFile) {
  writeFileAtomically(*this / "rig.yaml", "old and longer");
  fs::create_hard_link(*this / "rig.yaml", *this / "same.yaml");
  writeFileAtomically(*this / "rig.yaml", "new");
  EXPECT_EQ(test::contentsOf(*this / "same.yaml"), "new");
}

TEST_F(AtomicFile, WritesToAFifo) {
  ASSERT_EQ(::mkfifo((*this / "pipe").c_str(), 0600), 0);
  std::string received;
  std::thread reader([&] { received = test::contentsOf(*this / "pipe"); });
  writeFileAtomically(*this / "pipe", "{}");
  reader.join();
  EXPECT_EQ(received, "{}");
  EXPECT_TRUE(S_ISFIFO(statusOf(*this / "pipe").st_mode));
}

TEST_F(AtomicFile, WritesToDevicesAndLeavesThemDevices) {
  if (!makeDevice("null", kNull) || !makeDevice("full", kFull)) GTEST_SKIP() << "needs root to make devices";
  fs::create_symlink("full", *this / "link.json");
  if (std::FILE* probe = std::fopen((*this / "null").c_str(), "w"); probe != nullptr) {
    std::fclose(probe);
  } else {
    GTEST_SKIP() << "devices cannot be opened here";
  }
  writeFileAtomically(*this / "null", "{}");
  for (const char* const name : {"full", "link.json"}) {
    EXPECT_THAT(test::messageOf([&] { writeFileAtomically(*this / name, "{}"); }),
                AllOf(HasSubstr((*this / name).string()), HasSubstr("No space left on device")));
  }
  EXPECT_TRUE(S_ISCHR(statusOf(*this / "null").st_mode));
  EXPECT_TRUE(S_ISCHR(statusOf(*this / "full").st_mode));
  EXPECT_TRUE(S_ISLNK(statusOf(*this / "link.json").st_mode));
  EXPECT_EQ(entries(), 3);
}

TEST_F(AtomicFile, WritesToOwnDescriptorsWhereTheyStand) {
  const fs::path file = *this / "out.txt";
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT, 0600);
  ASSERT_EQ(::write(descriptor, "before ", 7), 7);
  fs::create_symlink("/proc/self/fd/" + std::to_string(descriptor), *this / "link");
  writeFileAtomically("/dev/fd/" + std::to_string(descriptor), "one ");
  writeFileAtomically(*this / "link", "two ");
  ASSERT_EQ(::write(descriptor, "after", 5), 5);
  ::close(descriptor);
  EXPECT_EQ(test::contentsOf(file), "before one two after");
  EXPECT_TRUE(fs::is_symlink(*this / "link"));
}

TEST_F(AtomicFile, FailureNamesTheFileAndTheReason) {
  writeFileAtomically(*this / "file", "text");
  const auto message = [](const fs::path& file) {
    return test::messageOf([&] { writeResultFile(file, "text"); });
  };
  EXPECT_EQ(message(*this / "file" / "rig.yaml"),
            (*this / "file" / "rig.yaml").string() + ": cannot be written: Not a directory");
  EXPECT_EQ(message(folder_.path()), folder_.path().string() + ": is a folder; name a file");
  EXPECT_THAT(message(*this / "out/"), HasSubstr("names no file"));
  EXPECT_THAT(message("/proc/nope/rig.yaml"), HasSubstr("/proc/nope: the folder cannot be created"));
}

TEST_F(AtomicFile, CheckFindsWhatCannotBeWrittenAndChangesNothing) {
  writeFileAtomically(*this / "file", "text");
  checkFileCanBeWritten(*this / "file");
  checkFileCanBeWritten(*this / "new" / "folder" / "rig.yaml");
  EXPECT_EQ(test::contentsOf(*this / "file"), "text");
  EXPECT_EQ(entries(), 1);
  EXPECT_THROW(checkFileCanBeWritten(*this / "file" / "rig.yaml"), std::runtime_error);
  EXPECT_THROW(checkFileCanBeWritten(folder_.path()), std::runtime_error);
  EXPECT_THROW(checkFileCanBeWritten("/proc/nope/rig.yaml"), std::runtime_error);
}

std::ptrdiff_t filesIn(const fs::path& folder) {
  return std::distance(fs::directory_iterator(folder), {});
}

TEST(AtomicFileWriter, AppearsWhenItIsComplete) {
  const test::TemporaryFolder folder;
  AtomicFileWriter writer(folder / "a/b/file");
  writer.write("one ");
  {
    std::ofstream library(writer.openPath(), std::ios::app);
    library << "two";
  }
  EXPECT_FALSE(fs::exists(folder / "a/b/file"));
  writer.commit();
  EXPECT_EQ(test::contentsOf(folder / "a/b/file"), "one two");
  EXPECT_EQ(filesIn(folder / "a/b"), 1);
}

TEST(AtomicFileWriter, LeavesNothingIfItIsNotComplete) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "old") << "old";
  {
    AtomicFileWriter fresh(folder / "a/b/file"), replacing(folder / "old");
    fresh.write("half");
    replacing.write("half");
  }
  EXPECT_EQ(test::contentsOf(folder / "old"), "old");
  EXPECT_EQ(filesIn(folder.path()), 1) << "the folders that were made are gone";
}

TEST(AtomicFileWriter, ReplacesAFileBehindALinkAndKeepsItsMode) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "old") << "old";
  fs::permissions(folder / "old", fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("old", folder / "link");
  AtomicFileWriter writer(folder / "link");
  writer.write("new");
  writer.commit();
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(test::contentsOf(folder / "old"), "new");
  EXPECT_EQ(fs::status(folder / "old").permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(filesIn(folder.path()), 2);
}

TEST(AtomicFileWriter, RefusesWhatIsNoRegularFile) {
  const test::TemporaryFolder folder;
  const auto open = [](const fs::path& file) {
    return test::messageOf([&] { const AtomicFileWriter writer(file); });
  };
  EXPECT_THAT(open(folder.path()), HasSubstr("is a folder"));
  ASSERT_EQ(::mkfifo((folder / "fifo").c_str(), 0600), 0);
  EXPECT_THAT(open(folder / "fifo"), HasSubstr("fifo: is not a regular file"));
  std::ofstream(folder / "file") << "x";
  EXPECT_THAT(open(folder / "file/below"), HasSubstr("file/below: "));
}

}  // namespace
}  // namespace cartvo
