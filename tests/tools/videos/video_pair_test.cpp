// Tests of two video files as a stereo pair: their time offset and their replay.
#include "tools/replay/video_pair.hpp"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "calib/format/rig_file.hpp"
#include "calib/format/rig_formats.hpp"
#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_data.hpp"
#include "support/tools/drift.hpp"
#include "tools/replay/replay.hpp"

namespace cartvo {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const cv::Size kSize(160, 96);
constexpr double kFrameRate = 12.5;

void encode(const std::string& input, const fs::path& output) {
  const std::string command =
      "ffmpeg -v error " + input + " -c:v libx264 -qp 4 -pix_fmt yuv420p -y " + output.string();
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
}

/// Position of the camera's view in a wide scene at `time`, px.
cv::Point2d lookingAround(double time) {
  return {400.0 + 120.0 * std::sin(0.9 * time) + 60.0 * std::sin(0.53 * time * time / 6.0) +
              8.0 * std::sin(7.1 * time),
          150.0 + 10.0 * std::sin(5.3 * time) + 6.0 * std::sin(9.7 * time + 1.0)};
}

/// Writes the video of a camera that is switched on at `begin` for `duration`, s.
void film(const fs::path& file, double begin, double duration) {
  cv::Mat scene(400, 900, CV_8UC1);
  cv::RNG random(3);
  random.fill(scene, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(scene, scene, {0, 0}, 2.0);
  cv::normalize(scene, scene, 0, 255, cv::NORM_MINMAX);
  const fs::path raw = file.string() + ".raw";
  {
    std::ofstream stream(raw, std::ios::binary);
    for (double time = begin; time < begin + duration; time += 1.0 / kFrameRate) {
      cv::Mat picture;
      cv::getRectSubPix(scene, kSize, lookingAround(time), picture);
      stream.write(reinterpret_cast<const char*>(picture.data),
                   static_cast<std::streamsize>(picture.total()));
    }
  }
  encode("-f rawvideo -pixel_format gray -video_size 160x96 -framerate 12.5 -i " + raw.string(), file);
}

calib::Rig smallRig() {
  calib::Rig rig;
  rig.left.size = rig.right.size = kSize;
  rig.left.fx = rig.left.fy = rig.right.fx = rig.right.fy = 150.0;
  rig.left.cx = rig.right.cx = 79.5;
  rig.left.cy = rig.right.cy = 47.5;
  rig.T_right_left.translation().x() = -0.1;
  rig.T_body_camera = calib::forwardLookingMount();
  return rig;
}

TEST(VideoPair, OffsetIsEstimatedFromTheImages) {
  const test::TemporaryFolder folder;
  film(folder / "left.mp4", 0.0, 12.0);
  film(folder / "right.mkv", 3.217, 8.0);
  std::size_t pictures = 0;
  const VideoTiming timing = findVideoTiming({folder / "left.mp4", folder / "right.mkv"}, smallRig(),
                                             [&](std::size_t done, std::size_t) { pictures = done; });
  EXPECT_NEAR(timing.offset, 3.217, 5e-3);
  EXPECT_NEAR(timing.offset, 3.217, 3.0 * timing.stddev);
  EXPECT_LT(timing.stddev, 5e-3);
  EXPECT_NEAR(static_cast<double>(pictures), 250.0, 2.0);
}

TEST(VideoPair, VideosOfDifferentDrivesAreRejected) {
  const test::TemporaryFolder folder;
  film(folder / "left.mp4", 0.0, 12.0);
  film(folder / "right.mp4", 100.0, 12.0);
  EXPECT_THAT(test::messageOf([&] {
                findVideoTiming({folder / "left.mp4", folder / "right.mp4"}, smallRig(),
                                [](std::size_t, std::size_t) {});
              }),
              HasSubstr("give --offset-ms"));
}

/// Joins two films with a filter of FFmpeg.
void join(const test::TemporaryFolder& folder, const std::string& how, const fs::path& output) {
  const std::string command = "ffmpeg -v error -i " + (folder / "left.mp4").string() + " -i " +
                              (folder / "right.mp4").string() + " " + how + " -y " + output.string();
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
}

TEST(VideoPair, FindsBothCamerasInOneFile) {
  const test::TemporaryFolder folder;
  film(folder / "left.mp4", 0.0, 0.5);
  film(folder / "right.mp4", 3.0, 0.5);
  join(folder, "-filter_complex hstack", folder / "beside.mp4");
  join(folder, "-filter_complex vstack", folder / "above.mp4");
  join(folder, "-map 0 -map 1 -c copy", folder / "tracks.mkv");
  for (const char* const name : {"beside.mp4", "above.mp4", "tracks.mkv"}) {
    const VideoPair videos = findVideos(folder / name, {}, 0.0, smallRig());
    EXPECT_TRUE(videos.is_one_file);
    capture::StereoSource source = openVideos(videos, {}, {});
    capture::Frame left, right;
    source.left->read(left, std::chrono::milliseconds(0));
    source.right->read(right, std::chrono::milliseconds(0));
    EXPECT_EQ(left.image.size(), kSize) << name;
    EXPECT_EQ(right.image.size(), kSize) << name;
    EXPECT_EQ(left.exposure_ns, right.exposure_ns);
    EXPECT_GT(cv::norm(left.image, right.image, cv::NORM_L1) / kSize.area(), 10.0) << name;
  }
}

TEST(VideoPair, NamesSizesThatAreNotTheRigs) {
  const test::TemporaryFolder folder;
  film(folder / "left.mp4", 0.0, 0.5);
  const fs::path file = folder / "left.mp4";
  calib::Rig rig = smallRig();
  EXPECT_THAT(test::messageOf([&] { findVideos(file, {}, 0.0, rig); }),
              HasSubstr("left.mp4 is one camera's video; give the right camera's too"));
  rig.left.size = rig.right.size = {320, 240};
  EXPECT_THAT(
      test::messageOf([&] { findVideos(file, file, 0.0, rig); }),
      HasSubstr("left.mp4 has pictures of 160x96, and the rig is for 320x240: give the rig of these"));
  EXPECT_THAT(test::messageOf([&] { findVideos(file, {}, 0.0, rig); }), HasSubstr("twice as wide"));
}

TEST(VideoPair, ReplayGivesTheTrueTrajectory) {
  CARTVO_NEEDS_DATA(sequence, "kitti_06");
  constexpr int kPairs = 6;
  const test::TemporaryFolder folder;
  for (const auto& [camera, video] : {std::pair("image_0", "left.mp4"), std::pair("image_1", "right.mkv")}) {
    encode("-framerate 10 -i " + (sequence / camera).string() + "/%06d.png -frames:v 6", folder / video);
  }
  calib::writeRig(folder / "rig.yaml",
                  calib::readRigFiles({sequence / "calib.txt"}, {.image_size = cv::Size(1226, 370)}));
  ReplaySettings settings;
  settings.source = folder / "left.mp4";
  settings.right_video = folder / "right.mkv";
  settings.rig = folder / "rig.yaml";
  settings.video_offset = 0.0;
  const Replay replay = replayVideos(
      settings, [](std::size_t, std::size_t) {}, [](const pipeline::PairResult&, std::size_t) {});
  ASSERT_EQ(replay.pairs.size(), static_cast<std::size_t>(kPairs));
  EXPECT_EQ(replay.kind, capture::SourceKind::videos);
  Trajectory truth = readTrajectory(sequence / "poses.txt");
  truth.resize(kPairs);
  EXPECT_LT(test::driftFraction(leftCameraTrajectory(replay), truth), 0.08);
}

}  // namespace
}  // namespace cartvo
