// The life of landmarks: detected, followed, matched in stereo, given new hosts, dropped.
#include "vo_core/landmark_tracker.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "vo_core/affine_alignment.hpp"
#include "vo_core/alignment_block.hpp"
#include "vo_core/parallel_loop.hpp"
#include "vo_core/shift_tracking.hpp"
#include "vo_core/stereo_matcher.hpp"

namespace cartvo {
namespace {

constexpr double kUnknownInverseDepth = 0.02;  // 1/m, where a landmark without a depth is taken to be
constexpr int kShiftLevel = 1;    // above the patch's own, where a shift ends that an alignment refines
constexpr double kOutside = 8.0;  // px; predicted farther outside the image, a landmark is gone
constexpr double kShiftCorrelation = 0.4;  // after a mere shift, of which a warp may make a match
constexpr double kLargestStretch = 0.35;   // of a warp's elements; a host that looks so different is given up
constexpr double kLargestRow = 1.5;  // px of the level, of a stereo match off the row where it is expected
// m and rad: a right camera that has gone or rolled so far since the left exposure sees rows of patches
// change.
constexpr double kSamePlace = 0.005, kSameRoll = 0.01;

bool stretched(const Eigen::Matrix2d& warp) {
  return (warp - Eigen::Matrix2d::Identity()).cwiseAbs().maxCoeff() > kLargestStretch;
}

/// Whether what was found, aligned backwards, leads to where it came from.
bool returns(const AffineAlignment& found, const TrackingSettings& tracking) {
  return found.return_miss <= tracking.maximum_return;
}

/// Levels of the shift that comes before an alignment in `level`, of so many that are tracked in. Where pose
/// and depth are expected, the landmark is within some 10 px of its prediction, and one level will do; where
/// the depth is not, one more reaches all but the nearest, of which most are lost in any case. Without a pose
/// it is looked for from the top.
PyramidLevels shiftLevels(int level, bool pose_expected, bool has_depth, int tracked) {
  const int finest = level + kShiftLevel;
  const int top = std::max(finest, tracked - 1);
  if (!pose_expected) return {finest, top};
  return {finest, has_depth ? finest : std::min(finest + 1, top)};
}

/// Whether the landmark was a new corner until it was looked for and `found` or not.
bool wasNew(const Landmark& landmark, bool found) {
  return landmark.age == (found ? 2 : 1);
}

/// How a left patch looks in the right image. On rectified cameras' rows only its columns are stretched and
/// sheared, however far apart the cameras are; a late camera that has driven on sees its rows grow too: left
/// out, they pull the match to the side.
WarpModel warpModelOf(const Eigen::Isometry3d& T_right_left) {
  return keepsRows(T_right_left) ? WarpModel::stereo : WarpModel::affine;
}

/// To first order in the inverse depth.
EpipolarLine epipolarLine(const StereoCamera& camera, const Eigen::Isometry3d& T_right_left,
                          const Eigen::Vector2d& pixel) {
  EpipolarLine line;
  const Eigen::Vector3d bearing = bearingOf(camera, pixel);
  const Projection infinity = projectLandmark(camera, T_right_left, bearing, 0.0);
  if (!infinity.valid) return line;
  line.at_infinity = infinity.pixel - pixel;
  const ProjectionJacobians by = projectionJacobians(camera, T_right_left, bearing, 0.0, infinity);
  line.per_disparity =
      by.by_inverse_depth / (camera.focal_length * camera.baseline) + Eigen::Vector2d::UnitX();
  return line;
}

/// How the landmark's ray y = R b + rho t in the new host changes with what late right cameras did to both
/// poses.
Eigen::Vector3d rayByLateRight(const WindowFrame& old_host, const WindowFrame& new_host,
                               const Eigen::Isometry3d& T_new_old, double rho, const Eigen::Vector3d& bearing,
                               const Eigen::Vector3d& ray) {
  const Vector6d& old_error = old_host.by_late_right;
  const Vector6d& new_error = new_host.by_late_right;
  return T_new_old.linear() * (old_error.tail<3>().cross(bearing) + rho * old_error.head<3>()) -
         (new_error.tail<3>().cross(ray) + rho * new_error.head<3>());
}

/// The last sighting becomes the host: the landmark's depth, seen from there, goes on as a prior, and so much
/// of what was known of it: `share`.
void moveHost(Landmark& landmark, const StereoCamera& camera, const std::vector<WindowFrame>& window,
              double share) {
  const WindowFrame* old_host = findFrame(window, landmark.host().frame);
  const WindowFrame* new_host = findFrame(window, landmark.last().frame);
  if (old_host != nullptr && new_host != nullptr && landmark.hasDepth()) {
    const Eigen::Isometry3d T_new_old = new_host->T_world_camera.inverse() * old_host->T_world_camera;
    const Eigen::Vector3d bearing = bearingOf(camera, landmark.host().left);
    const Projection seen = projectLandmark(camera, T_new_old, bearing, landmark.inverse_depth);
    if (seen.valid) {
      // y = R b + rho t, so rho' = rho / y_z, and d rho' / d rho = (R b)_z / y_z^2.
      const double z = seen.ray.z();
      const double slope = (z - landmark.inverse_depth * T_new_old.translation().z()) / (z * z);
      const double z_by_late_right =
          rayByLateRight(*old_host, *new_host, T_new_old, landmark.inverse_depth, bearing, seen.ray).z();
      landmark.by_late_right =
          slope * landmark.by_late_right - landmark.inverse_depth / (z * z) * z_by_late_right;
      landmark.inverse_depth /= z;
      landmark.information /= std::max(slope * slope, 1e-6);
    }
  }
  // What the new host sees in stereo has its share in what is known already.
  landmark.prior_inverse_depth = landmark.inverse_depth;
  landmark.prior_information = share * landmark.information;
  landmark.prior_by_late_right = landmark.by_late_right;
  Sighting last = landmark.last();
  last.stereo = false;
  landmark.sightings.clear();
  landmark.sightings.push_back(last);
  landmark.warp.setIdentity();
}

}  // namespace

bool keepsRows(const Eigen::Isometry3d& T_right_left) {
  const Eigen::Vector3d place = T_right_left.inverse().translation();
  const double roll = vectorFromMotion(T_right_left)[5];
  return place.tail<2>().norm() < kSamePlace && std::abs(roll) < kSameRoll;
}

int placeOf(const std::vector<WindowFrame>& window, std::int64_t index) {
  for (std::size_t i = 0; i < window.size(); ++i)
    if (window[i].index == index) return static_cast<int>(i);
  return -1;
}

const WindowFrame* findFrame(const std::vector<WindowFrame>& window, std::int64_t index) {
  const int place = placeOf(window, index);
  return place < 0 ? nullptr : &window[static_cast<std::size_t>(place)];
}

LandmarkTracker::LandmarkTracker(const StereoCamera& camera, const OdometrySettings& settings)
    : camera_(camera),
      settings_(settings),
      detector_(settings.detection, settings.features, cv::Size(camera.width, camera.height)) {}

void LandmarkTracker::aimAt(int features) {
  settings_.features = features;
  detector_.aimAt(features);
}

LandmarkTracker::Scene::Scene(const std::vector<WindowFrame>& in, const ImagePyramid& image,
                              std::int64_t index, const std::optional<Eigen::Isometry3d>& T_world_camera)
    : window(in), left(image), frame(index) {
  if (!T_world_camera) return;
  const Eigen::Isometry3d T_camera_world = T_world_camera->inverse();
  for (const WindowFrame& seen : window)
    T_camera_frame.push_back(T_camera_world * seen.T_world_camera);
}

/// Where the landmark should be seen; nothing if that is outside the image.
std::optional<Eigen::Vector2d> LandmarkTracker::expectedPixel(const Landmark& landmark, int host,
                                                              const Scene& scene) const {
  Eigen::Vector2d pixel = landmark.last().left;
  if (scene.poseExpected()) {
    const double inverse_depth = landmark.hasDepth() ? landmark.inverse_depth : kUnknownInverseDepth;
    const Projection predicted =
        projectLandmark(camera_, scene.T_camera_frame[static_cast<std::size_t>(host)],
                        bearingOf(camera_, landmark.host().left), inverse_depth);
    if (!predicted.valid) return std::nullopt;
    pixel = predicted.pixel;
  }
  if (pixel.x() < -kOutside || pixel.y() < -kOutside || pixel.x() > camera_.width + kOutside ||
      pixel.y() > camera_.height + kOutside)
    return std::nullopt;
  return pixel;
}

std::optional<ShiftTask> LandmarkTracker::startShift(Landmark& landmark, const Scene& scene,
                                                     std::int64_t oldest_host) const {
  const WindowFrame* last = findFrame(scene.window, landmark.last().frame);
  if (last == nullptr) return std::nullopt;
  if (landmark.host().frame < oldest_host || stretched(landmark.warp))
    moveHost(landmark, camera_, scene.window, settings_.bundle.standing_share);
  const int host = placeOf(scene.window, landmark.host().frame);
  if (host < 0) return std::nullopt;
  const auto expected = expectedPixel(landmark, host, scene);
  if (!expected) return std::nullopt;
  const PyramidLevels levels =
      shiftLevels(landmark.level, scene.poseExpected(), landmark.hasDepth(), settings_.tracking.levels);
  return ShiftTask{last->left.get(), &scene.left, landmark.last().left, *expected, levels};
}

void LandmarkTracker::shiftAll(std::span<Landmark> landmarks, const Scene& scene, std::int64_t oldest_host,
                               std::span<Pursuit> pursuits) const {
  FixedVector<ShiftTask, AlignmentBlock::kMost> tasks;
  FixedVector<std::size_t, AlignmentBlock::kMost> of_landmark;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (const auto task = startShift(landmarks[i], scene, oldest_host)) {
      tasks.push_back(*task);
      of_landmark.push_back(i);
    }
  }
  std::array<std::optional<Eigen::Vector2d>, AlignmentBlock::kMost> shifted;
  trackShifts({tasks.begin(), tasks.size()}, kShiftCorrelation, {shifted.data(), tasks.size()});
  for (std::size_t i = 0; i < tasks.size(); ++i)
    pursuits[of_landmark[i]].shifted = shifted[i];
}

void LandmarkTracker::alignWithHosts(std::span<const Landmark> landmarks, const Scene& scene,
                                     std::span<Pursuit> pursuits) const {
  const TrackingSettings& tracking = settings_.tracking;
  AlignmentBlock block;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (!pursuits[i].shifted || pursuits[i].aligned) continue;
    const Landmark& landmark = landmarks[i];
    const WindowFrame* host = findFrame(scene.window, landmark.host().frame);
    AffineAlignment start;
    start.position = *pursuits[i].shifted;
    start.warp = landmark.warp;
    block.add(i, {*host->left, scene.left, landmark.level}, landmark.host().left, start);
  }
  block.align(WarpModel::affine, tracking, [&](std::size_t i, const AffineAlignment& aligned) {
    if (aligned.correlation >= tracking.minimum_correlation && returns(aligned, tracking))
      pursuits[i].aligned = aligned;
  });
}

void LandmarkTracker::followBlock(std::span<Landmark> landmarks, const Scene& scene, std::int64_t oldest_host,
                                  std::span<unsigned char> found) const {
  std::array<Pursuit, AlignmentBlock::kMost> pursuits;
  shiftAll(landmarks, scene, oldest_host, pursuits);
  alignWithHosts(landmarks, scene, pursuits);
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    Pursuit& pursuit = pursuits[i];
    if (!pursuit.shifted || pursuit.aligned) continue;
    if (landmarks[i].sightings.size() > 1)
      moveHost(landmarks[i], camera_, scene.window, settings_.bundle.standing_share);
    else
      pursuit.shifted.reset();
  }
  alignWithHosts(landmarks, scene, pursuits);
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const auto& aligned = pursuits[i].aligned;
    found[i] = aligned ? 1 : 0;
    if (!aligned) continue;
    landmarks[i].warp = aligned->warp;
    Sighting sighting;
    sighting.frame = scene.frame;
    sighting.left = aligned->position;
    sighting.relative_noise = relativeNoise(aligned->variance, landmarks[i].level);
    landmarks[i].sightings.push_back(sighting);
    ++landmarks[i].age;
  }
}

void LandmarkTracker::follow(std::vector<Landmark>& landmarks, const std::vector<WindowFrame>& window,
                             const ImagePyramid& left, std::int64_t frame, std::int64_t oldest_host,
                             const std::optional<Eigen::Isometry3d>& T_world_camera) {
  const Scene scene(window, left, frame, T_world_camera);
  found_.reserve(landmarks.capacity());
  found_.resize(landmarks.size());
  forEachBlock(landmarks.size(), AlignmentBlock::kMost, [&](std::size_t first, std::size_t count) {
    followBlock(std::span(landmarks).subspan(first, count), scene, oldest_host,
                std::span(found_).subspan(first, count));
  });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (wasNew(landmarks[i], found_[i] != 0)) detector_.learn(landmarks[i], found_[i] != 0);
    if (found_[i] == 0) continue;
    if (kept != i) landmarks[kept] = std::move(landmarks[i]);
    ++kept;
  }
  landmarks.resize(kept);
}

void LandmarkTracker::renew(std::vector<Landmark>& landmarks, const ImagePyramid& left, std::int64_t frame) {
  Renewal& now = renewal_;
  now.spacing.reset(camera_.width, camera_.height, minimumDistance(settings_, camera_.width, camera_.height));
  now.reserve(landmarks.capacity());
  now.order.clear();
  for (std::size_t i = 0; i < landmarks.size(); ++i)
    now.order.emplace_back(-landmarks[i].trust * std::min(landmarks[i].age, 10), i);
  std::sort(now.order.begin(), now.order.end());
  now.kept.clear();
  for (const auto& [merit, index] : now.order) {
    const Eigen::Vector2d pixel = landmarks[index].last().left;
    if (!now.spacing.insert(pixel) || now.kept.size() >= static_cast<std::size_t>(settings_.features))
      continue;
    now.kept.push_back(std::move(landmarks[index]));
  }
  landmarks.swap(now.kept);

  for (const LandmarkCorner& corner : detector_.detect(left, landmarks, now.spacing)) {
    if (corner.score < settings_.tracking.minimum_score) continue;
    Landmark landmark;
    landmark.level = corner.level;
    landmark.age = 1;
    Sighting sighting;
    sighting.frame = frame;
    sighting.left = corner.pixel;
    landmark.sightings.push_back(sighting);
    landmarks.push_back(std::move(landmark));
  }
}

/// Where the landmark's last sighting may be in the right image.
std::optional<AffineAlignment> LandmarkTracker::startInRight(const Landmark& landmark, const StereoView& view,
                                                             double inverse_depth) const {
  const Eigen::Vector2d& left = landmark.last().left;
  AffineAlignment start;
  if (inverse_depth > 0.0) {
    const Projection expected =
        projectLandmark(camera_, view.T_right_left, bearingOf(camera_, left), inverse_depth);
    if (!expected.valid) return std::nullopt;
    start.position = expected.pixel;
    start.warp = landmark.stereo_warp;
    // Where rows stay, nothing would undo what a moving right camera has made of them before.
    if (view.warp_model == WarpModel::stereo) start.warp.row(1) = Eigen::RowVector2d::UnitY();
  } else {
    const EpipolarLine line = epipolarLine(camera_, view.T_right_left, left);
    const auto found =
        cartvo::matchStereo(view.left, view.right, left, settings_.stereo, line, landmark.level);
    if (!found) return std::nullopt;
    start.position = found->right;
  }
  if (!view.right.grey.front().contains(start.position)) return std::nullopt;
  return start;
}

/// In the camera of the newest pair, of landmarks with a depth and a host in the window; else 0.
double LandmarkTracker::expectedInverseDepth(const Landmark& landmark, const Scene& scene) const {
  const int host = placeOf(scene.window, landmark.host().frame);
  if (!landmark.hasDepth() || host < 0) return 0.0;
  const Projection seen = projectLandmark(camera_, scene.T_camera_frame[static_cast<std::size_t>(host)],
                                          bearingOf(camera_, landmark.host().left), landmark.inverse_depth);
  return seen.valid ? std::max(landmark.inverse_depth, 1e-4) / seen.ray.z() : 0.0;
}

void LandmarkTracker::matchBlock(std::span<Landmark> landmarks, const Scene& scene,
                                 const StereoView& view) const {
  std::array<double, AlignmentBlock::kMost> expected_row{};
  AlignmentBlock block;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const Landmark& landmark = landmarks[i];
    const auto start = startInRight(landmark, view, expectedInverseDepth(landmark, scene));
    if (!start) continue;
    expected_row[i] = start->position.y();
    block.add(i, {view.left, view.right, landmark.level}, landmark.last().left, *start);
  }
  block.align(view.warp_model, settings_.tracking, [&](std::size_t i, const AffineAlignment& aligned) {
    Landmark& landmark = landmarks[i];
    const double row_miss = aligned.position.y() - expected_row[i];
    if (aligned.correlation < settings_.stereo.minimum_correlation ||
        std::abs(row_miss) > kLargestRow * levelScale(landmark.level) ||
        !returns(aligned, settings_.tracking))
      return;
    Sighting& sighting = landmark.sightings.back();
    landmark.stereo_warp = aligned.warp;
    landmark.row_miss = row_miss;
    sighting.stereo = true;
    sighting.parallax = sighting.left - aligned.position;
  });
}

void LandmarkTracker::matchStereo(std::vector<Landmark>& landmarks, const std::vector<WindowFrame>& window,
                                  const ImagePyramid& left, const ImagePyramid& right,
                                  const Eigen::Isometry3d& T_right_left,
                                  const Eigen::Isometry3d& T_world_camera) const {
  const Scene scene(window, left, window.back().index, T_world_camera);
  const StereoView view{left, right, T_right_left, warpModelOf(T_right_left)};
  forEachBlock(landmarks.size(), AlignmentBlock::kMost, [&](std::size_t first, std::size_t count) {
    matchBlock(std::span(landmarks).subspan(first, count), scene, view);
  });
}

}  // namespace cartvo
