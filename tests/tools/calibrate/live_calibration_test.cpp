// `cartvo calibrate live` with two simulated RTSP cameras and its page, and `cartvo calibrate` from a
// recording of the same cameras.
#include <array>
#include <atomic>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "calib/format/rig_file.hpp"
#include "capture/recording/stream_recorder.hpp"
#include "capture/rtsp/rtsp_camera.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_timeout.hpp"
#include "support/tools/held_boards.hpp"
#include "support/tools/run_cartvo.hpp"
#include "support/tools/running_cartvo.hpp"
#include "tools/simulate/server/simulated_camera.hpp"
#include "tools/simulate/stream/encode_content.hpp"

// Included last: it defines the resolver's macro _res, which breaks Eigen's headers.
#include <httplib.h>

namespace cartvo {
namespace {

using simulate::SimulatedCamera;
using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kPassword = "sesame-7351";
constexpr const char* kBoard = " --board chessboard:8x5:0.05 --model brown2 ";

/// Waits for what must come.
bool comes(const std::function<bool()>& condition) {
  const auto end = std::chrono::steady_clock::now() + test::kTestTimeout;
  while (!condition() && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  return condition();
}

std::unique_ptr<SimulatedCamera> switchOn(const simulate::EncodedStream& stream) {
  simulate::SimulatedCameraSettings settings;
  settings.password = kPassword;
  settings.repeat_after_ns = std::llround(test::HeldBoards::kPairs * 1e9 / test::HeldBoards::kFrameRate);
  return std::make_unique<SimulatedCamera>(std::make_shared<simulate::EncodedStream>(stream), settings);
}

/// Reads a camera and passes its stream to the recorder, like the daemon.
class RecordedCamera {
 public:
  RecordedCamera(const SimulatedCamera& camera, capture::StreamObserver& recorder)
      : camera_(settingsFor(camera)) {
    camera_.setObserver(recorder);
    reader_ = std::thread([this] {
      capture::Frame frame;
      while (camera_.read(frame, std::chrono::milliseconds(100)) != capture::ReadOutcome::ended) {
      }
    });
  }
  ~RecordedCamera() {
    camera_.interrupt();
    reader_.join();
  }
  RecordedCamera(const RecordedCamera&) = delete;
  RecordedCamera& operator=(const RecordedCamera&) = delete;

 private:
  static capture::RtspCameraSettings settingsFor(const SimulatedCamera& camera) {
    capture::RtspCameraSettings settings;
    settings.url = camera.url();
    settings.credentials = {"admin", kPassword};
    return settings;
  }

  capture::RtspCamera camera_;
  std::thread reader_;
};

class LiveCalibration : public ::testing::Test {
 protected:
  void SetUp() override {
    const simulate::EncodedPair streams =
        simulate::encodeContent(test::HeldBoards(), simulate::EncoderSettings{}, [](int, int) {});
    left_ = switchOn(streams.left);
    right_ = switchOn(streams.right);
    std::ofstream(folder_ / "password") << kPassword << "\n";
    std::filesystem::permissions(folder_ / "password", std::filesystem::perms::owner_read);
    std::ofstream(folder_ / "cartvod.yaml")
        << "cameras:\n  left: {url: '" << left_->url() << "', username: admin, password_file: password}\n"
        << "  right: {url: '" << right_->url()
        << "', username: admin, password_file: password}\n";  // no rig: yet
  }

  /// Starts the content when each camera has this many clients.
  void startContentFor(int clients) {
    ASSERT_TRUE(
        comes([&] { return left_->playingClients() == clients && right_->playingClients() == clients; }));
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    const std::int64_t epoch = std::chrono::nanoseconds(now).count() + 300'000'000;
    left_->startContent(epoch);
    right_->startContent(epoch);
  }

  void expectTruth(const calib::Rig& rig) const {
    const calib::Rig truth = test::HeldBoards::rigOfBoards();
    EXPECT_NEAR(rig.baseline(), truth.baseline(), 2e-3);
    EXPECT_NEAR(rig.left.fx, truth.left.fx, 1.5);
    EXPECT_NEAR(rig.right.fx, truth.right.fx, 1.5);
  }

  test::TemporaryFolder folder_;
  std::unique_ptr<SimulatedCamera> left_, right_;
};

std::string pageOf(const std::string& said) {
  const std::string before = "the page is at ";
  const std::size_t begin = said.find(before);
  if (begin == std::string::npos) return {};
  const std::size_t url = begin + before.size(), end = said.find("/\n", url);
  return end == std::string::npos ? std::string() : said.substr(url, end - url);
}

TEST_F(LiveCalibration, CalibratesOverRtspWithPageAndFromTheRecording) {
  capture::StreamRecorder recorder({.folder = folder_ / "recording", .configuration = "", .rig = ""});
  auto recorded_left = std::make_unique<RecordedCamera>(*left_, recorder.left());
  auto recorded_right = std::make_unique<RecordedCamera>(*right_, recorder.right());
  test::RunningCartvo cartvo("calibrate live --config " + (folder_ / "cartvod.yaml").string() + kBoard +
                                 "--page 0 --output " + (folder_ / "live.yaml").string() + " --report " +
                                 (folder_ / "report.html").string(),
                             folder_ / "said");
  ASSERT_TRUE(comes([&] { return !pageOf(cartvo.output()).empty(); })) << cartvo.output();
  startContentFor(2);

  httplib::Client browser(pageOf(cartvo.output()));
  nlohmann::json state;
  const auto has_views = [&](std::size_t count) {
    const auto answer = browser.Get("/state.json");
    if (!answer || answer->status != 200) return false;
    state = nlohmann::json::parse(answer->body);
    return state["views"].size() >= count;
  };
  ASSERT_TRUE(comes([&] { return has_views(2); })) << cartvo.output();
  EXPECT_THAT(state["next"].get<std::string>(), HasSubstr("show the board in the"));
  EXPECT_THAT(state["left"]["coverage"].get<std::vector<int>>(), ::testing::Contains(::testing::Gt(0)));
  EXPECT_THAT(state.dump(), AllOf(Not(HasSubstr(kPassword)), Not(HasSubstr("rtsp:"))));
  for (const char* const path : {"/left.jpg", "/right.jpg"}) {
    const auto picture = browser.Get(path);
    ASSERT_TRUE(picture);
    const std::vector<unsigned char> bytes(picture->body.begin(), picture->body.end());
    EXPECT_EQ(cv::imdecode(bytes, cv::IMREAD_GRAYSCALE).size(), cv::Size(320, 240)) << path;
  }

  ASSERT_TRUE(comes([&] { return has_views(8); })) << cartvo.output();
  cartvo.interrupt();
  EXPECT_EQ(cartvo.wait(), 0) << cartvo.output();
  EXPECT_THAT(cartvo.output(), AllOf(HasSubstr("view 8 taken at"), HasSubstr("the calibration passes")));
  expectTruth(calib::readRig(folder_ / "live.yaml"));
  EXPECT_EQ(cv::imread((folder_ / "report-views/image_1/008.png").string(), cv::IMREAD_GRAYSCALE).size(),
            cv::Size(320, 240));
  const test::CommandResult kept = test::runCartvo("calibrate " + (folder_ / "report-views").string() +
                                                   kBoard + "--output " + (folder_ / "kept.yaml").string());
  EXPECT_EQ(kept.exit_code, 0) << kept.output;
  expectTruth(calib::readRig(folder_ / "kept.yaml"));

  recorded_left.reset();
  recorded_right.reset();
  recorder.finish();
  const test::CommandResult again = test::runCartvo("calibrate " + (folder_ / "recording").string() + kBoard +
                                                    "--output " + (folder_ / "recorded.yaml").string() +
                                                    " --report " + (folder_ / "recorded.html").string());
  EXPECT_EQ(again.exit_code, 0) << again.output;
  expectTruth(calib::readRig(folder_ / "recorded.yaml"));
}

}  // namespace
}  // namespace cartvo
