#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <set>
#include <vector>

#include <gst/rtsp-server/rtsp-server.h>

#include "tools/simulate/encoded_stream.hpp"

namespace cartvo::simulate {

struct GObjectUnref {
  void operator()(gpointer object) const { g_object_unref(object); }
};
template <class T>
using GPointer = std::unique_ptr<T, GObjectUnref>;

/// The clients of one simulated camera: who is playing, and the entrance (an appsrc) of each one's pipeline.
/// Outlives the server where a client's threads still hold it.
class ClientFeeds : public std::enable_shared_from_this<ClientFeeds> {
 public:
  /// Follows what a client asks for, until it is gone.
  void watch(GstRTSPClient* client);

  /// Feeds a pipeline that holds an appsrc named "source", until it is unprepared.
  void add(GstRTSPMedia* media);

  /// Clients that have said PLAY and are still there.
  int playing() const;

  /// Hands one picture to every client; `stream` owns the bytes. A client gets its first at a key frame. One
  /// that does not take its pictures loses those up to a later key frame.
  void send(const std::shared_ptr<const EncodedStream>& stream, const AccessUnit& unit,
            std::int64_t instant_ns);

  /// Tells all clients that nothing more follows, and refuses those that come later. Only the first call
  /// counts.
  void sendEnd();

 private:
  struct Feed {
    const GstRTSPMedia* media = nullptr;  ///< only compared
    GPointer<GstElement> source;
    bool begun = false;    ///< has got a picture
    bool running = false;  ///< has got a key frame, and everything since
  };

  void remove(const GstRTSPMedia* media);
  void setPlaying(const GstRTSPClient* client);
  void setStopped(const GstRTSPClient* client);

  mutable std::mutex mutex_;
  std::vector<Feed> feeds_;
  std::set<const GstRTSPClient*> playing_;
  bool ended_ = false;
};

}  // namespace cartvo::simulate
