#include "tools/world/renderer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "tools/world/hash.hpp"
#include "tools/world/parallel.hpp"
#include "tools/world/surface_shading.hpp"

namespace cartvo::world {
namespace {

constexpr int kLanes = 16;  // of a ray packet
constexpr int kTile = 20;   // px
constexpr std::uint32_t kSky = RTC_INVALID_GEOMETRY_ID;

struct Pixel {
  int x = 0;
  int y = 0;
};

/// What some rays through a pixel brought back.
struct PixelLight {
  float radiance = 0.0F;
  bool mixed = false;  ///< more than one surface, or partly in shadow
};

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

/// Renders pixels in packets of sixteen rays.
class PacketRenderer {
 public:
  PacketRenderer(const Scene& scene, const Lighting& lighting, const TextureStyle& style, const View& view,
                 const SamplePatterns& patterns)
      : scene_(scene), lighting_(lighting), style_(style), view_(view), patterns_(patterns) {}

  /// Up to 16 / `samples` pixels, `samples` rays through each. `salt` picks other patterns for another pass.
  void render(std::span<const Pixel> pixels, int samples, std::uint32_t salt, std::span<PixelLight> light) {
    castCameraRays(pixels, samples, salt);
    castSunRays(static_cast<int>(pixels.size()) * samples, samples);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      light[i] = gather(pixels[i], static_cast<int>(i) * samples, samples);
    }
  }

 private:
  void castCameraRays(std::span<const Pixel> pixels, int samples, std::uint32_t salt);
  void castSunRays(int rays, int samples);
  PixelLight gather(const Pixel& pixel, int first, int samples) const;
  float pixelAngle(const Pixel& pixel) const {
    const auto x = static_cast<float>(pixel.x);
    const auto y = static_cast<float>(pixel.y);
    return 0.5F * ((view_.rays->direction(x + 0.5F, y) - view_.rays->direction(x - 0.5F, y)).norm() +
                   (view_.rays->direction(x, y + 0.5F) - view_.rays->direction(x, y - 0.5F)).norm());
  }

  const Scene& scene_;
  const Lighting& lighting_;
  const TextureStyle& style_;
  const View& view_;
  const SamplePatterns& patterns_;
  RTCRayHit16 packet_{};
  RTCRay16 shadow_{};
  std::array<Eigen::Vector3f, kLanes> direction_;
  std::array<Eigen::Vector3f, kLanes> position_;
  std::array<Eigen::Vector3f, kLanes> normal_;
  std::array<float, kLanes> sunlit_{};
  alignas(64) std::array<int, kLanes> valid_{};
};

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
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
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
    light.mixed = light.mixed || count < samples;
    if (sky) {
      light.radiance += weight * static_cast<float>(count) * skyRadiance(lighting_, direction, angle);
      continue;
    }
    hit.uv *= inverse;
    hit.position *= inverse;
    hit.normal.normalize();
    hit.depth *= inverse;
    hit.sunlit *= inverse;
    light.mixed = light.mixed || (hit.sunlit > 0.0F && hit.sunlit < 1.0F);
    light.radiance += weight * static_cast<float>(count) *
                      surfaceRadiance(scene_, lighting_, style_, hit, direction * inverse, angle);
  }
  return light;
}

/// A square of the image: all its pixels first, then again those that hold an edge.
void renderTile(PacketRenderer& renderer, const RenderSettings& settings, const cv::Rect& tile,
                cv::Mat& radiance) {
  const int samples = settings.samples_per_pixel;
  const int block_width = samples == 4 ? 2 : 4;
  const int block_height = kLanes / samples / block_width;
  std::array<Pixel, kLanes> pixels;
  std::array<PixelLight, kLanes> light;
  std::vector<Pixel> edges;
  for (int y = tile.y; y < tile.br().y; y += block_height) {
    for (int x = tile.x; x < tile.br().x; x += block_width) {
      std::size_t count = 0;
      for (int v = y; v < std::min(y + block_height, tile.br().y); ++v) {
        for (int u = x; u < std::min(x + block_width, tile.br().x); ++u)
          pixels[count++] = {u, v};
      }
      renderer.render({pixels.data(), count}, samples, 0, light);
      for (std::size_t i = 0; i < count; ++i) {
        radiance.at<float>(pixels[i].y, pixels[i].x) = light[i].radiance;
        if (light[i].mixed) edges.push_back(pixels[i]);
      }
    }
  }
  if (settings.edge_samples == 0) return;
  const auto per_packet = static_cast<std::size_t>(kLanes / settings.edge_samples);
  const float share =
      static_cast<float>(settings.edge_samples) / static_cast<float>(settings.edge_samples + samples);
  for (std::size_t i = 0; i < edges.size(); i += per_packet) {
    const std::size_t count = std::min(per_packet, edges.size() - i);
    renderer.render({&edges[i], count}, settings.edge_samples, 1, light);
    for (std::size_t k = 0; k < count; ++k) {
      float& value = radiance.at<float>(edges[i + k].y, edges[i + k].x);
      value += share * (light[k].radiance - value);
    }
  }
}

}  // namespace

cv::Mat renderRadiance(const Scene& scene, const Lighting& lighting, const TextureStyle& style,
                       const RenderSettings& settings, const View& view) {
  static const SamplePatterns patterns;
  cv::Mat radiance(view.size, CV_32FC1);
  const int columns = (view.size.width + kTile - 1) / kTile;
  const int rows = (view.size.height + kTile - 1) / kTile;
  parallelFor(columns * rows, settings.threads, [&](int i) {
    PacketRenderer renderer(scene, lighting, style, view, patterns);
    const cv::Rect tile(i % columns * kTile, i / columns * kTile, kTile, kTile);
    renderTile(renderer, settings, tile & cv::Rect(cv::Point(), view.size), radiance);
  });
  return radiance;
}

void renderDepthAndMotion(const Scene& scene, const RenderSettings& settings, const View& view,
                          cv::Mat& depth, cv::Mat& moving) {
  depth.create(view.size, CV_32FC1);
  moving.create(view.size, CV_8UC1);
  const Eigen::Vector3f origin = view.T_map_camera.translation();
  const Eigen::Matrix3f turn = view.T_map_camera.linear();
  parallelFor(view.size.height, settings.threads, [&](int y) {
    RTCRayHit16 packet{};
    alignas(64) std::array<int, kLanes> valid{};
    for (int x = 0; x < view.size.width; x += kLanes) {
      const int count = std::min(kLanes, view.size.width - x);
      valid.fill(0);
      for (int lane = 0; lane < count; ++lane) {
        const Eigen::Vector2f d = view.rays->direction(static_cast<float>(x + lane), static_cast<float>(y));
        prepareRay(packet, lane, origin, turn * Eigen::Vector3f(d.x(), d.y(), 1.0F));
        valid[lane] = -1;
      }
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
      rtcIntersect16(valid.data(), scene.handle(), &context, &packet);
      for (int lane = 0; lane < count; ++lane) {
        const std::uint32_t id = packet.hit.instID[0][lane];
        depth.at<float>(y, x + lane) = id == kSky ? 0.0F : packet.ray.tfar[lane];
        moving.at<std::uint8_t>(y, x + lane) = id != kSky && scene.instance(id).moving ? 255 : 0;
      }
    }
  });
}

}  // namespace cartvo::world
