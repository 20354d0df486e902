#pragma once

#include "lab/render/scene/mesh.hpp"
#include "lab/render/scene/path.hpp"

namespace cartvo::world {

/// Cross section of the road; lateral positions in m left of the path.
struct RoadProfile {
  double right_kerb = -2.6;
  double left_kerb = 7.4;
  double pavement_width = 2.0;
  double verge_width = 3.0;  ///< of the grass beside the pavements

  double rightBorder() const { return right_kerb - 0.15 - pavement_width; }  ///< start of the grass
  double leftBorder() const { return left_kerb + 0.15 + pavement_width; }
};

/// Limits a lateral position to 92 % of the bend's radius, so that the strips of the road do not fold at its
/// centre.
double clampWithinBend(const PathPoint& point, double lateral);

/// Adds road, kerbs, pavements and verges along the path.
void addRoad(Mesh& mesh, const Path& path, const RoadProfile& profile, const Terrain& terrain);

/// Adds grassland around the path, 0.1 m below the terrain's land, up to 640 m beyond the campus.
void addGrassland(Mesh& mesh, const Path& path, const Terrain& terrain);

}  // namespace cartvo::world
