// Reader of recordings and image folders, for Python.
#include <cmath>
#include <memory>
#include <mutex>
#include <utility>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "capture/pair_synchroniser.hpp"
#include "capture/stereo_source.hpp"
#include "pipeline/source_rig.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/bindings.hpp"
#include "python/bindings/pair.hpp"

namespace py = pybind11;

namespace cartvo::python {
namespace {

capture::SourceSettings settingsOf(double frame_rate) {
  capture::SourceSettings settings;
  settings.frame_rate = frame_rate;
  return settings;
}

/// A source on disk and the reader of its pairs, for several Python threads, one at a time.
class Recording {
 public:
  Recording(std::filesystem::path path, double frame_rate)
      : path_(std::move(path)),
        source_(capture::openSource(path_, settingsOf(frame_rate))),
        reader_(*source_.left, *source_.right, {.period_ns = source_.period_ns}) {}

  std::shared_ptr<Pair> next() {
    auto pair = std::make_shared<Pair>();
    {
      const py::gil_scoped_release release;
      const std::lock_guard lock(mutex_);
      std::optional<capture::FramePair> frames = reader_.next();
      if (frames) {
        pair->frames = std::move(*frames);
        return pair;
      }
    }
    throw py::stop_iteration();
  }

  calib::Rig rig() const { return pipeline::findRig(source_, path_, {}).rig; }

  /// Unusual properties of the source and damage in it, as far as it was read.
  std::vector<std::string> problems() const {
    std::vector<std::string> problems = source_.warnings;
    for (const capture::CameraSource* camera : {source_.left.get(), source_.right.get()}) {
      if (const std::string error = camera->health().last_error; !error.empty()) problems.push_back(error);
    }
    return problems;
  }

  std::size_t pairs() const { return source_.pairs; }
  bool isRecording() const { return source_.kind == capture::SourceKind::recording; }

 private:
  std::filesystem::path path_;
  capture::StereoSource source_;
  std::mutex mutex_;
  capture::PairReader reader_;  // guarded by mutex_
};

std::shared_ptr<Pair> pairOfArrays(const py::object& left, const py::object& right, std::int64_t t_left,
                                   std::int64_t t_right, double offset_stddev) {
  auto pair = std::make_shared<Pair>();
  checkInstants(t_left, t_right);
  checkOffsetStddev(offset_stddev);
  capture::Frame& left_frame = pair->frames.left;
  capture::Frame& right_frame = pair->frames.right;
  left_frame.image = imageOf(left, "left");
  right_frame.image = imageOf(right, "right");
  left_frame.exposure_ns = t_left;
  right_frame.exposure_ns = t_right;
  right_frame.exposure_stddev_ns = std::llround(1e9 * offset_stddev);
  pair->left_array = left;
  pair->right_array = right;
  return pair;
}

py::object imageView(const py::object& self, bool is_left) {
  const Pair& pair = self.cast<const Pair&>();
  const py::object& array = is_left ? pair.left_array : pair.right_array;
  if (array) return array;
  return viewOf(is_left ? pair.frames.left.image : pair.frames.right.image, self);
}

}  // namespace

void bindRecording(py::module_& module) {
  py::class_<Pair, std::shared_ptr<Pair>>(module, "Pair",
                                          "Two raw images and their instants of exposure; read-only.")
      .def(py::init(&pairOfArrays), py::arg("left"), py::arg("right"), py::arg("t_left"), py::arg("t_right"),
           py::arg("offset_stddev") = 0.0,
           "Of two uint8 arrays of shape (height, width), which are not copied, and their instants in ns.")
      .def_property_readonly(
          "left", [](const py::object& self) { return imageView(self, true); },
          "uint8, (height, width), read-only, without a copy")
      .def_property_readonly(
          "right", [](const py::object& self) { return imageView(self, false); },
          "uint8, (height, width), read-only, without a copy")
      .def_property_readonly("t_left", &Pair::left_ns,
                             "ns, for Odometry.process: by the left camera's own clock")
      .def_property_readonly("t_right", &Pair::right_ns, "ns, for Odometry.process")
      .def_property_readonly(
          "left_exposure_ns", [](const Pair& pair) { return pair.frames.left.exposure_ns; },
          "ns since the Unix epoch, for comparison with other sensors")
      .def_property_readonly(
          "right_exposure_ns", [](const Pair& pair) { return pair.frames.right.exposure_ns; },
          "ns since the Unix epoch")
      .def_property_readonly(
          "offset_stddev", [](const Pair& pair) { return 1e-9 * pair.frames.offsetStddevNs(); },
          "s, standard deviation of the right exposure minus the left one")
      .def_property_readonly(
          "key_frames",
          [](const Pair& pair) { return std::pair(pair.frames.left.key_frame, pair.frames.right.key_frame); },
          "which images are key frames of a video: (left, right)");

  py::class_<Recording>(
      module, "Recording",
      "Reads the pairs of a recording of cartvod, or of a folder of images in KITTI's or EuRoC's "
      "layout, in order: for pair in Recording(path). Can be read once.")
      .def(py::init<std::filesystem::path, double>(), py::arg("path"), py::kw_only(),
           py::arg("frame_rate") = 0.0,
           "frame_rate: Hz, replaces the times of an image folder; 0: none. Raises RuntimeError that says "
           "what is "
           "wrong with the folder.")
      .def("__iter__", [](const py::object& self) { return self; })
      .def("__next__", &Recording::next)
      .def_property_readonly(
          "rig", &Recording::rig,
          "the rig that was recorded or lies in the folder; raises RuntimeError if there is none")
      .def_property_readonly("problems", &Recording::problems,
                             "list of what is unusual or damaged, as far as it was read")
      .def_property_readonly("pairs", &Recording::pairs,
                             "number of images of the shorter sequence; 0: unknown")
      .def_property_readonly(
          "is_recording", &Recording::isRecording,
          "whether it is of cartvod, so that readouts that its rig does not state are unknown");
}

}  // namespace cartvo::python
