// The metrics over HTTP: answers, idle and slow clients, requests that are refused.

#include "daemon/diagnostics/metrics_server.hpp"

#include <chrono>
#include <future>
#include <memory>
#include <vector>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <sys/socket.h>
#include <unistd.h>

#include "support/error_message.hpp"
#include "support/test_timeout.hpp"

namespace cartvo::daemon {
namespace {

using testing::HasSubstr;

class MetricsServerTest : public testing::Test {
 protected:
  MetricsServerTest() { client_.set_read_timeout(test::kTestTimeout); }

  static odometry_t message(std::int8_t status) {
    odometry_t message{};
    message.status = status;
    return message;
  }

  std::uint16_t port() const { return ListenAddress::parse(server_.address()).port; }

  MetricsServer server_{ListenAddress{}};
  httplib::Client client_{"http://" + server_.address()};
};

/// A connection that sends `text` and then nothing.
class SilentClient {
 public:
  SilentClient(std::uint16_t port, const std::string& text) : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    is_connected_ =
        connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
        send(socket_, text.data(), text.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(text.size());
  }
  ~SilentClient() { close(socket_); }
  SilentClient(const SilentClient&) = delete;
  SilentClient& operator=(const SilentClient&) = delete;

  bool isConnected() const { return is_connected_; }

 private:
  int socket_;
  bool is_connected_ = false;
};

TEST_F(MetricsServerTest, ServesHealthAndPairs) {
  health_t health{};
  health.version = "7.8.9";
  health.pairs = 42;
  server_.setHealth(health);
  server_.addPair(PairResult{}, message(odometry_t::VALID));
  const httplib::Result metrics = client_.Get("/metrics");
  ASSERT_TRUE(metrics);
  EXPECT_EQ(metrics->status, 200);
  EXPECT_EQ(metrics->get_header_value("Content-Type"), "text/plain; version=0.0.4; charset=utf-8");
  EXPECT_THAT(metrics->body, HasSubstr("cartvo_pairs 42\n"));
  EXPECT_THAT(metrics->body, HasSubstr("cartvo_processed_pairs 1\n"));
}

TEST_F(MetricsServerTest, SaysWhetherTheDaemonIsHealthy) {
  EXPECT_EQ(client_.Get("/healthz")->status, 200) << "it has just started and waits for the cameras";
  health_t health{};
  health.left.state = health.right.state = camera_health_t::STREAMING;
  server_.setHealth(health);
  server_.addMissedPair(message(odometry_t::INVALID));
  EXPECT_EQ(client_.Get("/healthz")->status, 503);
  server_.addPair(PairResult{}, message(odometry_t::VALID));
  const httplib::Result valid = client_.Get("/healthz");
  EXPECT_EQ(valid->status, 200);
  EXPECT_EQ(valid->body, "valid\n");
  server_.setStalled("left camera's reader");
  const httplib::Result stalled = client_.Get("/healthz");
  EXPECT_EQ(stalled->status, 503);
  EXPECT_EQ(stalled->body, "stalled: the left camera's reader makes no progress\n");
}

TEST_F(MetricsServerTest, RefusesOtherRequests) {
  EXPECT_EQ(client_.Get("/")->status, 404);
  EXPECT_EQ(client_.Post("/metrics", "x", "text/plain")->status, 403);
  EXPECT_EQ(client_.Get("/metrics", httplib::Headers{{"Host", "attacker.example"}})->status, 403);
}

TEST_F(MetricsServerTest, ASlowClientBlocksNeitherOthersNorTheOdometry) {
  const SilentClient slow(port(), "GET /metrics HTTP/1.1\r\nHost: 127");
  ASSERT_TRUE(slow.isConnected());
  const auto start = std::chrono::steady_clock::now();
  server_.addPair(PairResult{}, message(odometry_t::VALID));
  EXPECT_EQ(client_.Get("/metrics")->status, 200);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2))
      << "before the slow one's time-out";
}

TEST_F(MetricsServerTest, TooManyClientsWaitAndTheOdometryDoesNot) {
  std::vector<std::unique_ptr<SilentClient>> idle;
  for (int i = 0; i < 8; ++i)
    idle.push_back(std::make_unique<SilentClient>(port(), "GET "));
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < 1000; ++i)
    server_.addPair(PairResult{}, message(odometry_t::VALID));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(1));
  const httplib::Result answer = client_.Get("/metrics");
  ASSERT_TRUE(answer) << "answered when the idle ones have been disconnected";
  EXPECT_EQ(answer->status, 200);
}

TEST_F(MetricsServerTest, NamesAPortThatIsTaken) {
  EXPECT_THAT(test::messageOf([&] {
                MetricsServer({"127.0.0.1", port()});
              }),
              HasSubstr("is the port taken?"));
}

}  // namespace
}  // namespace cartvo::daemon
