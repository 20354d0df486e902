// Feeds the pictures of a simulated camera to the GStreamer pipelines of its clients.
#include "tools/simulate/server/client_feeds.hpp"

#include <utility>

#include <gst/app/gstappsrc.h>

#include "tools/simulate/server/rtsp_media.hpp"

namespace cartvo::simulate {
namespace {

constexpr guint64 kMaxQueuedBytes = 4'000'000;  // per client: several seconds of video

using SharedFeeds = std::shared_ptr<ClientFeeds>;

// Connects a signal to a callback whose data is a SharedFeeds*, which lives as long as the connection.
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
  // The interface needs a pointer to non-const; GStreamer does not write into read-only memory.
  GstBuffer* buffer = gst_buffer_new_wrapped_full(
      GST_MEMORY_FLAG_READONLY, const_cast<std::uint8_t*>(bytes.data()), bytes.size(), 0, bytes.size(),
      new Owner(stream), [](gpointer owner) { delete static_cast<Owner*>(owner); });
  GST_BUFFER_PTS(buffer) = ntpTimeOnRtpGrid(instant_ns);
  GST_BUFFER_DTS(buffer) = GST_BUFFER_PTS(buffer);
  return buffer;
}

// Ends a client's pipeline. A pipeline without a first picture still blocks the server's loop in its
// preparation; an end of stream would not unblock it, an error does.
void end(GstElement* source, bool has_sent_picture) {
  if (has_sent_picture) {
    gst_app_src_end_of_stream(GST_APP_SRC(source));
  } else {
    GST_ELEMENT_ERROR(source, RESOURCE, NOT_FOUND, ("the camera has no more pictures"), (nullptr));
  }
}

}  // namespace

void ClientFeeds::addClient(GstRTSPClient* client) {
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

void ClientFeeds::addMedia(GstRTSPMedia* media) {
  const GPointer<GstElement> element(gst_rtsp_media_get_element(media));
  GPointer<GstElement> source(gst_bin_get_by_name(GST_BIN(element.get()), "source"));
  const auto unprepared =
      +[](GstRTSPMedia* gone, gpointer feeds) { (*static_cast<SharedFeeds*>(feeds))->removeMedia(gone); };
  connect(media, "unprepared", G_CALLBACK(unprepared), shared_from_this());

  const std::lock_guard lock(mutex_);
  if (ended_) end(source.get(), false);
  feeds_.push_back({.media = media, .source = std::move(source)});
}

void ClientFeeds::removeMedia(const GstRTSPMedia* media) {
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

int ClientFeeds::playingCount() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(playing_.size());
}

void ClientFeeds::send(const std::shared_ptr<const EncodedStream>& stream, const AccessUnit& unit,
                       std::int64_t instant_ns) {
  const std::lock_guard lock(mutex_);
  for (Feed& feed : feeds_) {
    if (!feed.is_streaming && !unit.key_frame) continue;
    auto* source = GST_APP_SRC(feed.source.get());
    feed.is_streaming = gst_app_src_get_current_level_bytes(source) + unit.size <= kMaxQueuedBytes &&
                        gst_app_src_push_buffer(source, wrap(stream, unit, instant_ns)) == GST_FLOW_OK;
    feed.has_sent_picture = feed.has_sent_picture || feed.is_streaming;
  }
}

void ClientFeeds::sendEnd() {
  const std::lock_guard lock(mutex_);
  if (std::exchange(ended_, true)) return;
  for (const Feed& feed : feeds_)
    end(feed.source.get(), feed.has_sent_picture);
}

}  // namespace cartvo::simulate
