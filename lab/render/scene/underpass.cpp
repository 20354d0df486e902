// Places underpasses on straight stretches of the path, attenuates the light in them and builds their meshes.
#include "lab/render/scene/underpass.hpp"

#include <algorithm>
#include <cmath>

#include "lab/render/scenario_traits.hpp"
#include "lab/render/scene/steps.hpp"
#include "lab/render/surface/patterns.hpp"

namespace cartvo::world {
namespace {

using Eigen::Vector2d;
using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr double kLength = 26.0;         // m
constexpr double kTunnelLength = 37.0;   // m
constexpr double kFirstPosition = 24.0;  // m, earliest start along the path
constexpr double kSpacing = 40.0;        // m between underpasses
constexpr double kMaxCurvature = 0.012;  // 1/m, of a stretch that counts as straight
constexpr double kClearance = 3.9;       // m, from the highest floor to the ceiling
constexpr double kWallThickness = 1.0;   // m
constexpr float kDeckThickness = 1.5F;   // m, of the bridge
constexpr double kPieceLength = 2.0;     // m along the path
constexpr double kBeamSpacing = 4.0;     // m
constexpr float kBeamDepth = 0.35F;      // m, also its width
constexpr std::uint32_t kSeed = 9001U;   // of its finishes

bool isStraight(const Path& path, double from, double to) {
  const std::vector<double> places = stepsBelow(to, from, 1.0);
  return std::all_of(places.begin(), places.end(),
                     [&](double s) { return std::abs(path.at(s).curvature) < kMaxCurvature; });
}

Underpass underpassAt(const Path& path, const Terrain& terrain, double from, double to) {
  const RoadProfile road;
  Underpass underpass;
  underpass.from = from;
  underpass.to = to;
  const Vector2d a = path.at(from).position;
  const Vector2d b = path.at(underpass.to).position;
  underpass.middle = (0.5 * (a + b)).cast<float>();
  underpass.along = (b - a).normalized().cast<float>();
  underpass.half_length = static_cast<float>(0.5 * (b - a).norm());
  underpass.left = static_cast<float>(road.leftBorder() - 0.3);
  underpass.right = static_cast<float>(road.rightBorder() + 0.3);
  double highest = -1e9;
  for (const double s : stepsBelow(underpass.to, from, kPieceLength)) {
    const Vector2d p = path.at(s).position;
    highest = std::max(highest, terrain.height(p.x(), p.y()));
  }
  underpass.ceiling = static_cast<float>(highest + kClearance);
  return underpass;
}

/// Fraction of light from one end at `depth` m inside (negative: outside): the solid angle of a round opening
/// of the same size.
float lightFromEnd(float depth) {
  constexpr float kOpeningRadius = 4.2F;
  if (depth < 0.0F) return 1.0F - 0.5F * std::exp(depth / 0.8F);
  return 0.5F * (1.0F - depth / std::sqrt(depth * depth + kOpeningRadius * kOpeningRadius));
}

/// Adds the parts of an underpass. Places are `s` along the path and `lateral` to its left, m.
class UnderpassBuilder {
 public:
  UnderpassBuilder(Mesh& mesh, const Underpass& underpass, const Path& path, const Terrain& terrain)
      : mesh_(mesh),
        path_(path),
        terrain_(terrain),
        from_(underpass.from),
        to_(underpass.to),
        left_(underpass.left),
        right_(underpass.right),
        ceiling_(underpass.ceiling) {}

  void addWallsAndDeck() {
    for (const double s : stepsBelow(to_ - 0.01, from_, kPieceLength)) {
      const double next = std::min(s + kPieceLength, to_);
      const auto u0 = static_cast<float>(s);
      const auto u1 = static_cast<float>(next);
      const auto wall = [&](double lateral, float z, const Finish& finish) {
        const float f0 = foot(s, lateral);
        const float f1 = foot(next, lateral);
        mesh_.addQuad({at(s, lateral, f0), at(next, lateral, f1), at(next, lateral, z), at(s, lateral, z)},
                      {Vector2f(u0, f0), Vector2f(u1, f1), Vector2f(u1, z), Vector2f(u0, z)}, finish);
      };
      const auto slab = [&](double from, double to, float z) {
        const auto v0 = static_cast<float>(from) + 20.0F;
        const auto v1 = static_cast<float>(to) + 20.0F;
        mesh_.addQuad({at(s, from, z), at(next, from, z), at(next, to, z), at(s, to, z)},
                      Mesh::rectangle(u0, v0, u1, v1), deck_);
      };
      wall(left_, ceiling_, brick_);
      wall(right_, ceiling_, brick_);
      wall(left_ + kWallThickness, top_, face_);
      wall(right_ - kWallThickness, top_, face_);
      slab(right_, left_, ceiling_);
      slab(right_ - kWallThickness, left_ + kWallThickness, top_);
    }
  }
  /// Below the ceiling.
  void addBeams() {
    const float low = ceiling_ - kBeamDepth;
    for (const double s : stepsBelow(to_ - 1.0, from_ + 2.0, kBeamSpacing)) {
      const double end = s + kBeamDepth;
      addAcross(s, right_, left_, low, ceiling_, deck_);
      addAcross(end, right_, left_, low, ceiling_, deck_);
      mesh_.addPlane({at(s, right_, low), at(s, left_, low), at(end, left_, low), at(end, right_, low)},
                     deck_);
    }
  }
  /// Pillars and the edge of the deck.
  void addEnds() {
    for (const double s : {from_, to_}) {
      addAcross(s, left_, left_ + kWallThickness, foot(s, left_), ceiling_, face_);
      addAcross(s, right_ - kWallThickness, right_, foot(s, right_), ceiling_, face_);
      addAcross(s, right_ - kWallThickness, left_ + kWallThickness, ceiling_, top_, face_);
    }
  }

 private:
  Vector3f at(double s, double lateral, float z) const { return pointAt(path_.at(s).beside(lateral), z); }
  /// Height of a wall's foot, 0.4 m below the ground.
  float foot(double s, double lateral) const {
    const Vector2d p = path_.at(s).beside(lateral);
    return static_cast<float>(terrain_.height(p.x(), p.y()) - 0.4);
  }
  /// An upright face across the path.
  void addAcross(double s, double from, double to, float z0, float z1, const Finish& finish) {
    mesh_.addPlane({at(s, from, z0), at(s, to, z0), at(s, to, z1), at(s, from, z1)}, finish);
  }

  Mesh& mesh_;
  const Path& path_;
  const Terrain& terrain_;
  const double from_, to_, left_, right_;
  const float ceiling_;
  const float top_ = ceiling_ + kDeckThickness;
  const Finish brick_{Material::brick, kSeed, 0.35F};
  const Finish deck_{Material::concrete, kSeed + 1, 0.6F};
  const Finish face_{Material::concrete, kSeed + 2, 0.8F};
};

}  // namespace

float Underpass::openness(const Eigen::Vector3f& place) const {
  constexpr float kReach = 4.0F;  // m outside the ends up to which light is reduced
  if (place.z() > ceiling + 0.05F) return 1.0F;
  const Vector2f offset = place.head<2>() - middle;
  const float u = offset.dot(along);
  if (std::abs(u) > half_length + kReach) return 1.0F;
  const float v = along.x() * offset.y() - along.y() * offset.x();
  const float beside = std::max(v - left, right - v);
  if (beside > 1.5F) return 1.0F;
  const float inside = std::min(lightFromEnd(half_length - u) + lightFromEnd(half_length + u), 1.0F);
  return inside + (1.0F - inside) * smoothStep(0.2F, 1.5F, beside);
}

std::vector<Underpass> underpasses(const Path& path, const WorldSettings& settings) {
  std::vector<Underpass> found;
  const ScenarioTraits traits = traitsOf(settings.scenario);
  if (traits.tunnel_exit) {
    const double exit = *traits.tunnel_exit;
    found.push_back(underpassAt(path, traits.terrain, exit - kTunnelLength, exit));
  }
  if (!traits.underpasses) return found;
  double next = kFirstPosition;
  for (const double s : stepsBelow(path.length() - kLength - kFirstPosition, kFirstPosition, 1.0)) {
    if (s < next || !isStraight(path, s - 3.0, s + kLength + 3.0)) continue;
    found.push_back(underpassAt(path, traits.terrain, s, s + kLength));
    next = s + kLength + kSpacing;
  }
  return found;
}

void addUnderpass(Mesh& mesh, const Underpass& underpass, const Path& path, const Terrain& terrain) {
  UnderpassBuilder builder(mesh, underpass, path, terrain);
  builder.addWallsAndDeck();
  builder.addBeams();
  builder.addEnds();
}

Building groundPlan(const Underpass& underpass) {
  Building plan;
  const Vector2f across(-underpass.along.y(), underpass.along.x());
  plan.centre = (underpass.middle + 0.5F * (underpass.left + underpass.right) * across).cast<double>();
  plan.yaw = std::atan2(underpass.along.y(), underpass.along.x());
  plan.length = 2.0 * underpass.half_length;
  plan.depth = underpass.left - underpass.right + 2.0 * kWallThickness;
  return plan;
}

}  // namespace cartvo::world
