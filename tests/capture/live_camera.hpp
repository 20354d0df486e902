#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>

#include "capture/rtsp_camera.hpp"
#include "tools/simulate/simulated_camera.hpp"

namespace cartvo::test {

inline constexpr char kLivePassword[] = "p@ss:w/rd%";
inline constexpr std::int64_t kLiveOffset_ns = 10'000'000;   ///< right minus left
inline constexpr std::int64_t kLiveTurn_ns = 2'000'000'000;  ///< length of the content

std::int64_t nowNs();

/// What the two cameras send: a moving pattern of `kLiveTurn_ns` at 25 Hz, encoded once for all tests.
std::shared_ptr<const simulate::EncodedStream> leftStream();
std::shared_ptr<const simulate::EncodedStream> rightStream();

/// Camera on a free port, or the port given, that repeats its content for ever.
std::unique_ptr<simulate::SimulatedCamera> switchOn(std::shared_ptr<const simulate::EncodedStream> stream,
                                                    std::uint16_t port = 0);

/// What connects to it, quick to try again.
RtspCameraSettings settingsFor(std::uint16_t port);

/// Reads until `done` says so; false if that takes longer than kPatience.
bool readUntil(RtspCamera& camera, const std::function<bool(ReadOutcome, const Frame&)>& done);

bool readFrames(RtspCamera& camera, int count);

}  // namespace cartvo::test
