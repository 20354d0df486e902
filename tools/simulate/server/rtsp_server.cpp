// The simulated camera's RTSP server, on GStreamer's RTSP server.
#include "tools/simulate/server/rtsp_server.hpp"

#include <mutex>
#include <stdexcept>
#include <string>

#include "tools/simulate/server/rtsp_media.hpp"

namespace cartvo::simulate {
namespace {

// Paths of the main and sub stream, as on Hikvision cameras.
constexpr const char* kPaths[] = {"/Streaming/Channels/101", "/Streaming/Channels/102"};
constexpr const char* kViewer = "viewer";
constexpr guint kSessionCleanupSeconds = 2;

constexpr const char* kPipeline =
    "( appsrc name=source is-live=true format=time stream-type=stream "
    "caps=video/x-h264,stream-format=byte-stream,alignment=au ! rtph264pay name=pay0 pt=96 )";

void initialiseGStreamer() {
  static std::once_flag once;
  std::call_once(once, [] {
    GError* error = nullptr;
    if (gst_init_check(nullptr, nullptr, &error) == FALSE) {
      const std::string reason = error != nullptr ? error->message : "unknown reason";
      g_clear_error(&error);
      throw std::runtime_error("GStreamer cannot start: " + reason);
    }
    GstElementFactory* payloader = gst_element_factory_find("rtph264pay");
    if (payloader == nullptr) {
      throw std::runtime_error(
          "GStreamer's rtph264pay is missing: apt-get install gstreamer1.0-plugins-good");
    }
    gst_object_unref(payloader);
  });
}

// Makes running time equal to clock time, so that a buffer's timestamp can be its exposure.
void useClockTime(GstRTSPMedia* media) {
  const GPointer<GstElement> element(gst_rtsp_media_get_element(media));
  const GPointer<GstObject> pipeline(gst_object_get_parent(GST_OBJECT(element.get())));
  gst_element_set_start_time(GST_ELEMENT(pipeline.get()), GST_CLOCK_TIME_NONE);
  gst_element_set_base_time(GST_ELEMENT(pipeline.get()), 0);
}

void setAddress(GstRTSPServer* server, const std::string& address, std::uint16_t port) {
  gst_rtsp_server_set_address(server, address.c_str());
  gst_rtsp_server_set_service(server, std::to_string(port).c_str());
}

/// Takes the ownership of `error`, which may be nullptr.
[[noreturn]] void failListening(const std::string& address, std::uint16_t port, GError* error) {
  const std::string reason = error != nullptr ? error->message : "unknown reason";
  g_clear_error(&error);
  throw std::runtime_error("a simulated camera cannot listen on " + address + ":" + std::to_string(port) +
                           ": " + reason + "; give another port with --left-address or --right-address");
}

}  // namespace

GPointer<GSocket> RtspServer::reserve(const std::string& address, std::uint16_t port) {
  initialiseGStreamer();
  const GPointer<GstRTSPServer> server(gst_rtsp_server_new());
  setAddress(server.get(), address, port);
  GError* error = nullptr;
  GPointer<GSocket> socket(gst_rtsp_server_create_socket(server.get(), nullptr, &error));
  if (socket == nullptr) failListening(address, port, error);
  return socket;
}

RtspServer::RtspServer(const SimulatedCameraSettings& settings) {
  initialiseGStreamer();
  clock_.reset(newNtpClock());
  server_.reset(gst_rtsp_server_new());
  disableClientThreads();
  setAuthentication(settings);
  addMountPoints();
  const auto connected = +[](GstRTSPServer*, GstRTSPClient* client, gpointer clients) {
    static_cast<ClientFeeds*>(clients)->addClient(client);
  };
  g_signal_connect(server_.get(), "client-connected", G_CALLBACK(connected), clients_.get());
  listen(settings);
  thread_ = std::thread([this] {
    g_main_context_push_thread_default(context_.get());
    g_main_loop_run(loop_.get());
    g_main_context_pop_thread_default(context_.get());
  });
}

// Clients may be accessed only from the loop that serves them, and a request in progress must finish, so the
// shutdown runs inside the loop. The end of the pictures unblocks a request that waits for one. Closing a
// client sets its pipeline to NULL and waits for it.
RtspServer::~RtspServer() {
  clients_->sendEnd();
  GSource* shutdown = g_idle_source_new();
  g_source_set_priority(shutdown, G_PRIORITY_HIGH);
  g_source_set_callback(
      shutdown,
      [](gpointer self) -> gboolean {
        static_cast<RtspServer*>(self)->disconnectAll();
        g_main_loop_quit(static_cast<RtspServer*>(self)->loop_.get());
        return G_SOURCE_REMOVE;
      },
      this, nullptr);
  g_source_attach(shutdown, context_.get());
  g_source_unref(shutdown);
  thread_.join();
}

void RtspServer::disconnectAll() {
  g_source_destroy(listener_.get());
  gst_rtsp_server_client_filter(
      server_.get(), [](GstRTSPServer*, GstRTSPClient*, gpointer) { return GST_RTSP_FILTER_REMOVE; },
      nullptr);
  const GPointer<GstRTSPSessionPool> sessions(gst_rtsp_server_get_session_pool(server_.get()));
  gst_rtsp_session_pool_filter(
      sessions.get(), [](GstRTSPSessionPool*, GstRTSPSession*, gpointer) { return GST_RTSP_FILTER_REMOVE; },
      nullptr);
}

// Answers clients' requests in the server's own loop: pool threads cannot be joined.
void RtspServer::disableClientThreads() {
  const GPointer<GstRTSPThreadPool> threads(gst_rtsp_server_get_thread_pool(server_.get()));
  gst_rtsp_thread_pool_set_max_threads(threads.get(), 0);
}

void RtspServer::setAuthentication(const SimulatedCameraSettings& settings) {
  GPointer<GstRTSPAuth> authentication(gst_rtsp_auth_new());
  gst_rtsp_auth_set_supported_methods(authentication.get(), GST_RTSP_AUTH_DIGEST);
  gst_rtsp_auth_set_realm(authentication.get(), "cartvo simulated camera");
  GstRTSPToken* token =
      gst_rtsp_token_new(GST_RTSP_TOKEN_MEDIA_FACTORY_ROLE, G_TYPE_STRING, kViewer, nullptr);
  gst_rtsp_auth_add_digest(authentication.get(), settings.user.c_str(), settings.password.c_str(), token);
  gst_rtsp_token_unref(token);
  gst_rtsp_server_set_auth(server_.get(), authentication.get());
}

void RtspServer::addMountPoints() {
  GPointer<GstRTSPMountPoints> mount_points(gst_rtsp_server_get_mount_points(server_.get()));
  for (const char* path : kPaths) {
    GstRTSPMediaFactory* factory = gst_rtsp_media_factory_new();
    gst_rtsp_media_factory_set_media_gtype(factory, cameraMediaType());
    gst_rtsp_media_factory_set_launch(factory, kPipeline);
    gst_rtsp_media_factory_set_clock(factory, clock_.get());
    gst_rtsp_media_factory_set_shared(factory, FALSE);
    gst_rtsp_media_factory_set_protocols(
        factory, static_cast<GstRTSPLowerTrans>(GST_RTSP_LOWER_TRANS_TCP | GST_RTSP_LOWER_TRANS_UDP));
    gst_rtsp_media_factory_add_role(factory, kViewer, GST_RTSP_PERM_MEDIA_FACTORY_ACCESS, G_TYPE_BOOLEAN,
                                    TRUE, GST_RTSP_PERM_MEDIA_FACTORY_CONSTRUCT, G_TYPE_BOOLEAN, TRUE,
                                    nullptr);
    const auto configure = +[](GstRTSPMediaFactory*, GstRTSPMedia* media, gpointer clients) {
      useClockTime(media);
      static_cast<ClientFeeds*>(clients)->addMedia(media);
    };
    g_signal_connect(factory, "media-configure", G_CALLBACK(configure), clients_.get());
    gst_rtsp_mount_points_add_factory(mount_points.get(), path, factory);
  }
}

void RtspServer::listen(const SimulatedCameraSettings& settings) {
  setAddress(server_.get(), settings.address, settings.port);
  context_.reset(g_main_context_new());
  loop_.reset(g_main_loop_new(context_.get(), FALSE));

  GError* error = nullptr;
  listener_.reset(gst_rtsp_server_create_source(server_.get(), nullptr, &error));
  if (listener_ == nullptr) failListening(settings.address, settings.port, error);
  g_source_attach(listener_.get(), context_.get());
  port_ = static_cast<std::uint16_t>(gst_rtsp_server_get_bound_port(server_.get()));

  // Sessions of UDP clients that disappear without TEARDOWN must be removed by a timer.
  GSource* cleanup = g_timeout_source_new_seconds(kSessionCleanupSeconds);
  g_source_set_callback(
      cleanup,
      [](gpointer server) -> gboolean {
        GPointer<GstRTSPSessionPool> pool(
            gst_rtsp_server_get_session_pool(static_cast<GstRTSPServer*>(server)));
        gst_rtsp_session_pool_cleanup(pool.get());
        return G_SOURCE_CONTINUE;
      },
      server_.get(), nullptr);
  g_source_attach(cleanup, context_.get());
  g_source_unref(cleanup);
}

}  // namespace cartvo::simulate
