// Point matches between two rectified images.
#include "tools/calibrate/check/rectified_matches.hpp"

#include <cstdint>

#include <opencv2/features2d.hpp>
#include <opencv2/video/tracking.hpp>

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

}  // namespace

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
