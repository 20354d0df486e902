// Shades a surface hit: pixel footprint on the surface, filtered texture, light of sun and sky.
#include "lab/render/surface/surface_shading.hpp"

#include <algorithm>
#include <cmath>

#include "lab/render/surface/hash.hpp"
#include "lab/render/surface/patterns.hpp"

namespace cartvo::world {
namespace {

constexpr int kMaxTaps = 2;               // texture samples along the footprint's longer axis
constexpr float kMaxAspectRatio = 24.0F;  // of a footprint, length over width

/// A pixel's footprint on a surface: its long and short axis in texture coordinates, m.
struct Footprint {
  Eigen::Vector2f along{0, 0};
  Eigen::Vector2f across{0, 0};
  Eigen::Vector3f along_campus{0, 0, 0};
  float length = 0.0F;  ///< m
  float width = 0.0F;   ///< m
};

Footprint footprintOf(const Scene& scene, const SurfaceHit& hit, const Eigen::Vector3f& direction,
                      float pixel_angle) {
  Footprint footprint;
  const QuadShading& quad = scene.shading(hit.instance, hit.quad);
  const Eigen::Matrix3f& turn = scene.directions(hit.instance, hit.time);
  const Eigen::Vector3f d = direction.normalized();
  const float facing = std::max(std::abs(d.dot(hit.normal)), 1.0F / kMaxAspectRatio);
  footprint.width = hit.depth * pixel_angle;
  footprint.length = footprint.width / facing;
  Eigen::Vector3f along = d - d.dot(hit.normal) * hit.normal;
  const float norm = along.norm();
  along = norm > 1e-4F ? Eigen::Vector3f(along / norm) : hit.normal.unitOrthogonal();
  const Eigen::Vector3f across = hit.normal.cross(along);
  const Eigen::Vector3f gu = turn * quad.gradient_u;
  const Eigen::Vector3f gv = turn * quad.gradient_v;
  footprint.along = footprint.length * Eigen::Vector2f(gu.dot(along), gv.dot(along));
  footprint.across = footprint.width * Eigen::Vector2f(gu.dot(across), gv.dot(across));
  footprint.along_campus = footprint.length * along;
  return footprint;
}

float toneOf(const Finish& finish, const Instance& instance) {
  const bool own = finish.material == Material::paint || finish.material == Material::cloth ||
                   finish.material == Material::leaf;
  return own ? std::clamp(finish.tone + instance.tone_shift, 0.0F, 1.0F) : finish.tone;
}

/// Fraction of the ambient light that reaches the point; walls near the ground see less of the sky.
float openness(const Finish& finish, const SurfaceHit& hit) {
  switch (finish.material) {
    case Material::brick:
    case Material::concrete:
    case Material::plaster:
      return 0.6F + 0.4F * smoothStep(0.0F, 1.6F, hit.uv.y());
    case Material::rubber:
      return 0.5F;
    case Material::leaf:
      return 0.35F + 0.65F * finish.tone;
    default:
      return 1.0F;
  }
}

}  // namespace

float sunFactor(Material material, const Eigen::Vector3f& normal, const Eigen::Vector3f& to_sun) {
  const float facing = normal.dot(to_sun);
  if (material == Material::leaf) return facing > 0.0F ? 0.35F + 0.65F * facing : 0.35F - 0.35F * facing;
  return std::max(facing, 0.0F);
}

float surfaceRadiance(const Scene& scene, const Lighting& lighting, const TextureStyle& style,
                      const SurfaceHit& hit, const Eigen::Vector3f& direction, float pixel_angle) {
  const QuadShading& quad = scene.shading(hit.instance, hit.quad);
  const Instance& instance = scene.instance(hit.instance);
  const Finish& finish = quad.finish;
  const Footprint footprint = footprintOf(scene, hit, direction, pixel_angle);
  const bool plain = finish.material == Material::leaf || finish.material == Material::rubber;
  const float slant = footprint.length / footprint.width;
  const int taps = plain ? 1 : std::clamp(static_cast<int>(std::lround(slant)), 1, kMaxTaps);
  const float share = 1.0F / static_cast<float>(taps);

  SurfacePoint point;
  point.seed = instance.seed == 0 ? finish.seed : mixBits(finish.seed ^ instance.seed);
  point.tone = toneOf(finish, instance);
  // Footprint of one tap for fading the noise: weighted mean of width and length, closer to the length.
  const float tap_length = footprint.length * share;
  point.footprint = std::max(footprint.width, 0.35F * footprint.width + 0.65F * tap_length);
  point.width_u = std::max(std::abs(footprint.along.x()) * share + std::abs(footprint.across.x()), 1e-5F);
  point.width_v = std::max(std::abs(footprint.along.y()) * share + std::abs(footprint.across.y()), 1e-5F);
  point.z = hit.position.z();
  float albedo = 0.0F;
  for (int tap = 0; tap < taps; ++tap) {
    const float shift = (static_cast<float>(tap) + 0.5F) * share - 0.5F;
    point.u = hit.uv.x() + shift * footprint.along.x();
    point.v = hit.uv.y() + shift * footprint.along.y();
    point.x = hit.position.x() + shift * footprint.along_campus.x();
    point.y = hit.position.y() + shift * footprint.along_campus.y();
    albedo += reflectance(finish.material, point, style);
  }
  albedo *= share;
  const float direct = lighting.sun * hit.sunlit * sunFactor(finish.material, hit.normal, lighting.to_sun);
  return albedo *
         (direct + lighting.ambient(hit.normal) * openness(finish, hit) * lighting.openness(hit.position));
}

}  // namespace cartvo::world
