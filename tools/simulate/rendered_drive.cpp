// Makes rendered drives available as content of the simulated cameras.
#include "tools/simulate/rendered_drive.hpp"

#include <cstdint>
#include <utility>

#include "common/input_file.hpp"

namespace cartvo::simulate {

RenderedDrive::RenderedDrive(const std::filesystem::path& folder, double frame_rate, std::string key)
    : pictures_(folder, {}),
      frame_rate_(frame_rate),
      key_(std::move(key)),
      dense_truth_(readTrajectory(folder / "truth.tum")) {
  constexpr std::uintmax_t kMaxFileBytes = 1U << 30U;
  for (const char* name : {"rig.yaml", "times_0.txt", "times_1.txt", "poses.txt", "truth.tum"})
    written_[name] = readInputText(folder / name, kMaxFileBytes);
}

/// The truth's first two poses are a fraction of a frame period apart.
bool RenderedDrive::startsAtStandstill() const {
  return dense_truth_.size() < 2 || dense_truth_[0].pose.isApprox(dense_truth_[1].pose, 0.0);
}

}  // namespace cartvo::simulate
