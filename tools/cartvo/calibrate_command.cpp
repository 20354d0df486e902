// `cartvo calibrate`: what the cameras are, how they stand to each other and on the cart.
#include "tools/cartvo/calibrate_board.hpp"
#include "tools/cartvo/calibrate_check.hpp"
#include "tools/cartvo/calibrate_convert.hpp"
#include "tools/cartvo/calibrate_mount.hpp"
#include "tools/cartvo/calibrate_plan.hpp"
#include "tools/cartvo/calibrate_rig.hpp"
#include "tools/cartvo/commands.hpp"

namespace cartvo {

void addCalibrateCommand(CLI::App& cartvo) {
  CLI::App* command = cartvo.add_subcommand("calibrate", "Calibrate the cameras, and all that goes with it");
  command->require_subcommand(0, 1);
  command->footer(
      "Print a board (cartvo calibrate board), glue it to something flat, measure a square with a ruler or\n"
      "calliper, and take 20 to 40 pairs of images: near and far, in all corners of both images, tilted by\n"
      "20 to 40 degrees to all four sides, and the board held still. The lens model is chosen by how well "
      "it\n"
      "foretells views that it was not solved from. The exit code is 0 only if the calibration passes its\n"
      "validation; otherwise FILE is left as it was. See cartvo-calibrate(1).\n"
      "Examples:\n"
      "  cartvo calibrate board --board chessboard:9x6:0.025 --output board.pdf\n"
      "  cartvo calibrate images --board chessboard:9x6:0.0252 --output rig.yaml --report report\n"
      "  cartvo calibrate live --page --board chessboard:9x6:0.0252 --output rig.yaml\n"
      "  cartvo calibrate images --left 'left*.jpg' --right 'right*.jpg' --board aprilgrid:6x6:0.088:0.3 "
      "--output rig.yaml");
  addCalibrateRig(*command);
  addCalibrateBoard(*command);
  addCalibrateCheck(*command);
  addCalibrateConvert(*command);
  addCalibrateMount(*command);
  addCalibratePlan(*command);
}

}  // namespace cartvo
