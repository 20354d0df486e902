#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

// The parts of the Python module; each adds its classes to the module.

namespace cartvo::python {

void bindSettings(pybind11::module_& module);
void bindRig(pybind11::module_& module);
void bindEstimate(pybind11::module_& module);
void bindRecording(pybind11::module_& module);
void bindOdometry(pybind11::module_& module);
void bindPairProcessor(pybind11::module_& module);
void bindMessages(pybind11::module_& module);

}  // namespace cartvo::python
