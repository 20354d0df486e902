// Light, sharpness, rows and static parts of some pairs of pictures.
#include "tools/doctor/picture_checks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "calib/rectification/rectification_tables.hpp"
#include "calib/rectification/rectifier.hpp"
#include "common/image_size.hpp"
#include "common/statistics.hpp"
#include "tools/calibrate/check/row_check.hpp"
#include "tools/calibrate/mask/static_parts.hpp"
#include "tools/doctor/picture_measures.hpp"

namespace cartvo::doctor {
namespace {

constexpr std::size_t kMaxPairs = 10;      // that light, sharpness and rows are measured in
constexpr double kMaxRowRms = 0.3;         // px, as 'cartvo calibrate check'
constexpr double kMaxBrightnessRatio = 2;  // of the two means: one camera has another exposure setting
// On drives of three data sets and on rendered ones, cameras in focus have 0.69 to 1.67, after a blur of
// 1.5 px (standard deviation) 0.35 to 0.50, of 2 px 0.32 to 0.40.
constexpr double kMinSharpness = 0.35;
constexpr double kMaxSharpnessRatio = 2.0;           // of the excesses: a blur of about 0.7 px in one of them
constexpr double kMinStaticShare = 0.01;             // of the picture
constexpr std::int64_t kSameInstant_ns = 1'000'000;  // a cart at 5 m/s moves by 5 mm
constexpr std::int64_t kTellingTime_ns = 300'000'000;  // in which a cart that moves changes its view

using calib::CameraModel;

std::string percent(double share) {
  return fmt::format("{:.0f} %", 100.0 * share);
}

/// At most kMaxPairs, spread evenly.
std::vector<PicturePair> sample(const std::vector<PicturePair>& pairs) {
  if (pairs.size() <= kMaxPairs) return pairs;
  std::vector<PicturePair> chosen;
  for (std::size_t i = 0; i < kMaxPairs; ++i)
    chosen.push_back(pairs[i * (pairs.size() - 1) / (kMaxPairs - 1)]);
  return chosen;
}

/// The measures of a camera, each the median over the pairs.
PictureMeasures medianMeasures(const std::vector<PicturePair>& pairs, cv::Mat PicturePair::*picture,
                               const CameraModel* camera) {
  const cv::Mat used = camera == nullptr ? cv::Mat() : camera->mask.used;
  std::vector<double> means, blacks, saturated, textures, sharpnesses;
  for (const PicturePair& pair : pairs) {
    const cv::Mat& image = pair.*picture;
    const PictureMeasures measures = measurePicture(image, used.size() == image.size() ? used : cv::Mat());
    means.push_back(measures.mean);
    blacks.push_back(measures.black);
    saturated.push_back(measures.saturated);
    textures.push_back(measures.texture);
    if (measures.sharpness) sharpnesses.push_back(*measures.sharpness);
  }
  PictureMeasures medians{{median(means), median(blacks), median(saturated), median(textures)}, std::nullopt};
  if (!sharpnesses.empty()) medians.sharpness = median(sharpnesses);
  return medians;
}

Finding lightOf(const char* side, const PictureMeasures& measures) {
  Finding finding{"", fmt::format("{} camera, light", side), Verdict::ok, {}, {}, {}};
  finding.seen = fmt::format("mean {:.0f} of 255, {} black, {} white, texture in {}", measures.mean,
                             percent(measures.black), percent(measures.saturated), percent(measures.texture));
  finding.expected = pipeline::lightLimits();
  const pipeline::LightFault fault = pipeline::lightFault(measures);
  if (fault == pipeline::LightFault::none) return finding;
  finding.verdict = Verdict::look_at;
  finding.seen += std::string("; ") + pipeline::lightFaultText(fault);
  finding.advice = pipeline::lightAdvice(fault);
  return finding;
}

Finding lightOfBoth(const PictureMeasures& left, const PictureMeasures& right) {
  const double ratio = std::max(left.mean, right.mean) / std::max(1.0, std::min(left.mean, right.mean));
  Finding finding{"", "light, left against right", Verdict::ok, {}, {}, {}};
  finding.seen = fmt::format("means of {:.0f} and {:.0f}", left.mean, right.mean);
  finding.expected = fmt::format("within a factor of {:.0f}", kMaxBrightnessRatio);
  if (ratio <= kMaxBrightnessRatio) return finding;
  finding.verdict = Verdict::look_at;
  finding.advice = "set exposure, gain and WDR of both cameras alike, and clean both lenses";
  return finding;
}

Finding sharpnessOf(const char* side, const PictureMeasures& measures) {
  Finding finding{"", fmt::format("{} camera, sharpness", side), Verdict::ok, {}, {}, {}};
  finding.expected = fmt::format("at least {:.2f}", kMinSharpness);
  if (!measures.sharpness) {
    finding.verdict = Verdict::not_checked;
    finding.seen = "the picture shows no edges";
    finding.advice = "look at a scene with texture, by daylight";
    return finding;
  }
  finding.seen = fmt::format("{:.2f} (0.25: blurred)", *measures.sharpness);
  if (*measures.sharpness >= kMinSharpness) return finding;
  finding.verdict = Verdict::look_at;
  finding.advice =
      "clean and focus the lens, and shorten the exposure if the cart moves; calibrate again "
      "after focusing";
  return finding;
}

Finding sharpnessOfBoth(double left, double right) {
  const double ratio = excessSharpness(left) / excessSharpness(right);
  Finding finding{"", "sharpness, left against right", Verdict::ok, {}, {}, {}};
  finding.seen = fmt::format("{:.2f} and {:.2f}", left, right);
  finding.expected = "alike";
  if (std::max(ratio, 1.0 / ratio) <= kMaxSharpnessRatio) return finding;
  finding.verdict = Verdict::look_at;
  finding.advice = fmt::format(
      "clean and focus the lens of the {} camera, and set the sharpness filters of "
      "both cameras alike; calibrate again after focusing",
      ratio < 1.0 ? "left" : "right");
  return finding;
}

bool hasRigSize(const PicturePair& pair, const calib::Rig& rig) {
  return pair.left.size() == rig.left.size && pair.right.size() == rig.left.size;
}

/// Whether the pictures of a pair may differ because the cart moves between their exposures.
bool mayHaveMoved(const std::vector<PicturePair>& pairs) {
  const bool same_instants = std::all_of(pairs.begin(), pairs.end(), [](const PicturePair& pair) {
    return std::abs(pair.right_exposure_ns - pair.left_exposure_ns) <= kSameInstant_ns;
  });
  if (same_instants) return false;
  if (pairs.back().left_exposure_ns - pairs.front().left_exposure_ns < kTellingTime_ns) return true;
  calibrate::StaticPartFinder changes;
  for (const PicturePair& pair : pairs)
    changes.add(pair.left, pair.left_exposure_ns);
  return changes.pictures() > 1;
}

/// Measures the vertical disparities. Throws std::runtime_error if there are too few points.
calibrate::RowCheck measureRows(const std::vector<PicturePair>& pairs, const calib::Rectifier& rectifier) {
  std::vector<calibrate::RectifiedMatch> matches;
  for (const PicturePair& pair : pairs) {
    cv::Mat left, right;
    rectifier.rectifyLeft(pair.left, left);
    rectifier.rectifyRight(pair.right, right);
    const std::vector<calibrate::RectifiedMatch> found = calibrate::matchRectified(left, right);
    matches.insert(matches.end(), found.begin(), found.end());
  }
  return calibrate::checkRows(matches, static_cast<int>(pairs.size()), rectifier.rectification());
}

std::string rowsText(const calibrate::RowCheck& check) {
  std::string text =
      fmt::format("{:.2f} px (RMS), mean {:+.2f} px, of {} points", check.rms, check.median, check.matches);
  if (calibrate::isSlightlyTurned(check, kMaxRowRms))
    text +=
        fmt::format("; {:.2f} px after a small turn, which cartvod corrects while driving", check.scatter);
  return text;
}

Finding rowsOf(const std::vector<PicturePair>& pairs, const calib::Rig* rig) {
  Finding finding{"", "rows, left against right", Verdict::not_checked, {}, {}, {}};
  finding.expected =
      fmt::format("at most {:.1f} px (RMS), if need be after a small turn of the right camera", kMaxRowRms);
  if (rig == nullptr) {
    finding.seen = "there is no rig file";
    finding.advice = "calibrate the cameras with 'cartvo calibrate'";
    return finding;
  }
  std::vector<PicturePair> fitting;
  std::copy_if(pairs.begin(), pairs.end(), std::back_inserter(fitting),
               [&](const PicturePair& pair) { return hasRigSize(pair, *rig); });
  if (fitting.empty()) {
    finding.seen = fmt::format("pictures of {} and {} px, but the rig file is for {}",
                               sizeText(pairs.front().left.size()), sizeText(pairs.front().right.size()),
                               sizeText(rig->left.size));
    finding.advice = "set both cameras to the size of the rig file, or calibrate again";
    return finding;
  }
  try {
    const calib::Rectifier rectifier(*rig, rig->rectification, calib::buildTables(*rig, rig->rectification));
    const calibrate::RowCheck check = measureRows(fitting, rectifier);
    finding.seen = rowsText(check);
    if (calibrate::passes(check, kMaxRowRms)) {
      finding.verdict = Verdict::ok;
    } else if (mayHaveMoved(fitting)) {
      finding.advice =
          "let the cart stand and look again: cameras that are not synchronised show a moving "
          "scene in different rows";
    } else if (calibrate::seemsSwapped(check)) {
      finding.verdict = Verdict::broken;
      finding.seen += ", most points behind the cameras";
      finding.advice = "exchange the addresses of the left and the right camera";
    } else {
      finding.verdict = Verdict::broken;
      finding.advice = "is it the rig file of these cameras? If a camera was touched, calibrate again";
    }
  } catch (const std::runtime_error& error) {
    finding.seen = error.what();
    finding.advice = "look at a scene with texture, near and far, by daylight";
  }
  return finding;
}

Finding staticPartsOf(const std::vector<PicturePair>& pairs, cv::Mat PicturePair::*picture, const char* side,
                      const CameraModel* camera) {
  Finding finding{"", fmt::format("{} camera, static parts", side), Verdict::ok, {}, {}, {}};
  finding.expected = "nothing of the cart and no lettering in view, or a mask";
  if (camera != nullptr && !camera->mask.empty()) {
    finding.seen = fmt::format("{} of the picture is masked", percent(calib::maskedShare(camera->mask)));
    return finding;
  }
  calibrate::StaticPartFinder finder;
  try {
    for (const PicturePair& pair : pairs)
      finder.add(pair.*picture, pair.left_exposure_ns);
    const calibrate::StaticParts parts = finder.result();
    finding.seen = fmt::format("{:.1f} % of the picture keeps its place", 100.0 * parts.share);
    if (parts.share < kMinStaticShare) return finding;
    const cv::Rect& box = parts.boxes.front();
    finding.verdict = Verdict::look_at;
    finding.seen +=
        fmt::format(", at x {} to {}, y {} to {} px", box.x, box.br().x - 1, box.y, box.br().y - 1);
    finding.advice = "switch lettering off, clean the lens, or mask the cart: 'cartvo calibrate mask'";
  } catch (const std::runtime_error& error) {
    finding.verdict = Verdict::not_checked;
    finding.seen = error.what();
    finding.advice = "'cartvo calibrate mask' looks at all of a recording";
  }
  return finding;
}

}  // namespace

void checkPictures(const std::vector<PicturePair>& pairs, const calib::Rig* rig, FindingList& findings) {
  if (pairs.empty()) return findings.add("both cameras", Verdict::not_checked, {"there are no pictures"});
  const std::vector<PicturePair> some = sample(pairs);
  const CameraModel* const left_camera = rig == nullptr ? nullptr : &rig->left;
  const CameraModel* const right_camera = rig == nullptr ? nullptr : &rig->right;
  const PictureMeasures left = medianMeasures(some, &PicturePair::left, left_camera);
  const PictureMeasures right = medianMeasures(some, &PicturePair::right, right_camera);
  const auto add = [&](const Finding& finding) {
    findings.add(finding.subject, finding.verdict, {finding.seen, finding.expected, finding.advice});
  };
  add(lightOf("left", left));
  add(lightOf("right", right));
  add(lightOfBoth(left, right));
  add(sharpnessOf("left", left));
  add(sharpnessOf("right", right));
  if (left.sharpness && right.sharpness) add(sharpnessOfBoth(*left.sharpness, *right.sharpness));
  add(rowsOf(some, rig));
  add(staticPartsOf(pairs, &PicturePair::left, "left", left_camera));
  add(staticPartsOf(pairs, &PicturePair::right, "right", right_camera));
}

}  // namespace cartvo::doctor
