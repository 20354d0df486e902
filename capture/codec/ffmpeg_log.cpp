// FFmpeg's process-wide log.

#include "capture/codec/ffmpeg_log.hpp"

extern "C" {
#include <libavutil/log.h>
}

namespace cartvo::capture {

void keepFfmpegQuiet() {
  av_log_set_level(AV_LOG_QUIET);
}

}  // namespace cartvo::capture
