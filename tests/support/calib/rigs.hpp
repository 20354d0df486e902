#pragma once

#include "calib/model/rig.hpp"

namespace cartvo::test {

/// A wide-angle pair like that of the cart: distorted, and rotated relative to each other by about a degree.
inline calib::Rig cartRig() {
  calib::Rig rig;
  rig.name = "cart";
  rig.left.size = rig.right.size = {680, 420};
  rig.left.fx = 480.25;
  rig.left.fy = 481.5;
  rig.left.cx = 342.125;
  rig.left.cy = 207.75;
  rig.left.distortion = {-0.31, 0.11, 0.0004, -0.0003, -0.017, 0.0, 0.0, 0.0};
  rig.right = rig.left;
  rig.right.fx = 478.0;
  rig.right.fy = 479.0;
  rig.right.cx = 336.5;
  rig.right.distortion = {-0.29, 0.09, -0.0002, 0.0005, -0.01, 0.0, 0.0, 0.0};
  // Without sine and cosine: the same bits on each machine.
  rig.T_right_left.linear() = Eigen::Quaterniond(1.0, 0.003, -0.008, 0.005).normalized().toRotationMatrix();
  rig.T_right_left.translation() = Eigen::Vector3d(-0.115, 0.002, -0.001);
  rig.T_body_camera = calib::forwardLookingMount();
  rig.T_body_camera.translation() = Eigen::Vector3d(0.4, 0.0575, 1.9);
  return rig;
}

/// A pair whose images are already rectified.
inline calib::Rig rectifiedRig() {
  calib::Rig rig;
  rig.name = "rectified";
  rig.left.size = {640, 480};
  rig.left.fx = rig.left.fy = 500.5;
  rig.left.cx = 320.25;
  rig.left.cy = 240.75;
  rig.right = rig.left;
  rig.T_right_left.translation().x() = -0.12;
  rig.T_body_camera = calib::forwardLookingMount();
  return rig;
}

/// A pair of fisheye cameras with a field of view above 150 degrees, rotated relative to each other by a
/// degree.
inline calib::Rig wideRig() {
  calib::Rig rig = cartRig();
  rig.name = "wide";
  rig.left.fx = 250.5;
  rig.left.fy = 251.0;
  rig.right.fx = 249.0;
  rig.right.fy = 249.5;
  rig.left.lens = rig.right.lens = calib::LensModel::wide;
  rig.left.distortion = {-0.012, 0.006, -0.003, 0.0004};
  rig.right.distortion = {-0.011, 0.004, -0.002, 0.0003};
  return rig;
}

}  // namespace cartvo::test
