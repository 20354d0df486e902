// YAML access with errors that name file, line and key.
#include "common/strict_yaml.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <yaml-cpp/eventhandler.h>

#include "common/exact_text.hpp"
#include "common/input_file.hpp"
#include "common/printable_text.hpp"

namespace cartvo {
namespace {

constexpr std::uintmax_t kMaxFileSize = 1 << 20;  // bytes

/// The sequence's length, and its items if they are few.
std::string describeSequence(const YAML::Node& node) {
  constexpr std::size_t kMaxShown = 10;
  std::string description = "a sequence of " + std::to_string(node.size());
  const bool is_short = node.size() > 0 && node.size() <= kMaxShown;
  if (!is_short ||
      !std::all_of(node.begin(), node.end(), [](const YAML::Node& item) { return item.IsScalar(); })) {
    return description;
  }
  std::string items;
  for (const YAML::Node& item : node)
    items += (items.empty() ? "" : ", ") + printableExcerpt(item.Scalar());
  return description + " [" + items + "]";
}

std::string describe(const YAML::Node& node) {
  switch (node.Type()) {
    case YAML::NodeType::Scalar:
      return "'" + printableExcerpt(node.Scalar()) + "'";
    case YAML::NodeType::Sequence:
      return describeSequence(node);
    case YAML::NodeType::Map:
      return "a map";
    default:
      return "nothing";
  }
}

template <typename Number>
bool parseNumber(const std::string& text, Number& number) {
  const char* const begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), number);
  return error == std::errc{} && end == text.data() + text.size();
}

/// Appends the numbers of a sequence. Their count is bounded, since aliases let a short file expand to a huge
/// sequence.
bool collectNumbers(const YAML::Node& node, int levels, std::vector<double>& numbers) {
  constexpr std::size_t kMaxNumbers = 10'000;
  if (node.IsSequence()) {
    return levels > 0 && std::all_of(node.begin(), node.end(), [&](const YAML::Node& item) {
             return collectNumbers(item, levels - 1, numbers);
           });
  }
  double number = 0.0;
  if (!node.IsScalar() || !parseNumber(node.Scalar(), number) || !std::isfinite(number)) return false;
  numbers.push_back(number);
  return numbers.size() <= kMaxNumbers;
}

constexpr int kMatrixLevels = 2;  // a sequence of rows

/// Number of the first line whose indentation has a tab, which yaml-cpp does not name; 0 if there is none.
int lineIndentedByTab(const std::string& text) {
  std::istringstream stream(text);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const std::size_t end = line.find_first_not_of(" \t");
    if (end != std::string::npos && line.find('\t') < end) return number;
  }
  return 0;
}

/// A parser's message in terms of the file.
std::string explained(const std::string& message) {
  struct Explanation {
    const char* begin;  ///< of yaml-cpp's message
    const char* text;
  };
  constexpr std::array<Explanation, 8> kExplanations{
      {{"illegal map value",
        "expected 'key: value', with a blank behind the colon, in this line or the one above"},
       {"end of map not found", "this line is indented otherwise than the lines that it belongs to"},
       {"end of sequence not found", "this line is indented otherwise than the lines that it belongs to"},
       {"end of sequence flow not found", "a '[' is not closed by ']'"},
       {"end of map flow not found", "a '{' is not closed by '}'"},
       {"unknown escape character", "a backslash in double quotes must begin an escape; use single quotes"},
       {"unknown token", "a value that begins with '@', '`' or '%' must be in quotes"},
       {"bad file", "it is nested too deeply"}}};
  for (const Explanation& explanation : kExplanations)
    if (message.starts_with(explanation.begin)) return explanation.text;
  return isPrintable(message) ? message : "it holds characters that cannot be shown";
}

/// Refuses a token between documents that yaml-cpp does not consume, such as a comma: its LoadAll would read
/// empty documents at that place without end.
class DocumentProgress : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& mark) override {
    if (mark.pos == last_) throw YAML::ParserException(mark, "expected one value, found more behind its end");
    last_ = mark.pos;
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
  }
  void OnMapEnd() override {}

 private:
  int last_ = -1;  // where the last document began
};

void requireProgress(const std::string& text) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  DocumentProgress progress;
  while (parser.HandleNextDocument(progress)) {
  }
}

/// The only document of a text that is not empty; an empty one if there is none.
YAML::Node onlyDocument(const std::string& text, const std::filesystem::path& name) {
  requireProgress(text);
  YAML::Node only;
  for (const YAML::Node& document : YAML::LoadAll(text)) {
    if (document.IsNull()) continue;
    if (!only.IsNull()) {
      throw std::runtime_error(name.string() + ":" + std::to_string(document.Mark().line + 1) +
                               ": a second document begins behind '---'; expected one");
    }
    only.reset(document);
  }
  return only;
}

}  // namespace

StrictYaml::StrictYaml(std::filesystem::path file, std::string key, const YAML::Node& node)
    : file_(std::move(file)), key_(std::move(key)), node_(node) {}

StrictYaml StrictYaml::readFile(const std::filesystem::path& file) {
  return parse(readInputText(file, kMaxFileSize), file);
}

StrictYaml StrictYaml::parse(std::string text, const std::filesystem::path& name) {
  // OpenCV before 4 writes a directive that is not valid YAML. A comment in its place keeps the line numbers.
  if (text.starts_with("%YAML:")) text.front() = '#';
  try {
    StrictYaml root(name, "", onlyDocument(text, name));
    if (!root.node_.IsMap()) root.failExpecting("a map of keys and values");
    return root;
  } catch (const YAML::ParserException& error) {
    if (const int line = lineIndentedByTab(text); line > 0) {
      throw std::runtime_error(name.string() + ":" + std::to_string(line) +
                               ": is not YAML: this line is indented by a tab; indent it by spaces");
    }
    throw std::runtime_error(name.string() + ":" + std::to_string(error.mark.line + 1) +
                             ": is not YAML: " + explained(error.msg));
  }
}

void StrictYaml::allowOnly(std::initializer_list<const char*> keys) const {
  if (!node_.IsMap()) failExpecting("a map of keys and values");
  std::string known;
  for (const char* key : keys)
    known += (known.empty() ? "" : ", ") + std::string(key);
  std::set<std::string> seen;
  for (const auto& entry : node_) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : std::string();
    const StrictYaml at_key(file_, (key_.empty() ? "" : key_ + ".") + printableExcerpt(key), entry.first);
    const bool is_known =
        std::any_of(keys.begin(), keys.end(), [&](const char* name) { return key == name; });
    if (!is_known) at_key.failExpecting("one of the keys " + known);
    if (!seen.insert(key).second) at_key.failExpecting("each key once");
  }
}

bool StrictYaml::has(const std::string& key) const {
  return node_.IsMap() && node_[key].IsDefined() && !node_[key].IsNull();
}

StrictYaml StrictYaml::operator[](const std::string& key) const {
  const std::string full_key = key_.empty() ? key : key_ + "." + key;
  if (!node_.IsMap()) failExpecting("a map with the key " + key);
  if (!has(key)) throw std::runtime_error(place() + full_key + " is missing");
  return {file_, full_key, node_[key]};
}

std::vector<StrictYaml> StrictYaml::items(std::size_t max, const std::string& expected) const {
  if (!node_.IsSequence() || node_.size() > max) failExpecting(expected);
  std::vector<StrictYaml> values;
  for (std::size_t i = 0; i < node_.size(); ++i)
    values.push_back(StrictYaml(file_, key_ + "[" + std::to_string(i) + "]", node_[i]));
  return values;
}

std::string StrictYaml::text() const {
  if (!node_.IsScalar())  // without its items: one may be a password
    fail("expected text, found " + std::string(node_.IsSequence() ? "a sequence" : "a map"));
  if (!isPrintable(node_.Scalar())) fail("expected text of printable characters in UTF-8; it holds others");
  return node_.Scalar();
}

std::int64_t StrictYaml::integer(std::int64_t min, std::int64_t max) const {
  std::int64_t value = 0;
  if (!node_.IsScalar() || !parseNumber(node_.Scalar(), value) || value < min || value > max) {
    failExpecting("an integer from " + std::to_string(min) + " to " + std::to_string(max));
  }
  return value;
}

double StrictYaml::number(double min, double max, const std::string& unit) const {
  double value = 0.0;
  if (!node_.IsScalar() || !parseNumber(node_.Scalar(), value) || !(value >= min && value <= max)) {
    constexpr int kDigits = 10;  // 1e6 as 1000000
    failExpecting("a number from " + roundedText(min, kDigits) + " to " + roundedText(max, kDigits) +
                  (unit.empty() ? "" : " " + unit));
  }
  return value;
}

std::vector<double> StrictYaml::numbers() const {
  std::vector<double> values;
  if (!node_.IsSequence() || !collectNumbers(node_, kMatrixLevels, values))
    failExpecting("a sequence of numbers");
  return values;
}

std::vector<double> StrictYaml::numbers(std::size_t count) const {
  std::vector<double> values;
  if (!node_.IsSequence() || !collectNumbers(node_, kMatrixLevels, values) || values.size() != count) {
    failExpecting("a sequence of " + std::to_string(count) + " numbers");
  }
  return values;
}

void StrictYaml::failExpecting(const std::string& expected) const {
  fail("expected " + expected + ", found " + describe(node_));
}

void StrictYaml::fail(const std::string& problem) const {
  std::string message = place();
  if (!key_.empty()) message += key_ + ": ";
  throw std::runtime_error(message + problem);
}

std::string StrictYaml::place() const {
  const int line = node_.Mark().line + 1;
  std::string place = file_.string();
  if (line > 0) place.append(":").append(std::to_string(line));
  return place + ": ";
}

std::string quotedYaml(const std::string& text) {
  std::string result = "\"";
  for (const char character : text) {
    if (character == '"' || character == '\\') result += '\\';
    result += static_cast<unsigned char>(character) < ' ' ? ' ' : character;
  }
  return result + "\"";
}

}  // namespace cartvo
