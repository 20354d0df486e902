// The live calibration page, requested over HTTP.
#include "tools/calibrate/views/live_page.hpp"

#include <future>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <nlohmann/json.hpp>

#include "support/error_message.hpp"

namespace cartvo {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class CalibrationPage : public ::testing::Test {
 protected:
  CalibrationPage() {
    browser_.set_keep_alive(true);
    progress_.left.image = cv::Mat(420, 1200, CV_8UC1, cv::Scalar(90));
    progress_.right.image = progress_.left.image;
    progress_.left.corners = {{3, {10.0, 20.0}}};
    progress_.advice = "hold it still: 0.4 of 1 s";
    progress_.next_view_advice = "show the board in the upper left of the right image";
    progress_.so_far.views = {{"1 at 3.0 s", progress_.left.corners, {}}};
    progress_.so_far.rejected = {{"2 at 5.0 s", "left image: it is <blurred>"}};
  }

  static std::string urlWithoutSlash(const LivePage& page) {
    return page.url().substr(0, page.url().size() - 1);
  }

  nlohmann::json state() { return nlohmann::json::parse(browser_.Get("/state.json")->body); }

  LivePage page_{{.address = "127.0.0.1", .port = 0}, calib::Chessboard{9, 6, 0.025}};
  httplib::Client browser_{urlWithoutSlash(page_)};
  StreamProgress progress_;
};

TEST_F(CalibrationPage, IsSelfContained) {
  const auto page = browser_.Get("/");
  ASSERT_TRUE(page);
  EXPECT_EQ(page->status, 200);
  EXPECT_THAT(page->body, AllOf(HasSubstr("<script src=\"/page.js\">"), Not(HasSubstr("http:")),
                                Not(HasSubstr("https:"))));
  EXPECT_THAT(page->get_header_value("Content-Security-Policy"), HasSubstr("default-src 'none'"));
  const auto script = browser_.Get("/page.js");
  ASSERT_TRUE(script);
  EXPECT_THAT(script->body, AllOf(HasSubstr("/state.json"), Not(HasSubstr("innerHTML"))));
}

TEST_F(CalibrationPage, ShowsPicturesViewsRejectionsAndAdvice) {
  EXPECT_EQ(state()["has_pictures"], false);
  EXPECT_EQ(browser_.Get("/left.jpg")->status, 404);
  const std::uint64_t before = state()["number"];
  page_.show(progress_);
  const nlohmann::json shown = state();
  EXPECT_GT(shown["number"], before);
  EXPECT_EQ(shown["board"], "chessboard:9x6:0.025");
  EXPECT_EQ(shown["stage"], "views");
  EXPECT_EQ(shown["advice"], progress_.advice);
  EXPECT_EQ(shown["next"], progress_.next_view_advice);
  EXPECT_EQ(shown["left"]["corners"], 1);
  EXPECT_EQ(shown["views"][0]["name"], "1 at 3.0 s");
  EXPECT_EQ(shown["rejected"][0]["reason"], "left image: it is <blurred>");
  const auto picture = browser_.Get("/left.jpg");
  EXPECT_EQ(picture->get_header_value("Content-Type"), "image/jpeg");
  EXPECT_THAT(picture->body, ::testing::StartsWith("\xff\xd8"));
}

TEST_F(CalibrationPage, WaitsUntilThePollingBrowserHasReadTheResult) {
  state();
  page_.showSolving();
  EXPECT_EQ(state()["stage"], "solving");
  auto verdict = std::async(std::launch::async, [this] { page_.showResult(false, "too few views"); });
  nlohmann::json last = state();
  while (last["stage"] != "done")
    last = state();
  verdict.get();
  EXPECT_EQ(last["passed"], false);
  EXPECT_EQ(last["result"], "too few views");
}

TEST_F(CalibrationPage, AnswersOnlyGetRequestsForANumericHostOrLocalhost) {
  const auto asked_as = [&](const std::string& host) {
    return browser_.Get("/state.json", httplib::Headers{{"Host", host}})->status;
  };
  EXPECT_EQ(asked_as("localhost:8600"), 200);
  EXPECT_EQ(asked_as("[::1]:8600"), 200);
  EXPECT_EQ(asked_as("attacker.example"), 403);
  EXPECT_EQ(asked_as("127.0.0.1.attacker.example:8600"), 403);
  EXPECT_EQ(browser_.Post("/state.json", "x", "text/plain")->status, 405);
  EXPECT_EQ(browser_.Get("/../etc/passwd")->status, 404);
}

TEST_F(CalibrationPage, ReportsAPortThatIsTaken) {
  const std::string url = urlWithoutSlash(page_);
  const auto port = static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1)));
  EXPECT_THAT(test::messageOf([&] {
                LivePage({.address = "127.0.0.1", .port = port}, calib::Chessboard{9, 6, 0.025});
              }),
              HasSubstr("is the port taken?"));
}

}  // namespace
}  // namespace cartvo
