// Checks that the values of a rig describe two cameras of one rig.
#include "calib/model/rig_validation.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "calib/model/rotation.hpp"
#include "common/exact_text.hpp"
#include "common/units.hpp"

namespace cartvo::calib {
namespace {

void validateCamera(const CameraModel& camera, const std::string& side) {
  const auto check = [&](bool holds, const char* what) {
    if (!holds) throw std::invalid_argument("rig: the " + side + " camera's " + what);
  };
  check(camera.size.width >= 16 && camera.size.height >= 16, "image size is below 16x16 px");
  check(camera.size.width <= kMaxImageSide && camera.size.height <= kMaxImageSide,
        "image side is above 8192 px");
  for (const double focal_length : {camera.fx, camera.fy}) {
    check(focal_length >= kMinFocalLength && focal_length <= kMaxFocalLength,
          "focal lengths must lie in 1 to 100000 px");
  }
  const auto is_centre = [](double centre, int length) {
    return centre >= minCentre(length) && centre <= maxCentre(length);
  };
  check(is_centre(camera.cx, camera.size.width) && is_centre(camera.cy, camera.size.height),
        "principal point must lie within an image's size of the image");
  for (std::size_t i = 0; i < camera.distortion.size(); ++i) {
    check(std::isfinite(camera.distortion[i]), "distortion must be finite");
    check(i < distortionCount(camera.lens) || camera.distortion[i] == 0.0,
          "distortion has more coefficients than its lens model");
  }
  check(camera.mask.empty() || (camera.mask.used.size() == camera.size && camera.mask.used.type() == CV_8UC1),
        "mask must have the size of the image");
  check(std::abs(camera.readout.value_or(0.0)) <= kMaxReadout, "readout must lie in -0.2 to 0.2 s");
}

/// Collects unusual values, and for each kind of them what they may mean instead.
class Findings {
 public:
  /// Adds "SUBJECT is VALUE (expected MIN to MAX UNIT)" if the value lies outside.
  void check(const std::string& subject, double value, double min, double max, const char* unit,
             const std::string& question) {
    if (value >= min && value <= max) return;
    const std::string statement = subject + " is " + roundedText(value, 4) + unit + " (expected " +
                                  roundedText(min, 4) + " to " + roundedText(max, 4) + ")";
    for (auto& [known, statements] : kinds_) {
      if (known != question) continue;
      statements += ", " + statement;
      return;
    }
    kinds_.emplace_back(question, statement);
  }

  std::string text() const {
    std::string text;
    for (const auto& [question, statements] : kinds_)
      text += (text.empty() ? "" : " ") + statements + ": " + question;
    return text;
  }

 private:
  std::vector<std::pair<std::string, std::string>> kinds_;  ///< question and statements
};

constexpr double kMaxFocalRatio = 1.25;

void checkCamera(const CameraModel& camera, const std::string& side, Findings& findings) {
  constexpr double kMinCentre = 0.27, kMaxCentre = 0.73;  // relative to the image
  constexpr double kMinFocal = 0.15, kMaxFocal = 10.0;    // relative to the image's width
  constexpr double kMaxTangential = 0.05;
  const std::string prefix = "the " + side + " camera's ";
  const auto width = static_cast<double>(camera.size.width), height = static_cast<double>(camera.size.height);
  const char* const centre = "is the image's size right, are the numbers in order, is the matrix transposed?";
  findings.check(prefix + "cx", camera.cx, kMinCentre * width, kMaxCentre * width, " px", centre);
  findings.check(prefix + "cy", camera.cy, kMinCentre * height, kMaxCentre * height, " px", centre);
  findings.check(prefix + "fx", camera.fx, kMinFocal * width, kMaxFocal * width, " px",
                 "is it in millimetres, or for another image size?");
  findings.check(prefix + "fx/fy", camera.fx / camera.fy, 1.0 / kMaxFocalRatio, kMaxFocalRatio, "",
                 "pixels are square in almost all cameras; are the numbers in order?");
  if (camera.lens != LensModel::brown) return;
  for (const std::size_t index : {2, 3}) {
    findings.check(
        prefix + (index == 2 ? "p1" : "p2"), camera.distortion[index], -kMaxTangential, kMaxTangential, "",
        "a lens is not tilted so much; are the coefficients in the order k1 k2 p1 p2 k3, and is the "
        "lens model right (for cv::fisheye: fisheye_model: 1)?");
  }
}

}  // namespace

std::string unusualGeometry(const Rig& rig) {
  constexpr double kMinUsualBaseline = 0.02, kMaxUsualBaseline = 1.5;  // m
  constexpr double kMaxTurn = 15.0;                                    // degrees
  Findings findings;
  checkCamera(rig.left, "left", findings);
  checkCamera(rig.right, "right", findings);
  findings.check("the ratio of the left and the right fx", rig.left.fx / rig.right.fx, 1.0 / kMaxFocalRatio,
                 kMaxFocalRatio, "", "both cameras of a pair have like lenses; are the files of one rig?");
  findings.check("the baseline", rig.baseline(), kMinUsualBaseline, kMaxUsualBaseline, " m",
                 "is the translation in metres?");
  findings.check("the angle between the two cameras",
                 kDegreesPerRadian * Eigen::AngleAxisd(rig.T_right_left.linear()).angle(), 0.0, kMaxTurn,
                 " degrees", "is the rotation that of these two cameras, and in the right order?");
  return findings.text();
}

void validateRig(const Rig& rig) {
  validateCamera(rig.left, "left");
  validateCamera(rig.right, "right");
  if (rig.left.size != rig.right.size) {
    throw std::invalid_argument("rig: both cameras must have the same image size");
  }
  for (const Eigen::Isometry3d& transform : {rig.T_right_left, rig.T_body_camera}) {
    if (!isRotation(transform.linear())) throw std::invalid_argument("rig: a rotation is not orthonormal");
    if (!transform.translation().allFinite()) throw std::invalid_argument("rig: a translation is not finite");
  }
  if (!(rig.rectification.free_scaling >= 0.0 && rig.rectification.free_scaling <= 1.0)) {
    throw std::invalid_argument("rig: free_scaling must lie in 0 to 1");
  }
  if (!(rig.scale_stddev >= 0.0 && rig.scale_stddev <= kMaxScaleStddev)) {
    throw std::invalid_argument("rig: scale_deviation must lie in 0 to 0.1");
  }
  if (!(rig.baseline() >= kMinBaseline && rig.baseline() <= kMaxBaseline)) {
    throw std::invalid_argument(
        "rig: the baseline is " + roundedText(rig.baseline()) + " m, expected 0.005 m to 10 m; " +
        (rig.baseline() < kMinBaseline ? "do the files describe the same camera twice?"
                                       : "was the board's square given in millimetres?"));
  }
}

}  // namespace cartvo::calib
