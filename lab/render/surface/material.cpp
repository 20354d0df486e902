// Dispatches reflectance() to the texture of each material.
#include "lab/render/surface/material.hpp"

#include <array>

#include "lab/render/surface/material_textures.hpp"

namespace cartvo::world {

float reflectance(Material material, const SurfacePoint& point, const TextureStyle& style) {
  using namespace textures;
  using Texture = float(const SurfacePoint&, const TextureStyle&);
  // In the order of the enumeration.
  static constexpr std::array<Texture*, 19> kTextures{
      asphalt, kerb,  pavement, grass, brick, concrete, plaster, window, door, roof,
      wood,    metal, bark,     leaf,  paint, glass,    rubber,  cloth,  sign};
  static_assert(kTextures.size() == static_cast<std::size_t>(Material::sign) + 1);
  return kTextures[static_cast<std::size_t>(material)](point, style);
}

}  // namespace cartvo::world
