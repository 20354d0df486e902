// Results of the odometry, for Python.
#include "python/bindings/estimate.hpp"

#include <pybind11/stl.h>

#include "daemon/publish/message_names.hpp"
#include "daemon/publish/odometry_publisher.hpp"
#include "pipeline/body_motion.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/bindings.hpp"

namespace py = pybind11;

namespace cartvo::python {
namespace {

using vo::OdometryEstimate;

/// Velocities in the axes of the left camera: those at the exposure if they are known, else the means over
/// the time step; NaN if there is no motion.
pipeline::BodyMotion cameraMotion(const OdometryEstimate& estimate) {
  pipeline::BodyMotion motion = pipeline::bodyMotion(estimate, Eigen::Isometry3d::Identity());
  if (estimate.valid && estimate.twist)
    pipeline::setTwist(motion, *estimate.twist, Eigen::Isometry3d::Identity(), 0.0);
  return motion;
}

void bindRigError(py::module_& module) {
  using Value = vo::EstimateWithStddev;
  py::class_<Value>(module, "EstimateWithStddev", "A value and its standard deviation, in the same unit.")
      .def_readonly("value", &Value::value)
      .def_readonly("stddev", &Value::stddev);
  using Observability = vo::RigObservability;
  py::class_<Observability>(module, "RigObservability",
                            "Shares of the initial variances that measurements have removed: 0 to 1.")
      .def_readonly("pitch", &Observability::pitch)
      .def_readonly("yaw", &Observability::yaw)
      .def_readonly("roll", &Observability::roll)
      .def_readonly("delay", &Observability::delay);
  using Error = vo::RigCalibrationError;
  py::class_<Error>(module, "RigCalibrationError",
                    "Error of the rig as estimated while driving: of the right camera against the left one, "
                    "about x right, y down, z forward.")
      .def_readonly("pitch", &Error::pitch, "rad, positive if it looks too far up")
      .def_readonly("yaw", &Error::yaw, "rad, positive if it looks too far right")
      .def_readonly("roll", &Error::roll, "rad, positive if it is turned clockwise")
      .def_readonly("delay", &Error::delay, "s, by which the right exposure is later than its timestamp")
      .def_readonly("observability", &Error::observability);
}

template <typename Class>
void addMotion(Class& estimate) {
  estimate
      .def_property_readonly(
          "pose", [](const OdometryEstimate& self) { return toArray(self.T_world_camera); },
          "4x4, rectified left camera axes to world axes, m; the world is the camera at the "
          "start of the epoch")
      .def_property_readonly(
          "pose_covariance", [](const OdometryEstimate& self) { return toArray(self.pose_covariance); },
          "6x6, order x y z, rotation about x y z; m and rad, in the axes of the current camera")
      .def_property_readonly(
          "motion", [](const OdometryEstimate& self) { return toArray(self.T_previous_current); },
          "4x4, since the reference (the last valid pair); identity if invalid")
      .def_property_readonly(
          "motion_covariance", [](const OdometryEstimate& self) { return toArray(self.motion_covariance); },
          "6x6, as pose_covariance")
      .def_property_readonly(
          "velocity", [](const OdometryEstimate& self) { return toArray(cameraMotion(self).velocity); },
          "m/s in the axes of the rectified left camera; NaN if invalid")
      .def_property_readonly(
          "angular_velocity",
          [](const OdometryEstimate& self) { return toArray(cameraMotion(self).angular_velocity); },
          "rad/s about x right, y down, z forward; NaN if invalid")
      .def_property_readonly(
          "twist_covariance",
          [](const OdometryEstimate& self) { return toArray(cameraMotion(self).twist_covariance); },
          "6x6 of velocity, then angular velocity; NaN if invalid");
}

}  // namespace

py::list partsOf(const std::string& names) {
  py::list list;
  for (std::size_t begin = 0; begin < names.size();) {
    const std::size_t end = std::min(names.find(", ", begin), names.size());
    list.append(names.substr(begin, end - begin));
    begin = end + 2;
  }
  return list;
}

py::list reasonList(const vo::OdometryReasons& reasons) {
  return partsOf(daemon::reasonNames(static_cast<std::int32_t>(reasons.bits())));
}

void bindEstimate(py::module_& module) {
  py::enum_<Status>(module, "Status", "Whether a result can be used.")
      .value("INVALID", Status::invalid)
      .value("VALID", Status::valid);
  bindRigError(module);

  py::class_<OdometryEstimate> estimate(module, "Estimate", "Result of Odometry for one pair.");
  estimate
      .def_property_readonly(
          "status", [](const OdometryEstimate& self) { return self.valid ? Status::valid : Status::invalid; })
      .def_readonly("valid", &OdometryEstimate::valid, "whether a motion was measured")
      .def_property_readonly(
          "reasons", [](const OdometryEstimate& self) { return reasonList(self.reasons); },
          "why it is invalid, for example ['too few matches']; if valid empty or "
          "['zero velocity']")
      .def_readonly("exposure_ns", &OdometryEstimate::exposure_ns, "of the left image, as given")
      .def_readonly("epoch", &OdometryEstimate::reset_counter,
                    "from 0; increments when the pose restarts from the identity")
      .def_readonly("time_step", &OdometryEstimate::time_step, "s from the reference; 0 if invalid")
      .def_property_readonly(
          "detected", [](const OdometryEstimate& self) { return self.counts.detected; },
          "features in the left image")
      .def_property_readonly(
          "tracked", [](const OdometryEstimate& self) { return self.counts.tracked; },
          "features found again from the previous pair")
      .def_property_readonly(
          "inliers", [](const OdometryEstimate& self) { return self.counts.inliers; },
          "features consistent with the motion")
      .def_readonly("rig", &OdometryEstimate::rig,
                    "error of the rig as estimated; None if it is not estimated")
      .def("__repr__", [](const OdometryEstimate& self) {
        return py::str("<cartvo.Estimate {} {} at {} m>")
            .format(self.valid ? "VALID" : "INVALID", reasonList(self.reasons),
                    toArray(Eigen::Vector3d(self.T_world_camera.translation())));
      });
  addMotion(estimate);
}

}  // namespace cartvo::python
