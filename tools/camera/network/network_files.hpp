#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/camera/network/camera_ports.hpp"

// Files that configure the computer's network for the cameras.

namespace cartvo {

/// A file, and its place below /etc.
struct NetworkFile {
  std::filesystem::path place;
  std::string text;
};

/// A systemd-networkd file for each port, a chrony file that serves the time to the ports' networks, and a
/// sysctl file for the receive buffers. config/network/ holds those of two ports with DHCP.
std::vector<NetworkFile> networkFiles(const std::vector<CameraPort>& ports);

/// The steps that remain once the files are in /etc.
std::string nextSteps(const std::vector<CameraPort>& ports);

}  // namespace cartvo
