// Prints the step that follows a calibration.
#include "tools/calibrate/next_step.hpp"

#include <cstdio>

namespace cartvo {

void printNextStep(const calib::Rig& rig, const std::filesystem::path& file) {
  if (calib::hasMount(rig)) return;
  std::fprintf(stderr,
               "cartvo: next: record a straight drive on level ground with this rig file, then: cartvo "
               "calibrate mount RECORDING --rig %s --output %s --forward METRES --left METRES\n"
               "cartvo: until then the velocities are those of the left camera\n",
               file.c_str(), file.c_str());
}

}  // namespace cartvo
