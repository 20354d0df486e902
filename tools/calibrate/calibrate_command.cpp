// `cartvo calibrate`: calibrates the cameras, their relative pose and their mounting on the cart.

#include "common/command_line/parser.hpp"
#include "tools/calibrate/subcommands.hpp"
#include "tools/cartvo/commands.hpp"

namespace cartvo {

void addCommands(Command cartvo) {
  const Command command = addNamedCommand(cartvo, "calibrate");
  command.limitSubcommands(0, 1);
  command.footer(
      "Print a board (cartvo calibrate board), glue it to a flat plate, measure a square with a ruler or\n"
      "calliper, and record 20 to 40 pairs of images: near and far, in all corners of both images, tilted "
      "by\n"
      "20 to 40 degrees to all four sides, and the board held still. The lens model is the one that "
      "predicts\n"
      "held-out views best. The exit code is 0 only if the calibration passes its validation; otherwise "
      "FILE\n"
      "is not changed. See cartvo-calibrate(1).\n"
      "Examples:\n"
      "  cartvo calibrate board --board chessboard:9x6:0.025 --output board.pdf\n"
      "  cartvo calibrate images --board chessboard:9x6:0.0252 --output rig.yaml --report report.html\n"
      "  cartvo calibrate live --page --board chessboard:9x6:0.0252 --output rig.yaml\n"
      "  cartvo calibrate images --left-images 'left*.jpg' --right-images 'right*.jpg' --board "
      "aprilgrid:6x6:0.088:0.3 "
      "--output rig.yaml");
  addCalibrateRig(command);
  addCalibrateBoard(command);
  addCalibrateCheck(command);
  addCalibrateConvert(command);
  addCalibrateMask(command);
  addCalibrateMount(command);
  addCalibratePlan(command);
  addCalibrateReadout(command);
}

}  // namespace cartvo
