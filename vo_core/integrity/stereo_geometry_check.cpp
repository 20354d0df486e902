// Detection of gross faults of the rig: when to look, and what several looks say.
#include "vo_core/integrity/stereo_geometry_check.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <optional>

#include "common/picture_digest.hpp"
#include "vo_core/fixed_constants.hpp"

namespace cartvo::vo {
namespace {

double seconds(std::int64_t nanoseconds) {
  return 1e-9 * static_cast<double>(nanoseconds);
}

}  // namespace

void GeometryQuestion::update(Evidence evidence) {
  if (evidence == Evidence::none) {
    // Looks that cannot tell do not confirm an old contradiction.
    if (++silent_ >= geometry_check::kAnswers) contradictions_ = 0;
    return;
  }
  silent_ = 0;
  const bool contradicts = (evidence == Evidence::wrong) != wrong_;
  settled_ = settled_ || evidence == Evidence::right;
  contradictions_ = contradicts ? contradictions_ + 1 : 0;
  if (contradictions_ < geometry_check::kAnswers) return;
  wrong_ = !wrong_;
  contradictions_ = 0;
}

StereoGeometryCheck::StereoGeometryCheck(const StereoCamera& camera)
    : camera_(camera), search_(camera.width), pyramids_(search_.levels()) {}

StereoFault StereoGeometryCheck::update(const StereoImages& images, bool repeats) {
  updateSamePicture(images);
  updatePeriod(images);
  if (repeats) {
    previous_left_.reset();
  } else if (previous_left_ || looks_ == 0) {
    look(images);
  } else if (std::abs(images.left_exposure_ns - last_look_ns_) >= interval_ns_) {
    previous_left_ = pyramids_.build(images.left);  // a look also needs the pair before
  }
  previous_exposure_ns_ = images.left_exposure_ns;
  return fault();
}

/// Compares the pictures of this pair, and each with the other camera's previous one, as pairing may shift
/// the same stream by a frame.
void StereoGeometryCheck::updateSamePicture(const StereoImages& images) {
  const std::uint64_t left = images.left_digest != 0 ? images.left_digest : pictureDigest(images.left);
  const std::uint64_t right = images.right_digest != 0 ? images.right_digest : pictureDigest(images.right);
  const bool same = left == right || left == previous_digests_[1] || right == previous_digests_[0];
  if (same && !isUniform(images.left))
    same_picture_pairs_ = geometry_check::kSamePicturePairs;
  else if (same_picture_pairs_ > 0)
    --same_picture_pairs_;
  previous_digests_ = {left, right};
}

/// The shortest of the recent steps: pairs may be missing.
void StereoGeometryCheck::updatePeriod(const StereoImages& images) {
  const double step =
      previous_exposure_ns_ == 0 ? 0.0 : seconds(images.left_exposure_ns - previous_exposure_ns_);
  if (step > 0.0) period_ = period_ > 0.0 ? std::min(geometry_check::kPeriodGrowth * period_, step) : step;
}

void StereoGeometryCheck::look(const StereoImages& images) {
  const SharedPyramid left = pyramids_.build(images.left);
  const SharedPyramid right = pyramids_.build(images.right);
  match(*left, *right);
  PairTimes times;
  times.offset = seconds(images.right_exposure_ns - images.left_exposure_ns);
  times.period = period_;
  times.offset_stddev = images.offset_stddev;
  if (previous_left_) times.flow = seconds(images.left_exposure_ns - previous_exposure_ns_);
  const StereoLook seen = lookAt(camera_, matches_, times);
  rows_.update(seen.rows);
  order_.update(seen.order);
  lag_.update(seen.lag);
  if (looks_ < geometry_check::kFirstLooks) ++looks_;
  previous_left_ = looks_ < geometry_check::kFirstLooks ? left : nullptr;
  interval_ns_ = nextInterval();
  last_look_ns_ = images.left_exposure_ns;
}

std::int64_t StereoGeometryCheck::nextInterval() const {
  if (looks_ < geometry_check::kFirstLooks) return 0;
  if (rows_.isContested() || order_.isContested() || lag_.isContested())
    return geometry_check::kContestedInterval;
  return rows_.isSettled() && order_.isSettled() && lag_.isSettled() ? geometry_check::kInterval
                                                                     : geometry_check::kUnsettledInterval;
}

void StereoGeometryCheck::match(const ImagePyramid& left, const ImagePyramid& right) {
  const std::vector<Eigen::Vector2i>& centres = search_.choosePatches(left);
  matches_.clear();
  search_.setSearched(right, PatchSearch::kDisparityShare);
  found_.clear();
  for (const Eigen::Vector2i& centre : centres) {
    const std::optional<Eigen::Vector2d> shift = search_.find(left, centre);
    if (!shift) continue;
    const Eigen::Vector2d pixel = search_.fullPixel(centre);
    matches_.push_back({pixel, pixel + *shift, {}});
    found_.push_back(centre);
  }
  if (!previous_left_) return;
  search_.setSearched(*previous_left_, geometry_check::kFlowShare);
  for (std::size_t i = 0; i < found_.size(); ++i)
    if (const std::optional<Eigen::Vector2d> back = search_.find(left, found_[i]))
      matches_[i].row_flow = -back->y();
}

StereoFault StereoGeometryCheck::fault() const {
  if (same_picture_pairs_ > 0) return StereoFault::same_picture;
  if (order_.isWrong()) return StereoFault::swapped;
  if (lag_.isWrong()) return StereoFault::period_offset;
  if (rows_.isWrong()) return StereoFault::misaligned;
  const bool suspected = rows_.isSuspected() || order_.isSuspected() || lag_.isSuspected();
  return suspected ? StereoFault::suspected : StereoFault::none;
}

}  // namespace cartvo::vo
