#pragma once

#include "common/command_line/cli11_forward.hpp"
#include "tools/camera/camera_access.hpp"

namespace cartvo {

/// Adds --http-port, --https and --known-cameras: how the cameras' web pages are reached.
void addWebPageOptions(CLI::App& command, AccessOptions& access);

}  // namespace cartvo
