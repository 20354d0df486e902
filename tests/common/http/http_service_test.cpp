// The HTTP server: clients that drip bytes, send no end, or stay at its stop; requests that it refuses.
#include "common/http/http_service.hpp"

#include <chrono>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/http/listen_address.hpp"
#include "support/error_message.hpp"
#include "support/raw_client.hpp"
#include "support/test_timeout.hpp"

namespace cartvo {
namespace {

using std::chrono::milliseconds;
using test::RawClient;

constexpr std::chrono::hours kLong{1};  ///< no test waits for it
constexpr std::size_t kThreads = 2;
constexpr std::size_t kMoreThanBuffers = std::size_t{64} << 20U;  ///< bytes; of two sockets on loopback

class HttpServiceTest : public testing::Test {
 protected:
  void start(const HttpLimits& limits, bool any_host = false) {
    server_.emplace(kThreads, limits);
    if (any_host) server_->allowAnyHost();
    server_->Get("/", [this](const httplib::Request&, httplib::Response& response) {
      response.set_content(content_, "text/plain");
    });
    port_ = server_->bind(ListenAddress{});
    ASSERT_GT(port_, 0);
    server_->start();
  }

  std::string answerTo(const std::string& request) {
    RawClient client(port_);
    EXPECT_TRUE(client.send(request));
    return client.receive();
  }

  std::string content_ = "content";
  std::optional<HttpService> server_;
  int port_ = 0;
};

TEST_F(HttpServiceTest, AnswersOneRequestPerConnection) {
  start({});
  const std::string answer = answerTo("GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: keep-alive\r\n\r\n");
  EXPECT_TRUE(answer.starts_with("HTTP/1.1 200 OK\r\n")) << answer;
  EXPECT_NE(answer.find("Connection: close\r\n"), std::string::npos);
  EXPECT_TRUE(answer.ends_with("\r\n\r\ncontent"));
}

TEST_F(HttpServiceTest, ASilentClientBlocksNoOther) {
  start({.request_time = kLong});
  RawClient silent(port_);
  ASSERT_TRUE(silent.send("GET / HTTP/1.1\r\nHost: 127"));
  EXPECT_TRUE(answerTo("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n").starts_with("HTTP/1.1 200"));
}

TEST_F(HttpServiceTest, ManySlowClientsHardlyDelayOthers) {
  start({.request_time = kLong});
  std::vector<std::unique_ptr<RawClient>> slow;
  for (std::size_t i = 0; i < 10 * kThreads; ++i) {
    slow.push_back(std::make_unique<RawClient>(port_));
    ASSERT_TRUE(slow.back()->send("GET / HTTP/1.1\r\nHost: 127"));
  }
  EXPECT_TRUE(answerTo("GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n").starts_with("HTTP/1.1 200"));
}

TEST_F(HttpServiceTest, ConnectionsAheadOfNeedBlockNoOther) {
  start({.request_time = kLong});
  std::vector<std::unique_ptr<RawClient>> idle;
  for (std::size_t i = 0; i < 3 * kThreads; ++i)
    idle.push_back(std::make_unique<RawClient>(port_));
  EXPECT_TRUE(answerTo("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n").starts_with("HTTP/1.1 200"));
}

TEST_F(HttpServiceTest, DisconnectsClientsThatDripBytes) {
  start({.request_time = milliseconds(200)});
  RawClient dripping(port_);
  const auto end = std::chrono::steady_clock::now() + test::kTestTimeout;
  bool is_connected = dripping.send("GET /");
  while (is_connected && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(milliseconds(10));
    is_connected = dripping.send("a");
  }
  EXPECT_FALSE(is_connected);
}

TEST_F(HttpServiceTest, DisconnectsAClientWhoseRequestHasNoEnd) {
  start({.request_time = kLong});
  for (const char* start_of_line : {"GET /", "GET / HTTP/1.1\r\nHost: "}) {
    RawClient client(port_);
    bool is_connected = client.send(start_of_line);
    const std::string part(65536, 'a');
    std::size_t sent = 0;
    for (; is_connected && sent < kMoreThanBuffers; sent += part.size())
      is_connected = client.send(part);
    EXPECT_FALSE(is_connected) << "after " << sent << " bytes";
  }
}

TEST_F(HttpServiceTest, DisconnectsAClientThatSendsHeadersWithoutEnd) {
  start({.request_time = kLong});
  RawClient client(port_);
  bool is_connected = client.send("GET / HTTP/1.1\r\n");
  for (int i = 0; is_connected && i < 10'000'000; ++i)
    is_connected = client.send("A: b\r\n");
  EXPECT_FALSE(is_connected);
}

TEST_F(HttpServiceTest, StopsAtOnceWithClientsConnected) {
  start({.request_time = kLong, .answer_time = kLong});
  std::vector<std::unique_ptr<RawClient>> silent;
  for (std::size_t i = 0; i < 3 * kThreads; ++i) {  // served, in the queue, and neither
    silent.push_back(std::make_unique<RawClient>(port_));
    ASSERT_TRUE(silent.back()->send("GET /"));
  }
  server_.reset();  // would take an hour
  EXPECT_EQ(silent.front()->receive(), "");
}

TEST_F(HttpServiceTest, StopsAtOnceWithAClientThatTakesNoAnswer) {
  content_.assign(kMoreThanBuffers, 'a');
  start({.request_time = kLong, .answer_time = kLong});
  RawClient client(port_);
  ASSERT_TRUE(client.send("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n"));
  server_.reset();
  EXPECT_LT(client.receive().size(), content_.size());
}

TEST_F(HttpServiceTest, DisconnectsAClientThatTakesNoAnswer) {
  content_.assign(kMoreThanBuffers, 'a');
  start({.request_time = kLong, .answer_time = milliseconds(100)});
  std::vector<std::unique_ptr<RawClient>> clients;
  for (std::size_t i = 0; i < kThreads; ++i) {
    clients.push_back(std::make_unique<RawClient>(port_));
    ASSERT_TRUE(clients.back()->send("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n"));
  }
  // Answered once a thread is free.
  EXPECT_TRUE(answerTo("GET /other HTTP/1.1\r\nHost: localhost\r\n\r\n").starts_with("HTTP/1.1 404"));
}

TEST_F(HttpServiceTest, AnswersMonitors) {
  start({});
  const std::string head = answerTo("HEAD / HTTP/1.1\r\nHost: LocalHost:80\r\n\r\n");
  EXPECT_TRUE(head.starts_with("HTTP/1.1 200")) << head;
  EXPECT_NE(head.find("Content-Length: 7\r\n"), std::string::npos) << head;
  EXPECT_TRUE(head.ends_with("\r\n\r\n")) << head;
  const std::string old = answerTo("GET / HTTP/1.0\r\n\r\n");
  EXPECT_NE(old.find(" 200 "), std::string::npos) << old;
  EXPECT_TRUE(old.ends_with("\r\n\r\ncontent")) << old;
}

TEST_F(HttpServiceTest, RefusesOtherMethodsAndHostsWithASentence) {
  start({});
  for (const char* method : {"OPTIONS", "PUT", "DELETE", "POST"}) {
    const std::string answer = answerTo(std::string(method) + " / HTTP/1.1\r\nHost: localhost\r\n\r\n");
    EXPECT_TRUE(answer.starts_with("HTTP/1.1 405")) << answer;
    EXPECT_NE(answer.find("Allow: GET, HEAD\r\n"), std::string::npos) << answer;
    EXPECT_NE(answer.find("takes the methods"), std::string::npos) << answer;
  }
  for (const char* host : {"attacker.example", "127.0.0.1.example", "x"}) {
    const std::string answer = answerTo("GET / HTTP/1.1\r\nHost: " + std::string(host) + "\r\n\r\n");
    EXPECT_TRUE(answer.starts_with("HTTP/1.1 403")) << answer;
    EXPECT_NE(answer.find("Behind a proxy"), std::string::npos) << answer;
  }
  const std::string absent = answerTo("GET /other HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_TRUE(absent.ends_with("there is nothing at this path\n")) << absent;
}

TEST_F(HttpServiceTest, AnswersAnyHostIfAllowed) {
  start({}, true);
  EXPECT_TRUE(answerTo("GET / HTTP/1.1\r\nHost: cart.example\r\n\r\n").starts_with("HTTP/1.1 200"));
}

TEST_F(HttpServiceTest, IgnoresRangesBecauseManyMakeAnAnswerOfAnySize) {
  start({});
  std::string ranges = "0-";
  for (int i = 0; i < 1000; ++i)
    ranges += ",0-";
  const std::string answer =
      answerTo("GET / HTTP/1.1\r\nHost: localhost\r\nRange: bytes=" + ranges + "\r\n\r\n");
  EXPECT_LT(answer.size(), 1000u);
  EXPECT_TRUE(answer.ends_with("\r\n\r\ncontent")) << answer;
}

TEST_F(HttpServiceTest, CanEndWithoutAStart) {
  HttpService server(kThreads);
  EXPECT_GT(server.bind(ListenAddress{}), 0);
}

using testing::HasSubstr;

TEST(ListenAddress, IsAPortOrAddressAndPort) {
  EXPECT_EQ(ListenAddress::parse("81").port, 81);
  EXPECT_TRUE(ListenAddress::parse("81").isLoopback());
  EXPECT_EQ(ListenAddress::parse("0.0.0.0:81").address, "0.0.0.0");
  EXPECT_FALSE(ListenAddress::parse("0.0.0.0:81").isLoopback());
  EXPECT_EQ(ListenAddress::parse("[::1]:81").address, "::1");
  EXPECT_TRUE(ListenAddress::parse("[::1]:81").isLoopback());
  EXPECT_EQ(ListenAddress::parse("[::1]:81").text(), "[::1]:81");
  EXPECT_EQ(ListenAddress::parse("81").text(), "127.0.0.1:81");
  EXPECT_EQ(ListenAddress::parse("localhost:81").text(), "127.0.0.1:81");
  for (const char* const wrong : {"", "live", "70000", "-1", "cart:80", "127.0.0.1:", "1.2.3:80", "80 "}) {
    EXPECT_THAT(test::messageOf([&] { ListenAddress::parse(wrong); }),
                HasSubstr("is neither PORT nor ADDRESS:PORT"))
        << wrong;
  }
}

}  // namespace

}  // namespace cartvo
