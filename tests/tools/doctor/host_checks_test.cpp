// Checks of the computer, with the kernel's files of good and bad computers.
#include "tools/doctor/host_checks.hpp"

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "support/doctor/findings.hpp"
#include "support/temporary_folder.hpp"

namespace cartvo::doctor {
namespace {

using test::findingOf;
using test::Saw;

class HostChecks : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }

  Finding check(const std::string& subject) {
    FindingList list("computer");
    checkComputer(folder_.path(), list);
    checkReceiveBuffers(folder_.path(), configuration_, list);
    return findingOf(list.findings(), subject);
  }

  test::TemporaryFolder folder_;
  daemon::Configuration configuration_;
};

TEST_F(HostChecks, LooksAtABusyComputer) {
  write("loadavg", "0.00 0.01 0.05 1/100 4242\n");
  EXPECT_THAT(check("load"), Saw(Verdict::ok, "0.00 running programs"));
  write("loadavg", "1000.00 0.01 0.05 1/100 4242\n");
  EXPECT_THAT(check("load"), Saw(Verdict::look_at, "1000.00 running programs"));
}

TEST_F(HostChecks, LooksAtLittleMemory) {
  write("meminfo", "MemTotal:  1000000 kB\nMemFree: 7 kB\nMemAvailable:  900000 kB\n");
  EXPECT_THAT(check("memory"), Saw(Verdict::ok, "922 MB"));
  write("meminfo", "MemTotal:  1000000 kB\nMemAvailable:  1000 kB\n");
  EXPECT_THAT(check("memory"), Saw(Verdict::look_at, "1 MB"));
}

TEST_F(HostChecks, LooksAtSmallBuffersWithUdpOnly) {
  write("sys/net/core/rmem_max", "212992\n");
  EXPECT_THAT(check("receive buffers"), Saw(Verdict::ok, "212992 bytes"));
  configuration_.transport = capture::RtspTransport::udp;
  EXPECT_THAT(check("receive buffers"), Saw(Verdict::look_at, "212992 bytes"));
  write("sys/net/core/rmem_max", "4194304\n");
  EXPECT_THAT(check("receive buffers"), Saw(Verdict::ok, "4194304 bytes"));
}

TEST_F(HostChecks, DoesNotCheckWhatItCannotRead) {
  for (const char* subject : {"load", "memory", "receive buffers"})
    EXPECT_THAT(check(subject), Saw(Verdict::not_checked, "cannot be read"));
  write("loadavg", "nonsense");
  write("meminfo", "nonsense");
  EXPECT_THAT(check("load"), Saw(Verdict::not_checked, "cannot be read"));
  EXPECT_THAT(check("memory"), Saw(Verdict::not_checked, "cannot be read"));
}

TEST_F(HostChecks, LooksAtAFullDisk) {
  FindingList list("computer");
  checkDisk(configuration_, list);
  EXPECT_THAT(list.findings().back(), Saw(Verdict::ok, "no recordings"));
  configuration_.recording_directory = folder_ / "not/made/yet";
  configuration_.recording_quota.keep_free_bytes = 0;
  checkDisk(configuration_, list);
  EXPECT_THAT(list.findings().back(), Saw(Verdict::ok, "GB free"));
  configuration_.recording_quota.keep_free_bytes = 1'000'000'000'000'000'000;
  checkDisk(configuration_, list);
  EXPECT_THAT(list.findings().back(), Saw(Verdict::look_at, "GB free"));
}

TEST_F(HostChecks, FindsATimeServer) {
  EXPECT_FALSE(servesTime(folder_.path()));
  const std::string header = "  sl  local_address rem_address   st tx_queue\n";
  write("net/udp", header + "  10: 00000000:0044 00000000:0000 07 00000000:00000000\n");
  EXPECT_FALSE(servesTime(folder_.path()));
  write("net/udp6", header + "  10: 00000000000000000000000000000000:007B 0000 07\n");
  EXPECT_TRUE(servesTime(folder_.path()));
}

TEST_F(HostChecks, LooksAtAClockThatNothingKeeps) {
  FindingList list("computer");
  checkKernelClock(KernelClock{true, 0.004}, false, list);
  EXPECT_THAT(list.findings().back(), Saw(Verdict::ok, "error at most 4 ms"));
  checkKernelClock(KernelClock{false, 16.0}, true, list);
  EXPECT_THAT(list.findings().back(), Saw(Verdict::ok, "serves its time"));
  checkKernelClock(KernelClock{false, 16.0}, false, list);
  EXPECT_THAT(list.findings().back(), Saw(Verdict::look_at, "no time source"));
  checkKernelClock(std::nullopt, false, list);
  EXPECT_THAT(list.findings().back(), Saw(Verdict::not_checked, "does not say"));
}

TEST(TimeClients, FindACameraThatAsksForTheTime) {
  // As chronyc 4.3 prints them; tests/service/check_network.sh compares the columns with those of a running
  // chronyd.
  constexpr const char* kClients =
      "192.168.101.6,9,0,6,127,12,0,0,127,4294967295\n192.168.101.64,31,0,1,127,0,0,0,127,4294967295\n"
      "192.168.102.64,0,0,127,127,4294967295,5,0,1,3\n";
  FindingList list("left camera");
  checkTimeClient("192.168.101.64", kClients, list);
  EXPECT_THAT(list.findings().back(), Saw(Verdict::ok, "requests: 31"));
  checkTimeClient("192.168.102.64", kClients, list);
  EXPECT_THAT(list.findings().back(), Saw(Verdict::look_at, "requests: 0"));
  for (const char* clients : {"", "\n\n", "192.168.101.65", ",,,"}) {
    checkTimeClient("192.168.101.65", clients, list);
    EXPECT_THAT(list.findings().back(), Saw(Verdict::look_at, "has not asked"));
  }
}

}  // namespace
}  // namespace cartvo::doctor
