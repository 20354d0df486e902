#pragma once

#include <cstdint>
#include <vector>

#include "vo_core/image_region.hpp"
#include "vo_core/stereo_camera.hpp"
#include "vo_core/tracking/landmark.hpp"
#include "vo_core/tracking/window_frame.hpp"

namespace cartvo::vo {

/// Finds regions of the left image that keep their place in it while the scene moves through: lettering, dirt
/// on the lens or a part of the cart. What is static in the image is not static in the world. The image is
/// divided into cells; a cell is still if the landmarks in it stayed where they were in most of the pairs
/// whose motion should have moved them.
class StillRegions {
 public:
  explicit StillRegions(const StereoCamera& camera);

  /// Processes the landmarks of the window's last pair, whose motion is valid. A pair in which more than a
  /// third of the landmarks stayed in place is ignored: there, the motion is more likely wrong than the
  /// scene.
  void update(const std::vector<Landmark>& landmarks, const std::vector<WindowFrame>& window);

  /// Whether the pixel is in a still cell.
  bool contains(const Eigen::Vector2d& pixel) const;

  /// The largest rectangles that enclose adjacent still cells, largest first.
  const ImageRegions& regions() const { return regions_; }

 private:
  struct Cell {
    double still = 0.0, moving = 0.0;  ///< pairs, with fading memory
    bool is_still = false;
  };

  bool addPair(Cell& cell, bool moved);
  void findRegions();

  StereoCamera camera_;
  std::vector<Cell> cells_;
  ImageRegions regions_;
  // Of the current pair; members to reuse their memory.
  std::vector<int> still_, moved_;  ///< landmarks in each cell
};

}  // namespace cartvo::vo
