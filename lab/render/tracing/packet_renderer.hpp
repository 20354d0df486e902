#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>

#include <embree3/rtcore.h>

#include "lab/render/surface/lighting.hpp"
#include "lab/render/surface/material.hpp"
#include "lab/render/tracing/renderer.hpp"
#include "lab/render/tracing/scene.hpp"

namespace cartvo::world {

/// The part of one surface that one pixel shows.
struct SurfaceHit {
  std::uint32_t instance = 0;
  std::uint32_t quad = 0;
  float time = 0.0F;                  ///< see View::timeOf
  Eigen::Vector2f uv{0, 0};           ///< texture coordinates, m
  Eigen::Vector3f position{0, 0, 0};  ///< m, campus axes
  Eigen::Vector3f normal{0, 0, 1};    ///< unit length, toward the camera
  float depth = 1.0F;                 ///< m along the camera's z axis
  float sunlit = 0.0F;                ///< fraction of the part that the sun reaches, 0..1
};

/// Radiance of the surface along -`direction`; `pixel_angle`: width of the pixel on the plane z = 1.
float surfaceRadiance(const Scene& scene, const Lighting& lighting, const TextureStyle& style,
                      const SurfaceHit& hit, const Eigen::Vector3f& direction, float pixel_angle);

/// Cosine factor of the sun's light on a surface; leaves also transmit light from behind.
float sunFactor(Material material, const Eigen::Vector3f& normal, const Eigen::Vector3f& to_sun);

constexpr int kLanes = 16;                               ///< rays in a packet
constexpr std::uint32_t kSky = RTC_INVALID_GEOMETRY_ID;  ///< instance of a ray without a hit

/// Image coordinates of a pixel.
struct Pixel {
  int x = 0;
  int y = 0;
};

/// A surface identifier is a hash with two flag bits; 0: sky.
struct SurfaceId {
  static constexpr std::uint32_t kSunlit = 1;  ///< the sun reaches the surface
  static constexpr std::uint32_t kLeaf = 2;    ///< the surface is a leaf
};

/// Result of several rays through a pixel.
struct PixelLight {
  float radiance = 0.0F;
  bool mixed = false;         ///< more than one surface, or partly in shadow
  bool foliage = true;        ///< only leaves
  std::uint32_t surface = 0;  ///< surface of the first ray, see SurfaceId
};

/// Result of the first pass, one ray per pixel: correct where a pixel's neighbourhood shows one surface.
struct FirstPass {
  cv::Mat radiance;  ///< CV_32FC1
  cv::Mat surface;   ///< CV_32SC1, see SurfaceId
};

/// Initialises one lane of a packet with a ray that has no hit yet; `time` as in View::timeOf.
void prepareRay(RTCRayHit16& packet, int lane, const Eigen::Vector3f& origin,
                const Eigen::Vector3f& direction, float time);

/// Neighbouring rays of an image are coherent.
RTCIntersectContext contextOf(RTCIntersectContextFlags flags);

/// Renders pixels in packets of sixteen rays. The pixel size at `middle` is used for all of them, so they
/// must be near it.
class PacketRenderer {
 public:
  PacketRenderer(const Scene& scene, const Lighting& lighting, const TextureStyle& style, const View& view,
                 const SamplePatterns& patterns, const Pixel& middle)
      : scene_(scene),
        lighting_(lighting),
        style_(style),
        view_(view),
        patterns_(patterns),
        pixel_angle_(pixelAngle(middle)) {}

  /// Renders up to 16 / `samples` pixels with `samples` rays each. `salt` selects the sample patterns of the
  /// pass. Results of `first_pass` (null: none) are reused where they apply.
  void render(std::span<const Pixel> pixels, int samples, std::uint32_t salt, const FirstPass* first_pass,
              std::span<PixelLight> light) {
    castCameraRays(pixels, samples, salt);
    identifySurfaces(static_cast<int>(pixels.size()) * samples);
    if (first_pass != nullptr) reuseFirstPass(pixels, samples, *first_pass);
    castSunRays(static_cast<int>(pixels.size()) * samples, samples);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      light[i] = gather(pixels[i], static_cast<int>(i) * samples, samples);
    }
  }

 private:
  void castCameraRays(std::span<const Pixel> pixels, int samples, std::uint32_t salt);
  void identifySurfaces(int rays);
  void reuseFirstPass(std::span<const Pixel> pixels, int samples, const FirstPass& first_pass);
  void castSunRays(int rays, int samples);
  Eigen::Vector3f sunRayOrigin(int lane) const {
    return position_[lane] + (0.002F + 2e-4F * packet_.ray.tfar[lane]) * normal_[lane];
  }
  void castSunPacket(int rays);
  bool isSunlit(int lane) const;
  /// Mean of the samples of a pixel that hit one surface.
  struct Piece {
    SurfaceHit hit;
    Eigen::Vector3f direction{0, 0, 0};
    int count = 0;
  };
  Piece collect(int first, int end, std::array<bool, kLanes>& done) const;
  PixelLight gather(const Pixel& pixel, int first, int samples) const;
  void moveToCentre(const Pixel& pixel, SurfaceHit& hit, Eigen::Vector3f& direction) const;
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
  const float pixel_angle_;  ///< width of a pixel on the plane z = 1
  RTCRayHit16 packet_{};
  RTCRay16 shadow_{};
  std::array<Eigen::Vector3f, kLanes> direction_;
  std::array<float, kLanes> time_{};  ///< see View::timeOf
  std::array<Eigen::Vector3f, kLanes> position_;
  std::array<Eigen::Vector3f, kLanes> normal_;
  std::array<float, kLanes> sunlit_{};
  std::array<bool, kLanes> sun_is_known_{};
  std::array<std::uint32_t, kLanes> surface_{};
  std::array<float, kLanes> reused_radiance_{};  ///< radiance copied from the first pass; < 0: none
  alignas(64) std::array<int, kLanes> valid_{};
};

}  // namespace cartvo::world
