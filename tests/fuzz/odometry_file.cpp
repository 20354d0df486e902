// Fuzz target for the odometry.csv that `cartvo evaluate` reads.

#include "tools/evaluate/odometry_file.hpp"

#include "tests/fuzz/fuzzing.hpp"

using namespace cartvo;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::filesystem::path file = fuzz::writeScratch("odometry.csv", fuzz::toText(data, size));
  const auto rows = fuzz::parseOrReject([&] { return readOdometryFile(file); }, file.string());
  if (!rows) return 0;
  fuzz::require(!rows->empty(), "a file has a row");
  for (std::size_t i = 0; i < rows->size(); ++i) {
    fuzz::require((*rows)[i].T_world_body.matrix().allFinite(), "poses are finite");
    fuzz::require(i == 0 || (*rows)[i].time_ns >= (*rows)[i - 1].time_ns, "times do not decrease");
  }
  return 0;
}
