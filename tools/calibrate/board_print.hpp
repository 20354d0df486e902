#pragma once

#include <filesystem>
#include <string>

#include "tools/calibrate/board_sheet.hpp"

namespace cartvo::calibrate {

/// Writes the sheet as PDF or SVG (true to scale), or PNG (of `dots_per_inch`), by the file's extension;
/// atomically. Throws std::invalid_argument for another extension.
void printBoard(const BoardSheet& sheet, const std::filesystem::path& file, double dots_per_inch);

/// The same without writing: the bytes of such a file; `extension` with its dot.
std::string printedBoard(const BoardSheet& sheet, const std::string& extension, double dots_per_inch);

}  // namespace cartvo::calibrate
