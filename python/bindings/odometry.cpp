// The odometry on rectified images, for Python.
#include <cmath>
#include <mutex>
#include <utility>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "common/exact_text.hpp"
#include "pipeline/pair_processor.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/bindings.hpp"
#include "python/bindings/pair.hpp"
#include "python/bindings/rig.hpp"
#include "vo_core/stereo_odometry.hpp"

namespace py = pybind11;

namespace cartvo::python {
namespace {

/// StereoOdometry for several Python threads, one at a time.
class Odometry {
 public:
  Odometry(const vo::StereoCamera& camera, const vo::OdometrySettings& settings,
           const vo::StereoShutters& shutters, const vo::StereoMasks& masks)
      : size_(camera.width, camera.height), odometry_(camera, settings, shutters, masks) {}

  vo::OdometryEstimate process(const py::object& left, const py::object& right, std::int64_t t_left,
                               std::int64_t t_right, double offset_stddev, std::pair<bool, bool> key_frames) {
    vo::StereoImages images;
    images.left = imageOf(left, "left", size_);
    images.right = imageOf(right, "right", size_);
    checkInstants(t_left, t_right);
    checkOffsetStddev(offset_stddev);
    images.left_exposure_ns = t_left;
    images.right_exposure_ns = t_right;
    images.offset_stddev = offset_stddev;
    images.key_frames = {key_frames.first, key_frames.second};
    const py::gil_scoped_release release;
    const std::lock_guard lock(mutex_);
    vo::NullStageObserver observer;
    return odometry_.process(images, observer);
  }

  void setFeatures(int features) {
    const py::gil_scoped_release release;
    const std::lock_guard lock(mutex_);
    odometry_.setTargetFeatureCount(features);
  }

 private:
  cv::Size size_;
  std::mutex mutex_;
  vo::StereoOdometry odometry_;  // guarded by mutex_
};

cv::Mat maskOf(const py::object& array, const char* name, cv::Size size) {
  return array.is_none() ? cv::Mat() : imageOf(array, name, size).clone();
}

std::unique_ptr<Odometry> ofCamera(const vo::StereoCamera& camera, const vo::OdometrySettings& settings,
                                   const py::object& left_mask, const py::object& right_mask,
                                   double left_readout, double right_readout) {
  const cv::Size size(camera.width, camera.height);
  const vo::StereoMasks masks{maskOf(left_mask, "left_mask", size), maskOf(right_mask, "right_mask", size)};
  vo::StereoShutters shutters;
  shutters.left.readout = left_readout;
  shutters.right.readout = right_readout;
  return std::make_unique<Odometry>(camera, settings, shutters, masks);
}

std::unique_ptr<Odometry> ofRectifier(const RigRectifier& rectifier, const vo::OdometrySettings& settings,
                                      bool unknown_readout) {
  const calib::Rectifier& images = rectifier.rectifier();
  return std::make_unique<Odometry>(
      pipeline::stereoCamera(images.rectification()), settings,
      pipeline::stereoShutters(rectifier.rig(), images.rectification(), absentReadout(unknown_readout)),
      vo::StereoMasks{images.leftMask(), images.rightMask()});
}

}  // namespace

void checkInstants(std::int64_t left_ns, std::int64_t right_ns) {
  constexpr std::int64_t kMost = std::int64_t{1} << 62;
  for (const std::int64_t instant : {left_ns, right_ns}) {
    if (instant >= kMost || instant <= -kMost)
      throw py::value_error("t_left and t_right: expected ns less than 2**62 from zero, but got " +
                            std::to_string(instant));
  }
}

void checkOffsetStddev(double offset_stddev) {
  if (!(offset_stddev >= 0.0 && offset_stddev <= 1e6))
    throw py::value_error("offset_stddev: expected seconds, 0 to 1e6, but got " + roundedText(offset_stddev));
}

void bindOdometry(py::module_& module) {
  py::class_<Odometry>(
      module, "Odometry",
      "Estimates the motion of a stereo camera from rectified image pairs. The same images give "
      "the same results to the bit. Threads may share an object; they process one at a time.")
      .def(py::init(&ofCamera), py::arg("camera"), py::arg("settings") = vo::OdometrySettings{},
           py::kw_only(), py::arg("left_mask") = py::none(), py::arg("right_mask") = py::none(),
           py::arg("left_readout") = 0.0, py::arg("right_readout") = 0.0,
           "Of a rectified camera. Masks are 0 where an image must not be used. Readouts of rolling shutters "
           "in s: "
           "exposure of the lower edge minus that of the upper edge of the image.")
      .def(py::init(&ofRectifier), py::arg("camera"), py::arg("settings") = vo::OdometrySettings{},
           py::kw_only(), py::arg("unknown_readout") = false,
           "Of a rectifier, whose rig gives the camera, the masks and the readouts. unknown_readout: a "
           "readout that "
           "the rig does not state is estimated, as for IP cameras; else it counts as a global shutter.")
      .def("process", &Odometry::process, py::arg("left"), py::arg("right"), py::arg("t_left"),
           py::arg("t_right"), py::arg("offset_stddev") = 0.0,
           py::arg("key_frames") = std::pair(false, false),
           "Processes the next pair: rectified images, uint8 arrays of shape (height, width), and their "
           "instants of "
           "exposure in ns, of any epoch. offset_stddev: s, of the right exposure minus the left one. "
           "key_frames: "
           "which images are key frames of a video. Does not copy the arrays to Python objects, keeps no "
           "reference to "
           "them, and lets other threads run. Raises TypeError or ValueError that names the argument. What "
           "the images "
           "show, or a time that goes back, raises nothing: see Estimate.reasons.")
      .def("set_features", &Odometry::setFeatures, py::arg("features"),
           "Sets the target number of features from the next pair on.");
}

}  // namespace cartvo::python
