#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <thread>

#include <gst/rtsp-server/rtsp-server.h>

#include "tools/simulate/server/client_feeds.hpp"
#include "tools/simulate/server/simulated_camera.hpp"

namespace cartvo::simulate {

/// The RTSP server of one simulated camera (GStreamer), in its own thread. Every client has its own pipeline,
/// so that it can start at a key frame. After destruction all pipelines have stopped; a GStreamer thread may
/// release its shared ownership of a picture slightly later.
class RtspServer {
 public:
  /// Throws std::runtime_error if it cannot listen on the address and port.
  explicit RtspServer(const SimulatedCameraSettings& settings);
  ~RtspServer();
  RtspServer(const RtspServer&) = delete;
  RtspServer& operator=(const RtspServer&) = delete;

  /// A socket that listens there until it is destroyed. Throws std::runtime_error if none can.
  static GPointer<GSocket> reserve(const std::string& address, std::uint16_t port);

  std::uint16_t port() const { return port_; }
  ClientFeeds& clients() { return *clients_; }
  const ClientFeeds& clients() const { return *clients_; }

 private:
  void disableClientThreads();
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
