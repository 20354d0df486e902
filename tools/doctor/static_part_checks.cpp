// Parts of the pictures of a drive that keep their place.
#include "tools/doctor/static_part_checks.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "tools/calibrate/mask/static_parts.hpp"
#include "tools/calibrate/source_pairs.hpp"

namespace cartvo::doctor {
namespace {

constexpr std::size_t kSufficientPictures = 2 * calibrate::kMinPictures;
constexpr double kMinShare = 0.01;  // of the picture

Finding findingOf(const char* side) {
  return {{},
          fmt::format("{} camera, static parts", side),
          Verdict::ok,
          {},
          "nothing of the cart and no lettering in view, or a mask",
          {}};
}

Finding findingOf(const char* side, const calibrate::StaticPartFinder& finder) {
  Finding finding = findingOf(side);
  try {
    const calibrate::StaticParts parts = finder.result();
    finding.seen = fmt::format("{:.1f} % of the picture keeps its place", 100.0 * parts.share);
    if (parts.share < kMinShare) return finding;
    const cv::Rect& box = parts.boxes.front();
    finding.verdict = Verdict::look_at;
    finding.seen +=
        fmt::format(", at x {} to {}, y {} to {} px", box.x, box.br().x - 1, box.y, box.br().y - 1);
    finding.advice = "switch lettering off, clean the lens, or mask the cart with 'cartvo calibrate mask'";
  } catch (const std::runtime_error& error) {
    finding.verdict = Verdict::not_checked;
    finding.seen = error.what();
    finding.advice = "look at the recording of a drive";
  }
  return finding;
}

/// One camera: its mask or what is found.
class Camera {
 public:
  Camera(const char* side, const calib::CameraModel* model) : side_(side) {
    if (model == nullptr || model->mask.empty()) return;
    masked_ = calib::maskedShare(model->mask);
  }

  bool isDone() const { return masked_ || finder_.pictures() >= kSufficientPictures; }

  void add(const capture::Frame& frame) {
    if (!isDone() && frame.status == capture::FrameStatus::good) finder_.add(frame.image, frame.exposure_ns);
  }

  Finding finding() const {
    if (!masked_) return findingOf(side_, finder_);
    Finding finding = findingOf(side_);
    finding.seen = fmt::format("{:.0f} % of the picture is masked", 100.0 * *masked_);
    return finding;
  }

 private:
  const char* side_;
  std::optional<double> masked_;  ///< share
  calibrate::StaticPartFinder finder_;
};

}  // namespace

void checkStaticParts(capture::StereoSource& source, const calib::Rig* rig,
                      const std::atomic<bool>& interrupted, FindingList& findings) {
  std::array<Camera, 2> cameras{Camera("left", rig == nullptr ? nullptr : &rig->left),
                                Camera("right", rig == nullptr ? nullptr : &rig->right)};
  const auto is_done = [](const Camera& camera) { return camera.isDone(); };
  if (!std::all_of(cameras.begin(), cameras.end(), is_done)) {
    calibrate::forEachPair(source, [&](const capture::FramePair& pair) {
      cameras[0].add(pair.left);
      cameras[1].add(pair.right);
      return !interrupted && !std::all_of(cameras.begin(), cameras.end(), is_done);
    });
  }
  for (const Camera& camera : cameras) {
    const Finding finding = camera.finding();
    findings.add(finding.subject, finding.verdict, {finding.seen, finding.expected, finding.advice});
  }
}

}  // namespace cartvo::doctor
