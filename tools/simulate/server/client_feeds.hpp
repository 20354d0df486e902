#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <set>
#include <vector>

#include <gst/rtsp-server/rtsp-server.h>

#include "tools/simulate/stream/encoded_stream.hpp"

namespace cartvo::simulate {

/// Deleter and owning pointer for GObject types.
struct GObjectUnref {
  void operator()(gpointer object) const { g_object_unref(object); }
};
template <class T>
using GPointer = std::unique_ptr<T, GObjectUnref>;

/// The clients of one simulated camera: which of them are playing, and the appsrc of each client's pipeline.
/// Thread-safe. Threads of clients share ownership, so it can outlive the server.
class ClientFeeds : public std::enable_shared_from_this<ClientFeeds> {
 public:
  /// Tracks the requests of a client until it disconnects.
  void addClient(GstRTSPClient* client);

  /// Adds a pipeline with an appsrc named "source"; it is fed until it is unprepared.
  void addMedia(GstRTSPMedia* media);

  /// Number of connected clients that have sent PLAY.
  int playingCount() const;

  /// Sends one picture to every client; `stream` owns the bytes. A client starts at a key frame. A client
  /// whose queue is full loses pictures up to a later key frame.
  void send(const std::shared_ptr<const EncodedStream>& stream, const AccessUnit& unit,
            std::int64_t instant_ns);

  /// Ends the streams of all clients and of clients that connect later. Repeated calls have no effect.
  void sendEnd();

 private:
  struct Feed {
    const GstRTSPMedia* media = nullptr;  ///< for comparison only
    GPointer<GstElement> source;
    bool has_sent_picture = false;  ///< has received a picture
    bool is_streaming = false;      ///< has received a key frame and all pictures since
  };

  void removeMedia(const GstRTSPMedia* media);
  void setPlaying(const GstRTSPClient* client);
  void setStopped(const GstRTSPClient* client);

  mutable std::mutex mutex_;
  std::vector<Feed> feeds_;
  std::set<const GstRTSPClient*> playing_;
  bool ended_ = false;
};

}  // namespace cartvo::simulate
