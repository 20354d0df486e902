// The live daemon on loopback in its own network namespace: simulated RTSP cameras -> daemon -> LCM.

#include <array>
#include <cmath>
#include <fstream>
#include <future>
#include <mutex>
#include <thread>

#include <cartvo/health_t.hpp>
#include <cartvo/odometry_t.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcm/lcm-cpp.hpp>
#include <sys/resource.h>

#include "calib/format/rig_file.hpp"
#include "daemon/publish/foreign_odometry.hpp"
#include "daemon/publish/lcm_connection.hpp"
#include "daemon/service/daemon.hpp"
#include "support/capture/synthetic_cameras.hpp"
#include "support/error_message.hpp"
#include "support/log_text.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_timeout.hpp"
#include "tools/simulate/server/simulated_camera.hpp"
#include "tools/simulate/stream/encode_content.hpp"

namespace cartvo::daemon {
namespace {

using simulate::SimulatedCamera;
using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kUrl = "udpm://239.255.76.67:7667?ttl=0";
constexpr double kFrameRate = 18.0;

/// The two walls of test::wall, moving past at 18 Hz.
class PassingWalls : public simulate::Content {
 public:
  calib::Rig rig() const override { return test::smallRig(); }
  double frameRate() const override { return kFrameRate; }
  int pairCount() const override { return 90; }
  std::int64_t leftInstant(int index) const override { return std::llround(index * 1e9 / kFrameRate); }
  std::int64_t rightInstant(int index) const override { return leftInstant(index); }
  void images(int index, cv::Mat& left, cv::Mat& right) const override {
    left = test::wall(index, 0);
    right = test::wall(index, 12);
  }
  Trajectory truth() const override { return {}; }
  std::string cacheKey() const override { return "passing walls"; }
};

/// Receives the odometry and health messages.
class Subscriber {
 public:
  Subscriber() : lcm_(kUrl) {
    lcm_.subscribe(kOdometryChannel, &Subscriber::onOdometry, this)->setQueueCapacity(1000);
    lcm_.subscribe(kHealthChannel, &Subscriber::onHealth, this);
  }

  /// Receives messages until the condition holds; false after the test time-out.
  bool receiveUntil(const std::function<bool()>& condition) {
    const auto end = std::chrono::steady_clock::now() + test::kTestTimeout;
    while (!condition() && std::chrono::steady_clock::now() < end)
      lcm_.handleTimeout(50);
    return condition();
  }

  std::vector<odometry_t> odometry;
  std::vector<health_t> health;

 private:
  void onOdometry(const lcm::ReceiveBuffer*, const std::string&, const odometry_t* message) {
    odometry.push_back(*message);
  }
  void onHealth(const lcm::ReceiveBuffer*, const std::string&, const health_t* message) {
    health.push_back(*message);
  }

  lcm::LCM lcm_;
};

/// A daemon that runs in a thread of its own until it is stopped, at the latest at the end of the test.
class RunningDaemon {
 public:
  explicit RunningDaemon(const Configuration& configuration)
      : daemon_(configuration), run_(std::async(std::launch::async, [this] { daemon_.run(); })) {}
  ~RunningDaemon() { stop(); }
  RunningDaemon(const RunningDaemon&) = delete;
  RunningDaemon& operator=(const RunningDaemon&) = delete;

  void reload(const Configuration& next) { daemon_.reload(next); }
  void stop() {
    daemon_.stop();
    run_.wait();
  }

 private:
  Daemon daemon_;
  std::future<void> run_;
};

class LiveStream : public testing::Test {
 protected:
  static std::unique_ptr<SimulatedCamera> camera(const simulate::EncodedStream& stream) {
    simulate::SimulatedCameraSettings settings;
    settings.password = "test";
    settings.repeat_after_ns = std::llround(90 * 1e9 / kFrameRate);
    return std::make_unique<SimulatedCamera>(std::make_shared<simulate::EncodedStream>(stream), settings);
  }

  void SetUp() override {
    const simulate::EncodedPair streams =
        simulate::encodeContent(PassingWalls(), simulate::EncoderSettings{}, [](int, int) {});
    left_ = camera(streams.left);
    right_ = camera(streams.right);
    calib::writeRig(folder_ / "rig.yaml", test::smallRig());
    std::ofstream(folder_ / "password") << "test\n";
    std::filesystem::permissions(folder_ / "password", std::filesystem::perms::owner_read);
    std::ofstream(folder_ / "cartvod.yaml")
        << "cameras:\n  left: {url: '" << left_->url() << "', username: admin, password_file: password}\n"
        << "  right: {url: '" << right_->url() << "', username: admin, password_file: password}\n"
        << "rig: rig.yaml\ntables: tables.bin\nodometry:\n  features: 300\n"
           "  alert_limits: {velocity: 100, angular_rate: 1000, motion: 100, rotation: 180}\n";
  }

  void startContent() {
    const std::int64_t epoch = hostNow() + 500'000'000;
    left_->startContent(epoch);
    right_->startContent(epoch);
  }

  test::TemporaryFolder folder_;
  std::unique_ptr<SimulatedCamera> left_, right_;
};

bool isValid(const odometry_t& message) {
  return message.status == odometry_t::VALID;
}
bool hasNoPair(const odometry_t& message) {
  return (message.reasons & odometry_t::REASON_NO_PAIR) != 0;
}

TEST_F(LiveStream, IsPublishedAsOdometryAndAsInvalidAfterCameraLoss) {
  Configuration configuration = readConfiguration(folder_ / "cartvod.yaml");
  configuration.recording_directory = folder_ / "recording";
  Subscriber subscriber;
  RunningDaemon daemon(configuration);

  // INVALID messages at the frame rate before the first pair.
  ASSERT_TRUE(subscriber.receiveUntil([&] { return subscriber.odometry.size() > 3; }));
  EXPECT_TRUE(hasNoPair(subscriber.odometry.front()));

  startContent();
  const auto valid = [&] {
    return std::count_if(subscriber.odometry.begin(), subscriber.odometry.end(),
                         [](const odometry_t& m) { return isValid(m) && m.velocity_body[1] < -0.3; });
  };
  ASSERT_TRUE(subscriber.receiveUntil([&] { return valid() >= 20; })) << valid() << " valid messages";
  const odometry_t moving = *std::find_if(subscriber.odometry.rbegin(), subscriber.odometry.rend(), isValid);
  EXPECT_NEAR(moving.velocity_body[1], -2.0 * 4.0 / 240.0 * kFrameRate, 0.1);
  EXPECT_GT(moving.arrival_utime, 0);
  EXPECT_GE(moving.publication_utime, moving.arrival_utime);
  EXPECT_EQ(moving.time_to_live_us, 250'000);
  for (std::size_t i = 1; i < subscriber.odometry.size(); ++i) {
    ASSERT_EQ(subscriber.odometry[i].sequence, subscriber.odometry[i - 1].sequence + 1);
  }
  ASSERT_FALSE(subscriber.health.empty());
  EXPECT_EQ(subscriber.health.back().left.state, +camera_health_t::STREAMING);

  right_.reset();
  const auto without_pair = [&] {
    return std::count_if(subscriber.odometry.rbegin(), subscriber.odometry.rend(), hasNoPair);
  };
  const auto before = without_pair();
  EXPECT_TRUE(subscriber.receiveUntil([&] { return without_pair() - before > 30; }))
      << "a message per period";
  EXPECT_TRUE(std::isnan(subscriber.odometry.back().velocity_body[0]));
  EXPECT_EQ(subscriber.odometry.back().position_world_body[1] < 0.0, true) << "the pose is kept";

  daemon.stop();
  EXPECT_TRUE(std::filesystem::exists(folder_ / "recording/000000/left.mkv"));
}

TEST_F(LiveStream, OfWrongSizeIsReportedInHealthAndDaemonKeepsRunning) {
  calib::Rig rig = test::smallRig();
  for (calib::CameraModel* camera : {&rig.left, &rig.right}) {
    camera->size = {640, 480};
    camera->cx = 319.5;
    camera->cy = 239.5;
  }
  calib::writeRig(folder_ / "rig.yaml", rig);
  Subscriber subscriber;
  RunningDaemon daemon(readConfiguration(folder_ / "cartvod.yaml"));
  startContent();
  EXPECT_TRUE(subscriber.receiveUntil([&] {
    return !subscriber.health.empty() && subscriber.health.back().refused_size > 0 &&
           !subscriber.odometry.empty() &&
           (subscriber.odometry.back().reasons & odometry_t::REASON_WRONG_SIZE) != 0;
  })) << "in both messages";
  ASSERT_FALSE(subscriber.health.empty());
  EXPECT_THAT(subscriber.health.back().problem, HasSubstr("320x240, but the rig is for 640x480"));
}

TEST_F(LiveStream, EndsAtTheStartIfTheRecordingThatWasAskedForCannotBeMade) {
  Configuration configuration = readConfiguration(folder_ / "cartvod.yaml");
  configuration.recording_directory = folder_ / "rig.yaml" / "recording";
  EXPECT_THROW(Daemon{configuration}, std::runtime_error);
}

TEST_F(LiveStream, IsProcessedIfRecordingFailsToStartAndHealthNamesTheCause) {
  Configuration configuration = readConfiguration(folder_ / "cartvod.yaml");
  configuration.recording_quota.recordings = folder_ / "rig.yaml";  // root may write anywhere else
  configuration.recording_directory = configuration.recording_quota.recordings / "recording";
  Subscriber subscriber;
  RunningDaemon daemon(configuration);
  startContent();
  EXPECT_TRUE(subscriber.receiveUntil([&] {
    return !subscriber.health.empty() && !subscriber.health.back().problem.empty() &&
           std::any_of(subscriber.odometry.begin(), subscriber.odometry.end(), isValid);
  }));
  ASSERT_FALSE(subscriber.health.empty());
  EXPECT_THAT(subscriber.health.back().problem,
              AllOf(HasSubstr("not recording: cannot create the folder"), HasSubstr("rig.yaml/recording")));
}

TEST_F(LiveStream, OfAbsentCameraIsLoggedOnceNotEachSecond) {
  const test::LogText log;
  right_.reset();
  Subscriber subscriber;
  RunningDaemon daemon(readConfiguration(folder_ / "cartvod.yaml"));
  const auto reports = [&] {
    return std::count_if(subscriber.health.begin(), subscriber.health.end(),
                         [](const health_t& health) { return !health.right.last_error.empty(); });
  };
  EXPECT_TRUE(subscriber.receiveUntil([&] { return reports() >= 3; }));
  daemon.stop();
  ASSERT_FALSE(subscriber.health.empty());
  EXPECT_EQ(log.linesWith(subscriber.health.back().right.last_error), 1);
  EXPECT_EQ(log.linesWith("right camera: connecting: "), 1);
}

TEST_F(LiveStream, ReloadChangesTheTimeToLiveOfARunningDaemon) {
  Subscriber subscriber;
  Configuration configuration = readConfiguration(folder_ / "cartvod.yaml");
  RunningDaemon daemon(configuration);
  ASSERT_TRUE(subscriber.receiveUntil([&] { return !subscriber.odometry.empty(); }));
  EXPECT_EQ(subscriber.odometry.back().time_to_live_us, 250'000);
  configuration.time_to_live = std::chrono::milliseconds(400);
  daemon.reload(configuration);
  EXPECT_TRUE(subscriber.receiveUntil([&] { return subscriber.odometry.back().time_to_live_us == 400'000; }));
}

/// Publishes with `publish` until the problem is found; returns the problem.
std::string foreignProblem(ForeignOdometry& foreign, const std::function<void()>& publish) {
  const auto end = std::chrono::steady_clock::now() + test::kTestTimeout;
  std::string problem;
  while (problem.empty() && std::chrono::steady_clock::now() < end) {
    publish();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    problem = foreign.consumeProblem();
  }
  return problem;
}

TEST(ForeignOdometry, FindsOtherPublishersAndNotItself) {
  lcm::LCM lcm(kUrl);
  constexpr std::int64_t kOwn = 53;
  ForeignOdometry foreign(kUrl, kOwn);
  odometry_t message{};
  message.source_id = kOwn;
  const auto publish_own = [&] { lcm.publish(kOdometryChannel, &message); };
  // Only after the first foreign message is found it is known that messages are received.
  EXPECT_THAT(foreignProblem(foreign,
                             [&] {
                               publish_own();
                               odometry_t other = message;
                               other.source_id += 1;
                               lcm.publish(kOdometryChannel, &other);
                             }),
              HasSubstr("another program publishes CARTVO_ODOMETRY: controllers receive two motions"));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  foreign.consumeProblem();
  for (int i = 0; i < 20; ++i)
    publish_own();
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_EQ(foreign.consumeProblem(), "");

  const std::array<std::uint8_t, 40> undecodable{0x12, 0x34};
  EXPECT_THAT(
      foreignProblem(foreign, [&] { lcm.publish(kOdometryChannel, undecodable.data(), undecodable.size()); }),
      HasSubstr("with another definition of the type"));
}

TEST(LcmConnection, FindsInterfaceOfRoute) {
  const MulticastRoute route = findMulticastRoute(kUrl);
  EXPECT_EQ(route.interface, "lo");
  EXPECT_TRUE(route.loopback);
  EXPECT_EQ(multicastWarning(route), "");
}

TEST(LcmConnection, ErrorExplainsHowToAddMissingRoute) {
  try {
    connectLcm("udpm://239.255.1.1:7667?ttl=0");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("no route for the multicast group 239.255.1.1"),
                                    HasSubstr("ip route add 239.255.1.1/32 dev lo")));
  }
}

TEST(LcmConnection, WarnsIfRouteDoesNotMatchTimeToLive) {
  EXPECT_THAT(multicastWarning({"239.255.76.67", "eth0", false, 0}),
              HasSubstr("through lo, but programs in Java"));
  EXPECT_THAT(multicastWarning({"239.255.76.67", "lo", true, 1}), HasSubstr("no other host receives"));
  EXPECT_EQ(multicastWarning({"239.255.76.67", "eth1", false, 1}), "");
  EXPECT_THAT(multicastWarning({"239.255.76.67", "", false, 0}), HasSubstr("cannot subscribe"));
  EXPECT_THAT(multicastWarning({"239.255.76.67", "", false, 1}), HasSubstr("messages are not sent"));
}

TEST(LcmConnection, TooFewDescriptorsAreNoMissingRoute) {
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  const rlimit none{0, limit.rlim_max};
  setrlimit(RLIMIT_NOFILE, &none);
  const std::string error = test::messageOf([] { connectLcm("udpm://239.255.1.1:7667?ttl=0"); });
  setrlimit(RLIMIT_NOFILE, &limit);
  EXPECT_THAT(error, AllOf(HasSubstr("cannot be looked up"), HasSubstr("Too many open files")));
}

TEST(LcmConnection, RejectsNonMulticastUrl) {
  EXPECT_THROW(findMulticastRoute("udpm://10.0.0.1:7667?ttl=0"), std::invalid_argument);
  EXPECT_THROW(findMulticastRoute("tcpq://127.0.0.1:7700"), std::invalid_argument);
}

}  // namespace
}  // namespace cartvo::daemon
