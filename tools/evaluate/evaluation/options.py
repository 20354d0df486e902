"""The command line of `cartvo evaluate`: options, help, errors and completion in bash."""
import argparse
import difflib
import pathlib
import shutil

from evaluation.program import UsageError, print_output
from evaluation.validity import DEFAULT_LIMITS

FOOTER = """Files of TUM or EuRoC are compared by time: the truth is interpolated at the estimate's times. A KITTI file has no
times: it is compared row by row, and both files must have the same number of rows. Of an odometry.csv the velocities,
rates and bounds are compared too: how many VALID messages are above an alert limit or their bound.
Examples:
  cartvo evaluate out/poses.txt kitti_06/poses.txt --plot out/path.png
  cartvo evaluate out/odometry.csv truth.tum --json
  cartvo evaluate out/trajectory.tum truth.tum --report out/report.html
  cartvo evaluate one.tum other.tum --truth truth.tum --align --plot paths.svg"""
COMPLETION = """# Completion of cartvo in bash. Printed by: cartvo-evaluate --bash-completion
_cartvo_evaluate() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD - 1]}} kind=-f
  # bash takes --option=value as three words.
  if [[ $current == = ]]; then
    current=''
  elif [[ $previous == = ]]; then
    previous=${{COMP_WORDS[COMP_CWORD - 2]}}
  fi
  COMPREPLY=()
  case "$previous" in
    {folders}) kind=-d ;;
    {values}) return ;;
    {files}) ;;
    *)
      if [[ $current == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W '{options}' -- "$current")
        return
      fi ;;
  esac
  compopt -o filenames 2>/dev/null
  mapfile -t COMPREPLY < <(compgen $kind -- "$current")
}}
"""


class HelpFormat(argparse.RawDescriptionHelpFormatter):
    """The layout of the other commands."""

    def __init__(self, prog):
        super().__init__(prog, max_help_position=32, width=min(max(shutil.get_terminal_size((120, 24)).columns, 80), 120))

    def _format_action_invocation(self, action):
        names = ",".join(action.option_strings)
        return f"{names} {action.metavar}" if names and action.metavar else names or action.metavar


class Parser(argparse.ArgumentParser):
    def error(self, message):
        raise UsageError(message.removeprefix("argument "))


def path(text):
    if not text:
        raise argparse.ArgumentTypeError("expected a value, found an empty one")
    return text


def drawing(text):
    suffix = pathlib.PurePath(path(text)).suffix
    if suffix not in (".svg", ".png"):
        raise argparse.ArgumentTypeError(f"{text}: a plot is written as .svg or .png, not '{suffix}'; name the file so")
    return text


def number(text, least, most):
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not value == value:
        raise argparse.ArgumentTypeError(f"expected a number, found '{text}'")
    if not least <= value <= most:
        raise argparse.ArgumentTypeError(f"expected a number in [{least:g} - {most:g}], found '{text}'")
    return value


def offset(text):
    return number(text, -4e9, 4e9)


def limits(text):
    words = text.split(",")
    if len(words) != 4:
        raise argparse.ArgumentTypeError(f"expected four numbers V,RATE,MOTION,ROTATION, found '{text}'")
    return tuple(number(word, 1e-3, 1e6) for word in words)


def parser():
    parsed = Parser(prog="cartvo evaluate", usage="cartvo evaluate [OPTIONS] FILE...", description="Compare a trajectory with the truth",
                    formatter_class=HelpFormat, add_help=False, allow_abbrev=False, epilog=FOOTER)
    parsed._positionals.title, parsed._optionals.title = "Positionals", "Options"
    add = parsed.add_argument
    add("files", nargs="*", metavar="FILE", type=path,
        help="ESTIMATE TRUTH, or with --truth one or more estimates. An estimate is the odometry.csv of a replay, or a trajectory: TUM or KITTI "
             "text, or EuRoC's data.csv")
    add("-h", "--help", action="store_true", help="Print this help message and exit")
    add("--truth", metavar="FILE", type=path, help="The true trajectory of the same frame (camera or body), in one of these formats")
    add("--json", action="store_true", help="Print the results as JSON instead of the table")
    add("--alert-limits", metavar="V,RATE,MOTION,ROTATION", type=limits, default=DEFAULT_LIMITS,
        help="Errors above which a VALID message is counted: of a velocity (m/s), an angular rate (deg/s), and of the motion (m) and rotation "
             f"(deg) of the last second (default: those of cartvod, {','.join(f'{limit:g}' for limit in DEFAULT_LIMITS)})")
    add("--messages", metavar="FILE", type=path, help="File (.csv) for the errors and bounds of each message of an odometry.csv")
    add("--plot", metavar="FILE", type=drawing, help="Draw the paths and their errors into this .svg or .png file")
    add("--offset", metavar="SECONDS", type=offset, default=0.0,
        help="Seconds added to the estimate's instants, such as 18 for a truth in GPS time")
    add("--align", action="store_true", help="Fit the estimate's world (rotation and translation) and its axes to the truth")
    add("--correct-scale", action="store_true", help="Fit the scale of the estimate's path to the truth")
    add("--report", metavar="FILE", type=path,
        help="File for a report (one HTML page): paths, errors over distance and time, segments, velocities, rates, NEES and errors against "
             "bounds")
    add("--figures-dir", metavar="DIR", type=path, help="Folder for the report's figures as .svg and .png; created if it is missing")
    add("--odometry", metavar="FILE", type=path,
        help="With --report or --figures-dir: the odometry.csv of the replay, for velocities, rates, validity and NEES (default: that beside "
             "ESTIMATE)")
    return parsed


def completion(parsed):
    options = [action for action in parsed._actions if action.option_strings]
    def names(metavars):
        return " | ".join(name for action in options if action.metavar in metavars for name in action.option_strings)
    return COMPLETION.format(files=names(["FILE"]), folders=names(["DIR"]), values=names(["SECONDS", "V,RATE,MOTION,ROTATION"]),
                             options=" ".join(name for action in options for name in action.option_strings))


def check_options(parsed, words):
    """Names an unknown option before anything else."""
    known = [name for action in parsed._actions for name in action.option_strings if name.startswith("--")]
    for word in words[:words.index("--")] if "--" in words else words:
        name = word.partition("=")[0]
        if name.startswith("--") and len(name) > 2 and name not in known:
            similar = [other for other in known if other.startswith(name)] or difflib.get_close_matches(name, known, 1)
            raise UsageError(f"cartvo evaluate has no option {name}" + (f"; did you mean {similar[0]}?" if similar else ""))


def separate_truth(options):
    """Takes the truth from the files unless --truth names it."""
    has_one = len(options.files) == (1 if options.truth else 2)
    if not options.truth:
        if not has_one:
            raise UsageError(f"--truth: expected ESTIMATE TRUTH, or --truth TRUTH and one or more estimates; found {len(options.files)} files")
        options.truth = options.files.pop()
    if not options.files:
        raise UsageError("FILE: expected one or more estimates beside --truth")
    for name in ("messages", "odometry"):
        if not has_one and getattr(options, name):
            raise UsageError(f"--{name}: is for a single estimate")
    if options.odometry and not options.report and not options.figures_dir:
        raise UsageError("--odometry: is used by --report and --figures-dir only; name one of them")


def read_options(arguments, version):
    """The options of a command line of `cartvo`, or None if it only asks for a text, which is printed. Raises UsageError."""
    words = arguments[arguments[:1] == ["help"]:]
    if "evaluate" in words:  # the name of the command; only flags stand before it
        words.remove("evaluate")
    parsed = parser()
    if arguments[:1] == ["--bash-completion"]:
        print_output(completion(parsed))
        return None
    if "-V" in words or "--version" in words:
        print_output(f"cartvo {version}\n")
        return None
    if arguments[:1] == ["help"] or {"-h", "--help"} & set(words):
        print_output(parsed.format_help())
        return None
    check_options(parsed, words)
    joined = []  # argparse takes -1e3 for an option
    for word in words:
        if joined and joined[-1] == "--offset" and word.startswith("-"):
            joined[-1] += "=" + word
        else:
            joined.append(word)
    options = parsed.parse_intermixed_args(joined)
    separate_truth(options)
    return options
