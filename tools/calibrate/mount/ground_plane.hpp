#pragma once

#include <Eigen/Core>
#include <optional>

#include <opencv2/core/mat.hpp>

#include "calib/rectification/rectification.hpp"

namespace cartvo::calibrate {

/// The ground plane in one pair, in the axes of the rectified left camera.
struct GroundPlane {
  Eigen::Vector3d down = Eigen::Vector3d::UnitY();  ///< unit normal, pointing away from the camera
  double height = 0.0;                              ///< of the camera above the plane, m
  int points = 0;                                   ///< number of inliers
};

/// Finds the ground plane in a rectified pair (CV_8UC1) of a roughly upright camera. Disparities come from
/// semi-global matching. Points on a plane have the disparity d = (f b / h) (n_x x + n_y y + n_z) in
/// normalised coordinates, which is linear and has uniform noise, so the plane is fitted there by RANSAC and
/// least squares (after R. Labayrade et al., "Real time obstacle detection ... v-disparity", IV 2002).
/// std::nullopt if no plane below the camera contains most of the points in the lower half of the image.
/// Deterministic.
std::optional<GroundPlane> findGround(const cv::Mat& left, const cv::Mat& right,
                                      const calib::Rectification& rectification);

}  // namespace cartvo::calibrate
