#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>

#include <embree3/rtcore.h>

#include "tools/world/renderer.hpp"
#include "tools/world/surface_shading.hpp"

namespace cartvo::world {

constexpr int kLanes = 16;                               ///< of a ray packet
constexpr std::uint32_t kSky = RTC_INVALID_GEOMETRY_ID;  ///< the instance of a ray that met nothing

/// A pixel's place in the image.
struct Pixel {
  int x = 0;
  int y = 0;
};

/// A surface's name with whether the sun reaches it and whether it is a leaf; 0: sky.
struct SurfaceName {
  static constexpr std::uint32_t kSunlit = 1;
  static constexpr std::uint32_t kLeaf = 2;
};

/// What some rays through a pixel brought back.
struct PixelLight {
  float radiance = 0.0F;
  bool mixed = false;         ///< more than one surface, or partly in shadow
  bool foliage = true;        ///< nothing but leaves
  std::uint32_t surface = 0;  ///< of the first ray, see SurfaceName
};

/// One ray a pixel: a picture that is right where the surroundings are of one surface, and the surfaces.
struct FirstLook {
  cv::Mat radiance;  ///< CV_32FC1
  cv::Mat surface;   ///< CV_32SC1, see SurfaceName
};

/// Fills one lane with a ray that has met nothing yet.
void prepareRay(RTCRayHit16& packet, int lane, const Eigen::Vector3f& origin,
                const Eigen::Vector3f& direction);

/// Renders pixels in packets of sixteen rays, all near `middle`: they take the size of their pixels from it.
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

  /// Up to 16 / `samples` pixels, `samples` rays through each. `salt` picks other patterns for another pass.
  /// What `known` (null: nothing) already tells of the surfaces that the rays find is not worked out again.
  void render(std::span<const Pixel> pixels, int samples, std::uint32_t salt, const FirstLook* known,
              std::span<PixelLight> light) {
    castCameraRays(pixels, samples, salt);
    nameSurfaces(static_cast<int>(pixels.size()) * samples);
    if (known != nullptr) recall(pixels, samples, *known);
    castSunRays(static_cast<int>(pixels.size()) * samples, samples);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      light[i] = gather(pixels[i], static_cast<int>(i) * samples, samples);
    }
  }

 private:
  void castCameraRays(std::span<const Pixel> pixels, int samples, std::uint32_t salt);
  void nameSurfaces(int rays);
  void recall(std::span<const Pixel> pixels, int samples, const FirstLook& known);
  void castSunRays(int rays, int samples);
  Eigen::Vector3f sunRayOrigin(int lane) const {
    return position_[lane] + (0.002F + 2e-4F * packet_.ray.tfar[lane]) * normal_[lane];
  }
  void lookAtSunTogether(int rays);
  bool seesSun(int lane) const;
  /// What several samples of a pixel saw of one surface.
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
  std::array<Eigen::Vector3f, kLanes> position_;
  std::array<Eigen::Vector3f, kLanes> normal_;
  std::array<float, kLanes> sunlit_{};
  std::array<bool, kLanes> sun_known_{};
  std::array<std::uint32_t, kLanes> surface_{};
  std::array<float, kLanes> recalled_{};  ///< radiance that the first look found for the surface; < 0: none
  alignas(64) std::array<int, kLanes> valid_{};
};

}  // namespace cartvo::world
