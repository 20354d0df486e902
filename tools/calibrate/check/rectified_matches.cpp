// Point matches between two rectified images.
#include "tools/calibrate/check/rectified_matches.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "common/picture_digest.hpp"

namespace cartvo::calibrate {
namespace {

struct Features {
  std::vector<cv::KeyPoint> points;
  cv::Mat descriptors;
};

Features featuresOf(const cv::Mat& image) {
  constexpr int kMaxFeatures = 4000;
  Features features;
  cv::ORB::create(kMaxFeatures)->detectAndCompute(image, {}, features.points, features.descriptors);
  return features;
}

/// For each feature the index of its best match, -1 if it fails the ratio test.
std::vector<int> matchWithRatioTest(const Features& from, const Features& to) {
  constexpr float kRatio = 0.8F;
  std::vector<int> partners(from.points.size(), -1);
  if (from.points.empty() || to.points.size() < 2) return partners;
  std::vector<std::vector<cv::DMatch>> candidates;
  cv::BFMatcher(cv::NORM_HAMMING).knnMatch(from.descriptors, to.descriptors, candidates, 2);
  for (const std::vector<cv::DMatch>& best : candidates) {
    if (best.size() == 2 && best[0].distance < kRatio * best[1].distance)
      partners[static_cast<std::size_t>(best[0].queryIdx)] = best[0].trainIdx;
  }
  return partners;
}

std::vector<RectifiedMatch> mutualMatches(const Features& left, const Features& right) {
  const std::vector<int> to_right = matchWithRatioTest(left, right),
                         to_left = matchWithRatioTest(right, left);
  std::vector<RectifiedMatch> matches;
  for (std::size_t i = 0; i < to_right.size(); ++i) {
    const int partner = to_right[i];
    if (partner < 0 || to_left[static_cast<std::size_t>(partner)] != static_cast<int>(i)) continue;
    matches.push_back({left.points[i].pt, right.points[static_cast<std::size_t>(partner)].pt});
  }
  return matches;
}

/// The positions in `image_to` of the patches around `from`, starting from `there`. A patch that is not found
/// gets a position far outside the image.
std::vector<cv::Point2f> aligned(const cv::Mat& image_from, const cv::Mat& image_to,
                                 const std::vector<cv::Point2f>& from, std::vector<cv::Point2f> there) {
  constexpr double kMinTexture = 2e-3;  // smaller eigenvalue: excludes patches that can slide along an edge
  const cv::Point2f lost(-1e6F, -1e6F);
  std::vector<std::uint8_t> found;
  cv::calcOpticalFlowPyrLK(image_from, image_to, from, there, found, cv::noArray(), {15, 15}, 0,
                           {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 40, 0.003},
                           cv::OPTFLOW_USE_INITIAL_FLOW, kMinTexture);
  for (std::size_t i = 0; i < there.size(); ++i) {
    if (found[i] == 0) there[i] = lost;
  }
  return there;
}

/// Mean absolute difference of the pictures where the right one is shifted by some columns.
double meanDifference(const cv::Mat& left, const cv::Mat& right, int columns) {
  const cv::Rect whole(0, 0, left.cols - columns, left.rows);
  cv::Mat difference;
  cv::absdiff(left(whole), right(whole + cv::Point(columns, 0)), difference);
  return cv::mean(difference)[0];
}

constexpr int kPatchRadius = 10;       // px
constexpr double kRowTolerance = 2.0;  // px, of a place that agrees with the rig
constexpr double kOtherPlace = 5.0;    // px from the match
constexpr double kEqualFit = 0.9;      // of the match's correlation

cv::Rect around(const cv::Point2f& point, int x_radius, int y_radius) {
  const cv::Point centre(point);
  return {centre.x - x_radius, centre.y - y_radius, 2 * x_radius + 1, 2 * y_radius + 1};
}

/// Whether a place in the match's own row, in front of the cameras, fits as well as the match.
bool fitsElsewhere(const cv::Mat& left, const cv::Mat& right, const RectifiedMatch& match) {
  const cv::Rect whole(0, 0, right.cols, right.rows);
  const cv::Rect patch = around(match.left, kPatchRadius, kPatchRadius);
  const cv::Rect there = around(match.right, kPatchRadius, kPatchRadius);
  const int rows = kPatchRadius + static_cast<int>(kRowTolerance);
  const cv::Rect band =
      cv::Rect(0, patch.y - static_cast<int>(kRowTolerance), patch.br().x + 1, 2 * rows + 1) & whole;
  if ((patch & whole) != patch || (there & whole) != there || band.height < patch.height) return false;
  cv::Mat fit, fits;
  cv::matchTemplate(right(there), left(patch), fit, cv::TM_CCOEFF_NORMED);
  cv::matchTemplate(right(band), left(patch), fits, cv::TM_CCOEFF_NORMED);
  const cv::Rect match_itself =
      cv::Rect(there.x - band.x - static_cast<int>(kOtherPlace),
               there.y - band.y - static_cast<int>(kOtherPlace), 2 * static_cast<int>(kOtherPlace) + 1,
               2 * static_cast<int>(kOtherPlace) + 1) &
      cv::Rect(0, 0, fits.cols, fits.rows);
  if (!match_itself.empty()) fits(match_itself).setTo(-1.0F);
  double best = 0.0;
  cv::minMaxLoc(fits, nullptr, &best);
  return best >= kEqualFit * static_cast<double>(fit.at<float>(0));
}

}  // namespace

bool areOfOneCamera(const cv::Mat& left, const cv::Mat& right) {
  if (left.size() != right.size() || left.cols < 2 || isUniform(left)) return false;
  constexpr double kSame = 0.5;
  return meanDifference(left, right, 0) < kSame * meanDifference(left, left, 1);
}

void addContradictions(const cv::Mat& left, const cv::Mat& right, const std::vector<RectifiedMatch>& matches,
                       double max_difference, Contradictions& contradictions) {
  constexpr std::size_t kSample = 100;
  const std::size_t stride = std::max<std::size_t>(1, matches.size() / kSample);
  for (std::size_t i = 0; i < matches.size(); i += stride) {
    const RectifiedMatch& match = matches[i];
    if (std::abs(match.verticalDisparity()) <= max_difference && match.disparity() > kMinDisparity) continue;
    ++contradictions.all;
    if (fitsElsewhere(left, right, match)) ++contradictions.repeated;
  }
}

std::vector<RectifiedMatch> matchRectified(const cv::Mat& left, const cv::Mat& right) {
  constexpr double kMaxShift = 3.0, kMaxReturnError = 0.1;  // px
  const std::vector<RectifiedMatch> coarse = mutualMatches(featuresOf(left), featuresOf(right));
  if (coarse.empty()) return {};
  std::vector<cv::Point2f> from, guess;
  for (const RectifiedMatch& match : coarse) {
    from.push_back(match.left);
    guess.push_back(match.right);
  }
  const std::vector<cv::Point2f> there = aligned(left, right, from, guess);
  const std::vector<cv::Point2f> back = aligned(right, left, there, from);
  std::vector<RectifiedMatch> matches;
  for (std::size_t i = 0; i < coarse.size(); ++i) {
    if (cv::norm(there[i] - guess[i]) < kMaxShift && cv::norm(back[i] - from[i]) < kMaxReturnError)
      matches.push_back({from[i], there[i]});
  }
  return matches;
}

}  // namespace cartvo::calibrate
