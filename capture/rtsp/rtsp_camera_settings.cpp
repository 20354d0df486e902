// Checks of a camera's settings.

#include <stdexcept>

#include "capture/rtsp/rtsp_camera.hpp"
#include "capture/rtsp/rtsp_url.hpp"

namespace cartvo::capture {

void checkSettings(const RtspCameraSettings& settings) {
  checkRtspUrl(settings.url);
  const bool times_are_valid =
      settings.answer_timeout.count() > 0 && settings.connect_timeout.count() > 0 &&
      settings.stall_timeout.count() > 0 && settings.frozen_after.count() > 0 &&
      settings.first_retry.count() > 0 && settings.longest_retry >= settings.first_retry &&
      settings.refused_retry.count() > 0 && settings.longest_refused_retry >= settings.refused_retry;
  if (!times_are_valid) {
    throw std::invalid_argument(
        "a camera's time-outs must be positive, and its longest retry not shorter than its first one");
  }
  if (settings.decoder_threads < 1)
    throw std::invalid_argument("a camera's decoder_threads must be at least 1");
}

}  // namespace cartvo::capture
