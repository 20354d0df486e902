// The chain from raw images to the motion of the cart's body, for Python.
#include "pipeline/pair_processor.hpp"

#include <memory>
#include <mutex>
#include <utility>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "daemon/publish/message_names.hpp"
#include "daemon/publish/odometry_publisher.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/bindings.hpp"
#include "python/bindings/estimate.hpp"
#include "python/bindings/pair.hpp"
#include "python/bindings/rig.hpp"

namespace py = pybind11;

namespace cartvo::python {
namespace {

using pipeline::PairResult;

/// pipeline::PairProcessor for several Python threads, one at a time.
class Processor {
 public:
  Processor(const calib::Rig& rig, const vo::OdometrySettings& settings, bool unknown_readout,
            const pipeline::AlertLimits& alert_limits)
      : size_(rig.left.size),
        processor_(rig, {rig, rig.rectification, calib::buildTables(rig, rig.rectification)},
                   {settings, absentReadout(unknown_readout), alert_limits}) {}

  PairResult process(const Pair& pair) {
    requireSize(pair.frames.left, "left");
    requireSize(pair.frames.right, "right");
    const py::gil_scoped_release release;
    const std::lock_guard lock(mutex_);
    return processor_.process(pair.frames);
  }

 private:
  void requireSize(const capture::Frame& frame, const char* side) const {
    if (frame.image.size() == size_) return;
    throw py::value_error(std::string(side) + ": expected shape (" + std::to_string(size_.height) + ", " +
                          std::to_string(size_.width) + ") as in the rig, but got (" +
                          std::to_string(frame.image.rows) + ", " + std::to_string(frame.image.cols) + ")");
  }

  cv::Size size_;
  std::mutex mutex_;
  pipeline::PairProcessor processor_;  // guarded by mutex_
};

py::list reasonsOf(const PairResult& result) {
  return partsOf(daemon::reasonNames(daemon::odometryMessage(result).reasons));
}

void bindAlertLimits(py::module_& module) {
  using pipeline::AlertLimits;
  py::class_<AlertLimits>(
      module, "AlertLimits",
      "Largest bounds, for each axis, with which a motion is valid: odometry.alert_limits "
      "of cartvod, but angles in rad.")
      .def(py::init<>())
      .def_readwrite("velocity", &AlertLimits::velocity, "m/s")
      .def_readwrite("angular_rate", &AlertLimits::angular_rate, "rad/s")
      .def_readwrite("motion", &AlertLimits::motion, "m, of the translation over the last second")
      .def_readwrite("rotation", &AlertLimits::rotation, "rad, of the rotation over the last second");
}

template <typename Class>
void addBounds(Class& estimate) {
  estimate
      .def_property_readonly(
          "velocity_bound", [](const PairResult& self) { return toArray(self.level.velocity); },
          "m/s: the errors of velocity exceed it with a probability of at most 1e-4 an estimate; NaN if "
          "nothing was measured, as are the next three")
      .def_property_readonly(
          "angular_rate_bound", [](const PairResult& self) { return toArray(self.level.angular_rate); },
          "rad/s, of angular_velocity")
      .def_property_readonly(
          "motion_bound", [](const PairResult& self) { return toArray(self.level.motion); },
          "m, of the translation over the last second, in the axes of the current body")
      .def_property_readonly(
          "rotation_bound", [](const PairResult& self) { return toArray(self.level.rotation); },
          "rad, of the rotation over the last second")
      .def_property_readonly(
          "quality", [](const PairResult& self) { return self.isValid() ? self.worst->quality() : 0; },
          "distance of the worst bound from its alert limit: 1 to 100, 0 if invalid")
      .def_property_readonly(
          "bound_exceeded",
          [](const PairResult& self) {
            return self.exceedsAlertLimit() ? self.worst->text() : std::string();
          },
          "the bound that is farthest above its alert limit, in words; empty if none is");
}

}  // namespace

void bindPairProcessor(py::module_& module) {
  bindAlertLimits(module);
  py::class_<PairResult> estimate(
      module, "BodyEstimate",
      "Result of PairProcessor for one pair: the motion of the cart's body, as cartvod publishes it. "
      "Body axes: x forward, y left, z up.");
  estimate
      .def_property_readonly(
          "status", [](const PairResult& self) { return self.isValid() ? Status::valid : Status::invalid; })
      .def_property_readonly("valid", &PairResult::isValid,
                             "whether pose and velocity were measured, each bound below its alert limit")
      .def_property_readonly("reasons", &reasonsOf, "why it is invalid; if valid empty or ['zero velocity']")
      .def_property_readonly(
          "exposure_ns", [](const PairResult& self) { return self.left.exposure_ns; }, "of the left image")
      .def_property_readonly(
          "epoch", [](const PairResult& self) { return self.estimate.reset_counter; },
          "from 0; increments when the pose restarts from the identity")
      .def_property_readonly(
          "pose", [](const PairResult& self) { return toArray(self.motion.T_world_body); },
          "4x4, body axes to world axes, m; the world is the body at the start of the epoch")
      .def_property_readonly(
          "pose_covariance", [](const PairResult& self) { return toArray(self.motion.pose_covariance); },
          "6x6, order x y z, rotation about x y z; m and rad, in the axes of the current body")
      .def_property_readonly(
          "velocity", [](const PairResult& self) { return toArray(self.motion.velocity); },
          "m/s, of the body's origin at the exposure, in body axes; NaN if invalid")
      .def_property_readonly(
          "angular_velocity", [](const PairResult& self) { return toArray(self.motion.angular_velocity); },
          "rad/s: roll, pitch, yaw rate; NaN if invalid")
      .def_property_readonly(
          "twist_covariance", [](const PairResult& self) { return toArray(self.motion.twist_covariance); },
          "6x6 of velocity, then angular velocity; NaN if invalid")
      .def_readonly("camera", &PairResult::estimate, "the estimate of the rectified left camera");
  addBounds(estimate);

  py::class_<Processor>(
      module, "PairProcessor",
      "Processes pairs of raw images as cartvod does: rectification, odometry, motion of the body.")
      .def(py::init<const calib::Rig&, const vo::OdometrySettings&, bool, const pipeline::AlertLimits&>(),
           py::arg("rig"), py::arg("settings") = vo::OdometrySettings{}, py::kw_only(),
           py::arg("unknown_readout") = false, py::arg("alert_limits") = pipeline::AlertLimits{},
           "unknown_readout: as of Odometry. Raises ValueError if the rig or a setting is out of range.")
      .def("process", &Processor::process, py::arg("pair"),
           "Processes the next pair and lets other threads run. Raises ValueError for images of another size "
           "than the "
           "rig's.");
}

}  // namespace cartvo::python
