// Ground observations and motions from a recording, for the mount.
#include "tools/calibrate/mount/mount_source.hpp"

#include <cmath>
#include <optional>
#include <stdexcept>

#include "calib/rectification/rectification_tables.hpp"
#include "calib/rectification/rectifier.hpp"
#include "pipeline/body_motion.hpp"
#include "pipeline/pair_processor.hpp"
#include "tools/calibrate/mount/ground_plane.hpp"
#include "tools/calibrate/source_pairs.hpp"

namespace cartvo::calibrate {
namespace {

constexpr double kObservationInterval = 0.25;  // s
constexpr double kMaxDisplacement = 0.001;     // m, between the two exposures of a pair

double secondsOf(std::int64_t instant_ns) {
  return 1e-9 * static_cast<double>(instant_ns);
}

/// The mean twist of the left camera since the previous pair, in its own axes.
std::optional<CameraTwist> twistOf(const pipeline::PairResult& result,
                                   const Eigen::Matrix3d& R_left_rectified) {
  const vo::OdometryEstimate& estimate = result.estimate;
  if (!estimate.valid || estimate.time_step <= 0.0) return std::nullopt;
  const vo::Vector6d twist = pipeline::logarithm(estimate.T_previous_current) / estimate.time_step;
  return CameraTwist{secondsOf(estimate.exposure_ns), R_left_rectified * twist.head<3>(),
                     R_left_rectified * twist.tail<3>()};
}

std::optional<GroundPlane> groundOf(const capture::FramePair& pair, const calib::Rectifier& rectifier) {
  cv::Mat left, right;
  rectifier.rectifyLeft(pair.left.image, left);
  rectifier.rectifyRight(pair.right.image, right);
  return findGround(left, right, rectifier.rectification());
}

/// Collects the measurements, pair by pair.
class MountMeasurementCollector {
 public:
  MountMeasurementCollector(const calib::Rig& rig, pipeline::AbsentReadout absent_readout)
      : processor_(rig, {rig, rig.rectification, calib::buildTables(rig, rig.rectification)},
                   {.absent_readout = absent_readout}),
        R_left_rectified_(processor_.T_left_rectified().linear()) {}

  void add(const capture::FramePair& pair) {
    const std::optional<CameraTwist> twist = twistOf(processor_.process(pair), R_left_rectified_);
    ++measurements.pairs;
    if (!twist) return;
    measurements.motions.push_back(*twist);
    const double seconds = secondsOf(pair.left.exposure_ns);
    if (next_observation_ && seconds < *next_observation_) return;
    if (std::abs(secondsOf(pair.offsetNs())) * twist->velocity.norm() > kMaxDisplacement) {
      ++measurements.unsynchronised;
      return;
    }
    next_observation_ = seconds + kObservationInterval;
    if (const std::optional<GroundPlane> ground = groundOf(pair, processor_.rectifier()))
      measurements.ground.push_back({seconds, R_left_rectified_ * ground->down, ground->height});
  }

  MountMeasurements measurements;

 private:
  pipeline::PairProcessor processor_;
  Eigen::Matrix3d R_left_rectified_;
  std::optional<double> next_observation_;  ///< s
};

}  // namespace

MountMeasurements collectMountMeasurements(const std::filesystem::path& source, const calib::Rig& rig,
                                           const MountProgress& progress) {
  capture::StereoSource pairs = capture::openSource(source);
  MountMeasurementCollector collector(rig, pipeline::absentReadoutOf(pairs.kind));
  forEachPair(pairs, [&](const capture::FramePair& pair) {
    collector.add(pair);
    progress(collector.measurements.pairs, pairs.pairs);
    return true;
  });
  if (collector.measurements.pairs == 0)
    throw std::runtime_error(source.string() + ": holds no pair of images that belong together");
  return collector.measurements;
}

}  // namespace cartvo::calibrate
