// Fuzz target for the truth of KITTI's raw recordings.
//
// Input: several files: two packets, timestamps.txt, calib_imu_to_velo.txt, calib_velo_to_cam.txt,
// calib_cam_to_cam.txt.

#include "tools/replay/kitti_oxts.hpp"

#include "tests/fuzz/fuzzing.hpp"

using namespace cartvo;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::string> parts = fuzz::splitParts(fuzz::toText(data, size));
  const char* const names[] = {"oxts/data/0.txt",       "oxts/data/1.txt",       "oxts/timestamps.txt",
                               "calib_imu_to_velo.txt", "calib_velo_to_cam.txt", "calib_cam_to_cam.txt"};
  parts.resize(std::size(names));
  const std::filesystem::path drive = fuzz::scratchFolder() / "drive";
  std::filesystem::create_directories(drive / "oxts/data");
  for (std::size_t i = 0; i < parts.size(); ++i)
    fuzz::writeScratch(std::filesystem::path("drive") / names[i], parts[i]);
  const auto truth = fuzz::parseOrReject([&] { return readKittiOxts(drive); }, drive.string());
  if (!truth) return 0;
  fuzz::require(truth->size() == 2, "each packet is a pose");
  for (const StampedPose& pose : *truth)
    fuzz::require(pose.pose.matrix().allFinite(), "poses are finite");
  return 0;
}
