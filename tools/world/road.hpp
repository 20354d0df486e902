#pragma once

#include "tools/world/mesh.hpp"
#include "tools/world/path.hpp"

namespace cartvo::world {

/// The road's cross section, m left of the cart's line.
struct RoadProfile {
  double right_kerb = -2.6;
  double left_kerb = 7.4;
  double pavement_width = 2.0;

  double rightBorder() const { return right_kerb - 0.15 - pavement_width; }  ///< where the grass begins
  double leftBorder() const { return left_kerb + 0.15 + pavement_width; }
};

/// A lateral position that stays on this side of a bend's centre, where the strips of a road would fold over.
double keptWithinBend(const PathPoint& point, double lateral);

/// Road, kerbs, pavements and verges along the path.
void addRoad(Mesh& mesh, const Path& path, const RoadProfile& profile);

/// Grassland all around, a little below the road, to far beyond what the cart can see.
void addGrassland(Mesh& mesh, const Path& path);

}  // namespace cartvo::world
