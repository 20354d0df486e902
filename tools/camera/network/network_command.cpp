// `cartvo camera network`: writes the files that configure the computer's network for the cameras.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <net/if.h>

#include "capture/rtsp/rtsp_url.hpp"
#include "common/atomic_file.hpp"
#include "common/command_line/parser.hpp"
#include "common/input_file.hpp"
#include "daemon/service/configuration.hpp"
#include "tools/camera/actions.hpp"
#include "tools/camera/network/camera_ports.hpp"
#include "tools/camera/network/network_files.hpp"

namespace cartvo {
namespace fs = std::filesystem;
namespace {

struct Options {
  fs::path configuration = "/etc/cartvo/cartvod.yaml";
  std::string interface, left_interface, right_interface;
  std::string left_camera, right_camera;  ///< empty: of the configuration
  bool dhcp = false, force = false;
  fs::path output_dir;  ///< empty: print
};

/// A file to write, and whether it exists already, with the same text.
struct PlannedFile {
  fs::path path;
  std::string text;
  bool exists = false, is_same = false;
};

void warn(const std::string& text) {
  std::fprintf(stderr, "cartvo: warning: %s\n", text.c_str());
}

/// The address of a configured camera.
Ipv4 configuredAddress(const daemon::CameraConfiguration& camera, const std::string& side) {
  const std::string instead = "; name its address with --" + side + "-camera";
  if (camera.isV4l2())
    throw std::runtime_error("the " + side + " camera is a V4L2 camera (" + camera.url +
                             "), which needs no network" + instead + " if that changes");
  const std::string host = capture::parseRtspUrl(camera.url).host;
  try {
    return parseCameraAddress(host);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error("cameras." + side + ".url: " + error.what() + instead);
  }
}

void findCameras(const Options& options, PortWishes& wishes) {
  if (!options.left_camera.empty()) wishes.left_camera = parseCameraAddress(options.left_camera);
  if (!options.right_camera.empty()) wishes.right_camera = parseCameraAddress(options.right_camera);
  if (wishes.left_camera != 0 && wishes.right_camera != 0) return;
  const daemon::Configuration configuration =
      daemon::readConfiguration(options.configuration, daemon::RigKey::optional);
  if (wishes.left_camera == 0) wishes.left_camera = configuredAddress(configuration.left, "left");
  if (wishes.right_camera == 0) wishes.right_camera = configuredAddress(configuration.right, "right");
}

std::vector<CameraPort> portsOf(const Options& options) {
  const bool has_two = !options.left_interface.empty() && !options.right_interface.empty();
  if (options.interface.empty() && !has_two)
    throw CommandLineError("--interface",
                           "name the ports: --left-interface and --right-interface, or --interface for "
                           "both cameras at one port; see: ip -brief link");
  PortWishes wishes{options.interface, options.left_interface, options.right_interface, 0, 0, options.dhcp};
  findCameras(options, wishes);
  return planPorts(wishes);
}

PlannedFile plannedFile(const fs::path& folder, const NetworkFile& file) {
  constexpr std::uintmax_t kMaxBytes = 1'000'000;
  PlannedFile planned{folder / file.place, file.text};
  planned.exists = fs::exists(fs::symlink_status(planned.path));
  planned.is_same = fs::is_regular_file(planned.path) && fs::file_size(planned.path) == planned.text.size() &&
                    readInputFile(planned.path, kMaxBytes) == planned.text;
  return planned;
}

/// Other users read these files (systemd-network, _chrony), whatever the umask is.
void writeForAll(const PlannedFile& file) {
  for (const fs::path& folder : createFolders(file.path.parent_path()))
    fs::permissions(folder, fs::perms(0755));
  writeFileAtomically(file.path, file.text);
  if (!file.exists) fs::permissions(file.path, fs::perms(0644));
}

/// Writes all files, or none: nothing is written if one exists with other contents, except by --force.
void write(const Options& options, const std::vector<NetworkFile>& files) {
  std::vector<PlannedFile> planned;
  std::string in_the_way;
  for (const NetworkFile& file : files) {
    planned.push_back(plannedFile(options.output_dir, file));
    if (planned.back().exists && !planned.back().is_same) in_the_way += "\n  " + planned.back().path.string();
  }
  if (!in_the_way.empty() && !options.force)
    throw std::runtime_error(
        "nothing was written: these files exist with other contents; --force replaces them" + in_the_way);
  for (const PlannedFile& file : planned) {
    if (!file.is_same) writeForAll(file);
    std::printf("%s %s\n", file.is_same ? "unchanged:" : "written:", file.path.c_str());
  }
}

void print(const std::vector<NetworkFile>& files) {
  for (const NetworkFile& file : files)
    std::printf("==> /etc/%s <==\n%s\n", file.place.c_str(), file.text.c_str());
}

void checkHost(const Options& options, const std::vector<CameraPort>& ports) {
  for (const CameraPort& port : ports) {
    if (::if_nametoindex(port.interface.c_str()) == 0)
      warn("this computer has no interface " + port.interface + " now; see: ip -brief link");
  }
  const std::vector<HostAddress> addresses = hostAddresses();
  for (const std::string& lost : lostAddresses(ports, addresses))
    warn(lost);
  const std::vector<std::string> overlaps = overlapsWithHost(ports, addresses);
  if (overlaps.empty()) return;
  if (!options.output_dir.empty() && !options.force)
    throw std::runtime_error("nothing was written: " + overlaps.front() + "; --force writes all the same");
  for (const std::string& overlap : overlaps)
    warn(overlap);
}

void run(const Options& options) {
  // A folder of networkd itself would get files that networkd does not look for.
  if (options.output_dir.filename() == "network" || options.output_dir.parent_path().filename() == "network")
    throw CommandLineError("--output-dir",
                           "expected /etc or a folder like it: its folders systemd/network, chrony/conf.d "
                           "and sysctl.d get the files");
  const std::vector<CameraPort> ports = portsOf(options);
  checkHost(options, ports);
  if (options.output_dir.empty()) {
    print(networkFiles(ports));
    std::printf("Nothing was written; --output-dir /etc writes these files. Then:\n");
  } else {
    write(options, networkFiles(ports));
    std::printf("Next%s:\n", options.output_dir == "/etc" ? "" : ", with these files in /etc");
  }
  std::fputs(nextSteps(ports).c_str(), stdout);
}

}  // namespace

void addNetworkAction(Command camera) {
  const Command action =
      camera.addSubcommand("network", "Write the files of this computer's network for the cameras");
  const auto options = std::make_shared<Options>();
  const Option left = action.addOption("--left-interface", options->left_interface,
                                       "Port of the left camera, as ip -brief link prints it");
  const Option right =
      action.addOption("--right-interface", options->right_interface, "Port of the right camera");
  const Option both = action.addOption("--interface", options->interface,
                                       "Port of both cameras, with a switch, instead of the two above");
  for (const Option one : {left, right, both})
    one.typeName("NAME");
  both.excludes(left).excludes(right);
  left.needs(right);
  right.needs(left);
  action
      .addOption("--left-camera", options->left_camera,
                 "The left camera's IPv4 address (default: that of its URL in the configuration)")
      .typeName("ADDRESS");
  action.addOption("--right-camera", options->right_camera, "As --left-camera").typeName("ADDRESS");
  action.addFlag("--dhcp", options->dhcp, "Each port gives its camera this address, by DHCP");
  action
      .addOption("--config", options->configuration, "cartvod's configuration file, which names the cameras")
      .captureDefault()
      .typeName("FILE");
  action
      .addOption(
          "--output-dir", options->output_dir,
          "Write the files below this folder instead of printing them: /etc, or one that stands for it")
      .typeName("FOLDER");
  action.addFlag("--force", options->force, "Replace files that exist, and accept a network that overlaps");
  action.footer(
      "The port's address is the first free one of its camera's network 255.255.255.0. Nothing is activated: "
      "the\n"
      "command says how. Exit codes: 0 done, 1 failure, 2 wrong command line.\n"
      "Example: sudo cartvo camera network --left-interface enp2s0 --right-interface enp3s0 --dhcp "
      "--output-dir /etc");
  action.callback([options] { run(*options); });
}

}  // namespace cartvo
