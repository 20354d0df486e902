#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "capture/encoded_unit.hpp"

namespace cartvo::test {

/// Stream and faults of a ScriptedCamera.
struct CameraScript {
  using Packet = std::vector<std::uint8_t>;
  using Send = std::function<void(const Packet&)>;

  capture::VideoCodec codec = capture::VideoCodec::h264;
  std::vector<capture::EncodedUnit> pictures;  ///< repeated without end; the first is a key picture
  double frame_rate = 25.0;                    ///< Hz
  std::uint32_t first_rtp = 1'000'000'000;
  double report_interval = 0.25;  ///< s
  /// Error of the camera's wall clock, s, by the time since the first picture, s.
  std::function<double(double)> clock_error = [](double) { return 0.0; };
  /// Network link: forwards, drops, changes or duplicates each RTP packet.
  std::function<void(const Packet&, const Send&)> link = [](const Packet& packet, const Send& send) {
    send(packet);
  };
  /// Answer to a request instead of the usual one; the usual one if it is empty. Called in the camera's
  /// thread.
  std::function<std::string(const std::string& request)> respond = [](const std::string&) { return ""; };
  std::uint8_t channel = 0;     ///< of RTP over TCP; RTCP has the next one
  std::string description;      ///< replaces the session description if not empty
  int pictures_per_client = 0;  ///< the connection is closed after as many; 0: never
};

/// RTSP camera that follows a script, including faults: a server on loopback for one client at a time,
/// without passwords. RTP over TCP or UDP (RFC 2326, 3550, 6184, 7798).
class ScriptedCamera {
 public:
  explicit ScriptedCamera(CameraScript script);
  ~ScriptedCamera();
  ScriptedCamera(const ScriptedCamera&) = delete;
  ScriptedCamera& operator=(const ScriptedCamera&) = delete;

  std::uint16_t port() const { return port_; }

  /// Replaces the pictures from the next key picture on.
  void setPictures(std::vector<capture::EncodedUnit> pictures);

  int connections() const { return connections_; }

 private:
  struct Client;
  void run();
  bool answer(Client& client);
  void sendPicture(Client& client);
  void sendNal(Client& client, std::span<const std::uint8_t> nal, bool last);
  void sendRtp(Client& client, std::span<const std::uint8_t> payload, bool marker);
  void sendReport(Client& client);
  std::string describe() const;

  CameraScript script_;
  std::mutex mutex_;
  std::vector<capture::EncodedUnit> next_pictures_;
  int listener_;
  std::uint16_t port_ = 0;
  std::atomic<int> connections_ = 0;
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

}  // namespace cartvo::test
