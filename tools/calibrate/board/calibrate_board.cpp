// `cartvo calibrate board`: writes a calibration board to print.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include <nlohmann/json.hpp>

#include "calib/board/board_spec.hpp"
#include "common/command_line/parser.hpp"
#include "tools/calibrate/board/board_print.hpp"
#include "tools/calibrate/board/board_sheet.hpp"
#include "tools/calibrate/subcommands.hpp"
#include "tools/cartvo/json_text.hpp"

namespace cartvo {
namespace {

struct Options {
  std::string board;
  std::filesystem::path output;
  std::string paper = "auto";
  double dots_per_inch = 300.0;
  bool json = false;
};

void run(const Options& options) {
  const calibrate::BoardSheet sheet =
      calibrate::layOutBoard(calib::parseBoardSpec(options.board), options.paper);
  calibrate::printBoard(sheet, options.output, options.dots_per_inch);
  const std::string dictionary = calib::dictionaryName(sheet.board);
  if (options.json) {
    const nlohmann::ordered_json json{
        {"output", options.output.string()},
        {"board", calib::boardSpecText(sheet.board)},
        {"markers", dictionary.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(dictionary)},
        {"pattern_mm", {sheet.pattern.width, sheet.pattern.height}},
        {"paper", sheet.page.name},
        {"paper_mm", {sheet.page.size.width, sheet.page.size.height}}};
    printJson(json);
    return;
  }
  std::printf(
      "%s: %s%s, %.1f x %.1f mm on %s. Print it at 100 %%, check both scales with a ruler, mount it flat,\n"
      "and give the measured lengths to 'cartvo calibrate --board'.\n",
      options.output.c_str(), calib::boardSpecText(sheet.board).c_str(),
      dictionary.empty() ? "" : (" (markers " + dictionary + ")").c_str(), sheet.pattern.width,
      sheet.pattern.height, sheet.page.name.c_str());
}

}  // namespace

void addCalibrateBoard(Command calibrate) {
  const Command command =
      calibrate.addSubcommand("board", "Write a calibration board to print, true to scale");
  const auto options = std::make_shared<Options>();
  command
      .addOption(
          "--board", options->board,
          "chessboard:COLUMNSxROWS:SQUARE (inner corners), charuco:COLUMNSxROWS:SQUARE:MARKER[:BITSxBITS]\n"
          "(squares) or aprilgrid:COLUMNSxROWS:TAG:SPACING (tags); lengths in m, spacing in tags")
      .required()
      .typeName("SPEC");
  command.addOption("--output", options->output, "A .pdf, .svg or .png file").required().typeName("FILE");
  command
      .addOption("--paper", options->paper,
                 "A4, A3, A2, A1, A0 or WIDTHxHEIGHT in mm; auto: the smallest that fits")
      .captureDefault();
  command.addOption("--dpi", options->dots_per_inch, "Pixels per inch of a .png")
      .range(20.0, 1200.0)
      .captureDefault();
  command.addFlag("--json", options->json, "Print what was written as JSON");
  command.footer(
      "The markers of a ChArUco board are those of OpenCV's smallest dictionary with enough of them: "
      "DICT_4X4_50 "
      "for up to\n"
      "50 markers, then _100, _250, _1000 (DICT_5X5_50 with 5x5 bits, and so on).\n"
      "Examples:\n"
      "  cartvo calibrate board --board charuco:11x8:0.03:0.022 --output board.pdf --paper A3\n"
      "  cartvo calibrate board --board aprilgrid:6x6:0.088:0.3 --output board.pdf    Kalibr's default, "
      "A0");
  command.callback([options] { run(*options); });
}

}  // namespace cartvo
