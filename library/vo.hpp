#pragma once

// Visual odometry: StereoOdometry estimates the motion of a stereo camera from rectified image pairs. It
// reads no clock and no file and opens no socket. Link cartvo::vo.

#include "vo_core/odometry_estimate.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/rigid_motion.hpp"
#include "vo_core/shutter.hpp"
#include "vo_core/stage_observer.hpp"
#include "vo_core/stereo_camera.hpp"
#include "vo_core/stereo_masks.hpp"
#include "vo_core/stereo_odometry.hpp"
