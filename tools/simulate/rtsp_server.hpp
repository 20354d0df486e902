#pragma once

#include <cstdint>
#include <memory>
#include <thread>

#include <gst/rtsp-server/rtsp-server.h>

#include "tools/simulate/client_feeds.hpp"
#include "tools/simulate/simulated_camera.hpp"

namespace cartvo::simulate {

/// One camera's network side: a GStreamer RTSP server in a thread of its own. Every client has its own
/// pipeline, so that it can begin at a key frame. When it is destroyed, every pipeline has stopped; a thread
/// of GStreamer's may let go of a picture, which it owns with others, an instant later.
class RtspServer {
 public:
  /// Throws std::runtime_error if it cannot listen.
  explicit RtspServer(const SimulatedCameraSettings& settings);
  ~RtspServer();
  RtspServer(const RtspServer&) = delete;
  RtspServer& operator=(const RtspServer&) = delete;

  std::uint16_t port() const { return port_; }
  ClientFeeds& clients() { return *clients_; }
  const ClientFeeds& clients() const { return *clients_; }

 private:
  void serveClientsInTheLoop();
  void setAuthentication(const SimulatedCameraSettings& settings);
  void addMountPoints();
  void listen(const SimulatedCameraSettings& settings);
  void disconnectAll();

  struct Unref {
    void operator()(GMainContext* context) const { g_main_context_unref(context); }
    void operator()(GMainLoop* loop) const { g_main_loop_unref(loop); }
    void operator()(GSource* source) const { g_source_unref(source); }
  };

  std::shared_ptr<ClientFeeds> clients_ = std::make_shared<ClientFeeds>();
  GPointer<GstClock> clock_;
  GPointer<GstRTSPServer> server_;
  std::unique_ptr<GMainContext, Unref> context_;
  std::unique_ptr<GMainLoop, Unref> loop_;
  std::unique_ptr<GSource, Unref> listener_;
  std::uint16_t port_ = 0;
  std::thread thread_;
};

}  // namespace cartvo::simulate
