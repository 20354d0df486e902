// Writes completion scripts for bash.
#include "common/command_line/bash_completion.hpp"

#include <algorithm>
#include <vector>

#include <CLI/CLI.hpp>

namespace cartvo {
namespace {

constexpr const char* kFlag = "--bash-completion";

/// The end of each script: chooses among what the cases above it have found.
constexpr const char* kChoose = R"(  COMPREPLY=()
  case "$value" in
    files)
      compopt -o filenames 2>/dev/null
      mapfile -t COMPREPLY < <(compgen -f -- "$current")
      return ;;
    folders)
      compopt -o filenames 2>/dev/null
      mapfile -t COMPREPLY < <(compgen -d -- "$current")
      return ;;
    other) return ;;
    words) ;;
    *)
      if [[ $current == -* || -z $words && $arguments != files ]]; then words=$options; fi
      if [[ $current != -* && $arguments == files ]]; then
        compopt -o filenames 2>/dev/null
        mapfile -t COMPREPLY < <(compgen -f -- "$current")
      fi ;;
  esac
  mapfile -t -O ${#COMPREPLY[@]} COMPREPLY < <(compgen -W "$words" -- "$current")
}
)";

/// A command with the names that lead to it: `cartvo calibrate live`.
struct Command {
  std::string path;
  const CLI::App* app = nullptr;
};

std::vector<const CLI::App*> namedCommands(const CLI::App& app) {
  return app.get_subcommands(
      [](const CLI::App* command) { return !command->get_name().empty() && !command->get_group().empty(); });
}

void addCommands(const Command& command, std::vector<Command>& commands) {
  commands.push_back(command);
  for (const CLI::App* inner : namedCommands(*command.app))
    addCommands({command.path + " " + inner->get_name(), inner}, commands);
}

/// The visible options of a command and of its groups, which CLI11 keeps as commands without a name.
std::vector<const CLI::Option*> optionsOf(const CLI::App& app) {
  std::vector<const CLI::Option*> options =
      app.get_options([](const CLI::Option* option) { return !option->get_group().empty(); });
  for (const CLI::App* group :
       app.get_subcommands([](const CLI::App* part) { return part->get_name().empty(); })) {
    for (const CLI::Option* option : optionsOf(*group)) {
      if (option != group->get_help_ptr()) options.push_back(option);
    }
  }
  return options;
}

std::vector<std::string> namesOf(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_lnames())
    names.push_back("--" + name);
  for (const std::string& name : option.get_snames())
    names.push_back("-" + name);
  return names;
}

void append(std::string& words, const std::string& word) {
  words += (words.empty() ? "" : " ") + word;
}

/// The choices that a type shows as {a,b}, separated by blanks; empty if it has none.
std::string choicesOf(const std::string& type) {
  const std::size_t begin = type.find('{');
  const std::size_t end = type.find('}');
  if (begin == std::string::npos || end == std::string::npos || end < begin) return {};
  std::string choices = type.substr(begin + 1, end - begin - 1);
  std::replace(choices.begin(), choices.end(), ',', ' ');
  return choices;
}

/// What completes a value of this type: files, folders, words (of a choice) or other (nothing does).
std::string kindOf(const std::string& type) {
  if (!choicesOf(type).empty()) return "words";
  const std::string name = type.substr(0, type.find(':'));
  if (name == "DIR") return "folders";
  return name == "FILE" || name == "PATH" || name == "TEXT" ? "files" : "other";
}

bool takesValue(const CLI::Option& option) {
  return option.nonpositional() && option.get_items_expected_min() > 0;
}

/// The case that finds out which command the words before the cursor name.
std::string caseOfWords(const std::vector<Command>& commands) {
  std::string patterns;
  for (auto command = commands.begin() + 1; command != commands.end(); ++command)
    patterns += (patterns.empty() ? "      '" : " | \\\n      '") + command->path + "'";
  if (patterns.empty()) return {};
  return "  local i\n  for ((i = 1; i < COMP_CWORD; ++i)); do\n    case \"$command ${COMP_WORDS[i]}\" in\n" +
         patterns + ") command+=\" ${COMP_WORDS[i]}\" ;;\n    esac\n  done\n";
}

std::string caseOfCommand(const Command& command) {
  std::string words;
  for (const CLI::App* inner : namedCommands(*command.app))
    append(words, inner->get_name());
  std::string names;
  bool takes_arguments = false;
  for (const CLI::Option* option : optionsOf(*command.app)) {
    takes_arguments = takes_arguments || option->get_positional();
    for (const std::string& name : namesOf(*option))
      append(names, name);
  }
  return "    '" + command.path + "')" + (words.empty() ? "" : " words='" + words + "'") + " options='" +
         names + "'" + (takes_arguments ? " arguments=files" : "") + " ;;\n";
}

std::string caseOfValue(const Command& command, const CLI::Option& option) {
  std::string patterns;
  for (const std::string& name : namesOf(option))
    patterns += (patterns.empty() ? "'" : " | '") + command.path + " " + name + "'";
  const std::string type = option.get_type_name();
  const std::string kind = kindOf(type);
  return "    " + patterns + ") value=" + kind + (kind == "words" ? " words='" + choicesOf(type) + "'" : "") +
         " ;;\n";
}

}  // namespace

std::string bashCompletion(const CLI::App& program, const std::string& name) {
  std::vector<Command> commands;
  addCommands({name, &program}, commands);
  std::string script = "# Completion of " + name + " in bash. Printed by: " + name + " " + kFlag + "\n_" +
                       name + "() {\n  local command=" + name +
                       R"( words='' options='' arguments='' value=''
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}
  # bash takes --option=value as three words.
  if [[ $current == = ]]; then
    current=''
  elif [[ $previous == = ]]; then
    previous=${COMP_WORDS[COMP_CWORD - 2]}
  fi
)" + caseOfWords(commands) +
                       "  case \"$command\" in\n";
  for (const Command& command : commands)
    script += caseOfCommand(command);
  script += "  esac\n  case \"$command $previous\" in\n";
  for (const Command& command : commands) {
    for (const CLI::Option* option : optionsOf(*command.app)) {
      if (takesValue(*option)) script += caseOfValue(command, *option);
    }
  }
  return script + "  esac\n" + kChoose + "complete -F _" + name + " " + name + "\n";
}

void addBashCompletionFlag(CLI::App& program, const std::string& name) {
  program
      .add_flag_callback(kFlag,
                         [&program, name] {
                           std::string script = bashCompletion(program, name);
                           script.pop_back();  // exit() ends it with a line feed
                           throw CLI::CallForVersion(script, 0);
                         })
      ->group("");
}

}  // namespace cartvo
