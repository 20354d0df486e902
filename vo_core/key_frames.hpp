#pragma once

namespace cartvo {

/// Which pictures of a pair are key frames: coded by themselves in a stream whose others are coded as changes
/// of the one before. Pictures of no such stream are none.
struct KeyFrames {
  bool left = false;
  bool right = false;

  bool any() const { return left || right; }
  friend bool operator==(const KeyFrames&, const KeyFrames&) = default;
};

}  // namespace cartvo
