// Reading of video files in several containers and codecs.

#include "capture/dataset/video_file_source.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "support/error_message.hpp"
#include "support/file_text.hpp"
#include "support/temporary_folder.hpp"

namespace cartvo::capture {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

constexpr std::chrono::milliseconds kAtOnce{0};

/// Makes a video of two seconds of a moving test picture with the ffmpeg command.
fs::path video(const test::TemporaryFolder& folder, const std::string& name, const std::string& encoding) {
  fs::path file = folder / name;
  const std::string command = "ffmpeg -v error -f lavfi -i testsrc2=size=160x96:rate=25:duration=2 " +
                              encoding + " -y " + file.string();
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  return file;
}

std::vector<Frame> framesOf(VideoFileSource& source) {
  std::vector<Frame> frames;
  for (Frame frame; source.read(frame, kAtOnce) == ReadOutcome::frame;)
    frames.push_back(frame);
  return frames;
}

TEST(VideoFileSource, ReadsVideosOfOtherRecorders) {
  const test::TemporaryFolder folder;
  for (const auto& [name, encoding] : std::vector<std::pair<std::string, std::string>>{
           {"b_frames.mp4", "-c:v libx264 -pix_fmt yuv420p -bf 2"},
           {"hevc.mkv", "-c:v libx265 -x265-params log-level=none -pix_fmt yuv420p"},
           {"deep.mkv", "-c:v ffv1 -pix_fmt yuv420p10le"},
           {"jpegs.avi", "-c:v mjpeg -pix_fmt yuvj422p"},
           {"stream.ts", "-c:v libx264 -pix_fmt yuv420p"},
           {"raw.h264", "-c:v libx264 -pix_fmt yuv420p -bf 0"}}) {
    VideoFileSource source(video(folder, name, encoding), {.origin_ns = 1000});
    EXPECT_EQ(source.timeNote().empty(), name != "raw.h264") << name;
    EXPECT_EQ(source.pictureSize(), cv::Size(160, 96));
    const std::vector<Frame> frames = framesOf(source);
    ASSERT_EQ(frames.size(), 50U) << name;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      EXPECT_EQ(frames[i].image.size(), cv::Size(160, 96));
      EXPECT_EQ(frames[i].status, FrameStatus::good) << name << " " << i;
      EXPECT_NEAR(static_cast<double>(frames[i].exposure_ns - frames[0].exposure_ns),
                  4e7 * static_cast<double>(i), 1e6)
          << name << " " << i;
    }
    EXPECT_GT(cv::norm(frames[0].image, frames[49].image, cv::NORM_L1), 1000.0) << name;
    EXPECT_EQ(source.health().last_error, "") << name;
  }
}

TEST(VideoFileSource, ComputesTheLumaOfColours) {
  const test::TemporaryFolder folder;
  VideoFileSource grey(video(folder, "grey.mkv", "-c:v ffv1 -pix_fmt gray"), {});
  const std::vector<Frame> expected = framesOf(grey);
  for (const auto& [name, encoding] :
       std::vector<std::pair<std::string, std::string>>{{"rgb.mkv", "-c:v ffv1 -pix_fmt bgr0"},
                                                        {"planar.mkv", "-c:v ffv1 -pix_fmt gbrp"},
                                                        {"png.avi", "-c:v png -pix_fmt rgb24"},
                                                        {"yuyv.avi", "-c:v rawvideo -pix_fmt yuyv422"}}) {
    VideoFileSource source(video(folder, name, encoding), {});
    const std::vector<Frame> frames = framesOf(source);
    ASSERT_EQ(frames.size(), expected.size()) << name;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const double difference = cv::norm(frames[i].image, expected[i].image, cv::NORM_L1) / (160 * 96);
      EXPECT_LT(difference, 12.0) << name << " " << i;  // limited and full range differ by up to 20
    }
  }
}

TEST(VideoFileSource, MarksKeyFrames) {
  const test::TemporaryFolder folder;
  VideoFileSource source(video(folder, "film.mkv", "-c:v libx264 -pix_fmt yuv420p -g 20 -sc_threshold 0"),
                         {});
  for (const Frame& frame : framesOf(source))
    EXPECT_EQ(frame.key_frame, frame.sequence % 20 == 0) << frame.sequence;
}

TEST(VideoFileSource, AppliesClockModel) {
  const test::TemporaryFolder folder;
  const fs::path file = video(folder, "a.mp4", "-c:v libx264 -pix_fmt yuv420p");
  VideoFileTime time;
  time.origin_ns = 1'000'000'000'000;
  time.offset = -0.25;
  time.skew = 100e-6;
  time.stddev = 2e-3;
  time.from = 0.99;
  time.to = 1.5;
  VideoFileSource source(file, time);
  const std::vector<Frame> frames = framesOf(source);
  ASSERT_EQ(frames.size(), 13U);
  EXPECT_EQ(frames.front().sequence, 25U);
  EXPECT_NEAR(static_cast<double>(frames.front().exposure_ns), 1e12 + 0.75e9 + 1e5, 100.0);
  EXPECT_EQ(frames.front().exposure_stddev_ns, 2'000'000);
}

TEST(VideoFileSource, MarksPicturesWithDecodingErrors) {
  const test::TemporaryFolder folder;
  const fs::path file = video(folder, "a.mkv", "-c:v libx264 -pix_fmt yuv420p -g 10 -bf 0");
  {
    std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
    stream.seekp(static_cast<std::streamoff>(fs::file_size(file) / 2));
    stream << std::string(200, '\x55');
  }
  VideoFileSource source(file, {});
  const std::vector<Frame> frames = framesOf(source);
  ASSERT_GT(frames.size(), 30U);
  EXPECT_EQ(frames.front().status, FrameStatus::good);
  EXPECT_EQ(frames.back().status, FrameStatus::good) << "after the next key picture";
}

TEST(VideoFileSource, NeedsAFrameRateForStreamsWithoutTimes) {
  const test::TemporaryFolder folder;
  const fs::path jpegs = video(folder, "raw.mjpeg", "-c:v mjpeg -pix_fmt yuvj420p");
  EXPECT_THAT(
      test::messageOf([&] { VideoFileSource(jpegs, {}); }),
      HasSubstr("raw.mjpeg is a raw stream: nothing in it says how many pictures a second it has. Give "
                "the cameras' frame rate by --frame-rate HZ"));
  VideoFileSource source(jpegs, {.frame_rate = 18.0});
  const std::vector<Frame> frames = framesOf(source);
  ASSERT_EQ(frames.size(), 50U);
  EXPECT_NEAR(static_cast<double>(frames[49].exposure_ns), 49e9 / 18.0, 1.0);
}

TEST(VideoFileSource, RefusesTimeStampsThatAreNoCameras) {
  const test::TemporaryFolder folder;
  const fs::path fast = video(folder, "fast.mp4",
                              "-c:v mjpeg -pix_fmt yuvj420p -vf settb=1/90000,setpts=N -vsync passthrough "
                              "-enc_time_base 1/90000 -video_track_timescale 90000");
  EXPECT_THAT(test::messageOf([&] { VideoFileSource(fast, {}); }),
              HasSubstr("fast.mp4 has no usable time stamps: their median interval is 1.111e-05 s"));
  VideoFileSource source(fast, {.frame_rate = 25.0});
  const std::vector<Frame> frames = framesOf(source);
  ASSERT_EQ(frames.size(), 50U);
  EXPECT_NEAR(static_cast<double>(frames[25].exposure_ns), 1e9, 1.0);
}

TEST(VideoFileSource, DeliversAPartOfThePictures) {
  const test::TemporaryFolder folder;
  const fs::path file = video(folder, "a.mp4", "-c:v libx264 -qp 0 -pix_fmt yuv420p");
  VideoFileSource whole(file, {}), right(file, {}, {PicturePart::right_half, {}}),
      upper(file, {}, {PicturePart::upper_half, {}});
  Frame all, part;
  whole.read(all, kAtOnce);
  right.read(part, kAtOnce);
  EXPECT_EQ(cv::norm(part.image, all.image.colRange(80, 160), cv::NORM_INF), 0.0);
  upper.read(part, kAtOnce);
  EXPECT_EQ(cv::norm(part.image, all.image.rowRange(0, 48), cv::NORM_INF), 0.0);
}

TEST(VideoFileSource, SaysThatAnMp4WasNeverFinished) {
  const test::TemporaryFolder folder;
  const fs::path file = video(folder, "a.mp4", "-c:v libx264 -pix_fmt yuv420p");
  const std::string bytes = test::contentsOf(file);
  const std::size_t index = bytes.find("moov") - 4;
  for (const std::size_t end : {index, index + 100}) {
    std::ofstream(folder / "cut.mp4", std::ios::binary) << bytes.substr(0, end);
    EXPECT_THAT(test::messageOf([&] { VideoFileSource(folder / "cut.mp4", {}); }),
                HasSubstr("whose index (moov) is missing: the recorder never finished the file"));
  }
  std::ofstream(folder / "empty.mp4").flush();
  EXPECT_THAT(test::messageOf([&] { VideoFileSource(folder / "empty.mp4", {}); }), HasSubstr("it is empty"));
}

TEST(VideoFileSource, SaysThatAFileEndsBeforeItsHeaderStates) {
  const test::TemporaryFolder folder;
  for (const char* name : {"a.mkv", "b.flv"}) {
    const fs::path file = video(folder, name, "-c:v libx264 -pix_fmt yuv420p -g 10");
    VideoFileSource complete(file, {});
    framesOf(complete);
    EXPECT_EQ(complete.health().last_error, "") << name;
    fs::resize_file(file, fs::file_size(file) * 4 / 10);
    VideoFileSource source(file, {});
    EXPECT_LT(framesOf(source).size(), 25U) << name;
    EXPECT_THAT(source.health().last_error, HasSubstr("that its header states: it is cut off or damaged"))
        << name;
  }
}

TEST(VideoFileSource, RejectsFilesThatAreNoVideo) {
  const test::TemporaryFolder folder;
  EXPECT_THAT(test::messageOf([&] { VideoFileSource(folder / "no.mp4", {}); }),
              HasSubstr("cannot be read: No such file or directory"));
  for (const auto& [text, error] :
       {std::pair("0.05\n0.10\n", "it is a text file"), std::pair("<html>", "is a web page")}) {
    std::ofstream(folder / "text.txt") << text;
    EXPECT_THAT(test::messageOf([&] { VideoFileSource(folder / "text.txt", {}); }),
                AllOf(HasSubstr("cannot read the video"), HasSubstr(error)));
  }
  std::ofstream(folder / "list.m3u8") << "#EXTM3U\n#EXTINF:1,\nhttp://127.0.0.1:1/other.ts\n#EXT-X-ENDLIST\n";
  EXPECT_THAT(test::messageOf([&] { VideoFileSource(folder / "list.m3u8", {}); }),
              HasSubstr("cannot read the video"));
}

}  // namespace
}  // namespace cartvo::capture
