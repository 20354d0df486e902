// One packet of rays from the camera to the surfaces, from there to the sun, and the light they bring back.
#include "tools/world/packet_renderer.hpp"

#include <cmath>
#include <limits>

#include "tools/world/hash.hpp"

namespace cartvo::world {

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
  context.flags = salt == 0 ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  rtcIntersect16(valid_.data(), scene_.handle(), &context, &packet_);
}

void PacketRenderer::castSunRays(int rays, int samples) {
  valid_.fill(0);
  bool any = false;
  const Eigen::Vector3f side = lighting_.to_sun.unitOrthogonal();
  const Eigen::Vector3f up = lighting_.to_sun.cross(side);
  for (int lane = 0; lane < rays; ++lane) {
    const std::uint32_t instance = packet_.hit.instID[0][lane];
    sunlit_[lane] = 0.0F;
    if (instance == kSky) continue;
    Eigen::Vector3f n(packet_.hit.Ng_x[lane], packet_.hit.Ng_y[lane], packet_.hit.Ng_z[lane]);
    n = (scene_.directions(instance) * n).normalized();
    if (n.dot(direction_[lane]) > 0.0F) n = -n;
    const float depth = packet_.ray.tfar[lane];
    normal_[lane] = n;
    position_[lane] = view_.T_map_camera.translation() + depth * direction_[lane];
    if (lighting_.sun <= 0.0F) continue;
    const Material material = scene_.shading(instance, packet_.hit.primID[lane]).finish.material;
    if (sunFactor(material, n, lighting_.to_sun) <= 0.0F) continue;
    // The sun is a disc of half a degree: each of a pixel's samples looks at another part of it.
    const float angle = 2.4F * static_cast<float>(lane % samples);
    const float radius =
        0.0047F * std::sqrt((static_cast<float>(lane % samples) + 0.5F) / static_cast<float>(samples));
    const Eigen::Vector3f to_sun =
        lighting_.to_sun + radius * (std::cos(angle) * side + std::sin(angle) * up);
    const Eigen::Vector3f origin = position_[lane] + (0.002F + 2e-4F * depth) * n;
    shadow_.org_x[lane] = origin.x();
    shadow_.org_y[lane] = origin.y();
    shadow_.org_z[lane] = origin.z();
    shadow_.dir_x[lane] = to_sun.x();
    shadow_.dir_y[lane] = to_sun.y();
    shadow_.dir_z[lane] = to_sun.z();
    shadow_.tnear[lane] = 0.0F;
    shadow_.tfar[lane] = 400.0F;
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

PixelLight PacketRenderer::gather(const Pixel& pixel, int first, int samples) const {
  PixelLight light;
  const float angle = pixelAngle(pixel);
  std::array<bool, kLanes> done{};
  const float weight = 1.0F / static_cast<float>(samples);
  for (int i = first; i < first + samples; ++i) {
    if (done[i]) continue;
    const std::uint32_t instance = packet_.hit.instID[0][i];
    const bool sky = instance == kSky;
    const std::uint32_t surface = sky ? 0 : scene_.shading(instance, packet_.hit.primID[i]).surface;
    SurfaceHit hit;
    hit.instance = instance;
    hit.quad = packet_.hit.primID[i];
    hit.position.setZero();
    hit.normal.setZero();
    hit.depth = 0.0F;
    Eigen::Vector3f direction = Eigen::Vector3f::Zero();
    int count = 0;
    for (int j = i; j < first + samples; ++j) {
      if (done[j] || packet_.hit.instID[0][j] != instance) continue;
      if (!sky) {
        const QuadShading& quad = scene_.shading(instance, packet_.hit.primID[j]);
        if (quad.surface != surface) continue;
        const float u = packet_.hit.u[j];
        const float v = packet_.hit.v[j];
        hit.uv +=
            (1 - u) * ((1 - v) * quad.uv[0] + v * quad.uv[3]) + u * ((1 - v) * quad.uv[1] + v * quad.uv[2]);
        hit.position += position_[j];
        hit.normal += normal_[j];
        hit.depth += packet_.ray.tfar[j];
        hit.sunlit += sunlit_[j];
      }
      direction += direction_[j];
      done[j] = true;
      ++count;
    }
    const float inverse = 1.0F / static_cast<float>(count);
    if (i == first)
      light.surface = sky ? 0U : (hashOf({instance, surface}) & ~1U) | (sunlit_[i] > 0.0F ? 1U : 0U);
    light.mixed = light.mixed || count < samples;
    light.foliage =
        light.foliage && !sky && scene_.shading(instance, hit.quad).finish.material == Material::leaf;
    if (sky) {
      light.radiance += weight * static_cast<float>(count) * skyRadiance(lighting_, direction, angle);
      continue;
    }
    hit.uv *= inverse;
    hit.position *= inverse;
    hit.normal.normalize();
    hit.depth *= inverse;
    hit.sunlit *= inverse;
    if (samples == 1) moveToCentre(pixel, hit, direction);
    light.mixed = light.mixed || (hit.sunlit > 0.0F && hit.sunlit < 1.0F);
    light.radiance += weight * static_cast<float>(count) *
                      surfaceRadiance(scene_, lighting_, style_, hit, direction * inverse, angle);
  }
  return light;
}

}  // namespace cartvo::world
