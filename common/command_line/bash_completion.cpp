// Writes completion scripts for bash.
#include "common/command_line/bash_completion.hpp"

#include <algorithm>
#include <vector>

#include "common/command_line/parser.hpp"

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
struct NamedCommand {
  std::string path;
  Command command;
};

std::vector<Command> visibleSubcommands(Command command) {
  std::vector<Command> visible;
  for (const Command inner : command.subcommands()) {
    if (!inner.isHidden()) visible.push_back(inner);
  }
  return visible;
}

void addCommands(const NamedCommand& named, std::vector<NamedCommand>& commands) {
  commands.push_back(named);
  for (const Command inner : visibleSubcommands(named.command))
    addCommands({named.path + " " + inner.name(), inner}, commands);
}

/// The visible options of a command and of its groups.
std::vector<Option> optionsOf(Command command) {
  std::vector<Option> options;
  for (const Option option : command.options()) {
    if (!option.groupName().empty()) options.push_back(option);
  }
  for (const Command group : command.optionGroups()) {
    for (const Option option : optionsOf(group))
      options.push_back(option);
  }
  return options;
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

/// Kind of the completions of a value of this type: files, folders, words (of a choice) or other (none).
std::string kindOf(const std::string& type) {
  if (!choicesOf(type).empty()) return "words";
  const std::string name = type.substr(0, type.find(':'));
  if (name == "DIR") return "folders";
  return name == "FILE" || name == "PATH" || name == "TEXT" ? "files" : "other";
}

/// The case that finds out which command the words before the cursor name.
std::string caseOfWords(const std::vector<NamedCommand>& commands) {
  std::string patterns;
  for (auto command = commands.begin() + 1; command != commands.end(); ++command)
    patterns += (patterns.empty() ? "      '" : " | \\\n      '") + command->path + "'";
  if (patterns.empty()) return {};
  return "  local i\n  for ((i = 1; i < COMP_CWORD; ++i)); do\n    case \"$command ${COMP_WORDS[i]}\" in\n" +
         patterns + ") command+=\" ${COMP_WORDS[i]}\" ;;\n    esac\n  done\n";
}

std::string caseOfCommand(const NamedCommand& named) {
  std::string words;
  for (const Command inner : visibleSubcommands(named.command))
    append(words, inner.name());
  std::string names;
  bool takes_arguments = false;
  for (const Option option : optionsOf(named.command)) {
    takes_arguments = takes_arguments || option.isArgument();
    for (const std::string& name : option.names())
      append(names, name);
  }
  return "    '" + named.path + "')" + (words.empty() ? "" : " words='" + words + "'") + " options='" +
         names + "'" + (takes_arguments ? " arguments=files" : "") + " ;;\n";
}

std::string caseOfValue(const NamedCommand& named, Option option) {
  std::string patterns;
  for (const std::string& name : option.names())
    patterns += (patterns.empty() ? "'" : " | '") + named.path + " " + name + "'";
  const std::string type = option.type();
  const std::string kind = kindOf(type);
  return "    " + patterns + ") value=" + kind + (kind == "words" ? " words='" + choicesOf(type) + "'" : "") +
         " ;;\n";
}

}  // namespace

std::string bashCompletion(Command program, const std::string& name, const std::string& part) {
  std::vector<NamedCommand> commands;
  addCommands({name, program}, commands);
  const std::string function = "_" + name + (part.empty() ? "" : "_" + part);
  std::string script = "# Completion of " + name + " in bash. Printed by: " + name +
                       (part.empty() ? "" : "-" + part) + " " + kFlag + "\n" + function +
                       "() {\n  if declare -F \"" + function +
                       "_${COMP_WORDS[1]}\" >/dev/null; then\n    \"" + function +
                       "_${COMP_WORDS[1]}\"\n    return\n  fi\n  local command=" + name +
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
  for (const NamedCommand& command : commands)
    script += caseOfCommand(command);
  script += "  esac\n  case \"$command $previous\" in\n";
  for (const NamedCommand& named : commands) {
    for (const Option option : optionsOf(named.command)) {
      if (!option.names().empty() && option.needsValue()) script += caseOfValue(named, option);
    }
  }
  return script + "  esac\n" + kChoose + (part.empty() ? "complete -F _" + name + " " + name + "\n" : "");
}

void addBashCompletionFlag(Command program, const std::string& name, const std::string& part) {
  program
      .addTextFlag(kFlag,
                   [program, name, part] {
                     std::string script = bashCompletion(program, name, part);
                     script.pop_back();  // a line feed is printed after the text
                     return script;
                   })
      .group("");
}

}  // namespace cartvo
