// Two cameras over UDP with packet loss, reordering and delay by the kernel (tc-netem(8)), in a network
// namespace of its own. Netem drops packets at random; the assertions hold for any of them.

#include <array>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <net/if.h>

#include "capture/codec/video_decoder.hpp"
#include "capture/pair_synchroniser.hpp"
#include "capture/rtsp/rtsp_camera.hpp"
#include "support/test_timeout.hpp"
#include "tests/support/capture/encoded_sequence.hpp"
#include "tests/support/capture/live_camera.hpp"
#include "tests/support/capture/scripted_camera.hpp"

namespace cartvo::capture {
namespace {

constexpr double kFrameRate = 25.0;
constexpr std::int64_t kPeriod_ns = 40'000'000;
constexpr std::uint64_t kMinPairs = 40;

/// Small pictures, so that some arrive undamaged at 5 % loss.
const std::vector<EncodedUnit>& pictures() {
  static const std::vector<EncodedUnit> units =
      test::encodeSequence(VideoCodec::h264, cv::Size(160, 120), 40, 5, "crf=36");
  return units;
}

/// Whether loopback is the only interface, i.e. the network namespace is not shared.
bool isPrivateNetwork() {
  struct if_nameindex* interfaces = if_nameindex();
  const bool only_one = interfaces != nullptr && interfaces[0].if_index != 0 && interfaces[1].if_index == 0;
  if_freenameindex(interfaces);
  return only_one;
}

bool setLink(const std::string& netem) {
  return std::system(("tc qdisc replace dev lo root netem " + netem).c_str()) == 0;
}

/// Two cameras, each read by a thread, and statistics of their pairs.
class PairedCameras {
 public:
  PairedCameras() {
    for (const CameraSide side : {CameraSide::left, CameraSide::right}) {
      test::CameraScript script;
      script.pictures = pictures();
      script.frame_rate = kFrameRate;
      servers_.push_back(std::make_unique<test::ScriptedCamera>(script));
      RtspCameraSettings settings = test::settingsFor(servers_.back()->port());
      settings.credentials = {};
      settings.transport = RtspTransport::udp;
      cameras_.push_back(std::make_unique<RtspCamera>(settings));
      cameras_.back()->setTimestamper(timestamper_, side);
    }
    for (const CameraSide side : {CameraSide::left, CameraSide::right})
      readers_.emplace_back([this, side] { read(side); });
  }
  ~PairedCameras() {
    for (const auto& camera : cameras_)
      camera->interrupt();
    for (std::thread& reader : readers_)
      reader.join();
  }
  PairedCameras(const PairedCameras&) = delete;
  PairedCameras& operator=(const PairedCameras&) = delete;

  struct Tally {
    std::uint64_t pairs = 0;
    std::uint64_t damaged = 0;  ///< frames
    std::uint64_t bad_pairs =
        0;  ///< pairs with a picture that differs from the encoded one or is marked damaged
    std::uint64_t far_apart = 0;     ///< pairs, more than half a period
    std::uint64_t out_of_order = 0;  ///< frames
  };
  Tally tally() const {
    const std::lock_guard lock(mutex_);
    return tally_;
  }
  std::string lastError(CameraSide side) const { return cameras_[index(side)]->health().last_error; }

 private:
  static std::size_t index(CameraSide side) { return static_cast<std::size_t>(side); }

  void read(CameraSide side) {
    std::optional<std::uint64_t> last;
    for (Frame frame;;) {
      const ReadOutcome outcome = cameras_[index(side)]->read(frame, std::chrono::milliseconds(100));
      if (outcome == ReadOutcome::ended) return;
      if (outcome != ReadOutcome::frame) continue;
      const std::lock_guard lock(mutex_);
      if (last && frame.sequence <= *last) ++tally_.out_of_order;
      last = frame.sequence;
      if (frame.status == FrameStatus::damaged) ++tally_.damaged;
      synchroniser_.push(side, std::move(frame));
      while (const std::optional<FramePair> pair = synchroniser_.pop())
        check(*pair);
    }
  }

  void check(const FramePair& pair) {
    ++tally_.pairs;
    const auto is_good = [this](const Frame& frame) {
      return frame.status == FrameStatus::good && known_.contains(test::digest(frame.image));
    };
    if (!is_good(pair.left) || !is_good(pair.right)) ++tally_.bad_pairs;
    // The odometry uses no pair before both clocks have settled.
    const bool is_known = pair.offsetStddevNs() < 10e6;
    if (is_known && std::abs(pair.offsetNs()) > kPeriod_ns / 2) ++tally_.far_apart;
  }

  const std::set<std::uint64_t> known_ = test::digestsOf(VideoCodec::h264, pictures());
  StereoTimestamper timestamper_{ClockChoice::automatic};
  std::vector<std::unique_ptr<test::ScriptedCamera>> servers_;
  std::vector<std::unique_ptr<RtspCamera>> cameras_;
  mutable std::mutex mutex_;  ///< guards the next two
  PairSynchroniser synchroniser_{PairSynchroniserSettings{.period_ns = kPeriod_ns}};
  Tally tally_;
  std::vector<std::thread> readers_;
};

struct Impairment {
  const char* name;
  const char* netem;
  bool damages;  ///< damages pictures within the test
};

class ImpairedNetwork : public testing::TestWithParam<Impairment> {
 protected:
  void SetUp() override {
    if (!isPrivateNetwork()) GTEST_SKIP() << "only in a network namespace: tools/in_network_namespace";
    if (!setLink(GetParam().netem)) GTEST_SKIP() << "this kernel has no netem, or tc is missing (iproute2)";
    is_set_ = true;
  }
  void TearDown() override {
    if (is_set_) std::system("tc qdisc delete dev lo root");
  }

  bool is_set_ = false;
};

TEST_P(ImpairedNetwork, KeepsPairingWithoutDamagedPictures) {
  const PairedCameras cameras;
  const auto has_enough = [&] {
    const PairedCameras::Tally tally = cameras.tally();
    return tally.pairs >= kMinPairs && (tally.damaged > 0 || !GetParam().damages);
  };
  const auto end = std::chrono::steady_clock::now() + test::kTestTimeout;
  while (!has_enough() && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  const PairedCameras::Tally tally = cameras.tally();
  EXPECT_TRUE(has_enough()) << cameras.lastError(CameraSide::left) << cameras.lastError(CameraSide::right);
  EXPECT_EQ(tally.bad_pairs, 0U);
  EXPECT_EQ(tally.far_apart, 0U);
  EXPECT_EQ(tally.out_of_order, 0U);
  std::printf("%s: %llu pairs, %llu damaged frames\n", GetParam().netem,
              static_cast<unsigned long long>(tally.pairs), static_cast<unsigned long long>(tally.damaged));
}

INSTANTIATE_TEST_SUITE_P(Netem, ImpairedNetwork,
                         testing::Values(Impairment{"LossOfATenthOfAPercent", "loss 0.1%", false},
                                         Impairment{"LossOfOnePercent", "loss 1%", true},
                                         Impairment{"LossOfFivePercent", "loss 5%", true},
                                         Impairment{"Reordering", "delay 10ms reorder 25% 50%", false},
                                         Impairment{"JitterOfFiftyMilliseconds", "delay 50ms 50ms", false},
                                         Impairment{"Duplicates", "duplicate 5%", false},
                                         Impairment{"AllOfThem", "delay 20ms 10ms loss 1% duplicate 1%",
                                                    true}),
                         [](const auto& link) { return link.param.name; });

}  // namespace
}  // namespace cartvo::capture
