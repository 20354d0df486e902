// Makes the odometry's description of the cameras' shutters from the rig.
#include "pipeline/shutters.hpp"

#include <utility>

#include "calib/rectification/rectification_tables.hpp"

namespace cartvo::pipeline {
namespace {

// A sensor of 2 to 4 MP reads its rows in 0.96 of its own frame period, which is 1/30 s whatever frame rate
// is set. Sensors differ by 15 %, and one in seven or so has a global shutter.
constexpr double kUsualReadout = 0.96 / 30.0;                // s
constexpr double kUsualReadoutStddev = 0.4 * kUsualReadout;  // s

vo::Shutter shutter(const calib::CameraModel& camera, calib::RowShareGrid shares, AbsentReadout absent) {
  vo::Shutter shutter;
  if (camera.readout) {
    shutter.readout = *camera.readout;
  } else if (absent == AbsentReadout::unknown) {
    shutter.readout = kUsualReadout;
    shutter.readout_stddev = kUsualReadoutStddev;
  }
  if (shares.columns > 0) shutter.rows = {shares.columns, std::move(shares.nodes)};
  return shutter;
}

}  // namespace

AbsentReadout absentReadoutOf(capture::SourceKind kind) {
  return kind == capture::SourceKind::recording ? AbsentReadout::unknown : AbsentReadout::global_shutter;
}

vo::StereoShutters stereoShutters(const calib::Rig& rig, const calib::Rectification& rectification,
                                  AbsentReadout absent) {
  calib::StereoRowShares shares = calib::rowShares(rig, rectification, vo::RowShares::kStep);
  return {shutter(rig.left, std::move(shares.left), absent),
          shutter(rig.right, std::move(shares.right), absent)};
}

}  // namespace cartvo::pipeline
