// FFmpeg's process-wide log callback: discards the messages and counts missed RTP packets.

#include "capture/codec/ffmpeg_log.hpp"

#include <algorithm>
#include <cstdarg>
#include <cstring>
#include <map>
#include <mutex>
#include <utility>

extern "C" {
#include <libavutil/log.h>
}

namespace cartvo::capture {
namespace {

constexpr char kMissedPacketsFormat[] = "RTP: missed %d packets\n";  // libavformat/rtpdec.c

struct SharedCounts {
  std::mutex mutex;
  std::map<const void*, int> missed;  ///< by demuxer, of those with a counter
};

SharedCounts& sharedCounts() {
  static SharedCounts shared;
  return shared;
}

void countMissedPackets(const void* context, const char* format, va_list arguments) {
  if (std::strcmp(format, kMissedPacketsFormat) != 0) return;
  va_list copy;
  va_copy(copy, arguments);
  const int missed = va_arg(copy, int);
  va_end(copy);
  const std::lock_guard lock(sharedCounts().mutex);
  const auto watched = sharedCounts().missed.find(context);
  if (watched != sharedCounts().missed.end()) watched->second += std::max(missed, 1);
}

void handleLogMessage(void* context, int level, const char* format, va_list arguments) {
  if (level > AV_LOG_WARNING) return;
  countMissedPackets(context, format, arguments);
}

}  // namespace

void keepFfmpegQuiet() {
  static std::once_flag once;
  std::call_once(once, [] { av_log_set_callback(handleLogMessage); });
}

MissedPacketCounter::MissedPacketCounter(const void* demuxer) : demuxer_(demuxer) {
  keepFfmpegQuiet();
  const std::lock_guard lock(sharedCounts().mutex);
  sharedCounts().missed[demuxer_] = 0;
}

MissedPacketCounter::~MissedPacketCounter() {
  const std::lock_guard lock(sharedCounts().mutex);
  sharedCounts().missed.erase(demuxer_);
}

int MissedPacketCounter::fetchAndReset() {
  const std::lock_guard lock(sharedCounts().mutex);
  return std::exchange(sharedCounts().missed[demuxer_], 0);
}

}  // namespace cartvo::capture
