#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "calib/board/board_spec.hpp"
#include "calib/board/view_coverage.hpp"
#include "capture/camera_source.hpp"
#include "tools/calibrate/views/board_views.hpp"

namespace cartvo {

/// The newest processed image of a camera, with its corners and the coverage so far.
struct CameraPreview {
  cv::Mat image;  ///< CV_8UC1; immutable
  std::vector<calib::SeenCorner> corners;
  calib::ImageCoverage coverage;  ///< by the usable views so far
};

/// Progress of the collection of views.
struct StreamProgress {
  double seconds = 0.0;  ///< time since the first frame
  CameraPreview left, right;
  std::string advice;  ///< immediate instruction, see StillBoardDetector::advice, or a camera's problem
  bool has_new_view = false;  ///< whether this update took a view
  std::string rejection;      ///< why the new view was rejected; empty if it was not
  BoardViews so_far;
  calib::TiltCoverage tilts;     ///< computed with a typical lens
  std::string next_view_advice;  ///< see nextViewAdvice; empty if the views are sufficient
};

/// Number of views that is sufficient if they cover the images and all tilts.
inline constexpr std::size_t kTargetViewCount = 20;

/// Views taken from streams.
struct StreamedViews {
  cv::Size image_size;
  std::vector<DetectedView> views;  ///< the first ten with their images
};

/// Settings of the collection of views.
struct StreamViewSettings {
  double max_seconds = 900.0;      ///< time since the first frame
  bool stop_when_complete = true;  ///< stop when the views are sufficient; else read the streams to their end
  std::size_t max_views = 200;
  std::function<bool()> is_stop_requested = [] { return false; };
  /// Called with each view that is taken, with its images.
  std::function<void(const DetectedView&)> keep_view = [](const DetectedView&) {};
};

/// Collects the views in which the board is held still, see StillBoardDetector, and calls `report` after each
/// processed image. Throws std::runtime_error if a stream never has a picture (within ten seconds, or until
/// the collection is stopped) or the image size changes. If a stream stops later, it is waited for for a
/// minute; the views so far are then returned.
StreamedViews viewsFromStreams(capture::CameraSource& left, capture::CameraSource& right,
                               const calib::BoardSpec& board, const StreamViewSettings& settings,
                               const std::function<void(const StreamProgress&)>& report);

}  // namespace cartvo
