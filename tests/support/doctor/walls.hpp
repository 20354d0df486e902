#pragma once

#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>

#include "calib/format/rig_file.hpp"
#include "capture/recording/stream_recorder.hpp"
#include "support/capture/synthetic_cameras.hpp"
#include "tools/simulate/server/simulated_camera.hpp"
#include "tools/simulate/stream/encode_content.hpp"

// Two cameras that drive past walls: served live, or recorded.

namespace cartvo::test {

inline constexpr double kWallsRate = 20.0;  // Hz

/// A mounted rig for the walls.
inline calib::Rig wallsRig() {
  calib::Rig rig = smallRig();
  rig.T_body_camera.translation().z() = 1.8;
  return rig;
}

/// The two walls of test::wall, moving past.
class Walls : public simulate::Content {
 public:
  calib::Rig rig() const override { return wallsRig(); }
  double frameRate() const override { return kWallsRate; }
  int pairCount() const override { return 60; }
  std::int64_t leftInstant(int index) const override { return std::llround(index * 1e9 / kWallsRate); }
  std::int64_t rightInstant(int index) const override { return leftInstant(index); }
  void images(int index, cv::Mat& left, cv::Mat& right) const override {
    left = wall(index, 0);
    right = wall(index, 12);
  }
  Trajectory truth() const override { return {}; }
  std::string cacheKey() const override { return "walls"; }
};

/// The walls, encoded once for all tests.
inline std::shared_ptr<const simulate::EncodedPair> encodedWalls() {
  static const auto kPair = [] {
    simulate::EncoderSettings encoder;
    encoder.bitrate_kbps = 2000;
    return std::make_shared<const simulate::EncodedPair>(encodeContent(Walls(), encoder, [](int, int) {}));
  }();
  return kPair;
}

/// A camera at 127.0.0.1 (left) or 127.0.0.2 (right) that repeats the walls for ever.
inline std::unique_ptr<simulate::SimulatedCamera> wallsCamera(bool is_left, const std::string& password) {
  simulate::SimulatedCameraSettings settings;
  settings.address = is_left ? "127.0.0.1" : "127.0.0.2";
  settings.password = password;
  settings.repeat_after_ns = 3'000'000'000;
  const auto pair = encodedWalls();
  return std::make_unique<simulate::SimulatedCamera>(
      std::shared_ptr<const simulate::EncodedStream>(pair, is_left ? &pair->left : &pair->right), settings);
}

/// Records the three seconds of the walls, `rounds` times in sequence.
inline void recordWalls(const std::filesystem::path& folder, int rounds) {
  capture::RecordingSettings settings;
  settings.folder = folder;
  settings.rig = calib::rigText(wallsRig());
  capture::StreamRecorder recorder(settings);
  const auto pair = encodedWalls();
  recorder.left().onStream({});
  recorder.right().onStream({});
  constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;
  constexpr auto kInterval_ns = static_cast<std::int64_t>(1e9 / kWallsRate);
  const std::size_t pictures = pair->left.units.size();
  for (std::size_t i = 0; i < pictures * static_cast<std::size_t>(rounds); ++i) {
    for (const bool is_left : {true, false}) {
      const simulate::EncodedStream& stream = is_left ? pair->left : pair->right;
      const simulate::AccessUnit& picture = stream.units[i % pictures];
      const auto data = stream.data(picture);
      capture::EncodedUnit unit;
      unit.data.assign(data.begin(), data.end());
      unit.key = picture.key_frame;
      unit.sequence = i;
      const auto instant_ns = static_cast<std::int64_t>(i) * kInterval_ns;
      unit.pts = instant_ns * 9 / 100'000;
      unit.exposure_ns = kStart_ns + instant_ns;
      unit.first_arrival_ns = unit.arrival_ns = unit.exposure_ns + 20'000'000;
      unit.reference_us = unit.exposure_ns / 1000;
      (is_left ? recorder.left() : recorder.right()).onUnit(unit);
    }
  }
  recorder.finish();
}

/// Records three seconds of the walls.
inline void recordWalls(const std::filesystem::path& folder) {
  recordWalls(folder, 1);
}

}  // namespace cartvo::test
