#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "calib/board_spec.hpp"
#include "calib/view_coverage.hpp"
#include "capture/camera_source.hpp"
#include "tools/calibrate/board_views.hpp"

namespace cartvo {

/// What one camera shows at the moment.
struct StreamSight {
  cv::Mat image;  ///< CV_8UC1; never written to again
  std::vector<SeenCorner> corners;
  ImageCoverage coverage;  ///< by the views so far
};

/// What a person before the cameras is told.
struct StreamProgress {
  double seconds = 0.0;  ///< of the streams
  StreamSight left, right;
  std::string advice;         ///< what to do at this moment, see StillViews::advice; or what a camera lacks
  bool has_new_view = false;  ///< one was taken in this look
  std::string rejection;      ///< why the new view is rejected; empty if it is not
  BoardViews so_far;
  TiltCoverage tilts;        ///< as they look through a usual lens
  std::string what_to_show;  ///< next; empty if there is enough
};

/// So many views are enough if they show the board everywhere and tilted to all sides.
inline constexpr std::size_t kEnoughViews = 20;

struct StreamedViews {
  cv::Size image_size;
  std::vector<DetectedView> views;  ///< the first few with their images
};

struct StreamViewSettings {
  double most_seconds = 900.0;  ///< of the streams
  bool stop_when_enough =
      true;  ///< when there is nothing more to show; else the streams are read to their end
  std::size_t most_views = 200;
  std::function<bool()> is_asked_to_stop = [] { return false; };
};

/// Takes the views in which the board is held still, see StillViews, and tells after each look how things
/// stand. Throws std::runtime_error if a stream gives nothing in its first ten seconds or its images change
/// their size. A stream that falls silent later is waited for, for a minute: the views so far are not lost.
StreamedViews viewsFromStreams(CameraSource& left, CameraSource& right, const BoardSpec& board,
                               const StreamViewSettings& settings,
                               const std::function<void(const StreamProgress&)>& tell);

}  // namespace cartvo
