#pragma once

#include <pybind11/pybind11.h>

#include "vo_core/odometry_estimate.hpp"

namespace cartvo::python {

/// Whether a result can be used.
enum class Status : std::uint8_t { invalid = 0, valid = 1 };

/// The names of the reasons, as `cartvo watch` prints them, for example "too few matches".
pybind11::list reasonList(const vo::OdometryReasons& reasons);

/// The parts of "first, second" as a list.
pybind11::list partsOf(const std::string& names);

}  // namespace cartvo::python
