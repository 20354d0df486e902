// Loads the raw images of a drive into memory for the speed benchmark.
#include "tools/benchmark/speed/drive_in_memory.hpp"

#include <algorithm>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "calib/rectification/rectification.hpp"
#include "capture/dataset/image_folder.hpp"
#include "capture/stereo_source.hpp"
#include "pipeline/source_rig.hpp"

namespace cartvo::benchmark {
namespace {

constexpr double kPincushion = 0.1;  // k1 of Brown's distortion model

/// The position of each pixel of a distorted image in a pinhole image of the same focal length (CV_32FC2,
/// px).
cv::Mat pinholePositions(const calib::CameraModel& lens) {
  std::vector<cv::Point2f> pixels, positions;
  for (int y = 0; y < lens.size.height; ++y)
    for (int x = 0; x < lens.size.width; ++x)
      pixels.emplace_back(static_cast<float>(x), static_cast<float>(y));
  const cv::Matx33d pinhole(lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1);
  cv::undistortPoints(pixels, positions, pinhole, lens.distortion, cv::noArray(), pinhole);
  return cv::Mat(positions).reshape(2, lens.size.height).clone();
}

calib::CameraModel withLens(calib::CameraModel camera) {
  camera.distortion[0] = kPincushion;
  return camera;
}

capture::Frame distort(const cv::Mat& positions, const capture::Frame& frame) {
  capture::Frame distorted = frame;
  distorted.image = cv::Mat();
  cv::remap(frame.image, distorted.image, positions, cv::noArray(), cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  return distorted;
}

capture::Frame readFrame(const capture::ImageSequence& camera, std::size_t index) {
  capture::Frame frame;
  frame.image = capture::readGreyImage(camera.images[index]);
  frame.exposure_ns = camera.instants_ns[index];
  frame.sequence = index;
  return frame;
}

}  // namespace

DriveInMemory loadDrive(const std::string& name, const std::filesystem::path& folder, int max_pairs) {
  DriveInMemory drive{name, pipeline::findRig(capture::openSource(folder), folder, {}).rig, {}};
  const capture::ImageFolder images = capture::readImageFolder(folder);
  const std::size_t count = std::min(images.left.images.size(), static_cast<std::size_t>(max_pairs));
  for (std::size_t i = 0; i < count; ++i)
    drive.pairs.push_back({readFrame(images.left, i), readFrame(images.right, i)});
  return drive;
}

bool isRectified(const DriveInMemory& drive) {
  return calib::computeRectification(drive.rig, {}).is_identity;
}

DriveInMemory throughLenses(const DriveInMemory& rectified) {
  DriveInMemory drive{rectified.name + " behind lenses", rectified.rig, {}};
  drive.rig.left = withLens(rectified.rig.left);
  drive.rig.right = withLens(rectified.rig.right);
  const cv::Mat left = pinholePositions(drive.rig.left), right = pinholePositions(drive.rig.right);
  for (const capture::FramePair& pair : rectified.pairs)
    drive.pairs.push_back({distort(left, pair.left), distort(right, pair.right)});
  return drive;
}

}  // namespace cartvo::benchmark
