#pragma once

namespace cartvo {

/// An estimate with its standard deviation.
struct Checked {
  double value = 0.0;
  double deviation = 0.0;
};

/// What driving has told of the two cameras against each other, whatever has been corrected of it. Angles in
/// rad, about the rectified right camera's axes, signs as RigCorrection's.
struct RigCheck {
  Checked pitch, yaw, roll;
  Checked delay;  ///< s, by which the right camera is exposed later than its stamps say
};

}  // namespace cartvo
