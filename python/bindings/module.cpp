// The Python module cartvo._cartvo; python/cartvo/_cartvo.pyi describes it for users.
#include "python/bindings/bindings.hpp"

PYBIND11_MODULE(_cartvo, module) {
  using namespace cartvo::python;
  module.doc() = "Stereo visual odometry from two free-running cameras.";
  module.attr("__version__") = CARTVO_VERSION;
  bindSettings(module);
  bindRig(module);
  bindEstimate(module);
  bindRecording(module);
  bindOdometry(module);
  bindPairProcessor(module);
  bindMessages(module);
}
