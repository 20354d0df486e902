#pragma once

namespace cartvo {

/// What one pair's evidence of the rig stands for.
struct EvidenceSpan {
  double time_step = 0.0;  ///< s since the evidence before
  int pairs = 1;           ///< pairs that it stands for, itself among them
};

}  // namespace cartvo
