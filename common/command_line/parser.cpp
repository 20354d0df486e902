// Parses command lines with CLI11.
#include "common/command_line/parser.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <sstream>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>
#include <unistd.h>

#include "common/command_line/terminal.hpp"

namespace cartvo {
namespace {

/// Columns of --help: those of the terminal, within limits that its two columns need and a reader's eye
/// follows.
std::size_t helpColumns() {
  constexpr std::size_t kLeast = 80, kMost = 120;
  return std::clamp(terminalColumns(STDOUT_FILENO).value_or(kMost), kLeast, kMost);
}

/// CLI11's range, but also of a text that is no number it says what is expected.
template <typename Number>
CLI::Validator rangeOf(Number min, Number max) {
  const CLI::Range range(min, max);
  const auto check = [range](std::string& value) {
    return range(value).empty() ? std::string()
                                : "expected " + range.get_description() + ", found '" + value + "'";
  };
  return {check, range.get_description()};
}

}  // namespace

Option Option::required() const {
  return Option(option_->required());
}

Option Option::typeName(const std::string& name) const {
  return Option(option_->type_name(name));
}

Option Option::captureDefault() const {
  return Option(option_->capture_default_str());
}

Option Option::expected(int count) const {
  return Option(option_->expected(count));
}

Option Option::expected(int least, int most) const {
  return Option(option_->expected(least, most));
}

Option Option::delimiter(char separator) const {
  return Option(option_->delimiter(separator));
}

Option Option::group(const std::string& name) const {
  return Option(option_->group(name));
}

Option Option::needs(Option other) const {
  return Option(option_->needs(other.option_));
}

Option Option::excludes(Option other) const {
  return Option(option_->excludes(other.option_));
}

Option Option::excludes(const std::string& name) const {
  return Option(option_->excludes(name));
}

Option Option::check(const Check& check, const std::string& description) const {
  return Option(option_->check(check, description));
}

Option Option::transform(const Transformation& transformation) const {
  return Option(option_->transform(CLI::Validator(transformation, "")));
}

Option Option::range(double min, double max) const {
  return Option(option_->check(rangeOf(min, max)));
}

Option Option::range(int min, int max) const {
  return Option(option_->check(rangeOf(min, max)));
}

Option Option::choices(const std::vector<std::string>& values) const {
  return Option(option_->check(CLI::IsMember(values)));
}

Option Option::choices(std::initializer_list<double> values) const {
  return Option(option_->check(CLI::IsMember(values)));
}

Option Option::unlistedChoices(const std::vector<std::string>& values) const {
  return Option(option_->check(CLI::IsMember(values).description("")));
}

Option Option::existingFolder() const {
  return Option(option_->check(CLI::ExistingDirectory));
}

std::string Option::name() const {
  return option_->get_name();
}

std::vector<std::string> Option::names() const {
  std::vector<std::string> names;
  for (const std::string& name : option_->get_lnames())
    names.push_back("--" + name);
  for (const std::string& name : option_->get_snames())
    names.push_back("-" + name);
  return names;
}

bool Option::isArgument() const {
  return option_->get_positional();
}

bool Option::isFlag() const {
  return option_->get_items_expected_max() == 0;
}

bool Option::needsValue() const {
  return option_->get_items_expected_min() > 0;
}

std::string Option::groupName() const {
  return option_->get_group();
}

std::string Option::type() const {
  return option_->get_type_name();
}

std::size_t Option::count() const {
  return option_->count();
}

std::vector<std::string> Option::values() const {
  return option_->results();
}

template <typename Value>
Option Command::addOption(const std::string& names, Value& variable, const std::string& description) const {
  return Option(app_->add_option(names, variable, description));
}

Option Command::addListOption(const std::string& names,
                              const std::function<void(const std::vector<double>&)>& use,
                              const std::string& description) const {
  return Option(app_->add_option_function<std::vector<double>>(names, use, description));
}

Option Command::addFlag(const std::string& names, bool& variable, const std::string& description) const {
  return Option(app_->add_flag(names, variable, description));
}

Option Command::addTextFlag(const std::string& names, const std::function<std::string()>& text) const {
  return Option(app_->add_flag_callback(names, [text] { throw CLI::CallForVersion(text(), 0); }));
}

Option Command::addVersionFlag(const std::string& names, const std::string& text) const {
  return Option(app_->set_version_flag(names, text));
}

Command Command::addOptionGroup(const std::string& name, const std::string& description) const {
  return Command(app_->add_option_group(name, description));
}

Command Command::addSubcommand(const std::string& name, const std::string& description) const {
  return Command(app_->add_subcommand(name, description));
}

void Command::limitSubcommands(std::size_t least, std::size_t most) const {
  app_->require_subcommand(least, most);
}

void Command::footer(const std::string& text) const {
  app_->footer(text);
}

void Command::callback(const std::function<void()>& work) const {
  app_->callback(work);
}

std::string Command::name() const {
  return app_->get_name();
}

bool Command::isHidden() const {
  return app_->get_group().empty();
}

std::vector<Command> Command::subcommands() const {
  std::vector<Command> commands;
  for (CLI::App* app : app_->get_subcommands([](CLI::App* part) { return !part->get_name().empty(); }))
    commands.emplace_back(app);
  return commands;
}

std::vector<Command> Command::optionGroups() const {
  std::vector<Command> groups;
  for (CLI::App* app : app_->get_subcommands([](CLI::App* part) { return part->get_name().empty(); }))
    groups.emplace_back(app);
  return groups;
}

bool Command::requiresSubcommand() const {
  return app_->get_require_subcommand_min() > 0;
}

std::optional<Command> Command::givenSubcommand() const {
  const std::vector<CLI::App*> given = app_->get_subcommands();
  return given.empty() ? std::nullopt : std::optional(Command(given.front()));
}

std::vector<Option> Command::options() const {
  std::vector<Option> options;
  for (CLI::Option* option : app_->get_options()) {
    const bool is_help_of_group = app_->get_name().empty() && option == app_->get_help_ptr();
    if (!is_help_of_group) options.emplace_back(option);
  }
  return options;
}

std::optional<Option> Command::option(const std::string& name) const {
  CLI::Option* found = app_->get_option_no_throw(name);
  return found == nullptr ? std::nullopt : std::optional(Option(found));
}

Program::Program(const std::string& name, const std::string& description)
    : app_(std::make_unique<CLI::App>(description, name)) {}

Program::~Program() = default;

bool Program::parse(std::vector<std::string> arguments) {
  std::reverse(arguments.begin(), arguments.end());  // CLI11 takes them from the end
  try {
    app_->parse(std::move(arguments));
    return true;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) throw CommandLineError(error.what());
    std::ostringstream text;
    app_->exit(error, text, text);  // prints help, or the text of a flag
    const bool is_help = dynamic_cast<const CLI::CallForHelp*>(&error) != nullptr;
    std::cout << (is_help ? wrapLines(text.str(), helpColumns()) : text.str()) << std::flush;
    return false;
  }
}

// The types of options' variables.
template Option Command::addOption(const std::string&, int&, const std::string&) const;
template Option Command::addOption(const std::string&, double&, const std::string&) const;
template Option Command::addOption(const std::string&, std::uint64_t&, const std::string&) const;
template Option Command::addOption(const std::string&, std::string&, const std::string&) const;
template Option Command::addOption(const std::string&, std::filesystem::path&, const std::string&) const;
template Option Command::addOption(const std::string&, std::optional<int>&, const std::string&) const;
template Option Command::addOption(const std::string&, std::optional<double>&, const std::string&) const;
template Option Command::addOption(const std::string&, std::vector<int>&, const std::string&) const;
template Option Command::addOption(const std::string&, std::vector<double>&, const std::string&) const;
template Option Command::addOption(const std::string&, std::vector<std::uint64_t>&, const std::string&) const;
template Option Command::addOption(const std::string&, std::vector<std::string>&, const std::string&) const;
template Option Command::addOption(const std::string&, std::vector<std::filesystem::path>&,
                                   const std::string&) const;

}  // namespace cartvo
