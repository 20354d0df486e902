// `cartvo-render`: renders one drive into a folder: the images of two cameras, and their true motion.
// Exit codes: 0 success, 1 failure, 2 wrong command line.
#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "common/command_line/command_line.hpp"
#include "common/command_line/parser.hpp"
#include "common/command_line/standard_output.hpp"
#include "lab/render/render_options.hpp"
#include "lab/render/rendered_world.hpp"
#include "tools/cartvo/interruption.hpp"
#include "tools/cartvo/progress_bar.hpp"
#include "tools/simulate/content_files.hpp"

namespace {

constexpr int kWrongCommandLine = 2;

void describe(cartvo::Command command, cartvo::RenderOptions& options) {
  command.addVersionFlag("-V,--version", "cartvo-render " CARTVO_VERSION);
  cartvo::addRenderOptions(command, options);
  command.footer(
      "The folder then holds image_0 and image_1 (PNG), times_0.txt, times_1.txt, rig.yaml, poses.txt and "
      "truth.tum,\n"
      "as 'cartvo replay' and 'cartvo simulate --sequence' read them. The same options give the same bytes.\n"
      "By default the cameras are as users have them: wide lenses, rolling shutters, free-running clocks.\n"
      "Example:\n"
      "  cartvo-render --world turns --seconds 20 --output-dir turns");
  cartvo::refuseUnusableValues(command);
}

void render(const cartvo::RenderOptions& options) {
  const cartvo::world::RenderedWorld world(worldSettings(options));
  if (options.print_key) {
    std::printf("%s\n", world.cacheKey().c_str());
    return;
  }
  const cartvo::Interruption interruption;
  cartvo::ProgressBar bar("pairs");
  cartvo::simulate::renderFolder(options.output, world, [&](int done, int total) {
    interruption.check();
    bar.show(static_cast<std::size_t>(done), static_cast<std::size_t>(total));
  });
  std::printf("%d pairs: %s\n", world.pairCount(), options.output.c_str());
}

/// Returns the exit code.
int run(cartvo::Program& program, const std::vector<std::string>& arguments,
        const cartvo::RenderOptions& options) {
  try {
    if (program.parse(arguments)) render(options);
  } catch (const cartvo::ExitCode& end) {
    return end.code();
  } catch (const cartvo::CommandLineError& error) {
    std::fputs(cartvo::commandLineError(program.command(), error).c_str(), stderr);
    return kWrongCommandLine;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "cartvo-render: %s\n", error.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}

}  // namespace

// NOLINTNEXTLINE(bugprone-exception-escape): running out of memory during start-up may end the program
int main(int argument_count, char** arguments) {
  cartvo::occupyStandardDescriptors();
  cartvo::Program program("cartvo-render", "Renders a drive as two cameras see it, with its true motion");
  cartvo::RenderOptions options;
  describe(program.command(), options);
  const int code =
      run(program, {arguments + std::min(1, argument_count), arguments + argument_count}, options);
  const std::string error = cartvo::standardOutputError();
  if (!error.empty()) std::fprintf(stderr, "cartvo-render: %s\n", error.c_str());
  return code == EXIT_SUCCESS && !error.empty() ? EXIT_FAILURE : code;
}
