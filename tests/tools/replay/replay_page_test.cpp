// The page of a replay: pause, step, stored pairs.
#include "tools/replay/replay_page.hpp"

#include <atomic>
#include <chrono>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <httplib.h>
#include <nlohmann/json.hpp>

#include "support/test_timeout.hpp"

namespace cartvo {
namespace {

using Json = nlohmann::json;

class ReplayPageTest : public testing::Test {
 protected:
  static ReplayPageSettings settings() {
    ReplayPageSettings settings;
    settings.server.controllers = daemon::PageControllers::readers;
    settings.title = "drive";
    settings.speed = 0.0;
    return settings;
  }

  void addPair(std::uint64_t sequence) {
    pipeline::PairView* view = page_.nextView();
    view->left = view->right = cv::Mat(8, 16, CV_8UC1, cv::Scalar(static_cast<double>(sequence)));
    pipeline::PairResult result;
    result.sequence = sequence;
    page_.addPair(result, 10);
    added_ = sequence + 1;
  }

  Json get(const std::string& path) { return Json::parse(client_.Get(path)->body); }
  Json frame(const std::string& path) {
    const httplib::Result answer = client_.Get(path);
    if (answer->status != 200) return {};
    const auto size = static_cast<std::size_t>(static_cast<unsigned char>(answer->body[0])) +
                      256 * static_cast<std::size_t>(static_cast<unsigned char>(answer->body[1]));
    return Json::parse(answer->body.substr(4, size));
  }
  int control(const std::string& action) {
    return client_.Post("/control", {{"Origin", origin_}}, action, "text/plain")->status;
  }
  bool waitUntilAdded(std::uint64_t pairs) const {
    const auto end = std::chrono::steady_clock::now() + test::kTestTimeout;
    while (added_ < pairs && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return added_ == pairs;
  }

  ReplayPage page_{settings()};
  std::string origin_ = page_.url().substr(0, page_.url().size() - 1);
  httplib::Client client_{origin_};
  std::atomic<std::uint64_t> added_{0};
};

TEST_F(ReplayPageTest, KeepsPairsAsTheyWereProcessed) {
  for (std::uint64_t i = 0; i < 5; ++i)
    addPair(i);
  page_.finish();
  EXPECT_EQ(get("/about.json")["content"]["mode"], "replay");
  EXPECT_EQ(get("/health.json")["replay"],
            Json::parse(R"({"state": "ended", "first": 0, "last": 4, "total": 10})"));
  EXPECT_EQ(frame("/frame?seen=0")["pictures"]["sequence"], 4);
  EXPECT_EQ(client_.Get("/frame?seen=5")->status, 204);
  EXPECT_EQ(frame("/frame?pair=2")["pictures"]["sequence"], 2);
  EXPECT_EQ(frame("/frame?pair=2")["samples"].size(), 3U);
  EXPECT_EQ(frame("/frame?pair=2")["light"]["state"], "invalid");
  EXPECT_EQ(client_.Get("/frame?pair=5")->status, 404);
  EXPECT_EQ(get("/history.json")["samples"].size(), 5U);
  EXPECT_EQ(control("replay/step"), 409) << "it has ended";
}

TEST_F(ReplayPageTest, PausesAndSteps) {
  EXPECT_EQ(control("replay/pause"), 204);
  std::thread replaying([&] {
    for (std::uint64_t i = 0; i < 4; ++i)
      addPair(i);
  });
  for (std::uint64_t pair = 0; pair < 3; ++pair) {
    EXPECT_TRUE(waitUntilAdded(pair));
    const auto end = std::chrono::steady_clock::now() + test::kTestTimeout;
    while (client_.Get("/frame?pair=" + std::to_string(pair))->status != 200 &&
           std::chrono::steady_clock::now() < end) {
    }
    EXPECT_EQ(get("/health.json")["replay"]["state"], "paused");
    EXPECT_EQ(get("/health.json")["replay"]["last"], pair);
    EXPECT_EQ(control("replay/step"), 204);
  }
  EXPECT_EQ(control("replay/run"), 204);
  replaying.join();
  EXPECT_EQ(added_, 4U);
}

TEST_F(ReplayPageTest, RefusesOtherActions) {
  EXPECT_EQ(control("recording/start"), 409);
  EXPECT_EQ(control("replay"), 409);
}

}  // namespace
}  // namespace cartvo
