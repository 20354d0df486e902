#pragma once

namespace cartvo::vo {

/// Which images of a pair are key frames: intra-coded in a stream whose other images are inter-coded. False
/// for images that are not from such a stream.
struct KeyFrames {
  bool left = false;
  bool right = false;

  bool any() const { return left || right; }
  friend bool operator==(const KeyFrames&, const KeyFrames&) = default;
};

}  // namespace cartvo::vo
