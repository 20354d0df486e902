#pragma once

// Calibration: rig files of cartvo and of other tools, and rectification of raw images. Link cartvo::calib.

#include "calib/format/rig_file.hpp"
#include "calib/format/rig_formats.hpp"
#include "calib/model/rig.hpp"
#include "calib/rectification/rectification.hpp"
#include "calib/rectification/rectification_tables.hpp"
#include "calib/rectification/rectifier.hpp"
