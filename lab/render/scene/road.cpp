// Builds the road with kerbs, pavements and verges, and the grassland around it.
#include "lab/render/scene/road.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "lab/render/scene/steps.hpp"

namespace cartvo::world {
namespace {

constexpr double kStep = 0.5;         // m along the path
constexpr double kKerbHeight = 0.12;  // m
constexpr double kGrassDepth = 0.10;  // m below the road, so that the surfaces do not intersect

/// A point of the cross section, m; `finish` is that of the strip from this point to the next.
struct ProfilePoint {
  double lateral = 0.0;
  double height = 0.0;
  Finish finish;
};

std::vector<ProfilePoint> crossSection(const RoadProfile& road) {
  const Finish grass{Material::grass, 1, 0.5F};
  const Finish slabs{Material::pavement, 2, 0.5F};
  const Finish stone{Material::kerb, 3, 0.5F};
  const Finish asphalt{Material::asphalt, 4, 0.5F};
  std::vector<ProfilePoint> section{{road.rightBorder() - road.verge_width, -0.2, grass},
                                    {road.rightBorder(), kKerbHeight + 0.02, slabs},
                                    {road.right_kerb - 0.15, kKerbHeight, stone},
                                    {road.right_kerb - 0.02, kKerbHeight, stone}};
  const int lanes = 4;
  for (int i = 0; i < lanes; ++i) {
    section.push_back({road.right_kerb + (road.left_kerb - road.right_kerb) * i / lanes, 0.0, asphalt});
  }
  section.push_back({road.left_kerb, 0.0, stone});
  section.push_back({road.left_kerb + 0.02, kKerbHeight, stone});
  section.push_back({road.left_kerb + 0.15, kKerbHeight, slabs});
  section.push_back({road.leftBorder(), kKerbHeight + 0.02, grass});
  section.push_back({road.leftBorder() + road.verge_width, -0.2, grass});
  return section;
}

/// Grid coordinates: 3 m apart near the campus, 40 m apart beyond it.
std::vector<double> gridLines(double from, double to) {
  std::vector<double> lines;
  for (const double x : stepsBelow(from, from - 640.0, 40.0))
    lines.push_back(x);
  for (const double x : stepsBelow(to, from, 3.0))
    lines.push_back(x);
  for (const double x : stepsBelow(to + 641.0, to, 40.0))
    lines.push_back(x);
  return lines;
}

}  // namespace

double clampWithinBend(const PathPoint& point, double lateral) {
  if (point.curvature * lateral <= 0.0) return lateral;
  const double radius = 1.0 / std::abs(point.curvature);
  return std::copysign(std::min(std::abs(lateral), 0.92 * radius), lateral);
}

void addRoad(Mesh& mesh, const Path& path, const RoadProfile& profile, const Terrain& terrain) {
  const std::vector<ProfilePoint> section = crossSection(profile);
  const int steps = static_cast<int>(std::round(path.length() / kStep));
  const double step = path.length() / steps;
  for (int i = 0; i < steps; ++i) {
    const PathPoint here = path.at(i * step);
    const PathPoint next = path.at((i + 1) * step);
    const auto u0 = static_cast<float>(i * step);
    const auto u1 = static_cast<float>((i + 1) * step);
    float v = 0.0F;
    for (std::size_t k = 0; k + 1 < section.size(); ++k) {
      const ProfilePoint& a = section[k];
      const ProfilePoint& b = section[k + 1];
      // v is the lateral position for asphalt, whose texture has lane markings, else the length along the
      // section.
      const auto v0 = a.finish.material == Material::asphalt ? static_cast<float>(a.lateral) : v;
      const auto across = static_cast<float>(std::hypot(b.lateral - a.lateral, b.height - a.height));
      const auto corner = [&](const PathPoint& at, const ProfilePoint& p) {
        const Eigen::Vector2d place = at.beside(clampWithinBend(at, p.lateral));
        return pointAt(place, terrain.height(place.x(), place.y()) + p.height);
      };
      mesh.addQuad({corner(here, a), corner(next, a), corner(next, b), corner(here, b)},
                   Mesh::rectangle(u0, v0, u1, v0 + across), a.finish);
      v += across;
    }
  }
}

void addGrassland(Mesh& mesh, const Path& path, const Terrain& terrain) {
  Eigen::AlignedBox2d bounds;
  for (const double s : stepsBelow(path.length(), 0.0, 2.0))
    bounds.extend(path.at(s).position);
  const std::vector<double> xs = gridLines(bounds.min().x() - 60.0, bounds.max().x() + 60.0);
  const std::vector<double> ys = gridLines(bounds.min().y() - 60.0, bounds.max().y() + 60.0);
  const Finish finish{Material::grass, 1, 0.5F};
  for (std::size_t i = 0; i + 1 < xs.size(); ++i) {
    for (std::size_t j = 0; j + 1 < ys.size(); ++j) {
      const auto corner = [&](std::size_t a, std::size_t b) {
        return pointAt({xs[a], ys[b]}, terrain.landHeight(xs[a], ys[b]) - kGrassDepth);
      };
      const Mesh::Corners corners{corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)};
      Mesh::Coordinates uv;
      for (std::size_t k = 0; k < 4; ++k)
        uv[k] = corners[k].head<2>();
      mesh.addQuad(corners, uv, finish);
    }
  }
}

}  // namespace cartvo::world
