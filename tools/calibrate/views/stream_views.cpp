// Board views from two live or recorded streams.
#include "tools/calibrate/views/stream_views.hpp"

#include <chrono>
#include <stdexcept>
#include <utility>

#include "calib/board/board_pose.hpp"
#include "tools/calibrate/views/still_board_detector.hpp"

namespace cartvo {
namespace {

/// The arrival time of a frame by the host's clock, which is common to both cameras. For files without
/// arrival times, the exposure time.
std::int64_t arrivalOrExposure(const capture::Frame& frame) {
  return frame.arrival_ns != 0 ? frame.arrival_ns : frame.exposure_ns;
}

/// The next frame of a camera, and the camera's state.
class PendingFrame {
 public:
  PendingFrame(capture::CameraSource& source, const char* side) : source_(source), side_(side) {}

  bool ended() const { return ended_; }
  bool hasFrame() const { return has_frame_; }
  const capture::Frame& frame() const { return frame_; }

  /// Discards the frame.
  void discard() { has_frame_ = false; }

  /// Reads the next frame if there is none; waits at most half a second.
  void fetch() {
    if (has_frame_ || ended_) return;
    const capture::ReadOutcome outcome = source_.read(frame_, std::chrono::milliseconds(500));
    ended_ = outcome == capture::ReadOutcome::ended;
    has_frame_ = outcome == capture::ReadOutcome::frame && frame_.status == capture::FrameStatus::good;
    if (!has_frame_) return;
    last_ = Clock::now();
    has_started_ = true;
  }

  /// An error message if the camera refuses the connection, or has had no picture for ten seconds; else
  /// empty. Throws std::runtime_error if it never had one in that time.
  std::string problem() const {
    const bool is_silent = isSilentFor(std::chrono::seconds(10));
    if (!is_silent && source_.health().state != capture::CameraState::refused) return {};
    if (is_silent && !has_started_) throw std::runtime_error(silenceText());
    return silenceText();
  }

  bool hasStarted() const { return has_started_; }

  /// That the camera gives no picture, and why.
  std::string silenceText() const {
    const std::string reason = source_.health().last_error;
    return std::string("the ") + side_ + " camera gives no picture" + (reason.empty() ? "" : ": " + reason);
  }

  bool isLost() const { return isSilentFor(std::chrono::seconds(60)); }

 private:
  using Clock = std::chrono::steady_clock;

  bool isSilentFor(std::chrono::seconds time) const {
    return !has_frame_ && !ended_ && Clock::now() - last_ > time;
  }

  capture::CameraSource& source_;
  const char* side_;
  capture::Frame frame_;
  Clock::time_point last_ = Clock::now();
  bool has_frame_ = false;
  bool has_started_ = false;
  bool ended_ = false;
};

/// Tilts computed with a typical lens, since the actual one is not yet calibrated.
calib::TiltCoverage approximateTilts(const std::vector<calib::BoardView>& views,
                                     const calib::BoardSpec& board, cv::Size size) {
  calib::CameraModel typical;
  typical.size = size;
  typical.fx = typical.fy = 0.7 * size.width;
  typical.cx = (size.width - 1) / 2.0;
  typical.cy = (size.height - 1) / 2.0;
  std::vector<Eigen::Isometry3d> poses;
  for (const calib::BoardView& view : views) {
    if (const auto pose = calib::boardPose(typical, view.left, calib::boardCorners(board)))
      poses.push_back(*pose);
  }
  return calib::tiltsOf(poses);
}

/// Collects views from two streams.
class ViewCollector {
 public:
  ViewCollector(const calib::BoardSpec& board, const StreamViewSettings& settings,
                const std::function<void(const StreamProgress&)>& report)
      : board_(board), settings_(settings), still_board_(board), report_(report) {
    progress_.next_view_advice = "show the board to both cameras";
  }

  /// Processes the next frame. Throws std::runtime_error if its size differs.
  void process(capture::CameraSide side, const capture::Frame& frame) {
    if (streamed_.image_size.empty()) {
      streamed_.image_size = frame.image.size();
      begin_ns_ = arrivalOrExposure(frame);
    }
    if (frame.image.size() != streamed_.image_size)
      throw std::runtime_error("the cameras' images are not all of one size: set both streams to the same");
    progress_.seconds = 1e-9 * static_cast<double>(arrivalOrExposure(frame) - begin_ns_);
    StillBoardDetector::UpdateResult result =
        still_board_.update(side, frame.image, arrivalOrExposure(frame));
    if (!result.is_processed) return;
    CameraPreview& preview = side == capture::CameraSide::left ? progress_.left : progress_.right;
    preview.image = still_board_.image(side);
    preview.corners = still_board_.corners(side);
    progress_.advice = still_board_.advice();
    progress_.has_new_view = result.view.has_value();
    if (result.view) addView(std::move(*result.view));
    report_(progress_);
  }

  void reportProblem(const std::string& problem) {
    progress_.advice = problem;
    progress_.has_new_view = false;
    report_(progress_);
  }

  const StreamProgress& progress() const { return progress_; }
  std::size_t count() const { return streamed_.views.size(); }
  StreamedViews result() && { return std::move(streamed_); }

 private:
  void addView(DetectedView&& view) {
    settings_.keep_view(view);
    constexpr std::size_t kViewsWithImages =
        10;  // to have the images of at least one usable view in the report
    if (streamed_.views.size() >= kViewsWithImages) view.left_image = view.right_image = cv::Mat();
    streamed_.views.push_back(std::move(view));
    progress_.so_far = classifyViews(streamed_.views, streamed_.image_size);
    const std::vector<calib::BoardView>& views = progress_.so_far.views;
    const std::vector<calib::RejectedView>& rejected = progress_.so_far.rejected;
    const bool is_rejected = !rejected.empty() && rejected.back().name == streamed_.views.back().view.name;
    progress_.rejection = is_rejected ? rejected.back().reason : std::string();
    progress_.left.coverage = calib::coverageOf(views, &calib::BoardView::left, streamed_.image_size);
    progress_.right.coverage = calib::coverageOf(views, &calib::BoardView::right, streamed_.image_size);
    progress_.tilts = approximateTilts(views, board_, streamed_.image_size);
    progress_.next_view_advice =
        calib::nextViewAdvice(progress_.left.coverage, progress_.right.coverage, progress_.tilts);
    if (progress_.next_view_advice.empty() && views.size() < kTargetViewCount)
      progress_.next_view_advice = "show the board in other places, near and far";
  }

  calib::BoardSpec board_;
  const StreamViewSettings& settings_;
  StillBoardDetector still_board_;
  const std::function<void(const StreamProgress&)>& report_;
  StreamedViews streamed_;
  StreamProgress progress_;
  std::int64_t begin_ns_ = 0;
};

}  // namespace

StreamedViews viewsFromStreams(capture::CameraSource& left, capture::CameraSource& right,
                               const calib::BoardSpec& board, const StreamViewSettings& settings,
                               const std::function<void(const StreamProgress&)>& report) {
  PendingFrame left_frame(left, "left"), right_frame(right, "right");
  ViewCollector views(board, settings, report);
  while (!settings.is_stop_requested()) {
    left_frame.fetch();
    right_frame.fetch();
    if (left_frame.ended() || right_frame.ended() || left_frame.isLost() || right_frame.isLost()) break;
    if (!left_frame.hasFrame() || !right_frame.hasFrame()) {
      for (const PendingFrame* const frame : {&left_frame, &right_frame}) {
        if (const std::string problem = frame->problem(); !problem.empty()) views.reportProblem(problem);
      }
      continue;
    }
    const bool is_left = arrivalOrExposure(left_frame.frame()) <= arrivalOrExposure(right_frame.frame());
    PendingFrame& earlier = is_left ? left_frame : right_frame;
    views.process(is_left ? capture::CameraSide::left : capture::CameraSide::right, earlier.frame());
    const StreamProgress& progress = views.progress();
    if (settings.stop_when_complete && progress.next_view_advice.empty()) break;
    if (progress.seconds > settings.max_seconds || views.count() >= settings.max_views) break;
    earlier.discard();
  }
  for (const PendingFrame* const frame : {&left_frame, &right_frame}) {
    if (!frame->hasStarted()) throw std::runtime_error(frame->silenceText());
  }
  return std::move(views).result();
}

}  // namespace cartvo
