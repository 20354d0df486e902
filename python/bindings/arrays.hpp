#pragma once

#include <Eigen/Geometry>
#include <string>

#include <opencv2/core/mat.hpp>
#include <pybind11/numpy.h>

#include "vo_core/rigid_motion.hpp"

// Images and matrices between numpy and C++.

namespace cartvo::python {

/// The image of a numpy array, without a copy: it lies in the array's memory. The array must be uint8 with
/// the shape (height, width); its rows may be apart, but not its pixels. Throws TypeError or ValueError that
/// names `name`, what was expected, and what was found.
cv::Mat imageOf(const pybind11::object& array, const std::string& name);

/// As above, but of this size only.
cv::Mat imageOf(const pybind11::object& array, const std::string& name, cv::Size size);

/// A numpy array on the image's memory, read-only, which keeps `owner` alive.
pybind11::array viewOf(const cv::Mat& image, const pybind11::object& owner);

/// A copy of the image; None for an empty one.
pybind11::object copyOf(const cv::Mat& image);

pybind11::array_t<double> toArray(const Eigen::Isometry3d& motion);      ///< 4x4
pybind11::array_t<double> toArray(const vo::Matrix6d& matrix);           ///< 6x6
pybind11::array_t<double> toArray(const Eigen::Vector3d& vector);        ///< 3
pybind11::array_t<double> toArray(const double* values, std::size_t n);  ///< n
/// n x n, row by row
pybind11::array_t<double> toSquareArray(const double* values, std::size_t n);

}  // namespace cartvo::python
