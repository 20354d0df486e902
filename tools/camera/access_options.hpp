#pragma once

#include "tools/camera/camera_access.hpp"

namespace CLI {
class App;
}  // namespace CLI

namespace cartvo {

/// Adds --http-port, --https and --known-cameras: how the cameras' web pages are reached.
void addWebPageOptions(CLI::App& command, AccessOptions& access);

}  // namespace cartvo
