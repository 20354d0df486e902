// Hands the simulated camera's pictures to the pipelines of its clients.
#include "tools/simulate/client_feeds.hpp"

#include <utility>

#include <gst/app/gstappsrc.h>

#include "tools/simulate/rtsp_media.hpp"

namespace cartvo::simulate {
namespace {

constexpr guint64 kMostQueuedBytes = 4'000'000;  // per client; some seconds of video

using SharedFeeds = std::shared_ptr<ClientFeeds>;

// Connects a signal to a callback that gets a SharedFeeds*, which lives as long as the connection.
void connect(gpointer object, const char* signal, GCallback callback, SharedFeeds feeds) {
  g_signal_connect_data(
      object, signal, callback, new SharedFeeds(std::move(feeds)),
      [](gpointer data, GClosure*) { delete static_cast<SharedFeeds*>(data); },
      static_cast<GConnectFlags>(0));
}

GstBuffer* wrap(const std::shared_ptr<const EncodedStream>& stream, const AccessUnit& unit,
                std::int64_t instant_ns) {
  using Owner = std::shared_ptr<const EncodedStream>;
  const auto bytes = stream->data(unit);
  // GStreamer takes a pointer to non-const, but does not write into read-only memory.
  GstBuffer* buffer = gst_buffer_new_wrapped_full(
      GST_MEMORY_FLAG_READONLY, const_cast<std::uint8_t*>(bytes.data()), bytes.size(), 0, bytes.size(),
      new Owner(stream), [](gpointer owner) { delete static_cast<Owner*>(owner); });
  GST_BUFFER_PTS(buffer) = ntpTimeOnRtpGrid(instant_ns);
  GST_BUFFER_DTS(buffer) = GST_BUFFER_PTS(buffer);
  return buffer;
}

// A client whose pipeline has nothing to send yet waits for its first picture, and the server's loop with it:
// an end of stream would not wake it, an error does.
void end(GstElement* source, bool begun) {
  if (begun) {
    gst_app_src_end_of_stream(GST_APP_SRC(source));
  } else {
    GST_ELEMENT_ERROR(source, RESOURCE, NOT_FOUND, ("the camera has no more pictures"), (nullptr));
  }
}

}  // namespace

void ClientFeeds::watch(GstRTSPClient* client) {
  using Request = void (*)(GstRTSPClient*, GstRTSPContext*, gpointer);
  const Request played = [](GstRTSPClient* from, GstRTSPContext*, gpointer feeds) {
    (*static_cast<SharedFeeds*>(feeds))->setPlaying(from);
  };
  const Request stopped = [](GstRTSPClient* from, GstRTSPContext*, gpointer feeds) {
    (*static_cast<SharedFeeds*>(feeds))->setStopped(from);
  };
  const auto closed =
      +[](GstRTSPClient* from, gpointer feeds) { (*static_cast<SharedFeeds*>(feeds))->setStopped(from); };
  connect(client, "play-request", G_CALLBACK(played), shared_from_this());
  connect(client, "pause-request", G_CALLBACK(stopped), shared_from_this());
  connect(client, "teardown-request", G_CALLBACK(stopped), shared_from_this());
  connect(client, "closed", G_CALLBACK(closed), shared_from_this());
}

void ClientFeeds::add(GstRTSPMedia* media) {
  const GPointer<GstElement> element(gst_rtsp_media_get_element(media));
  GPointer<GstElement> source(gst_bin_get_by_name(GST_BIN(element.get()), "source"));
  const auto unprepared =
      +[](GstRTSPMedia* gone, gpointer feeds) { (*static_cast<SharedFeeds*>(feeds))->remove(gone); };
  connect(media, "unprepared", G_CALLBACK(unprepared), shared_from_this());

  const std::lock_guard lock(mutex_);
  if (ended_) end(source.get(), false);
  feeds_.push_back({.media = media, .source = std::move(source)});
}

void ClientFeeds::remove(const GstRTSPMedia* media) {
  const std::lock_guard lock(mutex_);
  std::erase_if(feeds_, [media](const Feed& feed) { return feed.media == media; });
}

void ClientFeeds::setPlaying(const GstRTSPClient* client) {
  const std::lock_guard lock(mutex_);
  playing_.insert(client);
}

void ClientFeeds::setStopped(const GstRTSPClient* client) {
  const std::lock_guard lock(mutex_);
  playing_.erase(client);
}

int ClientFeeds::playing() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(playing_.size());
}

void ClientFeeds::send(const std::shared_ptr<const EncodedStream>& stream, const AccessUnit& unit,
                       std::int64_t instant_ns) {
  const std::lock_guard lock(mutex_);
  for (Feed& feed : feeds_) {
    if (!feed.running && !unit.key_frame) continue;
    auto* source = GST_APP_SRC(feed.source.get());
    feed.running = gst_app_src_get_current_level_bytes(source) + unit.size <= kMostQueuedBytes &&
                   gst_app_src_push_buffer(source, wrap(stream, unit, instant_ns)) == GST_FLOW_OK;
    feed.begun = feed.begun || feed.running;
  }
}

void ClientFeeds::sendEnd() {
  const std::lock_guard lock(mutex_);
  if (std::exchange(ended_, true)) return;
  for (const Feed& feed : feeds_)
    end(feed.source.get(), feed.begun);
}

}  // namespace cartvo::simulate
