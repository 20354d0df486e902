// FFmpeg's process-wide log callback: redirection, removal of credentials, count of missed RTP packets.

#include "capture/codec/ffmpeg_log.hpp"

#include <algorithm>
#include <array>
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

// FFmpeg has one log per process, hence one sink.
struct SharedSink {
  std::mutex mutex;
  FfmpegLogSink sink;
};

SharedSink& sharedSink() {
  static SharedSink shared;
  return shared;
}

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

void forward(void* context, int level, const char* format, va_list arguments) {
  if (level > AV_LOG_WARNING) return;
  countMissedPackets(context, format, arguments);
  const std::lock_guard lock(sharedSink().mutex);
  if (!sharedSink().sink) return;
  std::array<char, 1024> line{};
  int prefix = 1;
  av_log_format_line2(context, level, format, arguments, line.data(), static_cast<int>(line.size()), &prefix);
  std::string message = line.data();
  while (!message.empty() && message.back() == '\n')
    message.pop_back();
  sharedSink().sink(withoutCredentials(message));
}

}  // namespace

void setFfmpegLogSink(FfmpegLogSink sink) {
  keepFfmpegQuiet();
  const std::lock_guard lock(sharedSink().mutex);
  sharedSink().sink = std::move(sink);
}

void keepFfmpegQuiet() {
  static std::once_flag once;
  std::call_once(once, [] { av_log_set_callback(forward); });
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

std::string withoutCredentials(const std::string& text) {
  std::string result;
  std::size_t copied = 0;
  for (std::size_t scheme = text.find("://"); scheme != std::string::npos;
       scheme = text.find("://", copied)) {
    const std::size_t begin = scheme + 3;
    const std::size_t end = text.find_first_of("/ \t\n'\"", begin);
    const std::size_t at = text.substr(0, end).rfind('@');
    result.append(text, copied, begin - copied);
    copied = begin;
    if (at != std::string::npos && at >= begin) {
      result += "***";
      copied = at;
    }
  }
  return result.append(text, copied, std::string::npos);
}

}  // namespace cartvo::capture
