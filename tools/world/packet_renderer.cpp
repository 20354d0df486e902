// One packet of rays from the camera to the surfaces, from there to the sun, and the light they bring back.
#include "tools/world/packet_renderer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/world/hash.hpp"

namespace cartvo::world {
namespace {

constexpr float kShadowReach = 400.0F;  // m

}  // namespace

void prepareRay(RTCRayHit16& packet, int lane, const Eigen::Vector3f& origin,
                const Eigen::Vector3f& direction) {
  packet.ray.org_x[lane] = origin.x();
  packet.ray.org_y[lane] = origin.y();
  packet.ray.org_z[lane] = origin.z();
  packet.ray.dir_x[lane] = direction.x();
  packet.ray.dir_y[lane] = direction.y();
  packet.ray.dir_z[lane] = direction.z();
  packet.ray.tnear[lane] = 0.0F;
  packet.ray.tfar[lane] = std::numeric_limits<float>::infinity();
  packet.ray.time[lane] = 0.0F;
  packet.ray.mask[lane] = 0xffffffffU;
  packet.ray.id[lane] = static_cast<unsigned>(lane);
  packet.ray.flags[lane] = 0;
  packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
  packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
}

void PacketRenderer::castCameraRays(std::span<const Pixel> pixels, int samples, std::uint32_t salt) {
  valid_.fill(0);
  const Eigen::Vector3f origin = view_.T_map_camera.translation();
  const Eigen::Matrix3f turn = view_.T_map_camera.linear();
  int lane = 0;
  for (const Pixel& pixel : pixels) {
    const std::uint32_t h =
        hashOf({view_.sample_seed, static_cast<std::uint32_t>(pixel.y * 8192 + pixel.x), salt});
    const Eigen::Vector2f* offsets = patterns_.offsets(samples, h);
    for (int i = 0; i < samples; ++i, ++lane) {
      const Eigen::Vector2f d = view_.rays->direction(static_cast<float>(pixel.x) + offsets[i].x(),
                                                      static_cast<float>(pixel.y) + offsets[i].y());
      direction_[lane] = turn * Eigen::Vector3f(d.x(), d.y(), 1.0F);  // so that tfar is the depth
      prepareRay(packet_, lane, origin, direction_[lane]);
      valid_[lane] = -1;
    }
  }
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  // Neighbouring pixels' single rays go side by side; those of pixels picked for their edges part at once.
  context.flags = samples == 1 ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  rtcIntersect16(valid_.data(), scene_.handle(), &context, &packet_);
}

void PacketRenderer::nameSurfaces(int rays) {
  for (int lane = 0; lane < rays; ++lane) {
    const std::uint32_t instance = packet_.hit.instID[0][lane];
    surface_[lane] = 0;
    sun_known_[lane] = instance == kSky || lighting_.sun <= 0.0F;
    sunlit_[lane] = 0.0F;
    recalled_[lane] = -1.0F;
    if (instance == kSky) continue;
    const QuadShading& quad = scene_.shading(instance, packet_.hit.primID[lane]);
    surface_[lane] = mixBits(instance * 0x9e3779b1U ^ quad.surface) << 2U;
    if (quad.finish.material == Material::leaf) surface_[lane] |= SurfaceName::kLeaf;
    Eigen::Vector3f n(packet_.hit.Ng_x[lane], packet_.hit.Ng_y[lane], packet_.hit.Ng_z[lane]);
    n = (scene_.directions(instance) * n).normalized();
    if (n.dot(direction_[lane]) > 0.0F) n = -n;
    normal_[lane] = n;
    position_[lane] = view_.T_map_camera.translation() + packet_.ray.tfar[lane] * direction_[lane];
    if (sunFactor(quad.finish.material, n, lighting_.to_sun) <= 0.0F) sun_known_[lane] = true;
  }
}

/// Where the pixels around show the same surface, and all of them in the same light, the sample is in that
/// light too; what the pixel's own centre shows need not be shaded again, nor a leaf, which has one tone.
/// A leaf that was not seen before is taken to be in the light of the leaf at the centre.
void PacketRenderer::recall(std::span<const Pixel> pixels, int samples, const FirstLook& known) {
  int lane = 0;
  for (const Pixel& pixel : pixels) {
    const int left = std::max(pixel.x - 1, 0);
    const int right = std::min(pixel.x + 1, known.surface.cols - 1);
    const int top = std::max(pixel.y - 1, 0);
    const int bottom = std::min(pixel.y + 1, known.surface.rows - 1);
    const auto own_name = static_cast<std::uint32_t>(known.surface.at<std::int32_t>(pixel.y, pixel.x));
    for (int sample = 0; sample < samples; ++sample, ++lane) {
      if (surface_[lane] == 0) continue;
      std::uint32_t lights_seen = 0;  // bit 0: in shadow, bit 1: in the sun
      const float* radiance = nullptr;
      for (int y = top; y <= bottom; ++y) {
        const auto* row = known.surface.ptr<std::int32_t>(y);
        for (int x = left; x <= right; ++x) {
          const auto name = static_cast<std::uint32_t>(row[x]);
          if (((name ^ surface_[lane]) & ~SurfaceName::kSunlit) != 0) continue;
          lights_seen |= 1U << (name & SurfaceName::kSunlit);
          const bool own = x == pixel.x && y == pixel.y;
          if (own || (radiance == nullptr && (name & SurfaceName::kLeaf) != 0))
            radiance = known.radiance.ptr<float>(y) + x;
        }
      }
      if (lights_seen == 0 && (surface_[lane] & own_name & SurfaceName::kLeaf) != 0)
        lights_seen = 1U << (own_name & SurfaceName::kSunlit);
      if (lights_seen != 1 && lights_seen != 2) continue;
      sun_known_[lane] = true;
      sunlit_[lane] = lights_seen == 2 ? 1.0F : 0.0F;
      if (radiance != nullptr) recalled_[lane] = *radiance;
    }
  }
}

void PacketRenderer::lookAtSunTogether(int rays) {
  valid_.fill(0);
  bool any = false;
  for (int lane = 0; lane < rays; ++lane) {
    if (sun_known_[lane]) continue;
    const Eigen::Vector3f origin = sunRayOrigin(lane);
    shadow_.org_x[lane] = origin.x();
    shadow_.org_y[lane] = origin.y();
    shadow_.org_z[lane] = origin.z();
    shadow_.dir_x[lane] = lighting_.to_sun.x();
    shadow_.dir_y[lane] = lighting_.to_sun.y();
    shadow_.dir_z[lane] = lighting_.to_sun.z();
    shadow_.tnear[lane] = 0.0F;
    shadow_.tfar[lane] = kShadowReach;
    shadow_.time[lane] = 0.0F;
    shadow_.mask[lane] = 0xffffffffU;
    shadow_.flags[lane] = 0;
    valid_[lane] = -1;
    any = true;
  }
  if (!any) return;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags =
      RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;  // the coherent variant of this call is known to hang
  rtcOccluded16(valid_.data(), scene_.handle(), &context, &shadow_);
  for (int lane = 0; lane < rays; ++lane) {
    if (valid_[lane] != 0 && shadow_.tfar[lane] >= 0.0F) sunlit_[lane] = 1.0F;
  }
}

bool PacketRenderer::seesSun(int lane) const {
  const Eigen::Vector3f origin = sunRayOrigin(lane);
  RTCRay ray{};
  ray.org_x = origin.x();
  ray.org_y = origin.y();
  ray.org_z = origin.z();
  ray.dir_x = lighting_.to_sun.x();
  ray.dir_y = lighting_.to_sun.y();
  ray.dir_z = lighting_.to_sun.z();
  ray.tfar = kShadowReach;
  ray.mask = 0xffffffffU;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene_.handle(), &context, &ray);
  return ray.tfar >= 0.0F;
}

/// A packet pays where most lanes take part; of the second look's rays few need the sun, and those few are
/// far apart.
void PacketRenderer::castSunRays(int rays, int samples) {
  if (samples == 1) {
    lookAtSunTogether(rays);
  } else {
    for (int lane = 0; lane < rays; ++lane) {
      if (!sun_known_[lane] && seesSun(lane)) sunlit_[lane] = 1.0F;
    }
  }
  for (int lane = 0; lane < rays; ++lane) {
    if (sunlit_[lane] > 0.0F) surface_[lane] |= SurfaceName::kSunlit;
  }
}

/// A lone ray that does not pass through the pixel's centre found the surface; shade it where the centre
/// meets it.
void PacketRenderer::moveToCentre(const Pixel& pixel, SurfaceHit& hit, Eigen::Vector3f& direction) const {
  const Eigen::Vector2f d = view_.rays->direction(static_cast<float>(pixel.x), static_cast<float>(pixel.y));
  direction = view_.T_map_camera.linear() * Eigen::Vector3f(d.x(), d.y(), 1.0F);
  const Eigen::Vector3f origin = view_.T_map_camera.translation();
  const float depth = (hit.position - origin).dot(hit.normal) / direction.dot(hit.normal);
  if (!(std::abs(depth - hit.depth) < 0.2F * hit.depth)) return;  // grazing: stay
  const Eigen::Vector3f shift = origin + depth * direction - hit.position;
  const Eigen::Vector3f in_object = scene_.directions(hit.instance).transpose() * shift;
  const QuadShading& quad = scene_.shading(hit.instance, hit.quad);
  hit.uv += Eigen::Vector2f(quad.gradient_u.dot(in_object), quad.gradient_v.dot(in_object));
  hit.position += shift;
  hit.depth = depth;
}

/// The mean of the samples that found the same surface as lane `first` does, from there on; marks them done.
PacketRenderer::Piece PacketRenderer::collect(int first, int end, std::array<bool, kLanes>& done) const {
  Piece piece;
  const std::uint32_t instance = packet_.hit.instID[0][first];
  const std::uint32_t name = surface_[first] & ~SurfaceName::kSunlit;
  piece.hit.instance = instance;
  piece.hit.quad = packet_.hit.primID[first];
  piece.hit.position.setZero();
  piece.hit.normal.setZero();
  piece.hit.depth = 0.0F;
  for (int j = first; j < end; ++j) {
    if (done[j] || (surface_[j] & ~SurfaceName::kSunlit) != name) continue;
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
    light.foliage = light.foliage && (surface_[i] & SurfaceName::kLeaf) != 0;
    if (done[i]) continue;
    if (recalled_[i] >= 0.0F) {
      light.radiance += weight * recalled_[i];
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
