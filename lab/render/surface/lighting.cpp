// Sun, sky, clouds and distant hills.
#include "lab/render/surface/lighting.hpp"

#include <algorithm>
#include <cmath>

#include "lab/render/scenario_traits.hpp"
#include "lab/render/surface/hash.hpp"
#include "lab/render/surface/noise.hpp"
#include "lab/render/surface/patterns.hpp"

namespace cartvo::world {
namespace {

constexpr float kSunRadius = 0.0047F;  // rad

/// Fraction of the light below a lamp that reaches `place`; lamps hang at multiples of `spacing` in x and y.
float lampLight(const Eigen::Vector3f& place, float spacing) {
  constexpr float kBetweenLamps = 0.35F;  // fraction where no lamp is near
  constexpr float kRadius = 0.3F;         // of a lamp's pool of light, in units of the spacing
  const Eigen::Vector2f cell = place.head<2>() / spacing;
  const Eigen::Vector2f offset(cell.x() - std::round(cell.x()), cell.y() - std::round(cell.y()));
  return kBetweenLamps + (1.0F - kBetweenLamps) * std::exp(-offset.squaredNorm() / (kRadius * kRadius));
}

/// Radiance of the sun's disc and the bright haze around it; `width`: the pixel's angle, rad.
float sunRadiance(const Lighting& lighting, const Eigen::Vector3f& direction, float width) {
  const float angle = (direction - lighting.to_sun).norm();
  // The disc is drawn at least as large as the pixel, with the same total light.
  const float radius = std::max(kSunRadius, 0.56F * width);
  const float share = std::clamp((radius - angle) / width + 0.5F, 0.0F, 1.0F);
  const float disc = lighting.sun / (radius * radius);  // pi times irradiance over the solid angle
  const float haze = 2.5F * std::exp(-angle / 0.05F) + 1.2F * std::exp(-angle / 0.25F);
  return share * disc + lighting.sky * haze;
}

}  // namespace

Lighting buildLighting(const WorldSettings& settings, const Path& path) {
  Lighting lighting;
  Random random(hashOf({static_cast<std::uint32_t>(settings.seed), 601U}));
  double azimuth = random.uniform(0.0, 6.28);
  double elevation = random.uniform(0.60, 0.95);
  const ScenarioTraits traits = traitsOf(settings.scenario);
  if (traits.low_sun) {
    const Eigen::Vector2d ahead = path.at(30.0).tangent;
    azimuth = std::atan2(ahead.y(), ahead.x()) + traits.low_sun->bearing + 0.08 * (azimuth - 3.14);
    elevation = traits.low_sun->elevation + 0.1 * (elevation - 0.60);
    lighting.glare = true;
  }
  lighting.underpasses = underpasses(path, settings);
  lighting.to_sun = Eigen::Vector3d(std::cos(azimuth) * std::cos(elevation),
                                    std::sin(azimuth) * std::cos(elevation), std::sin(elevation))
                        .cast<float>();
  lighting.clouds = random.real(0.35, 0.75);
  lighting.seed = random.bits();
  lighting.sun = traits.light.sun;
  lighting.sky = traits.light.sky;
  lighting.ground = traits.light.ground;
  lighting.lamp_spacing = static_cast<float>(traits.lamp_spacing);
  return lighting;
}

float Lighting::openness(const Eigen::Vector3f& place) const {
  float share = 1.0F;
  for (const Underpass& underpass : underpasses)
    share *= underpass.openness(place);
  if (lamp_spacing > 0.0F) share *= lampLight(place, lamp_spacing);
  return share;
}

float skyRadiance(const Lighting& lighting, const Eigen::Vector3f& direction, float footprint) {
  const Eigen::Vector3f d = direction.normalized();
  // The cloud layer is curved, so that it stays finite at the horizon.
  const float height = std::max(d.z(), 0.0F) + 0.09F;
  const float x = d.x() / height;
  const float y = d.y() / height;
  const float n = noise(x, y, footprint / height, {3.2F, 0.02F, 0.75F}, lighting.seed);
  const float cover = smoothStep(0.9F - 2.2F * lighting.clouds, 2.3F - 2.2F * lighting.clouds, n);
  const float clear = 1.1F - 0.75F * smoothStep(0.0F, 0.6F, d.z());
  const float cloud = 2.1F + 0.55F * std::min(n, 1.5F);
  float radiance = lighting.sky * (clear + (cloud - clear) * cover);
  if (lighting.glare) radiance += sunRadiance(lighting, d, footprint);

  constexpr float kAboveHills = 0.12F;
  if (d.z() - footprint > kAboveHills) return radiance;
  const float azimuth = std::atan2(d.y(), d.x());
  const float along = 4.0F * azimuth;
  const auto ridge = unfadedNoises(along, 0.3F, {1.9F, 0.61F, 0.13F, 0.033F}, lighting.seed + 1U);
  const float crest = 0.035F + 0.022F * ridge[0] + 0.008F * ridge[1] + 0.003F * ridge[2] + 0.0012F * ridge[3];
  const float wooded = 1.0F - filteredStep(crest, d.z(), std::max(footprint, 1e-4F));
  if (wooded > 0.0F) {
    const float trees =
        noise(azimuth * 100.0F, d.z() * 100.0F, footprint * 100.0F, {6.4F, 0.2F, 0.9F}, lighting.seed + 2U);
    const float hill = lighting.sky * 0.45F * std::exp(0.35F * std::clamp(trees, -2.0F, 2.0F));
    radiance += wooded * (hill - radiance);
  }
  return radiance;
}

}  // namespace cartvo::world
