// Renders whole images in tiles: a first pass with one ray per pixel, a second pass with more rays at edges.
#include "lab/render/tracing/renderer.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>
#include <vector>

#include "lab/render/surface/hash.hpp"
#include "lab/render/tracing/packet_renderer.hpp"
#include "lab/render/tracing/parallel.hpp"

namespace cartvo::world {
namespace {

constexpr int kTile = 20;  // px, width and height

/// First pass: one ray per pixel, a packet for each block of 4 by 4 pixels.
void renderFirstPass(PacketRenderer& renderer, const cv::Rect& tile, FirstPass& first_pass) {
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
      renderer.render({pixels.data(), count}, 1, 0, nullptr, light);
      for (std::size_t i = 0; i < count; ++i) {
        first_pass.radiance.at<float>(pixels[i].y, pixels[i].x) = light[i].radiance;
        first_pass.surface.at<std::int32_t>(pixels[i].y, pixels[i].x) =
            static_cast<std::int32_t>(light[i].surface);
      }
    }
  }
}

/// Content of a pixel and its eight neighbours in the first pass.
enum class Neighbourhood : std::uint8_t {
  plain,   ///< one surface with the same sunlight
  leaves,  ///< leaves and the gaps between them
  edge,    ///< several surfaces, or a shadow edge
};

Neighbourhood neighbourhoodOf(const FirstPass& first_pass, int x, int y) {
  // A smaller ratio of radiances is below one grey level.
  constexpr float kMinVisibleRatio = 1.03F;
  const std::int32_t own = first_pass.surface.at<std::int32_t>(y, x);
  bool plain = true;
  int leaves = 0;
  float darkest = first_pass.radiance.at<float>(y, x);
  float brightest = darkest;
  for (int v = std::max(y - 1, 0); v <= std::min(y + 1, first_pass.surface.rows - 1); ++v) {
    const auto* row = first_pass.surface.ptr<std::int32_t>(v);
    const auto* light = first_pass.radiance.ptr<float>(v);
    for (int u = std::max(x - 1, 0); u <= std::min(x + 1, first_pass.surface.cols - 1); ++u) {
      plain = plain && row[u] == own;
      if ((static_cast<std::uint32_t>(row[u]) & SurfaceId::kLeaf) != 0) ++leaves;
      darkest = std::min(darkest, light[u]);
      brightest = std::max(brightest, light[u]);
    }
  }
  if (plain || brightest <= kMinVisibleRatio * darkest) return Neighbourhood::plain;
  constexpr int kMinLeaves = 4;
  return leaves >= kMinLeaves ? Neighbourhood::leaves : Neighbourhood::edge;
}

/// Casts `samples` rays through each of the pixels and blends the result into `radiance` with weight `share`.
/// Returns the pixels that show more than one surface, except pixels of foliage only, where this is always
/// so.
std::vector<Pixel> addSamples(PacketRenderer& renderer, const std::vector<Pixel>& pixels, int samples,
                              std::uint32_t salt, float share, const FirstPass& first_pass,
                              cv::Mat& radiance) {
  std::vector<Pixel> mixed;
  std::array<PixelLight, kLanes> light;
  const auto per_packet = static_cast<std::size_t>(kLanes / samples);
  for (std::size_t i = 0; i < pixels.size(); i += per_packet) {
    const std::size_t count = std::min(per_packet, pixels.size() - i);
    renderer.render({&pixels[i], count}, samples, salt, &first_pass, light);
    for (std::size_t k = 0; k < count; ++k) {
      const Pixel& pixel = pixels[i + k];
      float& value = radiance.at<float>(pixel.y, pixel.x);
      value += share * (light[k].radiance - value);
      const auto first = static_cast<std::uint32_t>(first_pass.surface.at<std::int32_t>(pixel.y, pixel.x));
      if (!light[k].foliage && (light[k].mixed || light[k].surface != first)) mixed.push_back(pixel);
    }
  }
  return mixed;
}

/// Second pass over a tile: several rays near an edge, more where the edge passes through the pixel.
void renderSecondPass(PacketRenderer& renderer, int edge_samples, const cv::Rect& tile,
                      const FirstPass& first_pass, cv::Mat& radiance) {
  constexpr int kStep = 2;  // rays at a time
  std::vector<Pixel> edges;
  std::vector<Pixel> leaves;
  for (int y = tile.y; y < tile.br().y; ++y) {
    for (int x = tile.x; x < tile.br().x; ++x) {
      const Neighbourhood around = neighbourhoodOf(first_pass, x, y);
      if (around == Neighbourhood::edge) edges.push_back({x, y});
      if (around == Neighbourhood::leaves) leaves.push_back({x, y});
    }
  }
  constexpr float kLeavesShare = 2.0F / 3.0F;
  addSamples(renderer, leaves, kStep, 1U, kLeavesShare, first_pass, radiance);
  for (int samples = kStep; samples <= edge_samples;
       samples += kStep) {  // in addition to the ray of the first pass
    const float share = static_cast<float>(kStep) / static_cast<float>(samples + 1);
    std::vector<Pixel> mixed =
        addSamples(renderer, edges, kStep, static_cast<std::uint32_t>(samples), share, first_pass, radiance);
    // Only after half of the rays: with fewer, agreement does not exclude a second surface. A narrow one is
    // missed most of the time and weighs too much where it is hit.
    if (2 * samples >= edge_samples) edges = std::move(mixed);
  }
}

}  // namespace

cv::Mat renderRadiance(const Scene& scene, const Lighting& lighting, const TextureStyle& style,
                       const RenderSettings& settings, const View& view) {
  static const SamplePatterns patterns;
  FirstPass first_pass{cv::Mat(view.size, CV_32FC1), cv::Mat(view.size, CV_32SC1)};
  const int columns = (view.size.width + kTile - 1) / kTile;
  const int rows = (view.size.height + kTile - 1) / kTile;
  const auto for_each_tile = [&](const auto& work) {
    parallelFor(columns * rows, settings.threads, [&](int i) {
      const cv::Rect tile =
          cv::Rect(i % columns * kTile, i / columns * kTile, kTile, kTile) & cv::Rect(cv::Point(), view.size);
      PacketRenderer renderer(scene, lighting, style, view, patterns,
                              {tile.x + tile.width / 2, tile.y + tile.height / 2});
      work(renderer, tile);
    });
  };
  for_each_tile(
      [&](PacketRenderer& renderer, const cv::Rect& tile) { renderFirstPass(renderer, tile, first_pass); });
  if (settings.edge_samples <= 0) return first_pass.radiance;
  cv::Mat radiance = first_pass.radiance.clone();
  for_each_tile([&](PacketRenderer& renderer, const cv::Rect& tile) {
    renderSecondPass(renderer, settings.edge_samples, tile, first_pass, radiance);
  });
  return radiance;
}

void renderDepthAndMotion(const Scene& scene, const RenderSettings& settings, const View& view,
                          cv::Mat& depth, cv::Mat& moving) {
  depth.create(view.size, CV_32FC1);
  moving.create(view.size, CV_8UC1);
  parallelFor(view.size.height, settings.threads, [&](int y) {
    const Eigen::Vector3f origin = view.poseOf(y).translation();
    const Eigen::Matrix3f turn = view.poseOf(y).linear();
    RTCRayHit16 packet{};
    alignas(64) std::array<int, kLanes> valid{};
    for (int x = 0; x < view.size.width; x += kLanes) {
      const int count = std::min(kLanes, view.size.width - x);
      valid.fill(0);
      for (int lane = 0; lane < count; ++lane) {
        const Eigen::Vector2f d = view.rays->direction(static_cast<float>(x + lane), static_cast<float>(y));
        prepareRay(packet, lane, origin, turn * Eigen::Vector3f(d.x(), d.y(), 1.0F), view.timeOf(y));
        valid[lane] = -1;
      }
      RTCIntersectContext context = contextOf(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
      rtcIntersect16(valid.data(), scene.handle(), &context, &packet);
      for (int lane = 0; lane < count; ++lane) {
        const std::uint32_t id = packet.hit.instID[0][lane];
        depth.at<float>(y, x + lane) = id == kSky ? 0.0F : packet.ray.tfar[lane];
        moving.at<std::uint8_t>(y, x + lane) = id != kSky && scene.instance(id).moving ? 255 : 0;
      }
    }
  });
}

SamplePatterns::SamplePatterns() {
  Random random(20161);
  for (std::size_t level = 0; level < patterns_.size(); ++level) {
    const int samples = 1 << level;
    for (int variant = 0; variant < kVariants; ++variant) {
      // Latin hypercube (one point in each row and column) with the largest minimum distance of 12
      // permutations.
      std::vector<Eigen::Vector2f> best;
      float best_distance = -1.0F;
      for (int attempt = 0; attempt < 12; ++attempt) {
        std::vector<int> rows(samples);
        std::iota(rows.begin(), rows.end(), 0);
        for (int i = samples - 1; i > 0; --i)
          std::swap(rows[i], rows[random.below(i + 1)]);
        std::vector<Eigen::Vector2f> points;
        for (int i = 0; i < samples; ++i) {
          const double spread = samples == 1 ? 0.49 : 0.3;
          points.emplace_back(
              (static_cast<float>(i) + 0.5F + random.real(-spread, spread)) / static_cast<float>(samples) -
                  0.5F,
              (static_cast<float>(rows[i]) + 0.5F + random.real(-spread, spread)) /
                      static_cast<float>(samples) -
                  0.5F);
        }
        float nearest = 2.0F;
        for (int i = 0; i < samples; ++i) {
          for (int j = 0; j < i; ++j)
            nearest = std::min(nearest, (points[i] - points[j]).norm());
        }
        if (nearest > best_distance) {
          best_distance = nearest;
          best = points;
        }
      }
      patterns_[level].insert(patterns_[level].end(), best.begin(), best.end());
    }
  }
}

}  // namespace cartvo::world
