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

/// What a ScriptedCamera sends, and what goes wrong with it.
struct CameraScript {
  using Packet = std::vector<std::uint8_t>;
  using Send = std::function<void(const Packet&)>;

  VideoCodec codec = VideoCodec::h264;
  std::vector<EncodedUnit> pictures;        ///< again and again; the first is a key picture
  double frame_rate = 25.0;                 ///< Hz
  std::uint32_t first_rtp = 1'000'000'000;  ///< FFmpeg merges the first pictures where it is 0
  double report_interval = 0.25;            ///< s
  /// Of the camera's time of day, s, at a time since the first picture, s.
  std::function<double(double)> clock_error = [](double) { return 0.0; };
  /// What becomes of each RTP packet on its way.
  std::function<void(const Packet&, const Send&)> link = [](const Packet& packet, const Send& send) {
    send(packet);
  };
  std::string description;      ///< sent instead of the session description, if not empty
  int pictures_per_client = 0;  ///< then the connection is closed; 0: never
};

/// An RTSP camera that does just what a test tells it, badly if need be: a server of its own on loopback, for
/// one client at a time, without passwords. RTP over TCP or UDP (RFC 2326, 3550, 6184, 7798).
class ScriptedCamera {
 public:
  explicit ScriptedCamera(CameraScript script);
  ~ScriptedCamera();
  ScriptedCamera(const ScriptedCamera&) = delete;
  ScriptedCamera& operator=(const ScriptedCamera&) = delete;

  std::uint16_t port() const { return port_; }

  /// From the next key picture on the other pictures are sent.
  void change(std::vector<EncodedUnit> pictures);

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
  std::vector<EncodedUnit> next_pictures_;
  int listener_;
  std::uint16_t port_ = 0;
  std::atomic<int> connections_ = 0;
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

}  // namespace cartvo::test
