// Whole images: the tiles, and which pixels deserve a second look.
#include "tools/world/renderer.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "tools/world/packet_renderer.hpp"
#include "tools/world/parallel.hpp"

namespace cartvo::world {
namespace {

constexpr int kTile = 20;  // px

/// One ray a pixel: a picture that is right where the surroundings are of one surface, and the surfaces.
struct FirstLook {
  cv::Mat radiance;  ///< CV_32FC1
  cv::Mat surface;   ///< CV_32SC1, see PixelLight
};

/// The first look: one ray a pixel, 4 by 4 pixels a packet.
void renderFirst(PacketRenderer& renderer, const cv::Rect& tile, FirstLook& look) {
  constexpr int kBlock = 4;
  std::array<Pixel, kLanes> pixels;
  std::array<PixelLight, kLanes> light;
  for (int y = tile.y; y < tile.br().y; y += kBlock) {
    for (int x = tile.x; x < tile.br().x; x += kBlock) {
      std::size_t count = 0;
      for (int v = y; v < std::min(y + kBlock, tile.br().y); ++v) {
        for (int u = x; u < std::min(x + kBlock, tile.br().x); ++u)
          pixels[count++] = {u, v};
      }
      renderer.render({pixels.data(), count}, 1, 0, light);
      for (std::size_t i = 0; i < count; ++i) {
        look.radiance.at<float>(pixels[i].y, pixels[i].x) = light[i].radiance;
        look.surface.at<std::int32_t>(pixels[i].y, pixels[i].x) = static_cast<std::int32_t>(light[i].surface);
      }
    }
  }
}

/// Whether a pixel's neighbours show another surface, or light where it has shadow.
bool nearEdge(const cv::Mat& surface, int x, int y) {
  const std::int32_t own = surface.at<std::int32_t>(y, x);
  for (int v = std::max(y - 1, 0); v <= std::min(y + 1, surface.rows - 1); ++v) {
    const auto* row = surface.ptr<std::int32_t>(v);
    for (int u = std::max(x - 1, 0); u <= std::min(x + 1, surface.cols - 1); ++u) {
      if (row[u] != own) return true;
    }
  }
  return false;
}

/// Casts `samples` rays through each of the pixels and mixes what they bring into `radiance`, of which they
/// make up `share`. Returns the pixels that hold more than one surface,
/// foliage aside, where nobody can tell.
std::vector<Pixel> renderAgain(PacketRenderer& renderer, const std::vector<Pixel>& pixels, int samples,
                               std::uint32_t salt, float share, FirstLook& look) {
  std::vector<Pixel> mixed;
  std::array<PixelLight, kLanes> light;
  const auto per_packet = static_cast<std::size_t>(kLanes / samples);
  for (std::size_t i = 0; i < pixels.size(); i += per_packet) {
    const std::size_t count = std::min(per_packet, pixels.size() - i);
    renderer.render({&pixels[i], count}, samples, salt, light);
    for (std::size_t k = 0; k < count; ++k) {
      const Pixel& pixel = pixels[i + k];
      float& value = look.radiance.at<float>(pixel.y, pixel.x);
      value += share * (light[k].radiance - value);
      const auto first = static_cast<std::uint32_t>(look.surface.at<std::int32_t>(pixel.y, pixel.x));
      if (!light[k].foliage && (light[k].mixed || light[k].surface != first)) mixed.push_back(pixel);
    }
  }
  return mixed;
}

/// The second look at a tile: several rays where an edge is near, more where it passes through the pixel.
void renderEdges(PacketRenderer& renderer, int edge_samples, const cv::Rect& tile, FirstLook& look) {
  constexpr int kStep = 2;  // rays at a time
  std::vector<Pixel> edges;
  for (int y = tile.y; y < tile.br().y; ++y) {
    for (int x = tile.x; x < tile.br().x; ++x) {
      if (nearEdge(look.surface, x, y)) edges.push_back({x, y});
    }
  }
  for (int samples = kStep; samples <= edge_samples; samples += kStep) {  // beside the first look's one
    const float share = static_cast<float>(kStep) / static_cast<float>(samples + 1);
    edges = renderAgain(renderer, edges, kStep, static_cast<std::uint32_t>(samples), share, look);
  }
}

}  // namespace

cv::Mat renderRadiance(const Scene& scene, const Lighting& lighting, const TextureStyle& style,
                       const RenderSettings& settings, const View& view) {
  static const SamplePatterns patterns;
  FirstLook look{cv::Mat(view.size, CV_32FC1), cv::Mat(view.size, CV_32SC1)};
  const int columns = (view.size.width + kTile - 1) / kTile;
  const int rows = (view.size.height + kTile - 1) / kTile;
  const auto eachTile = [&](const auto& work) {
    parallelFor(columns * rows, settings.threads, [&](int i) {
      PacketRenderer renderer(scene, lighting, style, view, patterns);
      const cv::Rect tile(i % columns * kTile, i / columns * kTile, kTile, kTile);
      work(renderer, tile & cv::Rect(cv::Point(), view.size));
    });
  };
  eachTile([&](PacketRenderer& renderer, const cv::Rect& tile) { renderFirst(renderer, tile, look); });
  if (settings.edge_samples > 0) {
    eachTile([&](PacketRenderer& renderer, const cv::Rect& tile) {
      renderEdges(renderer, settings.edge_samples, tile, look);
    });
  }
  return look.radiance;
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
