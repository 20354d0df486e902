#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

namespace cartvo {

/// A value of a YAML file with its file, line and key, for errors such as "FILE:LINE: KEY: expected ...,
/// found ...". All errors are std::runtime_error.
class StrictYaml {
 public:
  /// Reads a whole regular file (at most 1 MiB) as a map, see readInputText. Accepts the directive
  /// "%YAML:1.0" that OpenCV writes.
  static StrictYaml readFile(const std::filesystem::path& file);

  /// As `readFile`, from text; `name` stands for the file in errors.
  static StrictYaml parse(std::string text, const std::filesystem::path& name);

  /// Throws for keys other than these and for repeated keys.
  void allowOnly(std::initializer_list<const char*> keys) const;

  /// Whether the key exists and has a value.
  bool has(const std::string& key) const;

  /// The value of a key. Throws "FILE:LINE: KEY is missing" if the map does not have it.
  StrictYaml operator[](const std::string& key) const;

  bool isSequence() const { return node_.IsSequence(); }
  bool isText() const { return node_.IsScalar(); }

  /// The values of a sequence of at most `max` values. Otherwise throws as failExpecting(expected).
  std::vector<StrictYaml> items(std::size_t max, const std::string& expected) const;

  /// Text of printable UTF-8 characters, see isPrintable.
  std::string text() const;
  std::int64_t integer(std::int64_t min, std::int64_t max) const;
  double number(double min, double max) const { return number(min, max, ""); }
  /// `unit`: for the error.
  double number(double min, double max, const std::string& unit) const;

  /// A sequence of numbers, of any length up to 10,000 or of `count`. A sequence of sequences is read row by
  /// row.
  std::vector<double> numbers() const;
  std::vector<double> numbers(std::size_t count) const;

  /// Throws "FILE:LINE: KEY: expected EXPECTED, found VALUE".
  [[noreturn]] void failExpecting(const std::string& expected) const;

  /// Throws "FILE:LINE: KEY: PROBLEM", without the value, which may be secret.
  [[noreturn]] void fail(const std::string& problem) const;

 private:
  StrictYaml(std::filesystem::path file, std::string key, const YAML::Node& node);

  /// "FILE:LINE: ", without the line where it is unknown.
  std::string place() const;

  std::filesystem::path file_;
  std::string key_;
  YAML::Node node_;
};

/// Text as a double-quoted YAML value; control characters become blanks.
std::string quotedYaml(const std::string& text);

}  // namespace cartvo
