// `cartvo camera network`: ports of the cameras, and the files that configure them.
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "support/error_message.hpp"
#include "support/file_text.hpp"
#include "support/places.hpp"
#include "support/temporary_folder.hpp"
#include "support/tools/run_cartvo.hpp"
#include "tools/camera/network/camera_ports.hpp"
#include "tools/camera/network/network_files.hpp"

namespace cartvo {
namespace {

using test::CommandResult;
using test::messageOf;
using test::runCartvo;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
namespace fs = std::filesystem;

constexpr const char* kTwoPorts =
    "camera network --left-interface enp2s0 --right-interface enp3s0 --left-camera 192.168.101.64 "
    "--right-camera 192.168.102.64 --dhcp";

void writeFile(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file) << text;
}

std::string inQuotes(const fs::path& file) {
  return "'" + file.string() + "'";
}

PortWishes twoPorts(const std::string& left, const std::string& right) {
  return {"", "enp2s0", "enp3s0", parseCameraAddress(left), parseCameraAddress(right), false};
}

PortWishes onePort(const std::string& left, const std::string& right) {
  return {"enp2s0", "", "", parseCameraAddress(left), parseCameraAddress(right), false};
}

TEST(CameraAddress, IsOneThatACameraCanHave) {
  EXPECT_EQ(ipv4Text(parseCameraAddress("192.168.101.64")), "192.168.101.64");
  for (const std::string text : {"", "camera", "192.168.1", "192.168.1.0", "192.168.1.255", "127.0.0.1",
                                 "224.0.0.1", "0.1.2.3", "fe80::1", "192.168.1.64/24", "192.168.1.64\n"})
    EXPECT_THROW(parseCameraAddress(text), std::invalid_argument) << text;
}

TEST(HostAddress, IsNearACameraOfItsNetwork) {
  const std::vector<HostAddress> addresses{{"enp1s0", parseCameraAddress("10.0.0.5"), 8},
                                           {"enp2s0", parseCameraAddress("192.168.101.1"), 24}};
  EXPECT_EQ(addressNear("192.168.101.64", addresses), "192.168.101.1");
  EXPECT_EQ(addressNear("10.200.0.1", addresses), "10.0.0.5");
  EXPECT_EQ(addressNear("192.168.102.64", addresses), "");
  EXPECT_EQ(addressNear("camera.example", addresses), "");
}

TEST(CameraPorts, HaveTheFirstFreeAddressOfTheCamerasNetwork) {
  const auto ports = planPorts(twoPorts("10.0.1.64", "10.0.2.1"));
  ASSERT_EQ(ports.size(), 2U);
  EXPECT_EQ(ipv4Text(ports[0].address), "10.0.1.1");
  EXPECT_EQ(ipv4Text(ports[1].address), "10.0.2.2");
  const auto shared = planPorts(onePort("10.0.1.2", "10.0.1.1"));
  ASSERT_EQ(shared.size(), 1U);
  EXPECT_EQ(ipv4Text(shared[0].address), "10.0.1.3");
}

TEST(CameraPorts, RefuseAddressesThatDoNotSuitThem) {
  EXPECT_THAT(messageOf([] { planPorts(twoPorts("10.0.1.64", "10.0.1.65")); }),
              AllOf(HasSubstr("10.0.1.0/24"), HasSubstr("--interface")));
  EXPECT_THAT(messageOf([] { planPorts(onePort("10.0.1.64", "10.0.2.64")); }), HasSubstr("one network"));
  EXPECT_THAT(messageOf([] { planPorts(twoPorts("10.0.1.64", "10.0.1.64")); }),
              HasSubstr("both cameras have the address 10.0.1.64"));
  PortWishes wishes = onePort("10.0.1.64", "10.0.1.65");
  wishes.dhcp = true;
  EXPECT_THAT(messageOf([&] { planPorts(wishes); }), HasSubstr("a port for each camera"));
}

TEST(CameraPorts, RefuseNamesThatAreNoneOfAnInterface) {
  for (const std::string name :
       {"", "*", "enp2s0 eth0", "a/b", "enp2s0\n[Network]", "sixteen-letters-", ".."}) {
    PortWishes wishes = twoPorts("10.0.1.64", "10.0.2.64");
    wishes.left_interface = name;
    EXPECT_THROW(planPorts(wishes), std::runtime_error) << name;
  }
  PortWishes wishes = twoPorts("10.0.1.64", "10.0.2.64");
  wishes.right_interface = wishes.left_interface;
  EXPECT_THAT(messageOf([&] { planPorts(wishes); }), HasSubstr("--interface enp2s0"));
}

TEST(CameraPorts, FindNetworksOfTheComputerThatOverlap) {
  const auto ports = planPorts(twoPorts("10.0.1.64", "10.0.2.64"));
  const auto host = [](const std::string& interface, const std::string& address, int prefix) {
    return HostAddress{interface, parseCameraAddress(address), prefix};
  };
  EXPECT_THAT(overlapsWithHost(ports, {host("eth0", "192.168.1.7", 24), host("enp2s0", "10.0.1.1", 24)}),
              IsEmpty());
  EXPECT_THAT(overlapsWithHost(ports, {host("eth0", "10.0.2.200", 25)}),
              ElementsAre(AllOf(HasSubstr("10.0.2.0/24"), HasSubstr("eth0"))));
  EXPECT_EQ(overlapsWithHost(ports, {host("eth0", "10.9.9.9", 8)}).size(), 2U);
  EXPECT_THAT(lostAddresses(ports, {host("enp2s0", "10.0.1.1", 24), host("eth0", "192.168.1.7", 24)}),
              IsEmpty());
  EXPECT_THAT(lostAddresses(ports, {host("enp2s0", "192.168.1.7", 24)}),
              ElementsAre(HasSubstr("192.168.1.7/24")));
}

TEST(CameraNetwork, WritesTheFilesThatAreInstalledAsExamples) {
  const test::TemporaryFolder etc;
  const CommandResult run = runCartvo(kTwoPorts + (" --output-dir " + inQuotes(etc.path())));
  ASSERT_EQ(run.exit_code, 0) << run.output;
  std::size_t written = 0;
  for (const auto& entry : fs::recursive_directory_iterator(etc.path())) {
    if (!entry.is_regular_file()) continue;
    ++written;
    const fs::path example = test::sourceFolder() / "config/network" / entry.path().filename();
    EXPECT_EQ(test::contentsOf(entry.path()), test::contentsOf(example)) << example;
  }
  EXPECT_EQ(written, 4U);
  EXPECT_THAT(run.output, HasSubstr("networkctl reload"));
}

TEST(CameraNetwork, WritesFilesThatEachUserCanRead) {
  const test::TemporaryFolder etc;
  const mode_t before = ::umask(077);
  const CommandResult run = runCartvo(kTwoPorts + (" --output-dir " + inQuotes(etc / "etc")));
  ::umask(before);
  ASSERT_EQ(run.exit_code, 0) << run.output;
  for (const auto& entry : fs::recursive_directory_iterator(etc / "etc")) {
    EXPECT_NE(entry.status().permissions() & fs::perms::others_read, fs::perms::none) << entry.path();
  }
}

TEST(CameraNetwork, ReplacesOtherFilesOnlyByForce) {
  const test::TemporaryFolder etc;
  const fs::path mine = etc / "systemd/network/10-cartvo-right.network";
  writeFile(mine, "mine\n");
  const std::string command = kTwoPorts + (" --output-dir " + inQuotes(etc.path()));
  const CommandResult refused = runCartvo(command);
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.output, AllOf(HasSubstr(mine.string()), HasSubstr("--force")));
  EXPECT_EQ(test::contentsOf(mine), "mine\n");
  EXPECT_FALSE(fs::exists(etc / "systemd/network/10-cartvo-left.network"));
  EXPECT_EQ(runCartvo(command + " --force").exit_code, 0);
  EXPECT_THAT(test::contentsOf(mine), HasSubstr("Name=enp3s0"));
  const CommandResult again = runCartvo(command);
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_THAT(again.output, AllOf(HasSubstr("unchanged: "), Not(HasSubstr("written: "))));
}

TEST(CameraNetwork, PrintsAndTakesAddressesFromTheConfiguration) {
  const test::TemporaryFolder folder;
  writeFile(folder / "cartvod.yaml",
            "cameras:\n  left: {url: 'rtsp://10.77.1.64/1'}\n  right: {url: 'rtsp://10.77.1.65/1'}\n");
  const std::string config = " --config " + inQuotes(folder / "cartvod.yaml");
  const CommandResult run = runCartvo("camera network --interface cartvo-none" + config);
  EXPECT_EQ(run.exit_code, 0) << run.output;
  EXPECT_THAT(run.output, AllOf(HasSubstr("==> /etc/systemd/network/10-cartvo-cameras.network <=="),
                                HasSubstr("Address=10.77.1.1/24"), HasSubstr("10.77.1.64 and 10.77.1.65"),
                                HasSubstr("allow 10.77.1.0/24"), HasSubstr("no interface cartvo-none"),
                                Not(HasSubstr("[DHCPServer]"))));
}

TEST(CameraNetwork, SaysWhichAddressIsMissing) {
  const test::TemporaryFolder folder;
  writeFile(folder / "cartvod.yaml",
            "cameras:\n  left: {url: 'rtsp://left-camera.lan/1'}\n  right: {url: 'v4l2:/dev/video1'}\n");
  const std::string command =
      "camera network --interface cartvo-none --config " + inQuotes(folder / "cartvod.yaml");
  EXPECT_THAT(runCartvo(command).output, AllOf(HasSubstr("'left-camera.lan'"), HasSubstr("--left-camera")));
  EXPECT_THAT(runCartvo(command + " --left-camera 10.77.1.64").output, HasSubstr("V4L2"));
}

TEST(CameraNetwork, RefusesWrongCommandLines) {
  EXPECT_EQ(runCartvo("camera network").exit_code, 2);
  EXPECT_EQ(runCartvo("camera network --left-interface enp2s0").exit_code, 2);
  EXPECT_EQ(runCartvo(std::string(kTwoPorts) + " --interface enp4s0").exit_code, 2);
  const CommandResult run = runCartvo(std::string(kTwoPorts) + " --output-dir /etc/systemd/network");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.output, HasSubstr("expected /etc"));
}

}  // namespace
}  // namespace cartvo
