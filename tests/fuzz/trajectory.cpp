// Trajectories that `cartvo evaluate` compares, TUM's and KITTI's.

#include "tools/trajectory/trajectory.hpp"

#include "tests/fuzz/fuzzing.hpp"

using namespace cartvo;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::filesystem::path file = fuzz::writeScratch("trajectory.txt", fuzz::textOf(data, size));
  const auto trajectory = fuzz::accepted([&] { return readTrajectory(file); }, file.string());
  if (!trajectory) return 0;
  fuzz::require(!trajectory->empty(), "a trajectory has a pose");
  const bool is_kitti = isKittiTrajectory(file);
  (is_kitti ? writeKitti : writeTum)(file, *trajectory);
  const Trajectory again = readTrajectory(file);
  fuzz::require(again.size() == trajectory->size(), "a trajectory is read back, row by row");
  for (std::size_t i = 0; i < again.size(); ++i) {
    fuzz::require((*trajectory)[i].pose.matrix().allFinite(), "poses are finite");
    const bool exact = (*trajectory)[i].time_ns >= 0;  // before 1970 to a double's digits
    fuzz::require(!exact || again[i].time_ns == (*trajectory)[i].time_ns, "instants are read back exactly");
  }
  return 0;
}
