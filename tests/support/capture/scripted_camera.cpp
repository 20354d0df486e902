// RTSP server of the scripted camera.

#include "tests/support/capture/scripted_camera.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "capture/codec/nal_units.hpp"

namespace cartvo::test {
namespace {

using Clock = std::chrono::steady_clock;
using Packet = CameraScript::Packet;
constexpr std::size_t kMaxPayload = 400;
constexpr std::uint32_t kFrom1900To1970 = 2'208'988'800U;  // s, RFC 868
constexpr std::uint32_t kSource = 0x1234abcd;

sockaddr_in loopback(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

void append16(Packet& packet, std::uint32_t value) {
  packet.push_back(static_cast<std::uint8_t>(value >> 8));
  packet.push_back(static_cast<std::uint8_t>(value));
}
void append32(Packet& packet, std::uint32_t value) {
  append16(packet, value >> 16);
  append16(packet, value & 0xffff);
}

/// Value of a header line or parameter such as "CSeq: " or "client_port=", up to its delimiter.
std::string valueAfter(const std::string& text, const std::string& name) {
  const std::size_t begin = text.find(name);
  if (begin == std::string::npos) return {};
  const std::size_t value = begin + name.size();
  return text.substr(value, text.find_first_of("\r\n;-", value) - value);
}

}  // namespace

struct ScriptedCamera::Client {
  int socket = -1;
  int udp = -1;
  sockaddr_in rtp{};
  sockaddr_in rtcp{};
  bool playing = false;
  bool gone = false;
  std::string request;
  Clock::time_point start;
  double next_report = 0.0;
  std::size_t picture = 0;      ///< index in the script's
  std::int64_t sent = 0;        ///< pictures
  std::uint16_t number = 1000;  ///< of the next RTP packet
  std::uint32_t rtp_time = 0;
  std::uint8_t first_channel = 0;

  void write(const Packet& data) {
    std::size_t done = 0;
    while (!gone && done < data.size()) {
      const ssize_t step = send(socket, data.data() + done, data.size() - done, MSG_NOSIGNAL);
      gone = step <= 0;
      if (step > 0) done += static_cast<std::size_t>(step);
    }
  }

  /// `channel`: 0 RTP, 1 RTCP.
  void deliver(const Packet& packet, std::uint8_t channel) {
    if (udp >= 0) {
      const sockaddr_in& to = channel == 0 ? rtp : rtcp;
      sendto(udp, packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof(to));
      return;
    }
    Packet framed{'$', static_cast<std::uint8_t>(first_channel + channel)};  // RFC 2326, 10.12
    append16(framed, static_cast<std::uint32_t>(packet.size()));
    framed.insert(framed.end(), packet.begin(), packet.end());
    write(framed);
  }

  void close() {
    if (socket >= 0) ::close(socket);
    if (udp >= 0) ::close(udp);
    *this = Client();
  }
};

ScriptedCamera::ScriptedCamera(CameraScript script)
    : script_(std::move(script)), listener_(socket(AF_INET, SOCK_STREAM, 0)) {
  const int reuse = 1;
  setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &reuse, sizeof(reuse));
  sockaddr_in address = loopback(0);
  socklen_t size = sizeof(address);
  auto* generic = reinterpret_cast<sockaddr*>(&address);
  if (listener_ < 0 || bind(listener_, generic, size) != 0 || listen(listener_, 16) != 0 ||
      getsockname(listener_, generic, &size) != 0) {
    throw std::runtime_error("cannot listen on loopback");
  }
  port_ = ntohs(address.sin_port);
  thread_ = std::thread([this] { run(); });
}

ScriptedCamera::~ScriptedCamera() {
  stopping_ = true;
  thread_.join();
  ::close(listener_);
}

void ScriptedCamera::setPictures(std::vector<capture::EncodedUnit> pictures) {
  const std::lock_guard lock(mutex_);
  next_pictures_ = std::move(pictures);
}

void ScriptedCamera::run() {
  Client client;
  while (!stopping_) {
    int wait_ms = 5;
    if (client.playing) {
      const auto due =
          client.start +
          std::chrono::nanoseconds(std::llround(static_cast<double>(client.sent) * 1e9 / script_.frame_rate));
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(due - Clock::now()).count();
      wait_ms = static_cast<int>(std::clamp<std::int64_t>(left, 0, 5));
      if (Clock::now() >= due) sendPicture(client);
    }
    std::array<pollfd, 2> polled{{{listener_, POLLIN, 0}, {client.socket, POLLIN, 0}}};
    poll(polled.data(), polled.size(), wait_ms);
    if ((polled[0].revents & POLLIN) != 0) {
      client.close();
      client.socket = accept(listener_, nullptr, nullptr);
    } else if (client.socket >= 0 && polled[1].revents != 0 && !answer(client)) {
      client.gone = true;
    }
    const bool is_finished = script_.pictures_per_client > 0 && client.sent >= script_.pictures_per_client;
    if (client.gone || is_finished) client.close();
  }
  client.close();
}

/// Reads and answers requests. False when the client has closed the connection.
bool ScriptedCamera::answer(Client& client) {
  std::array<char, 4096> buffer{};
  const ssize_t size = recv(client.socket, buffer.data(), buffer.size(), 0);
  if (size <= 0) return false;
  client.request.append(buffer.data(), static_cast<std::size_t>(size));
  while (!client.request.empty() && client.request[0] == '$') {  // the client's RTCP
    if (client.request.size() < 4) return true;
    const std::size_t length = 4 + 256U * static_cast<std::uint8_t>(client.request[2]) +
                               static_cast<std::uint8_t>(client.request[3]);
    if (client.request.size() < length) return true;
    client.request.erase(0, length);
  }
  const std::size_t end = client.request.find("\r\n\r\n");
  if (end == std::string::npos) return true;
  const std::string request = client.request.substr(0, end + 2);
  client.request.erase(0, end + 4);

  if (const std::string other = script_.respond(request); !other.empty()) {
    send(client.socket, other.data(), other.size(), MSG_NOSIGNAL);
    return true;
  }
  std::string headers = "RTSP/1.0 200 OK\r\nCSeq: " + valueAfter(request, "CSeq: ") + "\r\nSession: 1\r\n";
  std::string body;
  if (request.rfind("DESCRIBE", 0) == 0) {
    body = script_.description.empty() ? describe() : script_.description;
    headers += "Content-Type: application/sdp\r\nContent-Length: " + std::to_string(body.size()) + "\r\n";
  } else if (request.rfind("SETUP", 0) == 0) {
    const std::string port = valueAfter(request, "client_port=");
    if (port.empty()) {
      headers += "Transport: RTP/AVP/TCP;unicast;interleaved=0-1\r\n";
    } else {
      client.udp = socket(AF_INET, SOCK_DGRAM, 0);
      sockaddr_in own = loopback(0);
      socklen_t own_size = sizeof(own);
      auto* generic = reinterpret_cast<sockaddr*>(&own);
      if (bind(client.udp, generic, own_size) != 0 || getsockname(client.udp, generic, &own_size) != 0)
        return false;
      const int first = std::stoi(port);
      client.rtp = loopback(static_cast<std::uint16_t>(first));
      client.rtcp = loopback(static_cast<std::uint16_t>(first + 1));
      const std::string from = std::to_string(ntohs(own.sin_port));
      headers += "Transport: RTP/AVP;unicast;client_port=" + port + "-" + std::to_string(first + 1) +
                 ";server_port=" + from + "-" + from + "\r\n";
    }
  } else if (request.rfind("PLAY", 0) == 0) {
    client.playing = true;
    client.first_channel = script_.channel;
    client.start = Clock::now();
    ++connections_;
  } else if (request.rfind("OPTIONS", 0) == 0) {
    headers += "Public: OPTIONS, DESCRIBE, SETUP, PLAY, TEARDOWN\r\n";
  }
  const std::string answer = headers + "\r\n" + body;
  client.write({answer.begin(), answer.end()});
  return request.rfind("TEARDOWN", 0) != 0;
}

std::string ScriptedCamera::describe() const {
  const std::string name = script_.codec == capture::VideoCodec::h264 ? "H264" : "H265";
  return "v=0\r\no=- 1 1 IN IP4 127.0.0.1\r\ns=camera\r\nt=0 0\r\nm=video 0 RTP/AVP 96\r\n"
         "c=IN IP4 0.0.0.0\r\na=rtpmap:96 " +
         name + "/90000\r\na=fmtp:96 packetization-mode=1\r\na=control:track1\r\n";
}

void ScriptedCamera::sendPicture(Client& client) {
  const double time = static_cast<double>(client.sent) / script_.frame_rate;
  client.rtp_time = script_.first_rtp + static_cast<std::uint32_t>(std::llround(90000.0 * time));
  if (time >= client.next_report) {
    sendReport(client);
    client.next_report = time + script_.report_interval;
  }
  {
    const std::lock_guard lock(mutex_);
    if (!next_pictures_.empty() && script_.pictures[client.picture].key) {
      script_.pictures.swap(next_pictures_);
      next_pictures_.clear();
      client.picture = 0;
    }
  }
  const capture::EncodedUnit& unit = script_.pictures[client.picture];
  const std::vector<capture::NalUnit> nals = capture::splitNalUnits(script_.codec, unit.data);
  for (std::size_t i = 0; i < nals.size(); ++i)
    sendNal(client, nals[i].bytes, i + 1 == nals.size());
  client.picture = (client.picture + 1) % script_.pictures.size();
  ++client.sent;
}

/// Sends one packet, or fragments: RFC 6184, 5.8 (FU-A), and RFC 7798, 4.4.3 (FU).
void ScriptedCamera::sendNal(Client& client, std::span<const std::uint8_t> nal, bool last) {
  if (nal.size() <= kMaxPayload) return sendRtp(client, nal, last);
  const bool h264 = script_.codec == capture::VideoCodec::h264;
  const std::size_t header = h264 ? 1 : 2;
  const auto type = static_cast<std::uint8_t>(h264 ? nal[0] & 0x1f : (nal[0] >> 1) & 0x3f);
  for (std::size_t begin = header; begin < nal.size(); begin += kMaxPayload) {
    const std::size_t size = std::min(kMaxPayload, nal.size() - begin);
    const bool is_last = begin + size == nal.size();
    Packet fragment;
    if (h264) {
      fragment.push_back(static_cast<std::uint8_t>((nal[0] & 0xe0) | 28));
    } else {
      fragment.push_back(static_cast<std::uint8_t>((nal[0] & 0x81) | (49 << 1)));
      fragment.push_back(nal[1]);
    }
    fragment.push_back(static_cast<std::uint8_t>((begin == header ? 0x80 : 0) | (is_last ? 0x40 : 0) | type));
    fragment.insert(fragment.end(), nal.begin() + static_cast<std::ptrdiff_t>(begin),
                    nal.begin() + static_cast<std::ptrdiff_t>(begin + size));
    sendRtp(client, fragment, last && is_last);
  }
}

void ScriptedCamera::sendRtp(Client& client, std::span<const std::uint8_t> payload, bool marker) {
  Packet packet{0x80, static_cast<std::uint8_t>(96 | (marker ? 0x80 : 0))};
  append16(packet, client.number++);
  append32(packet, client.rtp_time);
  append32(packet, kSource);
  packet.insert(packet.end(), payload.begin(), payload.end());
  script_.link(packet, [&client](const Packet& passed) { client.deliver(passed, 0); });
}

/// Sends a sender report (RFC 3550, 6.4.1) with the required source description (6.5).
void ScriptedCamera::sendReport(Client& client) {
  const double time = static_cast<double>(client.sent) / script_.frame_rate;
  const auto now = std::chrono::system_clock::now() +
                   std::chrono::nanoseconds(std::llround(1e9 * script_.clock_error(time)));
  const auto seconds = std::chrono::floor<std::chrono::seconds>(now.time_since_epoch());
  const std::chrono::duration<double> fraction = now.time_since_epoch() - seconds;
  Packet packet{0x80, 200};
  append16(packet, 6);
  append32(packet, kSource);
  append32(packet, static_cast<std::uint32_t>(seconds.count()) + kFrom1900To1970);
  append32(packet, static_cast<std::uint32_t>(std::ldexp(fraction.count(), 32)));
  append32(packet, client.rtp_time);
  append32(packet, static_cast<std::uint32_t>(client.sent));
  append32(packet, 0);
  packet.insert(packet.end(), {0x81, 202, 0, 3});
  append32(packet, kSource);
  packet.insert(packet.end(), {1, 3, 'c', 'a', 'm', 0, 0, 0});
  client.deliver(packet, 1);
}

}  // namespace cartvo::test
