// The metrics over HTTP: answers, idle clients, requests that are refused. See http_service_test.cpp for
// more.

#include "daemon/diagnostics/metrics_server.hpp"

#include <chrono>
#include <functional>
#include <memory>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>

#include "support/error_message.hpp"
#include "support/raw_client.hpp"
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

  /// Publishes and asks for the health until the answer begins with `line`; its status, or 0 at the time-out.
  /// More than once, because a busy machine may take longer than a message counts as new.
  int statusWith(const std::string& line, const std::function<void()>& publish) {
    const auto end = std::chrono::steady_clock::now() + test::kTestTimeout;
    while (std::chrono::steady_clock::now() < end) {
      publish();
      const httplib::Result answer = client_.Get("/healthz");
      if (answer && answer->body.starts_with(line)) return answer->status;
    }
    return 0;
  }

  std::uint16_t port() const { return ListenAddress::parse(server_.address()).port; }

  MetricsServer server_{ListenAddress{}};
  httplib::Client client_{"http://" + server_.address()};
};

TEST_F(MetricsServerTest, ServesHealthAndPairs) {
  health_t health{};
  health.version = "7.8.9";
  health.pairs = 42;
  server_.setHealth(health);
  server_.addPair(pipeline::PairResult{}, message(odometry_t::VALID));
  const httplib::Result metrics = client_.Get("/metrics");
  ASSERT_TRUE(metrics);
  EXPECT_EQ(metrics->status, 200);
  EXPECT_EQ(metrics->get_header_value("Content-Type"), "text/plain; version=0.0.4; charset=utf-8");
  EXPECT_THAT(metrics->body, HasSubstr("cartvo_pairs 42\n"));
  EXPECT_THAT(metrics->body, HasSubstr("cartvo_processed_pairs 1\n"));
}

TEST_F(MetricsServerTest, SaysWhetherTheDaemonIsHealthy) {
  const auto publish = [&](std::int8_t status) {
    return [&, status] { server_.addPair(pipeline::PairResult{}, message(status)); };
  };
  EXPECT_EQ(statusWith("waiting for ", [&] { server_.addMissedPair(message(odometry_t::INVALID)); }), 200);
  health_t health{};
  health.left.state = health.right.state = camera_health_t::STREAMING;
  server_.setHealth(health);
  EXPECT_EQ(statusWith("invalid (", publish(odometry_t::INVALID)), 503);
  EXPECT_EQ(statusWith("valid\n", publish(odometry_t::VALID)), 200);
  server_.setStalled("left camera's reader");
  EXPECT_EQ(statusWith("stalled: the left camera's reader makes no progress\n", publish(odometry_t::VALID)),
            503);
}

TEST_F(MetricsServerTest, IsAliveWhateverTheCamerasDoAndReadyOnceTheyStream) {
  EXPECT_EQ(client_.Get("/livez")->status, 200);
  EXPECT_EQ(client_.Head("/livez")->status, 200);
  const httplib::Result waiting = client_.Get("/readyz");
  EXPECT_EQ(waiting->status, 503);
  EXPECT_THAT(waiting->body, HasSubstr("the left camera is connecting"));
}

TEST_F(MetricsServerTest, RefusesOtherRequests) {
  EXPECT_EQ(client_.Get("/")->status, 404);
  EXPECT_EQ(client_.Post("/metrics", "x", "text/plain")->status, 405);
  EXPECT_EQ(client_.Get("/metrics", httplib::Headers{{"Host", "attacker.example"}})->status, 403);
}

TEST_F(MetricsServerTest, TooManyClientsWaitAndTheOdometryDoesNot) {
  std::vector<std::unique_ptr<test::RawClient>> idle;
  for (int i = 0; i < 8; ++i) {
    idle.push_back(std::make_unique<test::RawClient>(port()));
    EXPECT_TRUE(idle.back()->send("GET "));
  }
  for (int i = 0; i < 1000; ++i)
    server_.addPair(pipeline::PairResult{}, message(odometry_t::VALID));
  const httplib::Result answer = client_.Get("/metrics");
  ASSERT_TRUE(answer) << "answered when the idle ones have been disconnected";
  EXPECT_EQ(answer->status, 200);
}

TEST_F(MetricsServerTest, NamesAPortThatIsTaken) {
  EXPECT_THAT(test::messageOf([&] {
                MetricsServer({"127.0.0.1", port()});
              }),
              HasSubstr("is the port taken,"));
}

}  // namespace
}  // namespace cartvo::daemon
