// Log lines in the journal: text, priority and fields.
#include "daemon/diagnostics/journal.hpp"

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include "daemon/diagnostics/camera_log.hpp"

namespace cartvo::daemon {
namespace {

using Lines = std::vector<std::vector<std::string>>;

/// Sends the log to a journal that keeps its lines, and restores it.
class Journal : public testing::Test {
 protected:
  void SetUp() override { logTo(true); }
  void TearDown() override { spdlog::set_default_logger(before_); }

  void logTo(bool takes_lines) {
    auto sink = makeJournalSink([this, takes_lines](const std::vector<std::string>& fields) {
      if (takes_lines) lines_.push_back(fields);
      return takes_lines;
    });
    spdlog::set_default_logger(std::make_shared<spdlog::logger>("test", std::move(sink)));
  }

  Lines lines_;

 private:
  std::shared_ptr<spdlog::logger> before_ = spdlog::default_logger();
};

TEST_F(Journal, KeepsTheFieldsOfAnEvent) {
  logEvent(spdlog::level::warn, "the text", {{"CARTVO_EVENT", "test"}, {"CARTVO_CAMERA", "left"}});
  EXPECT_EQ(lines_, (Lines{{"MESSAGE=the text", "PRIORITY=4", "SYSLOG_IDENTIFIER=cartvod",
                            "CARTVO_EVENT=test", "CARTVO_CAMERA=left"}}));
}

TEST_F(Journal, GivesLaterLinesNoFieldsOfAnEarlierOne) {
  logEvent(spdlog::level::info, "first", {{"CARTVO_EVENT", "test"}});
  spdlog::error("second");
  EXPECT_EQ(lines_.at(1),
            (std::vector<std::string>{"MESSAGE=second", "PRIORITY=3", "SYSLOG_IDENTIFIER=cartvod"}));
}

TEST_F(Journal, TakesBracesInATextAsTheyAre) {
  logEvent(spdlog::level::info, "a {} brace", {});
  EXPECT_EQ(lines_.at(0).at(0), "MESSAGE=a {} brace");
}

TEST_F(Journal, NamesTheCameraAndItsState) {
  capture::CameraHealth health;
  health.state = capture::CameraState::stalled;
  health.last_error = "no picture for 2 s";
  CameraLog("left camera").log(health);
  ASSERT_EQ(lines_.size(), 1U);
  EXPECT_EQ(lines_[0][3], "CARTVO_EVENT=camera_state");
  EXPECT_EQ(lines_[0][4], "CARTVO_CAMERA=left");
  EXPECT_EQ(lines_[0][5], "CARTVO_CAMERA_STATE=stalled");
}

TEST_F(Journal, WritesTheTextToStandardErrorWhereTheJournalTakesNone) {
  logTo(false);
  testing::internal::CaptureStderr();
  logEvent(spdlog::level::err, "the text", {{"CARTVO_EVENT", "test"}});
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "<3>the text\n");
}

}  // namespace
}  // namespace cartvo::daemon
