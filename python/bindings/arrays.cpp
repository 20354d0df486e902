// Passes images and matrices between numpy and C++.
#include "python/bindings/arrays.hpp"

#include <algorithm>
#include <limits>
#include <optional>

namespace py = pybind11;

namespace cartvo::python {
namespace {

std::string shapeText(const py::array& array) {
  return py::str(array.attr("shape"));
}

std::string expectedText(const std::optional<cv::Size>& size) {
  const std::string shape =
      size ? "(" + std::to_string(size->height) + ", " + std::to_string(size->width) + ")"
           : "(height, width)";
  return "expected a numpy array of dtype uint8 and shape " + shape;
}

/// An image that lies in the array's memory, of any size if `size` is empty.
cv::Mat imageIn(const py::object& object, const std::string& name, const std::optional<cv::Size>& size) {
  const std::string expected = name + ": " + expectedText(size) + ", but got ";
  if (!py::isinstance<py::array>(object))
    throw py::type_error(expected + std::string(py::str(py::type::of(object).attr("__name__"))));
  const auto array = py::reinterpret_borrow<py::array>(object);
  if (!py::isinstance<py::array_t<std::uint8_t>>(array))
    throw py::type_error(expected + "dtype " + std::string(py::str(array.dtype())));
  if (array.ndim() != 2) throw py::value_error(expected + "shape " + shapeText(array));
  const py::ssize_t rows = array.shape(0);
  const py::ssize_t columns = array.shape(1);
  constexpr py::ssize_t kMost = std::numeric_limits<std::int16_t>::max();
  const bool is_size = !size || (rows == size->height && columns == size->width);
  if (!is_size || rows < 1 || columns < 1 || rows > kMost || columns > kMost)
    throw py::value_error(expected + "shape " + shapeText(array));
  const bool are_rows = array.strides(1) == 1 && (rows == 1 || array.strides(0) >= columns);
  if (!are_rows) {
    throw py::value_error(expected + "an array whose rows are not contiguous (strides " +
                          std::string(py::str(array.attr("strides"))) + "): pass numpy.ascontiguousarray(" +
                          name + ")");
  }
  const std::size_t step = static_cast<std::size_t>(rows == 1 ? columns : array.strides(0));
  // OpenCV has no image of constant pixels; the odometry and the rectifier only read it.
  return {static_cast<int>(rows), static_cast<int>(columns), CV_8UC1, const_cast<void*>(array.data()), step};
}

}  // namespace

cv::Mat imageOf(const py::object& array, const std::string& name) {
  return imageIn(array, name, std::nullopt);
}

cv::Mat imageOf(const py::object& array, const std::string& name, cv::Size size) {
  return imageIn(array, name, size);
}

py::array viewOf(const cv::Mat& image, const py::object& owner) {
  py::array view(py::dtype::of<std::uint8_t>(), {image.rows, image.cols},
                 {static_cast<py::ssize_t>(image.step), py::ssize_t{1}}, image.data, owner);
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

py::object copyOf(const cv::Mat& image) {
  if (image.empty()) return py::none();
  return py::array(py::dtype::of<std::uint8_t>(), {image.rows, image.cols},
                   {static_cast<py::ssize_t>(image.step), py::ssize_t{1}}, image.data);
}

py::array_t<double> toArray(const Eigen::Isometry3d& motion) {
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> rows = motion.matrix();
  return toSquareArray(rows.data(), 4);
}

py::array_t<double> toArray(const vo::Matrix6d& matrix) {
  const Eigen::Matrix<double, 6, 6, Eigen::RowMajor> rows = matrix;
  return toSquareArray(rows.data(), 6);
}

py::array_t<double> toArray(const Eigen::Vector3d& vector) {
  return toArray(vector.data(), 3);
}

py::array_t<double> toArray(const double* values, std::size_t n) {
  return py::array_t<double>(static_cast<py::ssize_t>(n), values);
}

py::array_t<double> toSquareArray(const double* values, std::size_t n) {
  return py::array_t<double>({n, n}, values);
}

}  // namespace cartvo::python
