// Checks of LCM, in a network namespace of its own.
#include "tools/doctor/network/lcm_checks.hpp"

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcm/lcm-cpp.hpp>

#include "daemon/publish/lcm_connection.hpp"
#include "support/camera/isapi_server.hpp"
#include "support/client/valid_message.hpp"
#include "support/doctor/findings.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_timeout.hpp"
#include "support/tools/run_cartvo.hpp"

namespace cartvo::doctor {
namespace {

using test::findingOf;
using test::Saw;

constexpr const char* kUrl = "udpm://239.255.76.67:7667?ttl=0";

/// A health message of a daemon that receives its left camera; the right one refuses the login.
health_t exampleHealth() {
  health_t health{};
  health.version = "7.8.9";
  health.left.state = camera_health_t::STREAMING;
  health.right.state = camera_health_t::REFUSED;
  return health;
}

/// Publishes health and odometry until it is destroyed.
class Publisher {
 public:
  explicit Publisher(bool is_foreign)
      : lcm_(daemon::connectLcm(kUrl)), thread_([this, is_foreign] { run(is_foreign); }) {}
  ~Publisher() {
    ended_ = true;
    thread_.join();
  }
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

 private:
  void run(bool is_foreign) {
    const health_t health = exampleHealth();
    const std::string garbage = "not a message of this type";
    for (std::int64_t sequence = 0; !ended_; ++sequence) {
      const odometry_t message = test::validMessage(sequence);
      lcm_->publish(daemon::kOdometryChannel, &message);
      if (is_foreign) {
        lcm_->publish(daemon::kHealthChannel, garbage.data(), static_cast<unsigned>(garbage.size()));
      } else {
        lcm_->publish(daemon::kHealthChannel, &health);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }

  std::unique_ptr<lcm::LCM> lcm_;
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

LcmObservation observe(std::chrono::milliseconds duration) {
  const std::atomic<bool> interrupted{false};
  return observeLcm(kUrl, duration, interrupted);
}

Findings checked(const LcmObservation& seen, const std::string& url) {
  FindingList list("messages");
  checkLcm(url, seen, list);
  return list.take();
}

TEST(LcmChecks, ReceiveTheirOwnMessageAndThoseOfCartvod) {
  const Publisher publisher(false);
  const LcmObservation seen = observe(test::kTestTimeout);
  EXPECT_TRUE(seen.is_returned);
  ASSERT_TRUE(seen.health);
  EXPECT_EQ(seen.health->version, "7.8.9");
  EXPECT_GT(seen.odometry_messages, 0);
  EXPECT_EQ(worstVerdict(checked(seen, kUrl)), Verdict::ok) << areaText(checked(seen, kUrl));
}

TEST(LcmChecks, FindMessagesOfAnotherRelease) {
  const Publisher publisher(true);
  const LcmObservation seen = observe(std::chrono::milliseconds(1000));
  EXPECT_FALSE(seen.health);
  EXPECT_THAT(findingOf(checked(seen, kUrl), "publishers"), Saw(Verdict::broken, "another release"));
}

TEST(LcmChecks, EndAtAnInterruption) {
  const std::atomic<bool> interrupted{true};
  EXPECT_FALSE(observeLcm(kUrl, test::kTestTimeout, interrupted).health);
}

TEST(LcmChecks, FindAMissingRoute) {
  const std::string url = "udpm://239.1.2.3:7667?ttl=0";
  const std::atomic<bool> interrupted{false};
  const LcmObservation seen = observeLcm(url, test::kTestTimeout, interrupted);
  EXPECT_THAT(seen.problem, testing::HasSubstr("no route"));
  EXPECT_THAT(findingOf(checked(seen, url), "multicast route"),
              Saw(Verdict::broken, "no route for 239.1.2.3"));
}

TEST(LcmChecks, JudgeWhatWasObserved) {
  LcmObservation seen;
  EXPECT_THAT(findingOf(checked(seen, kUrl), "own message"), Saw(Verdict::broken, "not received back"));
  seen.is_returned = true;
  EXPECT_THAT(findingOf(checked(seen, kUrl), "publishers"), Saw(Verdict::ok, "no cartvod"));
  seen.has_two_publishers = true;
  EXPECT_THAT(findingOf(checked(seen, kUrl), "publishers"), Saw(Verdict::broken, "two programs"));
  const std::string far = "udpm://239.255.76.67:7667?ttl=1";
  EXPECT_THAT(findingOf(checked(seen, far), "multicast route"), Saw(Verdict::look_at, "no other host"));
}

TEST(DoctorBesideCartvod, OpensNoStreamAndSendsNoPasswordThatWasRefused) {
  const Publisher publisher(false);
  const test::IsapiServer camera;
  const test::TemporaryFolder folder;
  std::ofstream(folder / "password") << "canary-7Fq2";
  std::filesystem::permissions(folder / "password", std::filesystem::perms::owner_read);
  const std::string url = "rtsp://127.0.0.1:" + std::to_string(camera.port()) + "/1";
  std::ofstream(folder / "cartvod.yaml")
      << "cameras:\n  left: {url: '" << url << "'}\n  right: {url: '" << url << "02"
      << "', username: admin, password_file: password}\nrig: rig.yaml\n";
  const test::CommandResult result = test::runCartvo("doctor " + (folder / "cartvod.yaml").string() +
                                                     " --http-port " + std::to_string(camera.port()));
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_THAT(result.output, testing::HasSubstr("publishers: one cartvod"));
  EXPECT_THAT(result.output, testing::HasSubstr("not checked  stream: cartvod has it"));
  EXPECT_THAT(result.output, testing::HasSubstr("refuses the login, by cartvod"));
  EXPECT_THAT(result.output, testing::HasSubstr("login: cartvod was refused, so that no password was sent"));
  EXPECT_EQ(camera.wrongPasswords(), 0);
  EXPECT_THAT(camera.received(), testing::Not(testing::HasSubstr("Authorization")));
}

}  // namespace
}  // namespace cartvo::doctor
