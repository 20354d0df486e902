#pragma once

// The chain of cartvod from two cameras to the motion of the cart's body: pairing, rectification, odometry,
// velocity at the exposure. Link cartvo::pipeline, which links the other libraries.

#include "daemon/pipeline/body_motion.hpp"
#include "daemon/pipeline/pair_processor.hpp"
#include "daemon/pipeline/pipeline.hpp"
#include "daemon/pipeline/rectified_camera.hpp"
#include "daemon/pipeline/shutters.hpp"
#include "daemon/pipeline/source_rig.hpp"
