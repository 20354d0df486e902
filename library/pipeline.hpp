#pragma once

// The chain of cartvod from two cameras to the motion of the cart's body: pairing, rectification, odometry,
// velocity at the exposure. Link cartvo::pipeline, which links the other libraries.

#include "pipeline/body_motion.hpp"
#include "pipeline/pair_processor.hpp"
#include "pipeline/pipeline.hpp"
#include "pipeline/shutters.hpp"
#include "pipeline/source_rig.hpp"
