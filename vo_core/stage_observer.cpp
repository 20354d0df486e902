// Names of the stages in files and outputs.
#include "vo_core/stage_observer.hpp"

namespace cartvo::vo {

const char* stageName(Stage stage) {
  switch (stage) {
    case Stage::rectify:
      return "rectify";
    case Stage::pyramid:
      return "pyramid";
    case Stage::optical_flow:
      return "optical_flow";
    case Stage::disparity:
      return "disparity";
    case Stage::reproject:
      return "reproject";
    case Stage::motion:
      return "motion";
    case Stage::detect:
      return "detect";
    case Stage::weights:
      return "weights";
    case Stage::minimum_distance:
      return "minimum_distance";
  }
  return "unknown";
}

}  // namespace cartvo::vo
