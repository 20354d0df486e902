// Formats tables as text and Markdown.
#include "tools/report/table.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace cartvo {
namespace {

/// Number of characters: does not count continuation bytes of UTF-8.
std::size_t width(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

std::string padded(const std::string& text, std::size_t columns, bool is_first) {
  const std::string space(columns - width(text), ' ');
  return is_first ? text + space : space + text;
}

std::string line(const std::vector<std::string>& cells, const std::vector<std::size_t>& widths,
                 const std::string& before, const std::string& between, const std::string& after) {
  std::string text = before;
  for (std::size_t i = 0; i < cells.size(); ++i)
    text += (i > 0 ? between : "") + padded(cells[i], widths[i], i == 0);
  text += after;
  text.erase(text.find_last_not_of(' ') + 1);
  return text + "\n";
}

}  // namespace

void Table::add(std::vector<std::string> row) {
  if (row.size() != header_.size()) {
    throw std::invalid_argument("Table::add: a row of " + std::to_string(row.size()) +
                                " cells in a table of " + std::to_string(header_.size()) + " columns");
  }
  rows_.push_back(std::move(row));
}

std::vector<std::size_t> Table::widths() const {
  std::vector<std::size_t> widths;
  for (std::size_t column = 0; column < header_.size(); ++column) {
    widths.push_back(std::max<std::size_t>(3, width(header_[column])));  // a Markdown rule needs three
    for (const std::vector<std::string>& row : rows_)
      widths.back() = std::max(widths.back(), width(row[column]));
  }
  return widths;
}

std::string Table::text() const {
  const std::vector<std::size_t> widths = this->widths();
  std::string text = line(header_, widths, "", "  ", "");
  for (const std::vector<std::string>& row : rows_)
    text += line(row, widths, "", "  ", "");
  return text;
}

std::string Table::markdown() const {
  const std::vector<std::size_t> widths = this->widths();
  std::string text = line(header_, widths, "| ", " | ", " |");
  std::vector<std::string> rule;
  for (std::size_t i = 0; i < widths.size(); ++i)
    rule.push_back(i == 0 ? std::string(widths[i], '-') : std::string(widths[i] - 1, '-') + ":");
  text += line(rule, widths, "| ", " | ", " |");
  for (const std::vector<std::string>& row : rows_)
    text += line(row, widths, "| ", " | ", " |");
  return text;
}

std::string Table::as(ReportFormat format) const {
  return format == ReportFormat::markdown ? markdown() : text();
}

std::string fixed(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

std::string significant(double value) {
  if (value == 0.0) return "0";
  const int before_point = static_cast<int>(std::floor(std::log10(std::abs(value)))) + 1;
  return fixed(value, std::clamp(3 - before_point, 0, 9));
}

}  // namespace cartvo
