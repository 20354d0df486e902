#include "tools/calibrate/stream_views.hpp"

#include <chrono>
#include <stdexcept>
#include <utility>

#include "calib/board_pose.hpp"
#include "tools/calibrate/still_views.hpp"

namespace cartvo {
namespace {

/// When a frame came, by the host's clock, which is the same for both cameras; files may know the exposure
/// alone.
std::int64_t instantOf(const Frame& frame) {
  return frame.arrival_ns != 0 ? frame.arrival_ns : frame.exposure_ns;
}

/// One camera's frames, the next one in hand.
class FrameInHand {
 public:
  FrameInHand(CameraSource& source, const char* side) : source_(source), side_(side) {}

  bool ended() const { return ended_; }
  bool isThere() const { return is_there_; }
  const Frame& frame() const { return frame_; }

  /// Lets go of the frame.
  void advance() { is_there_ = false; }

  /// Waits half a second at most for the next frame if there is none.
  void fetch() {
    if (is_there_ || ended_) return;
    const ReadOutcome outcome = source_.read(frame_, std::chrono::milliseconds(500));
    ended_ = outcome == ReadOutcome::ended;
    is_there_ = outcome == ReadOutcome::frame && frame_.status == FrameStatus::good;
    if (!is_there_) return;
    last_ = Clock::now();
    has_begun_ = true;
  }

  /// What is wrong with a camera that gives no picture for ten seconds; empty if nothing is. Throws
  /// std::runtime_error if it never gave one.
  std::string problem() const {
    if (!isSilentFor(std::chrono::seconds(10))) return {};
    const std::string reason = source_.health().last_error;
    std::string problem =
        std::string("the ") + side_ + " camera gives no picture" + (reason.empty() ? "" : ": " + reason);
    if (!has_begun_) throw std::runtime_error(problem);
    return problem;
  }

  bool isLost() const { return isSilentFor(std::chrono::seconds(60)); }

 private:
  using Clock = std::chrono::steady_clock;

  bool isSilentFor(std::chrono::seconds time) const {
    return !is_there_ && !ended_ && Clock::now() - last_ > time;
  }

  CameraSource& source_;
  const char* side_;
  Frame frame_;
  Clock::time_point last_ = Clock::now();
  bool is_there_ = false;
  bool has_begun_ = false;
  bool ended_ = false;
};

/// Tilts as they look through a usual lens: nothing better is known before the calibration.
TiltCoverage roughTilts(const std::vector<BoardView>& views, const BoardSpec& board, cv::Size size) {
  CameraModel usual;
  usual.size = size;
  usual.fx = usual.fy = 0.7 * size.width;
  usual.cx = (size.width - 1) / 2.0;
  usual.cy = (size.height - 1) / 2.0;
  std::vector<Eigen::Isometry3d> poses;
  for (const BoardView& view : views) {
    if (const auto pose = boardPose(usual, view.left, boardCorners(board))) poses.push_back(*pose);
  }
  return tiltsOf(poses);
}

/// The views being taken from two streams.
class ViewTaking {
 public:
  ViewTaking(const BoardSpec& board, const std::function<void(const StreamProgress&)>& tell)
      : board_(board), still_(board), tell_(tell) {
    progress_.what_to_show = "show the board to both cameras";
  }

  /// Looks at the next frame; throws std::runtime_error for one of another size.
  void look(CameraSide side, const Frame& frame) {
    if (streamed_.image_size.empty()) {
      streamed_.image_size = frame.image.size();
      begin_ns_ = instantOf(frame);
    }
    if (frame.image.size() != streamed_.image_size)
      throw std::runtime_error("the cameras' images are not all of one size: set both streams to the same");
    progress_.seconds = 1e-9 * static_cast<double>(instantOf(frame) - begin_ns_);
    StillViews::Looked looked = still_.look(side, frame.image, instantOf(frame));
    if (!looked.has_looked) return;
    StreamSight& sight = side == CameraSide::left ? progress_.left : progress_.right;
    sight.image = still_.image(side);
    sight.corners = still_.corners(side);
    progress_.advice = still_.advice();
    progress_.has_new_view = looked.view.has_value();
    if (looked.view) take(std::move(*looked.view));
    tell_(progress_);
  }

  void tellProblem(const std::string& problem) {
    progress_.advice = problem;
    progress_.has_new_view = false;
    tell_(progress_);
  }

  const StreamProgress& progress() const { return progress_; }
  std::size_t count() const { return streamed_.views.size(); }
  StreamedViews result() && { return std::move(streamed_); }

 private:
  void take(DetectedView&& view) {
    constexpr std::size_t kWithImages = 10;  // one that is used will be among them, for the report
    if (streamed_.views.size() >= kWithImages) view.left_image = view.right_image = cv::Mat();
    streamed_.views.push_back(std::move(view));
    progress_.so_far = partViews(streamed_.views, streamed_.image_size);
    const std::vector<BoardView>& views = progress_.so_far.views;
    const std::vector<RejectedView>& rejected = progress_.so_far.rejected;
    const bool is_rejected = !rejected.empty() && rejected.back().name == streamed_.views.back().view.name;
    progress_.rejection = is_rejected ? rejected.back().reason : std::string();
    progress_.left.coverage = coverageOf(views, &BoardView::left, streamed_.image_size);
    progress_.right.coverage = coverageOf(views, &BoardView::right, streamed_.image_size);
    progress_.tilts = roughTilts(views, board_, streamed_.image_size);
    progress_.what_to_show =
        whatToShowNext(progress_.left.coverage, progress_.right.coverage, progress_.tilts);
    if (progress_.what_to_show.empty() && views.size() < kEnoughViews)
      progress_.what_to_show = "show the board in other places, near and far";
  }

  BoardSpec board_;
  StillViews still_;
  const std::function<void(const StreamProgress&)>& tell_;
  StreamedViews streamed_;
  StreamProgress progress_;
  std::int64_t begin_ns_ = 0;
};

}  // namespace

StreamedViews viewsFromStreams(CameraSource& left, CameraSource& right, const BoardSpec& board,
                               const StreamViewSettings& settings,
                               const std::function<void(const StreamProgress&)>& tell) {
  FrameInHand left_frame(left, "left"), right_frame(right, "right");
  ViewTaking views(board, tell);
  while (!settings.is_asked_to_stop()) {
    left_frame.fetch();
    right_frame.fetch();
    if (left_frame.ended() || right_frame.ended() || left_frame.isLost() || right_frame.isLost()) break;
    if (!left_frame.isThere() || !right_frame.isThere()) {
      for (const FrameInHand* const frame : {&left_frame, &right_frame}) {
        if (const std::string problem = frame->problem(); !problem.empty()) views.tellProblem(problem);
      }
      continue;
    }
    const bool is_left = instantOf(left_frame.frame()) <= instantOf(right_frame.frame());
    FrameInHand& earlier = is_left ? left_frame : right_frame;
    views.look(is_left ? CameraSide::left : CameraSide::right, earlier.frame());
    const StreamProgress& progress = views.progress();
    if (settings.stop_when_enough && progress.what_to_show.empty()) break;
    if (progress.seconds > settings.most_seconds || views.count() >= settings.most_views) break;
    earlier.advance();
  }
  return std::move(views).result();
}

}  // namespace cartvo
