// Dispatches reflectance() to the texture of each material.
#include "lab/render/surface/material.hpp"

#include "lab/render/surface/material_textures.hpp"

namespace cartvo::world {

float reflectance(Material material, const SurfacePoint& point, const TextureStyle& style) {
  switch (material) {
    case Material::asphalt:
      return textures::asphalt(point, style);
    case Material::kerb:
      return textures::kerb(point, style);
    case Material::pavement:
      return textures::pavement(point, style);
    case Material::grass:
      return textures::grass(point, style);
    case Material::brick:
      return textures::brick(point, style);
    case Material::concrete:
      return textures::concrete(point, style);
    case Material::plaster:
      return textures::plaster(point, style);
    case Material::window:
      return textures::window(point, style);
    case Material::door:
      return textures::door(point, style);
    case Material::roof:
      return textures::roof(point, style);
    case Material::wood:
      return textures::wood(point, style);
    case Material::metal:
      return textures::metal(point, style);
    case Material::bark:
      return textures::bark(point, style);
    case Material::leaf:
      return textures::leaf(point, style);
    case Material::paint:
      return textures::paint(point, style);
    case Material::glass:
      return textures::glass(point, style);
    case Material::rubber:
      return textures::rubber(point, style);
    case Material::cloth:
      return textures::cloth(point, style);
    case Material::sign:
      return textures::sign(point, style);
  }
  return 0.5F;
}

}  // namespace cartvo::world
