// Fuzz target for the trajectories of `cartvo export` and `cartvo simulate`, in TUM's and KITTI's formats.

#include "tools/trajectory/trajectory.hpp"

#include "tests/fuzz/fuzzing.hpp"

using namespace cartvo;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::filesystem::path file = fuzz::writeScratch("trajectory.txt", fuzz::toText(data, size));
  const auto trajectory = fuzz::parseOrReject([&] { return readTrajectory(file); }, file.string());
  if (!trajectory) return 0;
  fuzz::require(!trajectory->empty(), "a trajectory has a pose");
  if (isKittiTrajectory(file)) {
    writeKitti(file, *trajectory);
  } else {
    writeTum(file, *trajectory);
  }
  const Trajectory again = readTrajectory(file);
  fuzz::require(again.size() == trajectory->size(), "a trajectory is read back, row by row");
  for (std::size_t i = 0; i < again.size(); ++i) {
    fuzz::require((*trajectory)[i].pose.matrix().allFinite(), "poses are finite");
    const bool exact = (*trajectory)[i].time_ns >= 0;  // before 1970 only to the precision of a double
    fuzz::require(!exact || again[i].time_ns == (*trajectory)[i].time_ns, "instants are read back exactly");
  }
  return 0;
}
