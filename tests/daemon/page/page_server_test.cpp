// The status page over HTTP: who may read and press buttons, what is refused, slow clients.
#include "daemon/page/page_server.hpp"

#include <chrono>
#include <memory>
#include <optional>
#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <nlohmann/json.hpp>

#include "support/error_message.hpp"
#include "support/raw_client.hpp"
#include "support/test_timeout.hpp"

namespace cartvo::daemon {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kToken = "a-token-of-the-test";

class FixedContent : public PageContent {
 public:
  std::string about() override { return R"({"mode":"live"})"; }
  std::optional<std::string> newestFrame(std::uint64_t seen) override {
    if (seen == 5) return std::nullopt;
    return frame;
  }
  std::optional<std::string> storedFrame(std::uint64_t pair) override {
    if (pair != 7) return std::nullopt;
    return "stored";
  }
  std::string history() override { return "{}"; }
  std::string health() override { return "{}"; }
  std::string control(const std::string& action) override {
    actions.push_back(action);
    return action == "refused" ? "because of the test" : "";
  }

  std::string frame = "newest";
  std::vector<std::string> actions;
};

class PageServerTest : public testing::Test {
 protected:
  void serve(const std::string& address, PageControllers controllers = PageControllers::token_holders,
             const std::string& token = kToken) {
    PageServerSettings settings;
    settings.address.address = address;
    settings.token = token;
    settings.controllers = controllers;
    server_.emplace(settings, content_);
    const std::string url = server_->url();
    origin_ = "http://127.0.0.1:" + url.substr(url.rfind(':') + 1);
    origin_.pop_back();
    client_ = std::make_unique<httplib::Client>(origin_);
    client_->set_read_timeout(test::kTestTimeout);
  }
  int get(const std::string& path, const httplib::Headers& headers = {}) {
    const httplib::Result answer = client_->Get(path, headers);
    return answer ? answer->status : 0;
  }
  int post(const std::string& path, const std::string& body, const httplib::Headers& headers) {
    const httplib::Result answer = client_->Post(path, headers, body, "text/plain");
    return answer ? answer->status : 0;
  }
  nlohmann::json about(const httplib::Headers& headers = {}) {
    return nlohmann::json::parse(client_->Get("/about.json", headers)->body);
  }
  std::string cookie() {
    const httplib::Result answer = client_->Post("/login", {{"Origin", origin_}}, kToken, "text/plain");
    EXPECT_EQ(answer->status, 204);
    const std::string value = answer->get_header_value("Set-Cookie");
    return value.substr(0, value.find(';'));
  }

  FixedContent content_;
  std::optional<PageServer> server_;
  std::string origin_;
  std::unique_ptr<httplib::Client> client_;
};

const httplib::Headers kBearer{{"Authorization", "Bearer " + kToken}};

TEST_F(PageServerTest, ServesThePageWithAStrictPolicy) {
  serve("127.0.0.1");
  for (const char* path : {"/", "/style.css", "/page.js", "/help.html", "/troubleshooting.md"}) {
    const httplib::Result answer = client_->Get(path);
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->status, 200) << path;
    const std::string policy = answer->get_header_value("Content-Security-Policy");
    EXPECT_THAT(policy, HasSubstr("default-src 'none'; script-src 'self'; style-src 'self'"));
    EXPECT_EQ(policy.find("unsafe"), std::string::npos);
    EXPECT_EQ(answer->get_header_value("Access-Control-Allow-Origin"), "");
    EXPECT_EQ(answer->body.find("http://"), std::string::npos) << path << ": works without internet";
    EXPECT_EQ(answer->body.find("https://"), std::string::npos) << path;
  }
  EXPECT_EQ(get("/index.html"), 404);
  EXPECT_EQ(get("/../../etc/passwd"), 404);
}

TEST_F(PageServerTest, AtTheLoopbackEveryoneReadsAndTokenHoldersControl) {
  serve("127.0.0.1");
  for (const char* path : {"/frame", "/history.json", "/health.json", "/frame?pair=7"})
    EXPECT_EQ(get(path), 200) << path;
  EXPECT_EQ(about()["control"], "with_token");
  EXPECT_EQ(post("/control", "recording/start", {{"Origin", origin_}}), 401);
  EXPECT_THAT(content_.actions, IsEmpty());
  EXPECT_EQ(post("/control", "recording/start", {{"Origin", origin_}, {"Cookie", cookie()}}), 204);
  EXPECT_EQ(post("/control", "recording/stop", kBearer), 204);
  EXPECT_THAT(content_.actions, ElementsAre("recording/start", "recording/stop"));
}

TEST_F(PageServerTest, AtOtherAddressesTheTokenIsNeededForAllData) {
  serve("0.0.0.0");
  EXPECT_EQ(get("/"), 200);
  EXPECT_EQ(about(), nlohmann::json::parse(R"({"login":"needed"})"));
  for (const char* path : {"/frame", "/history.json", "/health.json", "/frame?pair=7"}) {
    EXPECT_EQ(get(path), 401) << path;
    EXPECT_EQ(get(path, {{"Authorization", "Bearer wrong-wrong-wrong"}}), 401) << path;
    EXPECT_EQ(get(path, kBearer), 200) << path;
    EXPECT_EQ(get(path, {{"Cookie", cookie()}}), 200) << path;
  }
  EXPECT_EQ(about(kBearer)["control"], "yes");
}

TEST_F(PageServerTest, NeedsATokenAtOtherAddresses) {
  EXPECT_THAT(test::messageOf([&] { serve("0.0.0.0", PageControllers::token_holders, ""); }),
              HasSubstr("can be reached from other computers: it needs a token"));
}

TEST_F(PageServerTest, AReplayIsControlledByItsReaders) {
  serve("127.0.0.1", PageControllers::readers, "");
  EXPECT_EQ(about()["control"], "yes");
  EXPECT_EQ(post("/control", "replay/pause", {{"Origin", origin_}}), 204);
}

TEST_F(PageServerTest, OtherSitesCannotPressButtons) {
  serve("127.0.0.1", PageControllers::readers);
  const std::string own = cookie();
  for (const std::string& origin :
       {std::string("http://attacker.example"), std::string("null"), origin_ + "0"}) {
    EXPECT_EQ(post("/control", "replay/pause", {{"Origin", origin}, {"Cookie", own}}), 403) << origin;
    EXPECT_EQ(post("/login", kToken, {{"Origin", origin}}), 403) << origin;
  }
  EXPECT_EQ(post("/control", "replay/pause", {{"Cookie", own}}), 403) << "without an origin";
  EXPECT_EQ(get("/control?action=replay/pause"), 404);
  EXPECT_THAT(content_.actions, IsEmpty());
}

TEST_F(PageServerTest, OtherHostNamesAreRefused) {
  serve("127.0.0.1");
  EXPECT_EQ(get("/frame", {{"Host", "attacker.example"}}), 403);
  EXPECT_EQ(post("/control", "x", {{"Host", "attacker.example"}, {"Origin", "http://attacker.example"}}),
            403);
}

TEST_F(PageServerTest, AProxyNamesTheHostThatTheBrowserAsked) {
  serve("127.0.0.1");
  EXPECT_EQ(post("/login", kToken, {{"Origin", "https://cart.example"}}), 403);
  EXPECT_EQ(
      post("/login", kToken, {{"Origin", "https://cart.example"}, {"X-Forwarded-Host", "cart.example"}}),
      204);
}

TEST_F(PageServerTest, RefusesWrongTokensAndThenAllForAWhile) {
  serve("127.0.0.1");
  for (int i = 0; i < 10; ++i)
    EXPECT_EQ(post("/login", "wrong-wrong-wrong", {{"Origin", origin_}}), 401);
  EXPECT_EQ(post("/login", kToken, {{"Origin", origin_}}), 429);
}

TEST_F(PageServerTest, SaysWhyAnActionIsNotDone) {
  serve("127.0.0.1");
  const httplib::Result answer = client_->Post("/control", kBearer, "refused", "text/plain");
  EXPECT_EQ(answer->status, 409);
  EXPECT_EQ(answer->body, "because of the test\n");
}

TEST_F(PageServerTest, RefusesHostileRequests) {
  serve("127.0.0.1");
  EXPECT_EQ(post("/control", "", kBearer), 400);
  EXPECT_EQ(post("/control", std::string(1000, 'a'), kBearer), 400);
  EXPECT_NE(post("/control", std::string(100'000, 'a'), kBearer), 204) << "more than a request may have";
  EXPECT_EQ(post("/frame", "x", kBearer), 405);
  EXPECT_EQ(client_->Delete("/frame")->status, 405);
  for (const char* pair : {"-1", "", "99999999999999999999999", "7x", "%00", "../7"})
    EXPECT_EQ(get(std::string("/frame?pair=") + pair), 404) << pair;
  EXPECT_THAT(content_.actions, IsEmpty());
}

TEST_F(PageServerTest, HasNoFrameThatWasSeen) {
  serve("127.0.0.1");
  EXPECT_EQ(get("/frame?seen=5"), 204);
  EXPECT_EQ(client_->Get("/frame?seen=4")->body, "newest");
  EXPECT_EQ(client_->Get("/frame?seen=abc")->body, "newest");
  EXPECT_EQ(client_->Get("/frame?pair=7")->body, "stored");
  EXPECT_EQ(get("/frame?pair=8"), 404);
}

TEST_F(PageServerTest, SlowClientsKeepNoThread) {
  content_.frame.assign(150'000, 'a');  // as large as frames are
  serve("127.0.0.1");
  const std::uint16_t port = ListenAddress::parse(origin_.substr(7)).port;
  std::vector<std::unique_ptr<test::RawClient>> slow;  // that ask for a frame and never read it
  for (int i = 0; i < 40; ++i) {
    slow.push_back(std::make_unique<test::RawClient>(port, 4096));
    EXPECT_TRUE(slow.back()->send("GET /frame HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"));
  }
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(get("/health.json"), 200);
  const std::chrono::duration<double> waited = std::chrono::steady_clock::now() - begin;
  EXPECT_LT(waited.count(), 30.0) << "ten rounds of four threads at 5 s each would be 50 s";
}

}  // namespace
}  // namespace cartvo::daemon
