#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

namespace cartvo {

/// A value of a YAML file that knows its file, line and key, for errors a person can act on:
/// "FILE:LINE: KEY: expected ..., found ...". All errors are std::runtime_error.
class StrictYaml {
 public:
  /// Reads a whole file (up to 1 MiB) as a map. Takes "%YAML:1.0", as OpenCV writes it, for the directive it
  /// means.
  static StrictYaml readFile(const std::filesystem::path& file);

  /// As `readFile`, of a text that lies elsewhere; `name` stands for the file in errors.
  static StrictYaml parse(std::string text, const std::filesystem::path& name);

  /// Refuses keys beside these, and keys given twice.
  void allowOnly(std::initializer_list<const char*> keys) const;

  /// Whether the key is there with a value.
  bool has(const std::string& key) const;

  /// The value of a key; a missing one is an error.
  StrictYaml operator[](const std::string& key) const;

  /// Printable characters in UTF-8: no line breaks, no other control characters.
  std::string text() const;
  std::int64_t integer(std::int64_t least, std::int64_t most) const;
  double number(double least, double most) const;

  /// A sequence of numbers, of any length or of `count`; a sequence of sequences is taken row by row. At
  /// most 10,000.
  std::vector<double> numbers() const;
  std::vector<double> numbers(std::size_t count) const;

  [[noreturn]] void failExpecting(const std::string& expected) const;

  /// As `failExpecting`, with a sentence of its own: "FILE:LINE: KEY: PROBLEM". Does not repeat the value,
  /// which may be secret.
  [[noreturn]] void fail(const std::string& problem) const;

 private:
  StrictYaml(std::filesystem::path file, std::string key, const YAML::Node& node);

  std::filesystem::path file_;
  std::string key_;
  YAML::Node node_;
};

}  // namespace cartvo
