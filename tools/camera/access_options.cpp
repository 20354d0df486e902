// Options of the commands that ask cameras' web pages.
#include "tools/camera/access_options.hpp"

#include "common/command_line/parser.hpp"

namespace cartvo {

void addWebPageOptions(Command command, AccessOptions& access) {
  command
      .addOption("--http-port", access.http_port,
                 "Port of the cameras' web page (default 80, with --https 443)")
      .range(1, 65535)
      .typeName("PORT");
  command.addFlag(
      "--https", access.https,
      "Use TLS. The key of each camera's certificate is kept at the first use and required from then on");
  command.addOption("--known-cameras", access.known_cameras,
                    "File of the kept keys (default: known-cameras beside the configuration)");
}

}  // namespace cartvo
