#pragma once

// Capture: live cameras (RTSP, V4L2), recordings and image folders as sources of frames with their instants
// of exposure, and the pairing of two of them. Link cartvo::capture.

#include "capture/camera_side.hpp"
#include "capture/camera_source.hpp"
#include "capture/clock/stereo_timestamper.hpp"
#include "capture/dataset/image_folder.hpp"
#include "capture/frame.hpp"
#include "capture/network/credentials.hpp"
#include "capture/pair_synchroniser.hpp"
#include "capture/recording/recording_folder.hpp"
#include "capture/recording/recording_source.hpp"
#include "capture/recording/stream_recorder.hpp"
#include "capture/rtsp/password_file.hpp"
#include "capture/rtsp/rtsp_camera.hpp"
#include "capture/stereo_source.hpp"
#include "capture/v4l2/v4l2_camera.hpp"
