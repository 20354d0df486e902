#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cartvo {

enum class ReportFormat : std::uint8_t { text, markdown, json };

/// What stands in a cell whose value does not apply or is not known.
inline constexpr const char* kNoValue = "–";

/// Rows of text under a header, UTF-8.
class Table {
 public:
  explicit Table(std::vector<std::string> header) : header_(std::move(header)) {}

  /// Throws std::invalid_argument unless there is a cell for each column.
  void add(std::vector<std::string> row);

  /// Columns aligned: the first to the left, the others to the right.
  std::string text() const;

  /// GitHub's Markdown, aligned in the source as well.
  std::string markdown() const;

  /// Either of the two; not for JSON.
  std::string as(ReportFormat format) const;

 private:
  std::vector<std::size_t> widths() const;

  std::vector<std::string> header_;
  std::vector<std::vector<std::string>> rows_;
};

/// printf's %.*f.
std::string fixed(double value, int decimals);

/// Three significant digits, without an exponent where that is not needed: 0.0123, 1.23, 123.
std::string significant(double value);

}  // namespace cartvo
