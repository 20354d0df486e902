// odometry_on_images FOLDER: prints the path of the left camera from a folder of images (KITTI's or EuRoC's
// layout).
#include <iostream>

#include <cartvo/calib.hpp>
#include <cartvo/capture.hpp>
#include <cartvo/pipeline.hpp>
#include <cartvo/vo.hpp>

int main(int argc, char** argv) try {
  using namespace cartvo;
  if (argc != 2) return std::cerr << "usage: odometry_on_images FOLDER\n", 2;
  const capture::StereoSource source = capture::openSource(argv[1]);
  const calib::Rig rig = pipeline::findRig(source, argv[1], {}).rig;
  const calib::Rectifier rectifier(rig, rig.rectification, calib::buildTables(rig, rig.rectification));
  vo::StereoOdometry odometry(
      pipeline::stereoCamera(rectifier.rectification()), vo::OdometrySettings{},
      pipeline::stereoShutters(rig, rectifier.rectification(), pipeline::absentReadoutOf(source.kind)),
      {rectifier.leftMask(), rectifier.rightMask()});
  capture::PairReader reader(*source.left, *source.right, {.period_ns = source.period_ns});
  vo::NullStageObserver observer;
  vo::StereoImages images;
  while (const auto pair = reader.next()) {
    images.left_exposure_ns = pair->left.exposure_ns;
    images.right_exposure_ns = pair->right.exposure_ns;
    odometry.acquireBuffers(images);
    rectifier.rectifyLeft(pair->left.image, images.left);
    rectifier.rectifyRight(pair->right.image, images.right);
    const vo::OdometryEstimate estimate = odometry.process(images, observer);
    std::cout << 1e-9 * static_cast<double>(estimate.exposure_ns) << " s "
              << (estimate.valid ? "valid " : "invalid ") << estimate.T_world_camera.translation().transpose()
              << " m\n";
  }
  return 0;
} catch (const std::exception& error) {
  return std::cerr << error.what() << '\n', 1;
}
