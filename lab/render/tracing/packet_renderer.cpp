// Renders one packet of rays: camera rays, surface identification, sun rays, shading.
#include "lab/render/tracing/packet_renderer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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

constexpr float kShadowReach = 400.0F;  // m, length of a sun ray

void setRay(RTCRay16& rays, int lane, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction,
            float length, float time) {
  rays.org_x[lane] = origin.x();
  rays.org_y[lane] = origin.y();
  rays.org_z[lane] = origin.z();
  rays.dir_x[lane] = direction.x();
  rays.dir_y[lane] = direction.y();
  rays.dir_z[lane] = direction.z();
  rays.tnear[lane] = 0.0F;
  rays.tfar[lane] = length;
  rays.time[lane] = time;
  rays.mask[lane] = 0xffffffffU;
  rays.id[lane] = static_cast<unsigned>(lane);
  rays.flags[lane] = 0;
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

void prepareRay(RTCRayHit16& packet, int lane, const Eigen::Vector3f& origin,
                const Eigen::Vector3f& direction, float time) {
  setRay(packet.ray, lane, origin, direction, std::numeric_limits<float>::infinity(), time);
  packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
  packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
}

RTCIntersectContext contextOf(RTCIntersectContextFlags flags) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = flags;
  return context;
}

void PacketRenderer::castCameraRays(std::span<const Pixel> pixels, int samples, std::uint32_t salt) {
  valid_.fill(0);
  int lane = 0;
  for (const Pixel& pixel : pixels) {
    // All rays of a pixel are cast at the instant of its row.
    const Eigen::Isometry3f& T_map_camera = view_.poseOf(pixel.y);
    const Eigen::Vector3f origin = T_map_camera.translation();
    const Eigen::Matrix3f turn = T_map_camera.linear();
    const float time = view_.timeOf(pixel.y);
    const std::uint32_t h =
        hashOf({view_.sample_seed, static_cast<std::uint32_t>(pixel.y * 8192 + pixel.x), salt});
    const Eigen::Vector2f* offsets = patterns_.offsets(samples, h);
    for (int i = 0; i < samples; ++i, ++lane) {
      const Eigen::Vector2f d = view_.rays->direction(static_cast<float>(pixel.x) + offsets[i].x(),
                                                      static_cast<float>(pixel.y) + offsets[i].y());
      direction_[lane] = turn * Eigen::Vector3f(d.x(), d.y(), 1.0F);  // so that tfar is the depth
      time_[lane] = time;
      prepareRay(packet_, lane, origin, direction_[lane], time);
      valid_[lane] = -1;
    }
  }
  // Single rays of neighbouring pixels are coherent; rays of scattered edge pixels are not.
  RTCIntersectContext context =
      contextOf(samples == 1 ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
  rtcIntersect16(valid_.data(), scene_.handle(), &context, &packet_);
}

void PacketRenderer::identifySurfaces(int rays) {
  for (int lane = 0; lane < rays; ++lane) {
    const std::uint32_t instance = packet_.hit.instID[0][lane];
    surface_[lane] = 0;
    sun_is_known_[lane] = instance == kSky || lighting_.sun <= 0.0F;
    sunlit_[lane] = 0.0F;
    reused_radiance_[lane] = -1.0F;
    if (instance == kSky) continue;
    const QuadShading& quad = scene_.shading(instance, packet_.hit.primID[lane]);
    surface_[lane] = mixBits(instance * 0x9e3779b1U ^ quad.surface) << 2U;
    if (quad.finish.material == Material::leaf) surface_[lane] |= SurfaceId::kLeaf;
    Eigen::Vector3f n(packet_.hit.Ng_x[lane], packet_.hit.Ng_y[lane], packet_.hit.Ng_z[lane]);
    n = (scene_.directions(instance, time_[lane]) * n).normalized();
    if (n.dot(direction_[lane]) > 0.0F) n = -n;
    normal_[lane] = n;
    const Eigen::Vector3f origin(packet_.ray.org_x[lane], packet_.ray.org_y[lane], packet_.ray.org_z[lane]);
    position_[lane] = origin + packet_.ray.tfar[lane] * direction_[lane];
    if (sunFactor(quad.finish.material, n, lighting_.to_sun) <= 0.0F) sun_is_known_[lane] = true;
  }
}

/// Copies results of the first pass. Where the surrounding pixels show the sample's surface and agree on
/// whether the sun reaches it, the sample has the same sunlight. The surface at the pixel's own centre is not
/// shaded again, nor is a leaf, which has one tone. A leaf that the first pass did not see gets the sunlight
/// of the leaf at the centre.
void PacketRenderer::reuseFirstPass(std::span<const Pixel> pixels, int samples, const FirstPass& first_pass) {
  int lane = 0;
  for (const Pixel& pixel : pixels) {
    const int left = std::max(pixel.x - 1, 0);
    const int right = std::min(pixel.x + 1, first_pass.surface.cols - 1);
    const int top = std::max(pixel.y - 1, 0);
    const int bottom = std::min(pixel.y + 1, first_pass.surface.rows - 1);
    const auto own_surface =
        static_cast<std::uint32_t>(first_pass.surface.at<std::int32_t>(pixel.y, pixel.x));
    for (int sample = 0; sample < samples; ++sample, ++lane) {
      if (surface_[lane] == 0) continue;
      std::uint32_t lights_seen = 0;  // bit 0: in shadow, bit 1: in the sun
      const float* radiance = nullptr;
      for (int y = top; y <= bottom; ++y) {
        const auto* row = first_pass.surface.ptr<std::int32_t>(y);
        for (int x = left; x <= right; ++x) {
          const auto surface = static_cast<std::uint32_t>(row[x]);
          if (((surface ^ surface_[lane]) & ~SurfaceId::kSunlit) != 0) continue;
          lights_seen |= 1U << (surface & SurfaceId::kSunlit);
          const bool own = x == pixel.x && y == pixel.y;
          if (own || (radiance == nullptr && (surface & SurfaceId::kLeaf) != 0))
            radiance = first_pass.radiance.ptr<float>(y) + x;
        }
      }
      if (lights_seen == 0 && (surface_[lane] & own_surface & SurfaceId::kLeaf) != 0)
        lights_seen = 1U << (own_surface & SurfaceId::kSunlit);
      if (lights_seen != 1 && lights_seen != 2) continue;
      sun_is_known_[lane] = true;
      sunlit_[lane] = lights_seen == 2 ? 1.0F : 0.0F;
      if (radiance != nullptr) reused_radiance_[lane] = *radiance;
    }
  }
}

void PacketRenderer::castSunPacket(int rays) {
  valid_.fill(0);
  bool any = false;
  for (int lane = 0; lane < rays; ++lane) {
    if (sun_is_known_[lane]) continue;
    setRay(shadow_, lane, sunRayOrigin(lane), lighting_.to_sun, kShadowReach, time_[lane]);
    valid_[lane] = -1;
    any = true;
  }
  if (!any) return;
  // The coherent variant of this call is known to stall.
  RTCIntersectContext context = contextOf(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
  rtcOccluded16(valid_.data(), scene_.handle(), &context, &shadow_);
  for (int lane = 0; lane < rays; ++lane) {
    if (valid_[lane] != 0 && shadow_.tfar[lane] >= 0.0F) sunlit_[lane] = 1.0F;
  }
}

bool PacketRenderer::isSunlit(int lane) const {
  const Eigen::Vector3f origin = sunRayOrigin(lane);
  RTCRay ray{};
  ray.org_x = origin.x();
  ray.org_y = origin.y();
  ray.org_z = origin.z();
  ray.dir_x = lighting_.to_sun.x();
  ray.dir_y = lighting_.to_sun.y();
  ray.dir_z = lighting_.to_sun.z();
  ray.tfar = kShadowReach;
  ray.time = time_[lane];
  ray.mask = 0xffffffffU;
  RTCIntersectContext context = contextOf(RTC_INTERSECT_CONTEXT_FLAG_NONE);
  rtcOccluded1(scene_.handle(), &context, &ray);
  return ray.tfar >= 0.0F;
}

/// Casts the missing sun rays: as one packet in the first pass, where most lanes need one; one by one in the
/// second pass, where few do and those are far apart.
void PacketRenderer::castSunRays(int rays, int samples) {
  if (samples == 1) {
    castSunPacket(rays);
  } else {
    for (int lane = 0; lane < rays; ++lane) {
      if (!sun_is_known_[lane] && isSunlit(lane)) sunlit_[lane] = 1.0F;
    }
  }
  for (int lane = 0; lane < rays; ++lane) {
    if (sunlit_[lane] > 0.0F) surface_[lane] |= SurfaceId::kSunlit;
  }
}

/// Moves a single ray's hit to where the ray through the pixel's centre meets the surface.
void PacketRenderer::moveToCentre(const Pixel& pixel, SurfaceHit& hit, Eigen::Vector3f& direction) const {
  const Eigen::Vector2f d = view_.rays->direction(static_cast<float>(pixel.x), static_cast<float>(pixel.y));
  const Eigen::Isometry3f& T_map_camera = view_.poseOf(pixel.y);
  direction = T_map_camera.linear() * Eigen::Vector3f(d.x(), d.y(), 1.0F);
  const Eigen::Vector3f origin = T_map_camera.translation();
  const float depth = (hit.position - origin).dot(hit.normal) / direction.dot(hit.normal);
  if (!(std::abs(depth - hit.depth) < 0.2F * hit.depth)) return;  // grazing view: keep the hit
  const Eigen::Vector3f shift = origin + depth * direction - hit.position;
  const Eigen::Vector3f in_object = scene_.directions(hit.instance, hit.time).transpose() * shift;
  const QuadShading& quad = scene_.shading(hit.instance, hit.quad);
  hit.uv += Eigen::Vector2f(quad.gradient_u.dot(in_object), quad.gradient_v.dot(in_object));
  hit.position += shift;
  hit.depth = depth;
}

/// Averages the samples in [first, end) that hit the surface of lane `first` and marks them done.
PacketRenderer::Piece PacketRenderer::collect(int first, int end, std::array<bool, kLanes>& done) const {
  Piece piece;
  const std::uint32_t instance = packet_.hit.instID[0][first];
  const std::uint32_t surface = surface_[first] & ~SurfaceId::kSunlit;
  piece.hit.instance = instance;
  piece.hit.time = time_[first];
  piece.hit.quad = packet_.hit.primID[first];
  piece.hit.position.setZero();
  piece.hit.normal.setZero();
  piece.hit.depth = 0.0F;
  for (int j = first; j < end; ++j) {
    if (done[j] || (surface_[j] & ~SurfaceId::kSunlit) != surface) continue;
    done[j] = true;
    ++piece.count;
    piece.direction += direction_[j];
    if (instance == kSky) continue;
    const QuadShading& quad = scene_.shading(packet_.hit.instID[0][j], packet_.hit.primID[j]);
    const float u = packet_.hit.u[j];
    const float v = packet_.hit.v[j];
    piece.hit.uv +=
        (1 - u) * ((1 - v) * quad.uv[0] + v * quad.uv[3]) + u * ((1 - v) * quad.uv[1] + v * quad.uv[2]);
    piece.hit.position += position_[j];
    piece.hit.normal += normal_[j];
    piece.hit.depth += packet_.ray.tfar[j];
    piece.hit.sunlit += sunlit_[j];
  }
  const float inverse = 1.0F / static_cast<float>(piece.count);
  piece.direction *= inverse;
  piece.hit.uv *= inverse;
  piece.hit.position *= inverse;
  piece.hit.normal.normalize();
  piece.hit.depth *= inverse;
  piece.hit.sunlit *= inverse;
  return piece;
}

PixelLight PacketRenderer::gather(const Pixel& pixel, int first, int samples) const {
  PixelLight light;
  light.surface = surface_[first];
  std::array<bool, kLanes> done{};
  const float weight = 1.0F / static_cast<float>(samples);
  for (int i = first; i < first + samples; ++i) {
    light.mixed = light.mixed || surface_[i] != light.surface;
    light.foliage = light.foliage && (surface_[i] & SurfaceId::kLeaf) != 0;
    if (done[i]) continue;
    if (reused_radiance_[i] >= 0.0F) {
      light.radiance += weight * reused_radiance_[i];
      done[i] = true;
      continue;
    }
    Piece piece = collect(i, first + samples, done);
    const float share = weight * static_cast<float>(piece.count);
    if (surface_[i] == 0) {
      light.radiance += share * skyRadiance(lighting_, piece.direction, pixel_angle_);
      continue;
    }
    if (samples == 1) moveToCentre(pixel, piece.hit, piece.direction);
    light.radiance +=
        share * surfaceRadiance(scene_, lighting_, style_, piece.hit, piece.direction, pixel_angle_);
  }
  return light;
}

}  // namespace cartvo::world
