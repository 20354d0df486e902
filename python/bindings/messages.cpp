// LCM messages of cartvod, for Python.
#include <algorithm>
#include <string>
#include <type_traits>

#include <cartvo/client.hpp>
#include <cartvo/health_t.hpp>
#include <cartvo/odometry_t.hpp>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "capture/camera_source.hpp"
#include "daemon/publish/message_names.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/bindings.hpp"
#include "python/bindings/estimate.hpp"

namespace py = pybind11;

namespace cartvo::python {
namespace {

/// The message in `data`, which must be all of it. Throws ValueError if it is none of this type, or an
/// odometry message that is not intact.
template <typename Message>
Message decode(const py::buffer& data) {
  const py::buffer_info bytes = data.request();
  const bool is_flat = bytes.itemsize == 1 && bytes.ndim == 1 && (bytes.size < 2 || bytes.strides[0] == 1);
  const std::string type = std::string("cartvo.") + Message::getTypeName();
  if (!is_flat) throw py::value_error(type + ": expected contiguous bytes");
  Message message{};
  int used = -1;
  constexpr py::ssize_t kMostBytes = 1 << 20;
  if (bytes.size <= kMostBytes) used = message.decode(bytes.ptr, 0, static_cast<unsigned>(bytes.size));
  if (used < 0 || used != bytes.size) {
    throw py::value_error(std::to_string(bytes.size) + " bytes are not a message of type " + type +
                          ": another channel, another version of cartvo, or cut short");
  }
  if constexpr (std::is_same_v<Message, odometry_t>) {
    if (!client::isIntact(message))
      throw py::value_error(type + ": changed on its way, its check sum is another");
  }
  return message;
}

template <typename Message>
py::bytes encode(const Message& message) {
  std::string bytes(static_cast<std::size_t>(message.getEncodedSize()), '\0');
  if (message.encode(bytes.data(), 0, static_cast<unsigned>(bytes.size())) < 0)
    throw std::runtime_error("the message cannot be encoded");
  return bytes;
}

void bindBounds(py::class_<odometry_t>& message) {
  using Message = odometry_t;
  message
      .def_property_readonly(
          "acceleration", [](const Message& self) { return toArray(self.acceleration_body, 3); },
          "m/s^2 in body axes; NaN: not estimated")
      .def_property_readonly(
          "acceleration_covariance",
          [](const Message& self) { return toSquareArray(self.acceleration_covariance_body, 3); }, "3x3")
      .def_property_readonly(
          "velocity_bound", [](const Message& self) { return toArray(self.velocity_bound, 3); },
          "m/s: errors of velocity exceed it with a probability of at most 1e-4 a message; NaN if INVALID, "
          "except for 'bound above its alert limit', as are the next three")
      .def_property_readonly(
          "angular_rate_bound", [](const Message& self) { return toArray(self.angular_rate_bound, 3); },
          "rad/s, of angular_velocity")
      .def_property_readonly(
          "motion_bound", [](const Message& self) { return toArray(self.motion_bound, 3); },
          "m, of the translation over the last second, in body axes")
      .def_property_readonly(
          "rotation_bound", [](const Message& self) { return toArray(self.rotation_bound, 3); },
          "rad, of the rotation over the last second");
}

void bindOdometryMessage(py::module_& module) {
  using Message = odometry_t;
  py::class_<Message> message(
      module, "OdometryMessage",
      "A message of the channel CARTVO_ODOMETRY. Body axes: x forward, y left, z up.");
  message
      .def_property_readonly(
          "status",
          [](const Message& self) { return self.status == Message::VALID ? Status::valid : Status::invalid; })
      .def_property_readonly("valid", [](const Message& self) { return self.status == Message::VALID; })
      .def_property_readonly(
          "reasons", [](const Message& self) { return partsOf(daemon::reasonNames(self.reasons)); },
          "why it is INVALID; if VALID empty or ['zero velocity']")
      .def_readonly("reason_bits", &Message::reasons)
      .def_readonly("utime", &Message::utime, "us since the Unix epoch, exposure of the left image")
      .def_readonly("arrival_utime", &Message::arrival_utime, "us, arrival of the pair's last packet")
      .def_readonly("publication_utime", &Message::publication_utime, "us, when it was sent")
      .def_readonly("time_to_live_us", &Message::time_to_live_us, "do not steer on an older message")
      .def_readonly("sequence", &Message::sequence, "counts the messages; a gap is a lost message")
      .def_readonly("offset_us", &Message::offset_us, "right exposure minus the left one")
      .def_readonly("source_id", &Message::source_id, "of the daemon's run, chosen at random; 0: a replay")
      .def_readonly("quality", &Message::quality,
                    "distance of the worst bound from its alert limit: 1 to 100; 0 if INVALID")
      .def_readonly("epoch", &Message::reset_counter, "increments when the pose restarts")
      .def_property_readonly(
          "position", [](const Message& self) { return toArray(self.position_world_body, 3); },
          "m, of the body in the world")
      .def_property_readonly(
          "orientation", [](const Message& self) { return toArray(self.orientation_world_body, 4); },
          "unit quaternion w x y z, body axes to world axes")
      .def_property_readonly(
          "pose_covariance", [](const Message& self) { return toSquareArray(self.pose_covariance_body, 6); },
          "6x6, order x y z, rotation about x y z; m and rad, in body axes; NaN if INVALID")
      .def_property_readonly(
          "velocity", [](const Message& self) { return toArray(self.velocity_body, 3); },
          "m/s in body axes; NaN if INVALID")
      .def_property_readonly(
          "angular_velocity", [](const Message& self) { return toArray(self.angular_velocity_body, 3); },
          "rad/s: roll, pitch, yaw rate; NaN if INVALID")
      .def_property_readonly(
          "twist_covariance",
          [](const Message& self) { return toSquareArray(self.twist_covariance_body, 6); },
          "6x6 of velocity, then angular velocity; NaN if INVALID")
      .def_readonly("features", &Message::features)
      .def_readonly("tracked", &Message::tracked)
      .def_readonly("inliers", &Message::inliers)
      .def("encode", &encode<Message>, "the bytes of the message");
  bindBounds(message);
}

py::array_t<double> vectorOf(const float (&values)[3]) {
  return toArray(Eigen::Vector3d(values[0], values[1], values[2]));
}

/// The text of a message, which should be UTF-8 but comes from the network.
template <typename Message>
auto text(std::string Message::*member) {
  return [member](const Message& self) {
    const std::string& bytes = self.*member;
    return py::reinterpret_steal<py::str>(
        PyUnicode_DecodeUTF8(bytes.data(), static_cast<py::ssize_t>(bytes.size()), "replace"));
  };
}

void bindCameraHealth(py::module_& module) {
  py::enum_<capture::CameraState>(module, "CameraState", "State of a camera.")
      .value("CONNECTING", capture::CameraState::connecting)
      .value("STREAMING", capture::CameraState::streaming)
      .value("STALLED", capture::CameraState::stalled)
      .value("REFUSED", capture::CameraState::refused)
      .value("ENDED", capture::CameraState::ended)
      .value("FROZEN", capture::CameraState::frozen);
  using Health = camera_health_t;
  py::class_<Health>(module, "CameraHealth", "One camera's part of HealthMessage.")
      .def_property_readonly("state",
                             [](const Health& self) { return static_cast<capture::CameraState>(self.state); })
      .def_readonly("frames", &Health::frames, "delivered since the start")
      .def_readonly("damaged", &Health::damaged, "number of these marked as damaged")
      .def_readonly("reconnections", &Health::reconnections)
      .def_readonly("frame_rate", &Health::frame_rate, "Hz, over the last second")
      .def_readonly("decode_ms", &Health::decode_ms, "median of the last second")
      .def_readonly("latency_ms", &Health::latency_ms, "exposure to first packet; NaN if unknown")
      .def_readonly("skew_ppm", &Health::skew_ppm, "of its clock relative to the host's clock")
      .def_readonly("clock_steps", &Health::clock_steps)
      .def_property_readonly("last_error", text(&Health::last_error));
}

void bindHealthMessage(py::module_& module) {
  using Health = health_t;
  py::class_<Health>(
      module, "HealthMessage",
      "A message of the channel CARTVO_HEALTH, once a second. Values over the last second are NaN if no "
      "pair was processed in it. daemon/messages/health_t.lcm explains each field.")
      .def_readonly("utime", &Health::utime, "us since the Unix epoch, when it was sent")
      .def_property_readonly("version", text(&Health::version))
      .def_readonly("uptime_us", &Health::uptime_us)
      .def_readonly("left", &Health::left)
      .def_readonly("right", &Health::right)
      .def_readonly("pairs", &Health::pairs, "pairs formed since the start")
      .def_readonly("dropped_no_partner", &Health::dropped_no_partner, "frames without a partner")
      .def_readonly("dropped_damaged", &Health::dropped_damaged)
      .def_readonly("dropped_out_of_order", &Health::dropped_out_of_order)
      .def_readonly("dropped_overflow", &Health::dropped_overflow)
      .def_readonly("dropped_clock", &Health::dropped_clock)
      .def_readonly("refused_size", &Health::refused_size, "frames whose size is not the rig's")
      .def_readonly("pairs_skipped", &Health::pairs_skipped, "dropped because a newer one was available")
      .def_readonly("estimates_valid", &Health::estimates_valid)
      .def_readonly("estimates_invalid", &Health::estimates_invalid)
      .def_property_readonly(
          "odometry_state", [](const Health& self) { return daemon::odometryStateName(self.odometry_state); },
          "such as \"tracking\" or \"left camera frozen\"")
      .def_readonly("pair_rate", &Health::pair_rate, "Hz")
      .def_readonly("offset_ms", &Health::offset_ms, "right minus left exposure, median")
      .def_readonly("latency_p50_ms", &Health::latency_p50_ms, "last packet to publication")
      .def_readonly("latency_p99_ms", &Health::latency_p99_ms, "last packet to publication")
      .def_readonly("process_ms", &Health::process_ms, "rectification and odometry, median")
      .def_readonly("features_configured", &Health::features_configured)
      .def_readonly("features_least", &Health::features_least, "smallest target number in the last second")
      .def_readonly("memory_mb", &Health::memory_mb, "resident")
      .def_readonly("clock_deviation_ms", &Health::clock_deviation_ms,
                    "standard deviation of a pair's time offset")
      .def_readonly("right_late_ms", &Health::right_late_ms, "right exposure later than its timestamp")
      .def_readonly("right_late_deviation_ms", &Health::right_late_deviation_ms)
      .def_property_readonly(
          "right_rotation_deg", [](const Health& self) { return vectorOf(self.right_rotation_deg); },
          "3: pitch up, yaw to the right, roll clockwise of the right camera")
      .def_property_readonly("right_rotation_deviation_deg",
                             [](const Health& self) { return vectorOf(self.right_rotation_deviation_deg); })
      .def_readonly("left_readout_ms", &Health::left_readout_ms)
      .def_readonly("right_readout_ms", &Health::right_readout_ms)
      .def_property_readonly("self_check", text(&Health::self_check),
                             "calibration error to fix; empty if none")
      .def_property_readonly("problem", text(&Health::problem), "what to fix first; empty if nothing")
      .def_property_readonly("bound_exceeded", text(&Health::bound_exceeded),
                             "the bound farthest above its alert limit in the last second; empty if none")
      .def("encode", &encode<Health>, "the bytes of the message");
}

}  // namespace

void bindMessages(py::module_& module) {
  bindOdometryMessage(module);
  bindCameraHealth(module);
  bindHealthMessage(module);
  module.def("decode_odometry", &decode<odometry_t>, py::arg("data"),
             "The message in the bytes of CARTVO_ODOMETRY. Raises ValueError if they are none.");
  module.def("decode_health", &decode<health_t>, py::arg("data"),
             "The message in the bytes of CARTVO_HEALTH. Raises ValueError if they are none.");
}

}  // namespace cartvo::python
