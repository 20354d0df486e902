// The Python module cartvo._cartvo; python/cartvo/_cartvo.pyi describes it for users.
#include <cstdint>

#include "python/bindings/bindings.hpp"

PYBIND11_MODULE(_cartvo, module) {
  using namespace cartvo::python;
  // Imports numpy now: pybind11 before 2.12 does so in the initialisation of a static variable at the first
  // array. A thread may lose the interpreter's lock within it to one that waits for this variable, and both
  // would wait for ever.
  const pybind11::array_t<std::uint8_t> first_array(1);
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
