#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>

#include "capture/rtsp/rtsp_camera.hpp"
#include "tools/simulate/server/simulated_camera.hpp"

namespace cartvo::test {

inline constexpr char kLivePassword[] = "p@ss:w/rd%";
inline constexpr std::int64_t kLiveOffset_ns = 10'000'000;       ///< right minus left exposure
inline constexpr std::int64_t kLiveDuration_ns = 2'000'000'000;  ///< duration of the content

/// Host's clock, ns since the Unix epoch.
std::int64_t nowNs();

/// Streams of the two cameras: a moving pattern of `kLiveDuration_ns` at 25 Hz, encoded once for all tests.
std::shared_ptr<const simulate::EncodedStream> leftStream();
std::shared_ptr<const simulate::EncodedStream> rightStream();

/// Starts a camera on a free port, or on the given one, that repeats its content without end.
std::unique_ptr<simulate::SimulatedCamera> startCamera(std::shared_ptr<const simulate::EncodedStream> stream,
                                                       std::uint16_t port = 0);

/// Settings to connect to it, with short retry pauses.
capture::RtspCameraSettings settingsFor(std::uint16_t port);

/// Reads until `done` returns true; false if that takes longer than kTestTimeout.
bool readUntil(capture::RtspCamera& camera,
               const std::function<bool(capture::ReadOutcome, const capture::Frame&)>& done);

/// Reads `count` frames; false if that takes longer than kTestTimeout.
bool readFrames(capture::RtspCamera& camera, int count);

}  // namespace cartvo::test
