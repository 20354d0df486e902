#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cartvo {

enum class ReportFormat : std::uint8_t { text, markdown };

/// Text of a cell whose value does not apply or is unknown.
inline constexpr const char* kNoValue = "–";

/// Table of UTF-8 text with a header.
class Table {
 public:
  explicit Table(std::vector<std::string> header) : header_(std::move(header)) {}

  /// Adds a row. Throws std::invalid_argument unless it has one cell for each column.
  void add(std::vector<std::string> row);

  /// Text with aligned columns: the first to the left, the others to the right.
  std::string text() const;

  /// GitHub's Markdown, also aligned in its source text.
  std::string markdown() const;

  /// Text or Markdown; not for JSON.
  std::string as(ReportFormat format) const;

 private:
  std::vector<std::size_t> widths() const;

  std::vector<std::string> header_;
  std::vector<std::vector<std::string>> rows_;
};

/// Formats like printf's %.*f.
std::string fixed(double value, int decimals);

/// Formats with three significant digits without an exponent: 0.0123, 1.23, 123.
std::string significant(double value);

}  // namespace cartvo
