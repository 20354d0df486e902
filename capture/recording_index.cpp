#include "capture/recording_index.hpp"

#include <array>
#include <charconv>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string_view>

namespace cartvo {
namespace {

constexpr std::string_view kHeader =
    "number,time_ms,sequence,pts,exposure_ns,arrival_ns,instant_source,size,key,status";
constexpr std::array<std::string_view, 3> kInstantSources = {"file", "sender_report", "arrival"};
constexpr std::array<std::string_view, 2> kStatuses = {"good", "damaged"};

std::vector<std::string> splitFields(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream input(line);
  for (std::string field; std::getline(input, field, ',');)
    fields.push_back(field);
  return fields;
}

template <typename Number>
bool parse(const std::string& text, Number& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

template <typename Enumeration, std::size_t size>
bool parseName(const std::string& text, const std::array<std::string_view, size>& names, Enumeration& value) {
  for (std::size_t i = 0; i < size; ++i) {
    if (text != names[i]) continue;
    value = static_cast<Enumeration>(i);
    return true;
  }
  return false;
}

}  // namespace

std::string indexHeader() {
  return std::string(kHeader);
}

std::string toText(const IndexRow& row) {
  std::ostringstream text;
  text << row.number << ',' << row.time_ms << ',' << row.sequence << ',' << row.pts << ',' << row.exposure_ns
       << ',' << row.arrival_ns << ',' << kInstantSources[static_cast<std::size_t>(row.instant_source)] << ','
       << row.size << ',' << (row.key ? 1 : 0) << ',' << kStatuses[static_cast<std::size_t>(row.status)];
  return text.str();
}

std::optional<IndexRow> parseIndexRow(const std::string& line) {
  const std::vector<std::string> fields = splitFields(line);
  if (fields.size() != 10) return std::nullopt;
  IndexRow row;
  int key = 0;
  const bool good =
      parse(fields[0], row.number) && parse(fields[1], row.time_ms) && parse(fields[2], row.sequence) &&
      parse(fields[3], row.pts) && parse(fields[4], row.exposure_ns) && parse(fields[5], row.arrival_ns) &&
      parseName(fields[6], kInstantSources, row.instant_source) && parse(fields[7], row.size) &&
      parse(fields[8], key) && (key == 0 || key == 1) && parseName(fields[9], kStatuses, row.status);
  if (!good) return std::nullopt;
  row.key = key == 1;
  return row;
}

Index readIndex(const std::filesystem::path& file) {
  std::ifstream input(file);
  std::string line;
  if (!input) throw std::runtime_error("cannot read the recording's index " + file.string());
  if (!std::getline(input, line) || line != kHeader) {
    throw std::runtime_error(file.string() + ", line 1: expected the header '" + std::string(kHeader) + "'");
  }
  Index index;
  for (int number = 2; std::getline(input, line); ++number) {
    // The last line may have been cut, even to one that reads well: it counts only with its end.
    const std::optional<IndexRow> row = input.eof() ? std::nullopt : parseIndexRow(line);
    if (!row || row->number != index.rows.size()) {
      index.damage = file.string() + ", line " + std::to_string(number) + " is damaged or cut short";
      break;
    }
    index.rows.push_back(*row);
  }
  return index;
}

}  // namespace cartvo
