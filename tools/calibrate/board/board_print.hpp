#pragma once

#include <filesystem>
#include <string>

#include "tools/calibrate/board/board_sheet.hpp"

namespace cartvo::calibrate {

/// Writes the sheet atomically as PDF or SVG (true to scale) or as PNG (at `dots_per_inch`), depending on the
/// file's extension. Throws std::invalid_argument for another extension.
void printBoard(const BoardSheet& sheet, const std::filesystem::path& file, double dots_per_inch);

/// The bytes of such a file; `extension` includes the dot.
std::string printedBoard(const BoardSheet& sheet, const std::string& extension, double dots_per_inch);

}  // namespace cartvo::calibrate
