// Options of the commands that ask cameras' web pages.
#include "tools/camera/access_options.hpp"

#include <CLI/CLI.hpp>

namespace cartvo {

void addWebPageOptions(CLI::App& command, AccessOptions& access) {
  command
      .add_option("--http-port", access.http_port,
                  "Port of the cameras' web page (default 80, with --https 443)")
      ->check(CLI::Range(1, 65535))
      ->type_name("PORT");
  command.add_flag(
      "--https", access.https,
      "Use TLS. The key of each camera's certificate is kept at the first use and required from then on");
  command.add_option("--known-cameras", access.known_cameras,
                     "File of the kept keys (default: known-cameras beside the configuration)");
}

}  // namespace cartvo
