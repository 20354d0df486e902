#include "tools/replay/video_pair.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "capture/video_file_source.hpp"
#include "tools/replay/replay.hpp"
#include "tools/videos/picture_offset.hpp"

namespace cartvo {
namespace {

constexpr double kLivelyPart = 15.0;  // s: the odometry's own memory of a delay is 10 s
constexpr int kRounds = 3;            // large delays are found too small (daemon/visual_clock.hpp)
constexpr double kUseful = 3e-3;      // s: a deviation beyond it tells no more than the image motion
constexpr double kShort = 0.1;        // of a delay, by which it may be found too small
constexpr double kMostRefined = 0.1;  // s: the image motion is not off by more

/// The part of that length in which the picture moved most.
VideoPart liveliestPart(const ImageMotion& motion, double length) {
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

/// What the odometry says the right camera is late by; nothing if it does not tell.
std::optional<Checked> delayByOdometry(const VideoPair& videos, const VideoTiming& timing,
                                       const VideoPart& part, const Rig& rig) {
  StereoSource source = openVideos(videos, timing, part);
  const Replay replay =
      replayPairs(source, {rig, ""}, OdometrySettings{}, [](const PairResult&, std::size_t) {});
  const auto last = std::find_if(replay.pairs.rbegin(), replay.pairs.rend(),
                                 [](const ReplayedPair& pair) { return pair.rig.has_value(); });
  if (last == replay.pairs.rend() || last->rig->delay.deviation > kUseful) return std::nullopt;
  return last->rig->delay;
}

/// The offset by the odometry over that part, with its standard deviation; nothing if it does not tell.
std::optional<Checked> offsetByOdometry(const VideoPair& videos, VideoTiming timing, const VideoPart& part,
                                        const Rig& rig) {
  const double before = timing.offset;
  std::optional<Checked> found;
  for (int round = 0; round < kRounds; ++round) {
    const std::optional<Checked> delay = delayByOdometry(videos, timing, part, rig);
    if (!delay || std::abs(timing.offset + delay->value - before) > kMostRefined) return std::nullopt;
    timing.offset += delay->value;
    found = Checked{timing.offset, std::hypot(delay->deviation, kShort * delay->value)};
    if (std::abs(delay->value) < delay->deviation) break;
  }
  return found;
}

/// The mean of both witnesses by their variances; less certain where they disagree.
void refine(const VideoPair& videos, const VideoPart& part, const Rig& rig, VideoTiming& timing) {
  const std::optional<Checked> odometry = offsetByOdometry(videos, timing, part, rig);
  if (!odometry) return;
  const double of_motion = 1.0 / (timing.deviation * timing.deviation);
  const double of_odometry = 1.0 / (odometry->deviation * odometry->deviation);
  const double difference = odometry->value - timing.offset;
  const double chi_square = difference * difference / (1.0 / of_motion + 1.0 / of_odometry);
  const double combined = std::sqrt(std::max(chi_square, 1.0) / (of_motion + of_odometry));
  timing.offset += difference * of_odometry / (of_motion + of_odometry);
  // The part tells of its own time; elsewhere the skew's uncertainty stays.
  timing.deviation = timing.skew != 0.0 ? std::max(combined, timing.deviation) : combined;
  timing.found_by = "image motion and odometry";
}

}  // namespace

StereoSource openVideos(const VideoPair& videos, const VideoTiming& timing, const VideoPart& part) {
  const double each = timing.deviation / std::sqrt(2.0);
  VideoFileTime left_time;
  left_time.deviation = each;
  left_time.from = part.from;
  left_time.to = part.to;
  left_time.origin_ns = VideoFileSource(videos.left, {}).creationNs();
  VideoFileTime right_time = left_time;
  right_time.offset = timing.offset;
  right_time.skew = timing.skew;
  right_time.from = (part.from - timing.offset) / (1.0 + timing.skew);
  right_time.to = (part.to - timing.offset) / (1.0 + timing.skew);

  StereoSource source;
  source.kind = SourceKind::videos;
  auto left = std::make_unique<VideoFileSource>(videos.left, left_time);
  auto right = std::make_unique<VideoFileSource>(videos.right, right_time);
  source.pairs = std::min(left->expectedPictures(), right->expectedPictures());
  source.left = std::move(left);
  source.right = std::move(right);
  return source;
}

VideoTiming findVideoTiming(const VideoPair& videos, const Rig& rig, const VideoProgress& progress) {
  VideoFileSource left(videos.left, {});
  VideoFileSource right(videos.right, {});
  const std::size_t expected = left.expectedPictures() + right.expectedPictures();
  std::size_t pictures = 0;
  const auto count = [&] { progress(++pictures, expected); };
  const ImageMotion left_motion = motionOf(left, count);
  const ImageMotion right_motion = motionOf(right, count);
  const PictureOffset found = findOffset(left_motion, right_motion);
  VideoTiming timing{found.offset, found.skew, found.deviation, "image motion", found.agreement};
  refine(videos, liveliestPart(left_motion, kLivelyPart), rig, timing);
  return timing;
}

}  // namespace cartvo
