#pragma once

#include <Eigen/Core>
#include <optional>

#include <opencv2/core/mat.hpp>

#include "calib/rectification.hpp"

namespace cartvo::calibrate {

/// The ground as one pair shows it, in the axes of the rectified left camera.
struct GroundPlane {
  Eigen::Vector3d down = Eigen::Vector3d::UnitY();  ///< unit normal, away from the camera
  double height = 0.0;                              ///< of the camera above it, m
  int points = 0;                                   ///< that lie on it
};

/// Finds the ground in a rectified pair (CV_8UC1) of a camera that is roughly upright. Disparities come from
/// semi-global matching; what lies on a plane has d = (f b / h) (n_x x + n_y y + n_z) in normalised
/// coordinates, linear with an error that is the same everywhere, so the plane is found by RANSAC and least
/// squares there (R. Labayrade et al., "Real time obstacle detection ... v-disparity", IV 2002, for the
/// idea). Nothing where no plane below the camera holds most of the picture's lower half. Deterministic.
std::optional<GroundPlane> findGround(const cv::Mat& left, const cv::Mat& right,
                                      const Rectification& rectification);

}  // namespace cartvo::calibrate
