#pragma once

#include <filesystem>

#include "calib/model/rig.hpp"

namespace cartvo {

/// Prints to standard error what to do with a new rig file: to measure how the cameras sit on the cart, if
/// the rig does not say it.
void printNextStep(const calib::Rig& rig, const std::filesystem::path& file);

}  // namespace cartvo
