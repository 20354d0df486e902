// Search of cameras by SADP and WS-Discovery.
#include "tools/camera/discovery.hpp"

#include <array>
#include <atomic>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include "support/error_message.hpp"

namespace cartvo {
namespace {

using testing::HasSubstr;

constexpr const char* kSadpAnswer =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?><ProbeMatch><Uuid>X</Uuid><Types>inquiry</Types>"
    "<DeviceDescription>DS-2CD2143G2-I</DeviceDescription><DeviceSN>S1</DeviceSN><MAC>44-19-B6-00-00-01</MAC>"
    "<IPv4Address>192.168.1.64</IPv4Address><IPv4SubnetMask>255.255.255.0</IPv4SubnetMask>"
    "<IPv4Gateway>192.168.1.1</IPv4Gateway><DHCP>false</DHCP><HttpPort>80</HttpPort>"
    "<SoftwareVersion>V5.7.3build 220112</SoftwareVersion><Activated>false</Activated></ProbeMatch>";

constexpr const char* kOnvifAnswer =
    "<?xml version=\"1.0\"?><s:Envelope xmlns:s=\"urn:s\" "
    "xmlns:d=\"urn:d\"><s:Body><d:ProbeMatches><d:ProbeMatch>"
    "<d:Scopes>onvif://www.onvif.org/type/video_encoder onvif://www.onvif.org/hardware/DS-2CD2143G2-I "
    "onvif://www.onvif.org/MAC/44:19:b6:00:00:01</d:Scopes>"
    "<d:XAddrs>http://[fe80::1]/onvif/device_service http://192.168.1.64:8080/onvif/device_service</d:XAddrs>"
    "</d:ProbeMatch></d:ProbeMatches></s:Body></s:Envelope>";

TEST(DiscoveryMessages, ReadSadpAnswers) {
  const auto device = parseSadpAnswer(std::string("\x21\x02\x00", 3) + kSadpAnswer);
  ASSERT_TRUE(device);
  EXPECT_EQ(device->address, "192.168.1.64");
  EXPECT_EQ(device->mac_address, "44:19:b6:00:00:01");
  EXPECT_EQ(device->subnet_mask, "255.255.255.0");
  EXPECT_EQ(device->activated, false);
  EXPECT_EQ(device->dhcp, false);
}

TEST(DiscoveryMessages, IgnoreOtherDatagrams) {
  for (const std::string& datagram :
       {std::string(), std::string("<Probe/>"), sadpProbe("X"), std::string("<ProbeMatch/>"),
        std::string("<ProbeMatch><IPv4Address>;rm</IPv4Address></ProbeMatch>"),
        std::string("<ProbeMatch><IPv4Address>1.2.3.</IPv4Address></ProbeMatch>"),
        std::string("<ProbeMatch><XAddrs>http://1.2.3.456/</XAddrs></ProbeMatch>")}) {
    EXPECT_FALSE(parseSadpAnswer(datagram)) << datagram;
    EXPECT_THAT(parseOnvifAnswer(datagram), testing::IsEmpty()) << datagram;
  }
}

TEST(DiscoveryMessages, IgnoreDatagramsOfNestedAnswers) {
  constexpr std::size_t kMaxDatagram = 65507;
  std::string nested;
  while (nested.size() + 40 < kMaxDatagram)
    nested += "<ProbeMatch xmlns:a" + std::to_string(nested.size()) + "=''>";
  EXPECT_THAT(parseOnvifAnswer(nested), testing::IsEmpty()) << "not closed";
  std::string closed;
  for (int i = 0; i < 2000; ++i)
    closed = "<ProbeMatch>" + closed + "</ProbeMatch>";
  EXPECT_THAT(parseOnvifAnswer(closed), testing::IsEmpty());
  EXPECT_FALSE(parseSadpAnswer(closed));
}

TEST(DiscoveryMessages, ReadNoAnswerInAnother) {
  const std::string match =
      "<ProbeMatch><XAddrs>http://192.168.1.64/x</XAddrs><ProbeMatch><XAddrs>http://192.168.1.65/x</XAddrs>"
      "</ProbeMatch></ProbeMatch>";
  EXPECT_THAT(parseOnvifAnswer("<A>" + match + match + "</A>"), testing::SizeIs(2));
}

TEST(DiscoveryMessages, ReadOnvifAnswers) {
  const std::vector<DiscoveredDevice> devices = parseOnvifAnswer(kOnvifAnswer);
  ASSERT_EQ(devices.size(), 1U);
  EXPECT_EQ(devices[0].address, "192.168.1.64");
  EXPECT_EQ(devices[0].model, "DS-2CD2143G2-I");
  EXPECT_EQ(devices[0].activated, std::nullopt);
}

TEST(DiscoveryMessages, MergeBothProtocols) {
  std::vector<DiscoveredDevice> devices = parseOnvifAnswer(kOnvifAnswer);
  mergeDevice(devices, *parseSadpAnswer(kSadpAnswer));
  ASSERT_EQ(devices.size(), 1U);
  EXPECT_EQ(devices[0].serial_number, "S1");
  EXPECT_THAT(devices[0].protocols, testing::ElementsAre("ONVIF", "SADP"));
}

TEST(DiscoveryMessages, KeepTwoNewCamerasAtOneAddressApart) {
  DiscoveredDevice first = *parseSadpAnswer(kSadpAnswer), second = first;
  second.mac_address = "44:19:b6:00:00:02";
  std::vector<DiscoveredDevice> devices{first};
  mergeDevice(devices, second);
  EXPECT_EQ(devices.size(), 2U);
}

/// Answers all datagrams that reach it, on a free port of loopback, until it is destroyed.
class Responder {
 public:
  explicit Responder(std::string answer)
      : answer_(std::move(answer)), socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    const timeval wait{0, 20'000};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &wait, sizeof wait);
    if (::bind(socket_, reinterpret_cast<sockaddr*>(&address), size) != 0 ||
        ::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size) != 0)
      throw std::runtime_error("Responder: cannot bind");
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { serve(); });
  }
  ~Responder() {
    is_done_ = true;
    thread_.join();
    ::close(socket_);
  }
  Responder(const Responder&) = delete;
  Responder& operator=(const Responder&) = delete;

  std::uint16_t port() const { return port_; }
  /// The last question.
  std::string question() const {
    const std::lock_guard lock(mutex_);
    return question_;
  }

 private:
  void serve() {
    std::array<char, 4096> buffer{};
    while (!is_done_) {
      sockaddr_in from{};
      socklen_t size = sizeof from;
      const ssize_t count =
          ::recvfrom(socket_, buffer.data(), buffer.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
      if (count <= 0) continue;
      {
        const std::lock_guard lock(mutex_);
        question_.assign(buffer.data(), static_cast<std::size_t>(count));
      }
      ::sendto(socket_, answer_.data(), answer_.size(), 0, reinterpret_cast<const sockaddr*>(&from), size);
    }
  }

  const std::string answer_;
  mutable std::mutex mutex_;
  std::string question_;
  std::atomic<bool> is_done_ = false;
  int socket_;
  std::uint16_t port_ = 0;
  std::thread thread_;
};

TEST(Discovery, CollectsTheAnswersOfBothProtocols) {
  const Responder sadp(kSadpAnswer), onvif(kOnvifAnswer);
  DiscoverySettings settings;
  settings.interfaces = {"lo"};
  settings.duration = std::chrono::milliseconds(600);
  settings.group = "127.0.0.1";
  settings.sadp_port = sadp.port();
  settings.onvif_port = onvif.port();
  const std::vector<DiscoveredDevice> devices = discoverDevices(settings);
  ASSERT_EQ(devices.size(), 1U);
  EXPECT_THAT(devices[0].protocols, testing::UnorderedElementsAre("SADP", "ONVIF"));
  EXPECT_THAT(sadp.question(),
              testing::MatchesRegex(".*<Uuid>[0-9A-F-]{36}</Uuid><Types>inquiry</Types></Probe>"));
}

TEST(Discovery, NamesAMissingInterface) {
  DiscoverySettings settings;
  settings.interfaces = {"nosuch0"};
  EXPECT_THAT(test::messageOf([&] { discoverDevices(settings); }),
              HasSubstr("the interface nosuch0 does not exist"));
}

}  // namespace
}  // namespace cartvo
