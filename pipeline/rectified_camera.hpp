#pragma once

#include "calib/rectification/rectification.hpp"
#include "vo_core/stereo_camera.hpp"

namespace cartvo::pipeline {

/// The camera of the rectified images, for StereoOdometry.
vo::StereoCamera stereoCamera(const calib::Rectification& rectification);

}  // namespace cartvo::pipeline
