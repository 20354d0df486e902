"""Options that the commands share."""
import argparse
import pathlib

from laboratory.program import processors


def numbers(kind=float):
    """A list of numbers, separated by commas."""
    def parse(text):
        try:
            return [kind(word) for word in text.split(",")]
        except ValueError:
            raise argparse.ArgumentTypeError(f"expected {'whole ' if kind is int else ''}numbers separated by commas, found '{text}'")
    return parse


def words(*known):
    """A list of words, separated by commas."""
    def parse(text):
        for word in text.split(","):
            if known and word not in known:
                raise argparse.ArgumentTypeError(f"expected some of {', '.join(known)}, separated by commas, found '{word}'")
        return text.split(",")
    return parse


def add_common(parser, jobs=None):
    parser.add_argument("--data", metavar="DIR", help="folder of real sequences, each an image folder with poses.txt, or none (default: "
                        "$CARTVO_DATA, else ../shared/data)")
    parser.add_argument("--features", type=numbers(int), default=[1000], metavar="LIST", help="target number in each left image")
    parser.add_argument("--alert-limits", metavar="V,RATE,MOTION,ROTATION", help="as of cartvo replay (default: those of cartvod)")
    parser.add_argument("--cartvo", metavar="PROGRAM", help="default: that of the release build, else the installed one")
    parser.add_argument("--cache-dir", type=pathlib.Path, default=pathlib.Path.home() / ".cache/cartvo", metavar="DIR",
                        help="rendered drives (0.4 GB a minute) and their streams (default: ~/.cache/cartvo)")
    parser.add_argument("--jobs", type=int, default=jobs or processors(), metavar="N",
                        help=f"replays at a time (default: {jobs or 'number of processors'})")
    parser.add_argument("--threads", type=int, default=1, metavar="N", help="of each replay; the results do not depend on it (default: 1)")
    output = parser.add_argument_group("output")
    form = output.add_mutually_exclusive_group()
    form.add_argument("--markdown", action="store_true", help="tables for a page")
    form.add_argument("--json", action="store_true", help="all numbers")
    output.add_argument("--output", type=pathlib.Path, metavar="FILE", help="write to this file")
    shared = parser.add_argument_group("work on several computers").add_mutually_exclusive_group()
    shared.add_argument("--list", metavar="DIR", help="measure nothing: print a command for each row, which writes its result to "
                        "DIR/NUMBER.json; tools/slurm/run_jobs runs them on a cluster")
    shared.add_argument("--merge", type=pathlib.Path, metavar="DIR|FILE", help="measure nothing: the table of the results in DIR, or "
                        "in a file of --json")
    shared.add_argument("--only", type=int, metavar="NUMBER", help="measure only this row, from 1")


def add_drives(parser, chosen_set=None):
    group = parser.add_argument_group("rendered drives")
    group.add_argument("--set", choices=["tuning", "reporting"], default=chosen_set,
                       help="drives on which numbers of the estimator are chosen (seeds below 10), or those that take no part in it"
                       f" (default: {chosen_set or 'both'})")
    group.add_argument("--scenarios", type=words(), metavar="LIST", help="names of cartvo simulate, each also with +lively; all; none")
    group.add_argument("--seeds", type=numbers(int), metavar="LIST", help="each scenario with each seed (default: 1 tuning, 11 reporting)")
    group.add_argument("--seconds", type=float, metavar="N", help="length of each drive")
    group.add_argument("--liveliness", type=float, default=1.0, metavar="L", help="of the drives NAME+lively, to 1 (default: 1)")
    group.add_argument("--start-at", type=float, metavar="S", help="instant of each drive at which the pictures begin, s")
