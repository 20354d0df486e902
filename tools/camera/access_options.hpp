#pragma once

#include "tools/camera/camera_access.hpp"

namespace cartvo {

class Command;

/// Adds --http-port, --https and --known-cameras: how the cameras' web pages are reached.
void addWebPageOptions(Command command, AccessOptions& access);

}  // namespace cartvo
