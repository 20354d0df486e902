// Opens two videos as a stereo source and estimates their time offset.

#include "tools/replay/video_pair.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "common/image_size.hpp"
#include "tools/replay/replay.hpp"
#include "tools/videos/picture_offset.hpp"

namespace cartvo {
namespace {

constexpr double kRefinementDuration = 15.0;  // s; the odometry averages the time offset over 10 s
constexpr int kMaxIterations = 3;  // large offsets are underestimated (pipeline/visual_offset_estimator.cpp)
constexpr double kMaxOdometryStddev = 3e-3;  // s; above it the odometry adds nothing to the image motion
constexpr double kUnderestimate = 0.1;       // fraction by which the odometry may underestimate an offset
constexpr double kMaxCorrection = 0.1;       // s; larger than any error of the image motion

/// Part of the video, `length` s long, in which the image moved most.
VideoPart partWithMostMotion(const ImageMotion& motion, double length) {
  std::vector<double> travelled(motion.times.size(), 0.0);
  for (std::size_t i = 1; i < motion.times.size(); ++i)
    travelled[i] = travelled[i - 1] + cv::norm(motion.positions[i] - motion.positions[i - 1]);
  std::size_t best = 0;
  double most = -1.0;
  for (std::size_t first = 0, last = 0; first < motion.times.size(); ++first) {
    while (last + 1 < motion.times.size() && motion.times[last] - motion.times[first] < length)
      ++last;
    if (travelled[last] - travelled[first] <= most) continue;
    most = travelled[last] - travelled[first];
    best = first;
  }
  return {motion.times[best], motion.times[best] + length};
}

/// Remaining time offset estimated by the odometry; empty if it is too uncertain.
std::optional<vo::EstimateWithStddev> remainingOffsetByOdometry(const VideoPair& videos,
                                                                const VideoTiming& timing,
                                                                const VideoPart& part,
                                                                const calib::Rig& rig) {
  capture::StereoSource source = openVideos(videos, timing, part);
  const Replay replay =
      replayPairs(source, {rig, ""}, vo::OdometrySettings{}, [](const pipeline::PairResult&, std::size_t) {});
  const auto last = std::find_if(replay.pairs.rbegin(), replay.pairs.rend(),
                                 [](const ReplayedPair& pair) { return pair.rig.has_value(); });
  if (last == replay.pairs.rend() || last->rig->delay.stddev > kMaxOdometryStddev) return std::nullopt;
  return last->rig->delay;
}

/// Offset estimated by the odometry over `part`, with its standard deviation; empty if it is too uncertain.
std::optional<vo::EstimateWithStddev> offsetByOdometry(const VideoPair& videos, VideoTiming timing,
                                                       const VideoPart& part, const calib::Rig& rig) {
  const double before = timing.offset;
  std::optional<vo::EstimateWithStddev> found;
  for (int round = 0; round < kMaxIterations; ++round) {
    const std::optional<vo::EstimateWithStddev> delay = remainingOffsetByOdometry(videos, timing, part, rig);
    if (!delay || std::abs(timing.offset + delay->value - before) > kMaxCorrection) return std::nullopt;
    timing.offset += delay->value;
    found = vo::EstimateWithStddev{timing.offset, std::hypot(delay->stddev, kUnderestimate * delay->value)};
    if (std::abs(delay->value) < delay->stddev) break;
  }
  return found;
}

/// Combines image motion and odometry weighted by their inverse variances; the standard deviation grows if
/// they disagree.
void refine(const VideoPair& videos, const VideoPart& part, const calib::Rig& rig, VideoTiming& timing) {
  const std::optional<vo::EstimateWithStddev> odometry = offsetByOdometry(videos, timing, part, rig);
  if (!odometry) return;
  const double motion_weight = 1.0 / (timing.stddev * timing.stddev);
  const double odometry_weight = 1.0 / (odometry->stddev * odometry->stddev);
  const double difference = odometry->value - timing.offset;
  const double chi_square = difference * difference / (1.0 / motion_weight + 1.0 / odometry_weight);
  const double combined = std::sqrt(std::max(chi_square, 1.0) / (motion_weight + odometry_weight));
  timing.offset += difference * odometry_weight / (motion_weight + odometry_weight);
  // The odometry improves the offset during `part` only; elsewhere the uncertainty of the skew remains.
  timing.stddev = timing.skew ? std::max(combined, timing.stddev) : combined;
  timing.found_by = "image motion and odometry";
}

}  // namespace

VideoPair findVideos(const std::filesystem::path& left, const std::filesystem::path& right, double frame_rate,
                     const calib::Rig& rig) {
  using capture::PicturePart;
  const cv::Size expected = rig.left.size;
  const auto open = [&](const std::filesystem::path& file, const capture::VideoView& view) {
    return capture::VideoFileSource(file, {.frame_rate = frame_rate}, view);
  };
  const auto fail = [&](const std::filesystem::path& file, cv::Size size, const std::string& what) {
    throw std::runtime_error(file.string() + " has pictures of " + sizeText(size) + ", and the rig is for " +
                             sizeText(expected) + what);
  };
  VideoPair videos{left, right.empty() ? left : right, frame_rate, {}, {}, right.empty()};
  if (!videos.is_one_file) {
    for (const std::filesystem::path& file : {left, right}) {
      if (const cv::Size size = open(file, {}).pictureSize(); size != expected)
        fail(file, size, ": give the rig of these videos, or calibrate at this size");
    }
    return videos;
  }
  const capture::VideoFileSource both = open(left, {});
  const cv::Size size = both.pictureSize();
  if (both.tracks() > 1) {
    videos.left_view.track = 0;
    videos.right_view.track = 1;
    for (const capture::VideoView& view : {videos.left_view, videos.right_view}) {
      if (const cv::Size track = open(left, view).pictureSize(); track != expected)
        fail(left, track, " in one of its tracks");
    }
  } else if (size == cv::Size(2 * expected.width, expected.height)) {
    videos.left_view.part = PicturePart::left_half;
    videos.right_view.part = PicturePart::right_half;
  } else if (size == cv::Size(expected.width, 2 * expected.height)) {
    videos.left_view.part = PicturePart::upper_half;
    videos.right_view.part = PicturePart::lower_half;
  } else if (size == expected) {
    throw std::runtime_error(left.string() +
                             " is one camera's video; give the right camera's too: cartvo replay LEFT RIGHT");
  } else {
    fail(left, size,
         ": a video with both cameras' pictures side by side is twice as wide, or twice as high with one "
         "above "
         "the other");
  }
  return videos;
}

capture::StereoSource openVideos(const VideoPair& videos, const VideoTiming& timing, const VideoPart& part) {
  const double each = timing.stddev / std::sqrt(2.0);
  capture::VideoFileTime left_time;
  left_time.frame_rate = videos.frame_rate;
  left_time.stddev = each;
  left_time.from = part.from;
  left_time.to = part.to;
  left_time.origin_ns = capture::VideoFileSource(videos.left, {.frame_rate = videos.frame_rate}).creationNs();
  capture::VideoFileTime right_time = left_time;
  right_time.offset = timing.offset;
  right_time.skew = timing.skew.value_or(0.0);
  right_time.from = (part.from - timing.offset) / (1.0 + right_time.skew);
  right_time.to = (part.to - timing.offset) / (1.0 + right_time.skew);

  capture::StereoSource source;
  source.kind = capture::SourceKind::videos;
  auto left = std::make_unique<capture::VideoFileSource>(videos.left, left_time, videos.left_view);
  auto right = std::make_unique<capture::VideoFileSource>(videos.right, right_time, videos.right_view);
  source.pairs = std::min(left->expectedPictures(), right->expectedPictures());
  for (const std::string& note : {left->timeNote(), videos.is_one_file ? "" : right->timeNote()}) {
    if (!note.empty()) source.warnings.push_back(note);
  }
  source.left = std::move(left);
  source.right = std::move(right);
  return source;
}

VideoTiming findVideoTiming(const VideoPair& videos, const calib::Rig& rig, const VideoProgress& progress) {
  capture::VideoFileSource left(videos.left, {.frame_rate = videos.frame_rate});
  capture::VideoFileSource right(videos.right, {.frame_rate = videos.frame_rate});
  const std::size_t expected = left.expectedPictures() + right.expectedPictures();
  std::size_t pictures = 0;
  const auto count = [&] { progress(++pictures, expected); };
  const ImageMotion left_motion = measureImageMotion(left, count);
  const ImageMotion right_motion = measureImageMotion(right, count);
  const PictureOffset found = findPictureOffset(left_motion, right_motion);
  VideoTiming timing{found.offset, found.skew, found.stddev, "image motion", found.agreement};
  refine(videos, partWithMostMotion(left_motion, kRefinementDuration), rig, timing);
  return timing;
}

}  // namespace cartvo
