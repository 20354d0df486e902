#!/usr/bin/env python3
"""check_completion.py CARTVO CARTVOD FOLDER: the completion scripts in FOLDER offer in bash what --help of each command shows.

For each command: its options, its commands, the choices of each option ({a,b} in --help) also as --option=VALUE, a file for
an option that takes a FILE, and nothing else.
"""
import pathlib
import re
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
from check_docs import Program  # noqa: E402

FOLDER_OF_FILES = pathlib.Path(__file__).resolve().parent
COMPLETE = r"""
source "$1"; cd "$2"; shift 2
while IFS=$'\t' read -ra COMP_WORDS; do
  [ "${COMP_WORDS[-1]}" != EMPTY ] || COMP_WORDS[-1]=''
  COMP_CWORD=$((${#COMP_WORDS[@]} - 1)) COMPREPLY=()
  "_${COMP_WORDS[0]}"
  echo "${COMPREPLY[*]}"
done
"""


def offers(script, command_lines):
    """The words offered for the last word of each command line, as sets."""
    lines = "".join("\t".join(word or "EMPTY" for word in words) + "\n" for words in command_lines)
    done = subprocess.run(["bash", "-c", COMPLETE, "bash", script, FOLDER_OF_FILES], input=lines, capture_output=True,
                          text=True, check=True)
    if done.stderr:
        sys.exit(f"check_completion: {script}: {done.stderr}")
    return [set(line.split()) for line in done.stdout.splitlines()]


def options_with_values(help_text):
    """(names, type) of each option that shows the type of its value."""
    for names, value in re.findall(r"^ {2,4}(-[\w,-]+) ((?:[A-Z]|BOTH)\S*)", help_text, re.M):
        yield names.split(","), value


def expectations(program, chain):
    """(words of a command line, what must be offered for the last)."""
    words = [program.path.name, *chain]
    commands = program.subcommands(*chain)
    yield [*words, "-"], program.options(*chain)
    if commands and not program.takes_positionals(*chain):
        yield [*words, ""], commands
    for names, value in options_with_values(program.help(*chain)):
        choices = re.search(r"\{(.*)\}", value)
        for name in names:
            if choices:
                yield [*words, name, ""], set(choices[1].split(","))
                yield [*words, name, "="], set(choices[1].split(","))
                first = choices[1].split(",")[0]
                yield [*words, name, "=", first], {c for c in choices[1].split(",") if c.startswith(first)}
            elif value.split(":")[0] == "FILE":
                yield [*words, name, "check_completion"], {"check_completion.py"}
    for command in sorted(commands):
        yield from expectations(program, (*chain, command))


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    checked, problems = 0, []
    for path in map(pathlib.Path, sys.argv[1:3]):
        expected = list(expectations(Program(path), ()))
        found = offers(pathlib.Path(sys.argv[3]) / path.name, [words for words, _ in expected])
        for (words, wanted), offered in zip(expected, found, strict=True):
            checked += 1
            if offered != wanted:
                problems.append(f"{' '.join(words)}: missing {sorted(wanted - offered)}, too much {sorted(offered - wanted)}")
    print("\n".join(problems) if problems else f"check_completion: {checked} completions: in order")
    return 1 if problems or checked < 50 else 0


if __name__ == "__main__":
    sys.exit(main())
