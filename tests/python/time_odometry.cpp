// time_odometry FOLDER: prints the CPU time of the odometry for each pair, ms; for measure_overhead.py.
#include <cstdio>
#include <ctime>
#include <exception>
#include <vector>

#include "calib/rectification/rectifier.hpp"
#include "capture/pair_reader.hpp"
#include "pipeline/rectified_camera.hpp"
#include "pipeline/shutters.hpp"
#include "pipeline/source_rig.hpp"
#include "vo_core/stereo_odometry.hpp"

namespace {

using namespace cartvo;

/// The rectified pairs of a folder, at 10 Hz.
std::vector<vo::StereoImages> rectifiedPairs(const capture::StereoSource& source,
                                             const calib::Rectifier& rectifier) {
  std::vector<vo::StereoImages> pairs;
  capture::PairReader reader(*source.left, *source.right, {.period_ns = source.period_ns});
  while (const auto pair = reader.next()) {
    vo::StereoImages& images = pairs.emplace_back();
    rectifier.rectifyLeft(pair->left.image, images.left);
    rectifier.rectifyRight(pair->right.image, images.right);
    images.left_exposure_ns = images.right_exposure_ns =
        100'000'000 * (static_cast<std::int64_t>(pairs.size()) - 1);
  }
  return pairs;
}

void printTimes(const char* folder) {
  const capture::StereoSource source = capture::openSource(folder);
  const calib::Rig rig = pipeline::findRig(source, folder, {}).rig;
  const calib::Rectifier rectifier(rig, rig.rectification, calib::buildTables(rig, rig.rectification));
  vo::StereoOdometry odometry(
      pipeline::stereoCamera(rectifier.rectification()), vo::OdometrySettings{},
      pipeline::stereoShutters(rig, rectifier.rectification(), pipeline::AbsentReadout::global_shutter),
      {rectifier.leftMask(), rectifier.rightMask()});
  vo::NullStageObserver observer;
  for (const vo::StereoImages& images : rectifiedPairs(source, rectifier)) {
    const std::clock_t begin = std::clock();
    odometry.process(images, observer);
    std::printf("%.4f\n", 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 2) return 2;
    printTimes(argv[1]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
