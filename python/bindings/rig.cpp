// Rig, rectified camera and rectifier, for Python.
#include "python/bindings/rig.hpp"

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "calib/format/rig_file.hpp"
#include "calib/format/rig_formats.hpp"
#include "common/threads/parallel_loop.hpp"
#include "pipeline/pair_processor.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/bindings.hpp"

namespace py = pybind11;

namespace cartvo::python {
namespace {

py::tuple sizeOf(const cv::Size& size) {
  return py::make_tuple(size.width, size.height);
}

py::array_t<double> distortionOf(const calib::CameraModel& camera) {
  return toArray(camera.distortion.data(), calib::distortionCount(camera.lens));
}

calib::Rig loadRig(const std::vector<std::filesystem::path>& files) {
  return calib::readRigFiles(files);
}

/// Both images rectified, in new arrays; the given arrays if they are rectified already.
py::tuple rectify(const RigRectifier& self, const py::object& left, const py::object& right) {
  const calib::Rectifier& rectifier = self.rectifier();
  const cv::Size size = rectifier.rectification().size;
  const cv::Mat raw_left = imageOf(left, "left", size);
  const cv::Mat raw_right = imageOf(right, "right", size);
  if (rectifier.rectification().is_identity) return py::make_tuple(left, right);
  py::array_t<std::uint8_t> new_left({size.height, size.width});
  py::array_t<std::uint8_t> new_right({size.height, size.width});
  cv::Mat left_image(size, CV_8UC1, new_left.mutable_data());
  cv::Mat right_image(size, CV_8UC1, new_right.mutable_data());
  {
    const py::gil_scoped_release release;
    doBoth([&] { rectifier.rectifyLeft(raw_left, left_image); },
           [&] { rectifier.rectifyRight(raw_right, right_image); });
  }
  return py::make_tuple(new_left, new_right);
}

void bindCameras(py::module_& module) {
  using Camera = calib::CameraModel;
  py::class_<Camera>(module, "CameraModel", "Intrinsics and shutter of one camera of a rig; read-only.")
      .def_property_readonly(
          "size", [](const Camera& camera) { return sizeOf(camera.size); },
          "(width, height) of its raw images, px")
      .def_readonly("fx", &Camera::fx, "px")
      .def_readonly("fy", &Camera::fy, "px")
      .def_readonly("cx", &Camera::cx, "px; pixel centres at integers")
      .def_readonly("cy", &Camera::cy, "px; pixel centres at integers")
      .def_property_readonly("distortion", &distortionOf,
                             "k1 k2 p1 p2 k3 k4 k5 k6 of Brown's model, or k1 k2 k3 k4 of a wide lens")
      .def_property_readonly(
          "is_wide", [](const Camera& camera) { return camera.lens == calib::LensModel::wide; },
          "whether the lens model is Kannala and Brandt's fisheye")
      .def_readonly(
          "readout", &Camera::readout,
          "s, exposure of the lower edge of the raw image minus that of its upper edge; None: unknown");

  using Stereo = vo::StereoCamera;
  py::class_<Stereo>(module, "StereoCamera",
                     "A rectified stereo camera: both images share focal length and principal point.")
      .def(py::init([](double focal_length, double cx, double cy, double baseline, int width, int height) {
             const Stereo camera{focal_length, cx, cy, baseline, width, height};
             vo::validate(camera);
             return camera;
           }),
           py::arg("focal_length"), py::arg("cx"), py::arg("cy"), py::arg("baseline"), py::arg("width"),
           py::arg("height"), "Raises ValueError that names the first value out of range.")
      .def_readonly("focal_length", &Stereo::focal_length, "px")
      .def_readonly("cx", &Stereo::cx, "px; pixel centres at integers")
      .def_readonly("cy", &Stereo::cy, "px; pixel centres at integers")
      .def_readonly("baseline", &Stereo::baseline, "m")
      .def_readonly("width", &Stereo::width, "px")
      .def_readonly("height", &Stereo::height, "px");
}

}  // namespace

void bindRig(py::module_& module) {
  bindCameras(module);

  using calib::Rig;
  py::class_<Rig>(module, "Rig", "Calibration of both cameras and their mount on the cart; read-only.")
      .def_static(
          "load", [](const std::filesystem::path& path) { return loadRig({path}); }, py::arg("path"),
          "Reads a rig file of cartvo, OpenCV, Kalibr or MATLAB. Raises RuntimeError that names file, "
          "line, key and what was expected.")
      .def_static("load", &loadRig, py::arg("paths"), "Reads the files of the left and the right camera.")
      .def_static(
          "parse", [](const std::string& text) { return calib::parseRig(text, "rig"); }, py::arg("text"),
          "Reads a rig from the text of a rig file.")
      .def(
          "save", [](const Rig& rig, const std::filesystem::path& path) { calib::writeRig(path, rig); },
          py::arg("path"), "Writes cartvo's rig file, atomically.")
      .def_property_readonly("text", &calib::rigText, "the text of cartvo's rig file")
      .def_readonly("name", &Rig::name)
      .def_readonly("left", &Rig::left, "the left camera")
      .def_readonly("right", &Rig::right, "the right camera")
      .def_property_readonly(
          "T_right_left", [](const Rig& rig) { return toArray(rig.T_right_left); },
          "4x4, left camera axes to right camera axes, m")
      .def_property_readonly(
          "T_body_camera", [](const Rig& rig) { return toArray(rig.T_body_camera); },
          "4x4, left camera axes (x right, y down, z forward) to body axes (x forward, y left, "
          "z up), m")
      .def_property_readonly("baseline", &Rig::baseline, "distance between the cameras, m")
      .def_readonly("scale_stddev", &Rig::scale_stddev,
                    "relative standard deviation of the baseline; 0: unknown");

  py::class_<RigRectifier>(module, "Rectifier", "Rectifies the raw images of a rig.")
      .def(py::init<const Rig&>(), py::arg("rig"), py::call_guard<py::gil_scoped_release>(),
           "Builds the tables. Raises ValueError if the rig cannot be rectified.")
      .def("rectify", &rectify, py::arg("left"), py::arg("right"),
           "The rectified images (left, right) of two raw images, uint8 arrays of shape (height, width). "
           "Arrays "
           "of a rig that is rectified already are returned as they are.")
      .def_property_readonly("rig", &RigRectifier::rig, py::return_value_policy::reference_internal)
      .def_property_readonly(
          "camera",
          [](const RigRectifier& self) { return pipeline::stereoCamera(self.rectifier().rectification()); },
          "the camera of the rectified images")
      .def_property_readonly(
          "left_mask", [](const RigRectifier& self) { return copyOf(self.rectifier().leftMask()); },
          "0 where the left rectified image must not be used, else 255; None without a mask")
      .def_property_readonly(
          "right_mask", [](const RigRectifier& self) { return copyOf(self.rectifier().rightMask()); },
          "as left_mask, of the right image");
}

}  // namespace cartvo::python
