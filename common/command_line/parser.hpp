// The command line of a program: commands, options and conditions on their values. parser.cpp is the only
// source that includes CLI11, which takes seconds to compile.
#pragma once

#include <cstddef>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/command_line/command_line_error.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace cartvo {

/// An option, a flag or an argument of a command. Copies stand for the same one, which lives as long as its
/// Program.
class Option {
 public:
  /// Returns what is wrong with a value; empty: nothing.
  using Check = std::function<std::string(const std::string&)>;
  /// As Check; may change the value.
  using Transformation = std::function<std::string(std::string&)>;

  explicit Option(CLI::Option* option) : option_(option) {}

  // Each returns the option itself.
  Option required() const;
  /// Name of the values' type in --help.
  Option typeName(const std::string& name) const;
  /// Shows the present value of the option's variable in --help.
  Option captureDefault() const;
  /// Number of values; at first one, of a vector one or more.
  Option expected(int count) const;
  Option expected(int least, int most) const;
  /// Separates values within a word.
  Option delimiter(char separator) const;
  /// Heading in --help; empty: the option is hidden.
  Option group(const std::string& name) const;
  Option needs(Option other) const;
  Option excludes(Option other) const;
  /// `name`: of an option that the command has.
  Option excludes(const std::string& name) const;

  // Conditions on the values, checked in the order of these calls.
  /// `description`: follows the type in --help.
  Option check(const Check& check, const std::string& description = "") const;
  /// Changes the values before all checks.
  Option transform(const Transformation& transformation) const;
  Option range(double min, double max) const;
  Option range(int min, int max) const;
  Option choices(const std::vector<std::string>& values) const;
  Option choices(std::initializer_list<double> values) const;
  /// As choices(), but --help does not list them.
  Option unlistedChoices(const std::vector<std::string>& values) const;
  Option existingFolder() const;

  /// As in messages: the first long name, or that of an argument.
  std::string name() const;
  /// With dashes, long ones first; without the name of an argument.
  std::vector<std::string> names() const;
  bool isArgument() const;
  bool isFlag() const;
  /// False if the option may be given without a value.
  bool needsValue() const;
  /// Empty: the option is hidden.
  std::string groupName() const;
  /// The type of the values in --help: "TYPE:DESCRIPTION".
  std::string type() const;
  /// Number of given values, of a flag how often it was given.
  std::size_t count() const;
  /// The given values.
  std::vector<std::string> values() const;

 private:
  CLI::Option* option_;
};

/// A command, or a group of its options. Copies stand for the same one, which lives as long as its Program.
class Command {
 public:
  explicit Command(CLI::App* app) : app_(app) {}

  /// Adds an option "--long,-s", an argument "NAME" or both. Its value is assigned to `variable`: a
  /// number, std::string or path, or a vector or std::optional of them, of the types at the end of
  /// parser.cpp.
  template <typename Value>
  Option addOption(const std::string& names, Value& variable, const std::string& description) const;
  /// As addOption(), for values that `use` receives.
  Option addListOption(const std::string& names, const std::function<void(const std::vector<double>&)>& use,
                       const std::string& description) const;
  Option addFlag(const std::string& names, bool& variable, const std::string& description) const;
  /// A flag that prints `text()` and a line feed, and ends the program with success.
  Option addTextFlag(const std::string& names, const std::function<std::string()>& text) const;
  /// A text flag with the program's name and version.
  Option addVersionFlag(const std::string& names, const std::string& text) const;
  /// Options that --help shows together.
  Command addOptionGroup(const std::string& name, const std::string& description) const;
  Command addSubcommand(const std::string& name, const std::string& description) const;
  /// How many subcommands a command line must and may name.
  void limitSubcommands(std::size_t least, std::size_t most) const;
  /// Text at the end of --help.
  void footer(const std::string& text) const;
  /// Called when all of the command line was read.
  void callback(const std::function<void()>& work) const;

  /// Empty: this is a group of options.
  std::string name() const;
  bool isHidden() const;
  std::vector<Command> subcommands() const;
  std::vector<Command> optionGroups() const;
  bool requiresSubcommand() const;
  /// The subcommand that the command line names.
  std::optional<Command> givenSubcommand() const;
  /// The options that are in no group.
  std::vector<Option> options() const;
  /// The option of this name, such as "--json"; empty if neither the command nor its groups have it.
  std::optional<Option> option(const std::string& name) const;

 private:
  CLI::App* app_;
};

/// The command line of a program.
class Program {
 public:
  Program(const std::string& name, const std::string& description);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// The program itself as a command.
  Command command() const { return Command(app_.get()); }

  /// Assigns the values of `arguments`, which are without the program's name, and calls the commands'
  /// callbacks. Returns false after printing what was asked for instead, such as help. Throws
  /// CommandLineError, and what the callbacks throw.
  bool parse(std::vector<std::string> arguments);

 private:
  std::unique_ptr<CLI::App> app_;
};

}  // namespace cartvo
