// `cartvo`: the command line tools around the daemon, one subcommand each.
// Exit codes: 0 success, 1 failure, 2 wrong command line.

#include <cstdio>
#include <cstdlib>
#include <exception>

#include "tools/cartvo/commands.hpp"

// NOLINTNEXTLINE(bugprone-exception-escape): running out of memory during start-up may end the program
int main(int argument_count, char** arguments) {
  CLI::App cartvo{"cartvo: motion from two ordinary IP cameras"};
  cartvo.set_version_flag("--version", "cartvo " CARTVO_VERSION);
  cartvo.require_subcommand(1);
  cartvo.footer("'cartvo COMMAND --help' explains each command.");

  cartvo::addSimulateCommand(cartvo);
  cartvo::addReplayCommand(cartvo);
  cartvo::addRecordingCommand(cartvo);
  cartvo::addEvaluateCommand(cartvo);
  cartvo::addWatchCommand(cartvo);
  cartvo::addCalibrateCommand(cartvo);
  cartvo::addBenchmarkCommand(cartvo);

  try {
    cartvo.parse(argument_count, arguments);
  } catch (const CLI::RuntimeError& error) {
    return error.get_exit_code();
  } catch (const CLI::ParseError& error) {
    return cartvo.exit(error) == 0 ? EXIT_SUCCESS : 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "cartvo: %s\n", error.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
