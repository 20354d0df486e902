// Replay of KITTI, EuRoC and recordings: accuracy, reproducibility, output files, errors.

#include "tools/replay/replay.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>

#include "calib/format/rig_file.hpp"
#include "calib/format/rig_formats.hpp"
#include "capture/recording/stream_recorder.hpp"
#include "common/atomic_file.hpp"
#include "support/error_message.hpp"
#include "support/file_text.hpp"
#include "support/pipeline/alert_limits.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_data.hpp"
#include "support/tools/drift.hpp"
#include "tools/replay/motion_csv.hpp"
#include "tools/replay/odometry_csv.hpp"
#include "tools/replay/output_files.hpp"
#include "tools/replay/summary.hpp"
#include "tools/simulate/stream/stream_encoder.hpp"

namespace cartvo {
namespace {

using ::testing::HasSubstr;

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);)
    lines.push_back(line);
  return lines;
}

std::vector<std::string> fieldsOf(const std::string& line) {
  std::vector<std::string> fields(1);
  for (const char character : line) {
    if (character == ',') {
      fields.emplace_back();
    } else {
      fields.back() += character;
    }
  }
  return fields;
}

/// Links the first pairs of a KITTI sequence into a new folder.
void linkFirstPairs(const std::filesystem::path& sequence, const std::filesystem::path& folder, int pairs) {
  for (const char* camera : {"image_0", "image_1"}) {
    std::filesystem::create_directories(folder / camera);
    for (int i = 0; i < pairs; ++i) {
      char name[16];
      std::snprintf(name, sizeof name, "%06d.png", i);
      std::filesystem::create_symlink(std::filesystem::canonical(sequence / camera / name),
                                      folder / camera / name);
    }
  }
  std::filesystem::copy(sequence / "calib.txt", folder / "calib.txt");
  for (const char* list : {"times.txt", "poses.txt"}) {
    std::ifstream all(sequence / list);
    std::ofstream first(folder / list);
    std::string line;
    for (int i = 0; i < pairs && std::getline(all, line); ++i)
      first << line << '\n';
  }
}

Replay replayed(const std::filesystem::path& source) {
  ReplaySettings settings;
  settings.source = source;
  settings.alert_limits = test::kNoAlertLimits;
  return replaySource(settings, [](const pipeline::PairResult&, std::size_t) {});
}

/// The first pairs of kitti_06 in a separate folder for each test; most tests share one replay.
class ReplayOfKitti : public ::testing::Test {
 protected:
  static constexpr int kPairs = 6;

  void SetUp() override {
    CARTVO_NEEDS_DATA(sequence, "kitti_06");
    linkFirstPairs(sequence, folder_.path(), kPairs);
  }

  const Replay& replayOfAll() const {
    static const Replay replay = replayed(folder_.path());
    return replay;
  }

  const test::TemporaryFolder folder_;
};

TEST_F(ReplayOfKitti, OdometryCsvHasTheMessagesWithTheirCovariances) {
  const Replay& replay = replayOfAll();
  const std::vector<std::string> lines = linesOf(odometryCsv(replay));
  ASSERT_EQ(lines.size(), kPairs + 1U);
  const std::vector<std::string> names = fieldsOf(lines.front());
  EXPECT_EQ(names.size(), 19U + 21U + 21U + 3U + 12U + 1U + 9U);
  for (std::size_t row = 1; row < lines.size(); ++row) {
    const std::vector<std::string> fields = fieldsOf(lines[row]);
    ASSERT_EQ(fields.size(), names.size());
    const auto at = [&](const char* name) {
      return fields.at(static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin()));
    };
    const odometry_t& message = replay.pairs[row - 1].message;
    EXPECT_EQ(at("valid"), replay.pairs[row - 1].valid ? "1" : "0");
    if (!replay.pairs[row - 1].valid) {
      EXPECT_EQ(at("vx_m_s"), "");
      EXPECT_EQ(at("motion_bound_z"), "");
      EXPECT_EQ(at("quality"), "0");
      continue;
    }
    const auto expect_written = [&](const char* name, double value) {  // with nine significant digits
      EXPECT_NEAR(std::stod(at(name)), value, 1e-8 * std::abs(value)) << name;
    };
    expect_written("vx_m_s", message.velocity_body[0]);
    expect_written("twist_covariance_vx_vx", message.twist_covariance_body[0]);
    expect_written("pose_covariance_y_rz", message.pose_covariance_body[11]);
    expect_written("velocity_bound_x", message.velocity_bound[0]);
    expect_written("rotation_bound_z", message.rotation_bound[2]);
    expect_written("quality", message.quality);
  }
}

TEST_F(ReplayOfKitti, MatchesTruthPairByPair) {
  const Replay& replay = replayOfAll();
  ASSERT_EQ(replay.pairs.size(), static_cast<std::size_t>(kPairs));
  EXPECT_FALSE(replay.pairs.front().valid);
  for (std::size_t i = 1; i < replay.pairs.size(); ++i)
    EXPECT_TRUE(replay.pairs[i].valid) << i;
  const Trajectory truth = readTrajectory(folder_ / "poses.txt");
  EXPECT_LT(test::driftFraction(leftCameraTrajectory(replay), truth), 0.05);
}

TEST_F(ReplayOfKitti, IsBitwiseReproducibleWithAnyNumberOfThreads) {
  const int threads = cv::getNumThreads();
  std::vector<std::string> poses;
  for (const int count : {1, 2}) {
    cv::setNumThreads(count);
    const std::filesystem::path file = folder_ / ("out" + std::to_string(poses.size()));
    writeKitti(file, leftCameraTrajectory(replayed(folder_.path())));
    poses.push_back(test::contentsOf(file));
  }
  cv::setNumThreads(threads);
  poses.push_back([&] {
    writeKitti(folder_ / "out", leftCameraTrajectory(replayOfAll()));
    return test::contentsOf(folder_ / "out");
  }());
  EXPECT_EQ(poses[0], poses[1]);
  EXPECT_EQ(poses[1], poses[2]);
}

TEST_F(ReplayOfKitti, WritesMotionInBodyAxes) {
  const Replay& replay = replayOfAll();
  const std::vector<std::string> rows = linesOf(motionCsv(replay));
  ASSERT_EQ(rows.size(), kPairs + 1u);
  const std::vector<std::string> header = fieldsOf(rows.front());
  const auto column = [&](const std::vector<std::string>& fields, const std::string& name) {
    return fields.at(std::find(header.begin(), header.end(), name) - header.begin());
  };
  for (const std::string& row : rows)
    ASSERT_EQ(fieldsOf(row).size(), header.size());
  EXPECT_EQ(column(fieldsOf(rows[1]), "Vx"), "");
  for (std::size_t i = 2; i < rows.size(); ++i) {
    const std::vector<std::string> fields = fieldsOf(rows[i]);
    EXPECT_NEAR(std::stod(column(fields, "Vx")), 12.0, 2.0);  // forward, as kitti_06 drives
    EXPECT_NEAR(std::stod(column(fields, "Vy")), 0.0, 1.0);
  }
  EXPECT_GT(std::stod(column(fieldsOf(rows.back()), "x")), 5.0);
  const std::vector<std::string> with_errors =
      linesOf(motionCsv(replay, std::vector(kPairs, std::string(",,,,,,,1.5"))));
  EXPECT_THAT(with_errors.front(), ::testing::EndsWith(",error_roll_rate,error_position"));
  EXPECT_EQ(with_errors[1], rows[1] + ",,,,,,,1.5");
}

TEST_F(ReplayOfKitti, WritesTimesOfEachStageAndPair) {
  const std::vector<std::string> rows = linesOf(timingCsv(replayOfAll()));
  ASSERT_EQ(rows.size(), kPairs + 1u);
  EXPECT_THAT(rows.front(), ::testing::StartsWith("pair,rectify_ms,pyramid_ms,"));
  EXPECT_THAT(rows.front(), ::testing::EndsWith(",total_ms"));
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const std::vector<std::string> fields = fieldsOf(rows[i]);
    double sum = 0.0;
    for (std::size_t k = 1; k + 1 < fields.size(); ++k)
      sum += std::stod(fields[k]);
    EXPECT_LE(sum, std::stod(fields.back()) + 0.01);
    EXPECT_GT(sum, 0.0);
  }
}

TEST_F(ReplayOfKitti, HasSummary) {
  ReplaySettings settings;
  settings.source = folder_.path();
  settings.odometry.features = 500;
  settings.alert_limits = test::kNoAlertLimits;
  const Replay replay = replaySource(settings, [](const pipeline::PairResult&, std::size_t expected) {
    EXPECT_EQ(expected, static_cast<std::size_t>(kPairs));
  });
  const nlohmann::ordered_json summary = replaySummary(settings, replay);
  EXPECT_EQ(summary["kind"], "kitti");
  EXPECT_EQ(summary["estimator"], "reprojection");
  EXPECT_EQ(summary["features"], 500);
  EXPECT_EQ(summary["pairs"], kPairs);
  EXPECT_EQ(summary["valid"], kPairs - 1);
  EXPECT_EQ(summary["invalid_by_reason"], (nlohmann::ordered_json{{"first_pair", 1}}));
  EXPECT_EQ(summary["invalid_pairs"], nlohmann::ordered_json::array({0}));
  EXPECT_GT(summary["path_length_m"], 5.0);
  EXPECT_GT(summary["time_ms"]["total"]["median"], 0.0);
}

TEST_F(ReplayOfKitti, PrefersGivenRigThenRigYamlThenCalibTxt) {
  const auto found = [&](const std::filesystem::path& given) {
    return pipeline::findRig(capture::openSource(folder_.path()), folder_.path(), given);
  };
  EXPECT_EQ(found({}).rig.name, "KITTI");
  EXPECT_EQ(found({}).rig.left.size, cv::Size(1226, 370));
  calib::Rig rig = calib::readRigFiles({folder_ / "calib.txt"}, {.image_size = cv::Size(1226, 370)});
  rig.name = "beside the images";
  calib::writeRig(folder_ / "rig.yaml", rig);
  EXPECT_EQ(found({}).rig.name, "beside the images");
  rig.name = "given";
  calib::writeRig(folder_ / "other.yaml", rig);
  EXPECT_EQ(found(folder_ / "other.yaml").rig.name, "given");
  EXPECT_EQ(found(folder_ / "other.yaml").origin, (folder_ / "other.yaml").string());
}

TEST_F(ReplayOfKitti, RejectsRigOfWrongImageSize) {
  calib::writeRig(folder_ / "rig.yaml",
                  calib::readRigFiles({folder_ / "calib.txt"}, {.image_size = cv::Size(1241, 376)}));
  EXPECT_THAT(test::messageOf([&] { replayed(folder_.path()); }), HasSubstr("1226x370"));
}

TEST_F(ReplayOfKitti, WithoutRigIsRejectedWithInstructions) {
  std::filesystem::remove(folder_ / "calib.txt");
  EXPECT_THAT(test::messageOf([&] { replayed(folder_.path()); }),
              HasSubstr("Give --rig FILE, or put a rig.yaml"));
}

/// Records pairs of a KITTI sequence as encoded streams of two cameras.
void record(const std::filesystem::path& sequence, const std::filesystem::path& folder, int pairs,
            double key_frame_interval) {
  calib::Rig rig = calib::readRigFiles({sequence / "calib.txt"}, {.image_size = cv::Size(1226, 370)});
  rig.left.readout = rig.right.readout = 0.0;  // KITTI's cameras have global shutters
  capture::RecordingSettings settings;
  settings.folder = folder;
  settings.rig = calib::rigText(rig);
  capture::StreamRecorder recorder(settings);
  const simulate::EncoderSettings encoding{.bitrate_kbps = 8000, .key_frame_interval = key_frame_interval};
  simulate::StreamEncoder left_encoder(encoding, rig.left.size, 10.0);
  simulate::StreamEncoder right_encoder(encoding, rig.left.size, 10.0);
  recorder.left().onStream({});
  recorder.right().onStream({});
  for (int i = 0; i < pairs; ++i) {
    for (const bool is_left : {true, false}) {
      const char* camera = is_left ? "image_0" : "image_1";
      simulate::StreamEncoder& encoder = is_left ? left_encoder : right_encoder;
      char name[16];
      std::snprintf(name, sizeof name, "%06d.png", i);
      const cv::Mat image = cv::imread((sequence / camera / name).string(), cv::IMREAD_GRAYSCALE);
      const simulate::EncodedPicture picture = encoder.encode(image);
      capture::EncodedUnit unit;
      unit.data = picture.data;
      unit.key = picture.key_frame;
      unit.pts = i * 9000;
      unit.exposure_ns = 1'700'000'000'000'000'000 + i * 100'000'000;
      unit.first_arrival_ns = unit.arrival_ns = unit.exposure_ns + 30'000'000;
      unit.sequence = static_cast<std::uint64_t>(i);
      unit.instant_source = capture::InstantSource::sender_report;
      (is_left ? recorder.left() : recorder.right()).onUnit(unit);
    }
  }
}

TEST(ReplayOfRecording, MatchesTruthWithRigAndTimesOfRecording) {
  CARTVO_NEEDS_DATA(sequence, "kitti_06");
  const test::TemporaryFolder folder;
  constexpr int kRecorded = 6;
  record(sequence, folder / "drive", kRecorded, 1.0);
  const Replay replay = replayed(folder / "drive");
  EXPECT_EQ(replay.kind, capture::SourceKind::recording);
  EXPECT_EQ(replay.rig.rig.name, "KITTI");
  EXPECT_EQ(replay.rig.origin, (folder / "drive/recording.json").string());
  EXPECT_EQ(replay.problems, std::vector<std::string>{calib::kNoMountText});
  ASSERT_EQ(replay.pairs.size(), static_cast<std::size_t>(kRecorded));
  EXPECT_EQ(replay.pairs[2].exposure_ns, 1'700'000'000'200'000'000);
  Trajectory truth = readTrajectory(sequence / "poses.txt");
  truth.resize(kRecorded);
  EXPECT_LT(test::driftFraction(leftCameraTrajectory(replay), truth), 0.08);
}

TEST(ReplayOfRecording, HasLargerCovarianceAcrossKeyFrames) {
  CARTVO_NEEDS_DATA(sequence, "kitti_06");
  const test::TemporaryFolder folder;
  record(sequence, folder / "drive", 11, 0.8);  // s: key frames at pairs 0 and 8, after the start-up
  const Replay replay = replayed(folder / "drive");
  ASSERT_EQ(replay.pairs.size(), 11U);
  const auto forwards = [&](std::size_t pair) { return replay.pairs[pair].motion_covariance(2, 2); };
  for (const std::size_t across : {8U, 9U})
    for (const std::size_t ordinary : {7U, 10U})
      EXPECT_GT(forwards(across), 2.0 * forwards(ordinary)) << across << " " << ordinary;
}

TEST(ReplayOfEuroc, OfRawImagesAtStandstillDoesNotMove) {
  CARTVO_NEEDS_DATA(folder, "euroc_still");
  const Replay replay = replayed(folder);
  ASSERT_EQ(replay.pairs.size(), 40u);
  EXPECT_EQ(replay.rig.rig.name, "EuRoC");
  for (std::size_t i = 1; i < replay.pairs.size(); ++i)
    EXPECT_TRUE(replay.pairs[i].valid) << i;
  const Eigen::Isometry3d& end = replay.pairs.back().T_first_left;
  EXPECT_LT(end.translation().norm(), 0.03);
  EXPECT_LT(Eigen::AngleAxisd(end.linear()).angle(), 0.5 * std::numbers::pi / 180.0);
}

TEST(Replay, RejectsFolderThatIsNoSource) {
  const test::TemporaryFolder folder;
  EXPECT_THAT(test::messageOf([&] { replayed(folder.path()); }), HasSubstr(folder.path().string()));
  EXPECT_THAT(test::messageOf([] { replayed("/no/such/folder"); }), HasSubstr("/no/such/folder"));
}

TEST(Replay, RemovesEmptyOutputFolderAfterFailure) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directory(folder / "mine");
  { const OutputFolder output(folder / "mine/new/deep/"); }
  EXPECT_TRUE(std::filesystem::is_directory(folder / "mine"));
  EXPECT_FALSE(std::filesystem::exists(folder / "mine/new"));
  { const OutputFolder output(folder / "mine"); }
  EXPECT_TRUE(std::filesystem::is_directory(folder / "mine")) << "existed before";
  {
    const OutputFolder output(folder / "mine/new/deep");
    std::ofstream(output / "poses.txt") << "1";
  }
  EXPECT_EQ(test::contentsOf(folder / "mine/new/deep/poses.txt"), "1");
}

TEST(Replay, RejectsFileAsOutputFolder) {
  const test::TemporaryFolder folder;
  writeFileAtomically(folder / "out", "a file");
  EXPECT_THAT(test::messageOf([&] { OutputFolder output(folder / "out"); }),
              HasSubstr("is not a folder; --output-dir"));
  EXPECT_THAT(test::messageOf([&] { OutputFolder output(folder / "out/inside"); }),
              HasSubstr("cannot be created"));
}

}  // namespace
}  // namespace cartvo
