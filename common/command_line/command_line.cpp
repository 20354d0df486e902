// Error messages for command lines with unknown commands and options.
#include "common/command_line/command_line.hpp"

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <optional>
#include <utility>

#include "common/ascii_text.hpp"
#include "common/command_line/parser.hpp"

namespace cartvo {
namespace {

using Words = std::vector<std::string>;

/// Number of letters to insert, delete or replace to turn one word into the other (Levenshtein distance).
std::size_t editDistance(const std::string& from, const std::string& to) {
  std::vector<std::size_t> row(to.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < from.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < to.size(); ++j) {
      const std::size_t replaced = diagonal + (from[i] == to[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

/// The nearest of the words: one that begins with `word`, or differs in at most a third of its letters.
std::optional<std::string> nearest(const std::string& word, const Words& words) {
  std::optional<std::string> best;
  std::size_t best_distance = std::max<std::size_t>(1, (word.size() + 1) / 3) + 1;
  for (const std::string& candidate : words) {
    const std::size_t distance =
        word.size() > 1 && candidate.starts_with(word) ? 1 : editDistance(word, candidate);
    if (distance < best_distance) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

std::string joined(const Words& words, const char* separator) {
  std::string text;
  for (const std::string& word : words)
    text += (text.empty() ? "" : separator) + word;
  return text;
}

Words namesOf(const std::vector<Command>& commands) {
  Words names;
  for (const Command command : commands)
    names.push_back(command.name());
  return names;
}

std::optional<Command> subcommand(Command command, const std::string& name) {
  for (const Command inner : command.subcommands()) {
    if (inner.name() == name) return inner;
  }
  return std::nullopt;
}

/// The commands that a command line names, from `cartvo` on.
using Chain = std::vector<Command>;

std::string textOf(const Chain& chain) {
  return joined(namesOf(chain), " ");
}

/// An unknown word where a command may stand. A word that names a file or folder, or no command nearly, may
/// be an argument if a command is not required.
std::string unknownCommand(const Chain& chain, const std::string& word) {
  const Words names = namesOf(chain.back().subcommands());
  if (names.empty()) return {};
  const std::optional<std::string> similar = nearest(word, names);
  if (!chain.back().requiresSubcommand() && (!similar || std::filesystem::exists(word))) return {};
  const std::string intended = textOf(chain) + " " + word;
  if (similar)
    return "there is no command '" + intended + "'; did you mean '" + textOf(chain) + " " + *similar + "'?";
  return "there is no command '" + intended + "'; the commands are " + joined(names, ", ");
}

bool isLongOption(const std::string& word) {
  return word.size() > 2 && word.starts_with("--");
}

/// Adds the long options of a command and of its groups.
void addOptionNames(Command command, Words& names) {
  for (const Option option : command.options()) {
    for (const std::string& name : option.names()) {
      if (isLongOption(name)) names.push_back(name);
    }
  }
  for (const Command group : command.optionGroups())
    addOptionNames(group, names);
}

std::string unknownOption(const Chain& chain, const std::string& word) {
  const std::string name = word.substr(0, word.find('='));
  Words names;
  for (const Command command : chain) {
    if (command.option(name)) return {};
    addOptionNames(command, names);
  }
  const std::optional<std::string> similar = nearest(name, names);
  return textOf(chain) + " has no option " + name + (similar ? "; did you mean " + *similar + "?" : "");
}

/// CLI11's "Could not convert: --offset-ms = abc" with what was expected; any other message unchanged.
std::string reasonOf(const CommandLineError& error) {
  std::string message = error.what();
  const std::string prefix = "Could not convert: ", separator = " = ";
  const std::size_t end = message.find(separator);
  if (!message.starts_with(prefix) || end == std::string::npos) return message;
  return message.substr(prefix.size(), end - prefix.size()) + ": expected a number, found '" +
         message.substr(end + separator.size()) + "'";
}

/// The words of the arguments before "--".
Words wordsOf(const Words& arguments) {
  return {arguments.begin(), std::find(arguments.begin(), arguments.end(), "--")};
}

}  // namespace

Words withHelpAsOption(Words arguments) {
  if (arguments.empty() || arguments.front() != "help") return arguments;
  arguments.erase(arguments.begin());
  arguments.emplace_back("--help");
  return arguments;
}

std::string unknownWord(Command cartvo, const Words& arguments) {
  const Words words = wordsOf(arguments);
  Chain chain{cartvo};
  bool after_option = false;
  for (const std::string& word : words) {
    if (const std::optional<Command> command = subcommand(chain.back(), word)) {
      chain.push_back(*command);
      after_option = false;
    } else if (word.starts_with("-")) {
      after_option = true;  // what follows may be the option's value
    } else if (!after_option) {
      if (std::string unknown = unknownCommand(chain, word); !unknown.empty()) return unknown;
      break;
    }
  }
  for (const std::string& word : words) {
    if (!isLongOption(word)) continue;
    if (std::string unknown = unknownOption(chain, word); !unknown.empty()) return unknown;
  }
  return {};
}

void refuseUnusableValues(Command command) {
  for (const Option option : command.options()) {
    if (option.isFlag()) continue;
    const bool may_be_number = !option.isArgument();
    option.check([may_be_number](const std::string& value) -> std::string {
      if (value.empty()) return "expected a value, found an empty one";
      std::string word = lowerCase(value);
      if (word.starts_with('-') || word.starts_with('+')) word.erase(0, 1);
      return may_be_number && word == "nan" ? "expected a number, found '" + value + "'" : "";
    });
  }
  for (const Command inner : command.subcommands())
    refuseUnusableValues(inner);
  for (const Command group : command.optionGroups())
    refuseUnusableValues(group);
}

std::string commandLineError(Command cartvo, const CommandLineError& error) {
  Chain chain{cartvo};
  while (const std::optional<Command> command = chain.back().givenSubcommand())
    chain.push_back(*command);
  return cartvo.name() + ": " + reasonOf(error) + "\n'" + textOf(chain) + " --help' explains the command.\n";
}

}  // namespace cartvo
