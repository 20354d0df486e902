// Finds real sequences and renders worlds, with their ground truth in one form.
#include "tools/benchmark/sequence.hpp"

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "capture/dataset/image_folder.hpp"
#include "pipeline/body_motion.hpp"
#include "tools/evaluate/evaluation.hpp"
#include "tools/simulate/truth.hpp"
#include "tools/world/rendered_world.hpp"

namespace cartvo::benchmark {
namespace fs = std::filesystem;
namespace {

bool isStandstill(const fs::path& folder) {
  return folder.filename().string().ends_with("_still");
}

/// Whether the folder has images and a ground truth, by the names of its files.
bool isSequence(const fs::path& folder) {
  const bool has_truth = fs::exists(folder / "poses.txt") || isStandstill(folder);
  return has_truth && capture::detectImageFolder(folder);
}

Trajectory truthOf(const fs::path& folder, const capture::ImageSequence& left) {
  Trajectory truth(left.images.size());
  const fs::path poses = folder / "poses.txt";
  if (fs::exists(poses)) {
    truth = readTrajectory(poses);
    if (truth.size() != left.images.size()) {
      throw std::runtime_error(poses.string() + ": " + std::to_string(truth.size()) + " poses for " +
                               std::to_string(left.images.size()) + " images");
    }
    truth = startingAt(Eigen::Isometry3d::Identity(), truth);
  }
  for (std::size_t i = 0; i < truth.size(); ++i)
    truth[i].time_ns = left.instants_ns[i];
  return truth;
}

/// The derivative of the exact pose by central differences. The drive is twice differentiable, so a step of
/// half a millisecond leaves an error below 1e-6 m/s.
vo::Vector6d twistAt(const world::RenderedWorld& world, std::int64_t time_ns) {
  constexpr double kStep = 5e-4;  // s
  const double time = 1e-9 * static_cast<double>(time_ns);
  const Eigen::Isometry3d before = world.T_world_body(time - kStep);
  const Eigen::Isometry3d after = world.T_world_body(time + kStep);
  return pipeline::logarithm(before.inverse() * after) / (2.0 * kStep);
}

}  // namespace

std::vector<Sequence> realSequences(const fs::path& data) {
  if (data.empty()) return {};
  std::vector<fs::path> folders;
  for (const fs::directory_entry& entry : fs::directory_iterator(data))
    if (entry.is_directory() && isSequence(entry.path())) folders.push_back(entry.path());
  std::sort(folders.begin(), folders.end());
  std::vector<Sequence> sequences;
  for (const fs::path& folder : folders) {
    const capture::ImageFolder images = capture::readImageFolder(folder);
    sequences.push_back(
        {folder.filename().string(), SequenceKind::real, folder, {truthOf(folder, images.left), {}}, {}});
  }
  if (sequences.empty()) {
    throw std::runtime_error(
        data.string() +
        ": contains no sequence; expected folders of images as cartvo replay reads them, with "
        "poses.txt, or whose name ends in _still");
  }
  return sequences;
}

Sequence renderedSequence(const world::WorldSettings& settings, const WorldCache& cache,
                          const simulate::Progress& progress) {
  const world::RenderedWorld world(settings);
  Sequence sequence{
      worldName(settings), SequenceKind::rendered, cache.rendered(world, progress), {}, setOf(settings)};
  sequence.truth.left_camera = simulate::cameraTrajectory(world.truth(), world.rig());
  for (const StampedPose& stamped : sequence.truth.left_camera)
    sequence.truth.body_twist.push_back(twistAt(world, stamped.time_ns));
  return sequence;
}

std::string worldName(const world::WorldSettings& settings) {
  std::string name = world::driveName(settings) + " " + std::to_string(settings.seed);
  if (settings.liveliness > 0.0 && settings.liveliness < 1.0) {
    char liveliness[32];
    std::snprintf(liveliness, sizeof liveliness, " (%g)", settings.liveliness);
    name += liveliness;
  }
  if (settings.start_seconds) {
    char start[32];
    std::snprintf(start, sizeof start, " from %g s", *settings.start_seconds);
    name += start;
  }
  if (settings.offset_s != 0.0) {
    char offset[32];
    std::snprintf(offset, sizeof offset, " %+g ms", 1e3 * settings.offset_s);
    name += offset;
  }
  if (settings.offset_drift_ppm != 0.0) {
    char drift[32];
    std::snprintf(drift, sizeof drift, " %+g ppm", settings.offset_drift_ppm);
    name += drift;
  }
  if (settings.left_readout != 0.0 || settings.right_readout != 0.0) {
    char readout[64];
    std::snprintf(readout, sizeof readout, ", readout %g/%g ms", 1e3 * settings.left_readout,
                  1e3 * settings.right_readout);
    name += readout;
  }
  if (settings.shake.amplitude != 0.0) {
    char shake[64];
    std::snprintf(shake, sizeof shake, ", shaken at %g Hz", settings.shake.frequency);
    name += shake;
  }
  return name;
}

}  // namespace cartvo::benchmark
