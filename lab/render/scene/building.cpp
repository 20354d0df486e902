// Builds the meshes of houses: walls with windows and doors, plinth and roof.
#include "lab/render/scene/building.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "lab/render/surface/hash.hpp"

namespace cartvo::world {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr float kStorey = 3.1F;        // m, height of one storey
constexpr float kRecess = 0.14F;       // m, from the wall's face to the pane
constexpr float kWindowHeight = 1.5F;  // m, equal to the height in the window texture
constexpr float kSillHeight = 0.95F;   // m above the floor
constexpr float kDoorWidth = 1.0F;
constexpr float kDoorHeight = 2.1F;

/// A wall as a vertical plane with coordinates u along it, v up and w into the house, m.
struct WallFrame {
  Vector3f origin;
  Vector3f along;
  Vector3f inward;
  float length = 0.0F;
  float texture_offset = 0.0F;  ///< m; continues the texture of the wall before

  Vector3f at(float u, float v, float w) const {
    return origin + u * along + v * Vector3f::UnitZ() + w * inward;
  }
};

struct Rectangle {
  float left, right, bottom, top;
};

void addWallPiece(Mesh& mesh, const WallFrame& wall, const Rectangle& r, const Finish& finish) {
  if (r.right - r.left < 1e-3F || r.top - r.bottom < 1e-3F) return;
  const float o = wall.texture_offset;
  mesh.addQuad({wall.at(r.left, r.bottom, 0), wall.at(r.right, r.bottom, 0), wall.at(r.right, r.top, 0),
                wall.at(r.left, r.top, 0)},
               Mesh::rectangle(r.left + o, r.bottom, r.right + o, r.top), finish);
}

/// Adds an opening: its recessed inset and the four reveal faces between the wall and the inset.
void addOpening(Mesh& mesh, const WallFrame& wall, const Rectangle& r, const Finish& inset,
                const Finish& reveal) {
  mesh.addPlane({wall.at(r.left, r.bottom, kRecess), wall.at(r.right, r.bottom, kRecess),
                 wall.at(r.right, r.top, kRecess), wall.at(r.left, r.top, kRecess)},
                inset);
  const auto face = [&](float u0, float v0, float u1, float v1) {
    mesh.addPlane(
        {wall.at(u0, v0, 0), wall.at(u1, v1, 0), wall.at(u1, v1, kRecess), wall.at(u0, v0, kRecess)}, reveal);
  };
  face(r.left, r.bottom, r.right, r.bottom);
  face(r.right, r.bottom, r.right, r.top);
  face(r.right, r.top, r.left, r.top);
  face(r.left, r.top, r.left, r.bottom);
}

void addSill(Mesh& mesh, const WallFrame& wall, const Rectangle& r, const Finish& finish) {
  const float l = r.left - 0.06F;
  const float e = r.right + 0.06F;
  const float top = r.bottom;
  const float low = r.bottom - 0.07F;
  constexpr float kOutward = -0.06F;
  mesh.addPlane({wall.at(l, low, kOutward), wall.at(e, low, kOutward), wall.at(e, top, kOutward),
                 wall.at(l, top, kOutward)},
                finish);
  mesh.addPlane({wall.at(l, top, kOutward), wall.at(e, top, kOutward), wall.at(e, top + 0.01F, 0),
                 wall.at(l, top + 0.01F, 0)},
                finish);
  mesh.addPlane(
      {wall.at(l, low, kOutward), wall.at(e, low, kOutward), wall.at(e, low, 0), wall.at(l, low, 0)}, finish);
}

void addWall(Mesh& mesh, const WallFrame& wall, const Building& house, float height, std::uint32_t salt) {
  Random random(hashOf({house.seed, salt}));
  const float tone = unitFloat(hashOf({house.seed, 1U}));
  const Finish face{house.wall, hashOf({house.seed, 2U}), tone};
  const Finish reveal{Material::plaster, hashOf({house.seed, 3U}), 0.5F};
  const Finish stone{Material::concrete, hashOf({house.seed, 4U}), 0.8F};
  const float window_tone = unitFloat(hashOf({house.seed, 5U}));
  const float window_width = 1.0F + 0.6F * window_tone;
  const int bays = std::max(1, static_cast<int>(wall.length / (window_width + 1.5F)));
  const float bay = wall.length / static_cast<float>(bays);
  const int door_bay = random.below(bays);
  for (int floor = 0; floor < house.storeys; ++floor) {
    const float bottom = kStorey * static_cast<float>(floor);
    const float top = floor + 1 == house.storeys ? height : bottom + kStorey;
    for (int i = 0; i < bays; ++i) {
      const float left = bay * static_cast<float>(i);
      const float middle = left + 0.5F * bay;
      const bool is_door = floor == 0 && i == door_bay;
      const bool blank = !is_door && random.chance(0.1);
      if (blank) {
        addWallPiece(mesh, wall, {left, left + bay, bottom, top}, face);
        continue;
      }
      const float half = 0.5F * (is_door ? kDoorWidth : window_width);
      const float from = is_door ? 0.3F : bottom + kSillHeight;
      const Rectangle opening{middle - half, middle + half, from,
                              from + (is_door ? kDoorHeight : kWindowHeight)};
      addWallPiece(mesh, wall, {left, opening.left, bottom, top}, face);
      addWallPiece(mesh, wall, {opening.right, left + bay, bottom, top}, face);
      addWallPiece(mesh, wall, {opening.left, opening.right, bottom, opening.bottom}, face);
      addWallPiece(mesh, wall, {opening.left, opening.right, opening.top, top}, face);
      const Finish inset{is_door ? Material::door : Material::window, random.bits(),
                         is_door ? tone : window_tone};
      addOpening(mesh, wall, opening, inset, reveal);
      if (!is_door) addSill(mesh, wall, opening, stone);
    }
  }
}

void addRoof(Mesh& mesh, const std::array<Vector3f, 4>& eaves, const Building& house, float height) {
  const Finish tiles{Material::roof, hashOf({house.seed, 6U}), unitFloat(hashOf({house.seed, 7U}))};
  const Finish trim{Material::concrete, hashOf({house.seed, 8U}), 0.6F};
  const Vector3f up = height * Vector3f::UnitZ();
  const Vector3f x = (eaves[1] - eaves[0]).normalized();
  const Vector3f y = (eaves[3] - eaves[0]).normalized();
  constexpr float kOverhang = 0.45F;
  const std::array<Vector3f, 4> edge{eaves[0] + up - kOverhang * (x + y), eaves[1] + up + kOverhang * (x - y),
                                     eaves[2] + up + kOverhang * (x + y),
                                     eaves[3] + up - kOverhang * (x - y)};
  const Vector3f thick = 0.25F * Vector3f::UnitZ();
  for (std::size_t i = 0; i < 4; ++i) {
    mesh.addPlane({edge[i], edge[(i + 1) % 4], edge[(i + 1) % 4] + thick, edge[i] + thick}, trim);
  }
  mesh.addPlane({edge[0], edge[1], edge[2], edge[3]}, trim);
  std::array<Vector3f, 4> top{edge[0] + thick, edge[1] + thick, edge[2] + thick, edge[3] + thick};
  if (house.wall == Material::concrete) {  // a flat roof
    mesh.addPlane({top[0], top[1], top[2], top[3]}, tiles);
    return;
  }
  const float half = 0.5F * (top[3] - top[0]).norm();
  const Vector3f rise = 0.55F * half * Vector3f::UnitZ();
  const Vector3f ridge_a = 0.5F * (top[0] + top[3]) + half * x + rise;
  const Vector3f ridge_b = 0.5F * (top[1] + top[2]) - half * x + rise;
  mesh.addPlane({top[0], top[1], ridge_b, ridge_a}, tiles);
  mesh.addPlane({top[2], top[3], ridge_a, ridge_b}, tiles);
  mesh.addPlane({top[3], top[0], ridge_a, ridge_a}, tiles);
  mesh.addPlane({top[1], top[2], ridge_b, ridge_b}, tiles);
}

}  // namespace

bool covers(const Building& building, const Eigen::Vector2d& point, double margin) {
  const Eigen::Vector2d offset = point - building.centre;
  const Eigen::Vector2d x(std::cos(building.yaw), std::sin(building.yaw));
  const Eigen::Vector2d y(-x.y(), x.x());
  return std::abs(offset.dot(x)) < 0.5 * building.length + margin &&
         std::abs(offset.dot(y)) < 0.5 * building.depth + margin;
}

void addBuilding(Mesh& mesh, const Building& building, const Terrain& terrain) {
  const auto ground =
      static_cast<float>(terrain.landHeight(building.centre.x(), building.centre.y())) - 0.25F;
  const auto yaw = static_cast<float>(building.yaw);
  const Vector3f x = static_cast<float>(building.length) * Vector3f(std::cos(yaw), std::sin(yaw), 0.0F);
  const Vector3f y = static_cast<float>(building.depth) * Vector3f(-std::sin(yaw), std::cos(yaw), 0.0F);
  const Vector3f centre(static_cast<float>(building.centre.x()), static_cast<float>(building.centre.y()),
                        ground);
  const std::array<Vector3f, 4> foot{centre - 0.5F * (x + y), centre + 0.5F * (x - y),
                                     centre + 0.5F * (x + y), centre - 0.5F * (x - y)};
  const float height = kStorey * static_cast<float>(building.storeys) + 0.3F;
  float offset = 0.0F;
  for (std::uint32_t i = 0; i < 4; ++i) {
    const Vector3f& a = foot[i];
    const Vector3f& b = foot[(i + 1) % 4];
    const Vector3f along = (b - a).normalized();
    const WallFrame wall{a, along, Vector3f(-along.y(), along.x(), 0.0F), (b - a).norm(), offset};
    addWall(mesh, wall, building, height, 20U + i);
    offset += wall.length;
  }
  const float deeper = 0.6F * static_cast<float>(terrain.relief - 1.0);  // on steep ground
  mesh.addBox(centre - Vector3f(0, 0, 0.6F + deeper),
              Vector3f(x.norm() + 0.08F, y.norm() + 0.08F, 1.15F + deeper), yaw,
              {Material::concrete, hashOf({building.seed, 9U}), 0.3F});
  addRoof(mesh, foot, building, height);
}

}  // namespace cartvo::world
