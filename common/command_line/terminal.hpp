#pragma once

#include <cstddef>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>

namespace cartvo {

struct TerminalSize {
  std::size_t columns = 0, rows = 0;
};

/// Size of the terminal that `descriptor` is open on; empty if it is none, or if it does not know its size.
std::optional<TerminalSize> terminalSize(int descriptor);

/// Number of columns of the terminal that `descriptor` is open on; empty if it is none. A terminal that does
/// not know its width counts as $COLUMNS, else as 80.
std::optional<std::size_t> terminalColumns(int descriptor);

/// Number of columns for a line that is redrawn in place on `stream`: one less than the terminal has, since a
/// full line would wrap; 1000 if the stream is no terminal.
std::size_t lineColumns(std::FILE* stream);

/// Number of columns that printable UTF-8 text takes, one for each character.
std::size_t textColumns(std::string_view text);

/// The text, or its start and "..." if it takes more than `columns`.
std::string cutToColumns(const std::string& text, std::size_t columns);

/// The text with its lines broken at blanks to at most `columns`, a longer word aside. The rest of a line
/// begins below the line's second column, if it has one (behind several blanks), else eight columns deeper
/// than a line that is indented by less than sixteen, else as deep as the line.
std::string wrapLines(const std::string& text, std::size_t columns);

}  // namespace cartvo
