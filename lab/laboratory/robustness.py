"""lab robustness: what disturbances do to both estimators."""
import dataclasses
import math

from laboratory import drives
from laboratory.accuracy import validity_line
from laboratory.changes import DISTURBANCES, EXPOSURE, RIG
from laboratory.matrix import START
from laboratory.measure import Case
from laboratory.options import words
from laboratory.table import NONE, Table, fixed, significant

HELP = "What lost pairs, text, covered and turned pictures, wrong instants and rigs do to both estimators"
EXAMPLES = """  lab/lab robustness --quick
  lab/lab robustness --scenarios none --disturbances text,swapped   real sequences only
  lab/lab robustness --data none --set reporting --seconds 8"""
SET = "tuning"
SIGNIFICANT = 2.0  # standard deviations
LEGEND = """error: of the path over each second, root mean square, mm. x: over the untouched sequence. worse: the default has more VALID messages
above an alert limit than estimator thesis; or as many, and a larger error in the same seconds or fewer VALID pairs by two standard
deviations, or a new epoch without more valid pairs. With a fault of the rig no motion is right, and only messages above a limit count."""


def add_options(parser):
    parser.add_argument("--disturbances", type=words(*DISTURBANCES), default=list(DISTURBANCES), metavar="LIST",
                        help="; ".join(f"{name}: {text}" for name, (_, text) in DISTURBANCES.items()).replace("%", "%%"))
    parser.add_argument("--quick", action="store_true", help="six seconds of the drive rough, no real sequences")


def cases(options):
    if options.quick:
        options.scenarios, options.seconds, options.data = ["rough"], 6.0, "none"
    options.seconds, options.seeds = options.seconds or 12.0, options.seeds or ([7] if options.set == "tuning" else None)
    found = [(folder.name, folder, None) for folder in drives.real_sequences(drives.data_folder(options.data))]
    found += [(drive.name, None, drive) for drive in drives.chosen_drives(options, ["campus", "turns", "rough"], START)]
    chosen = ["none"] + [name for name in options.disturbances if name != "none"]
    result = []
    for name, folder, drive in found:
        for disturbance in chosen:
            is_late = DISTURBANCES[disturbance][0] == EXPOSURE
            if is_late and drive is None:
                continue
            seen = dataclasses.replace(drive, offset_ms=500.0 / drives.FRAME_RATE) if is_late else drive
            result += [Case(name, folder, seen, estimator, options.features[0], change="" if is_late or disturbance == "none" else disturbance,
                            labels={"disturbance": disturbance, "wants": ("errors_per_second",)})
                       for estimator in ("reprojection", "thesis")]
    return result


def error(result):
    errors = result.get("errors_per_second_m")
    return math.sqrt(sum(value * value for value in errors) / len(errors)) if errors else None


def valid_pairs(result):
    return max(0, result["pairs"] - result.get("invalid", 0) - 1)  # the first has no motion


def exceeds(a, b):
    """Whether the mean of `a` is above that of `b` by more than chance; both are of the same seconds."""
    differences = [one - other for one, other in zip(a, b)]
    n = len(differences)
    if n < 2:
        return False
    mean = sum(differences) / n
    variance = max(0.0, sum(d * d for d in differences) / n - mean * mean) / (n - 1)
    return mean > SIGNIFICANT * math.sqrt(variance)


def is_worse(a, b, kind):
    """Whether the result `a` is worse than `b`, see the legend."""
    above = a.get("above_limit", 0), b.get("above_limit", 0)
    if above[0] != above[1] or kind == RIG:
        return above[0] > above[1]
    n = max(b["pairs"], 1)
    share = valid_pairs(b) / n
    if valid_pairs(a) + SIGNIFICANT * math.sqrt(max(n * share * (1 - share), 1.0)) < valid_pairs(b):
        return True
    if a.get("resets", 0) > b.get("resets", 0) and valid_pairs(a) <= valid_pairs(b):
        return True
    return exceeds(a.get("errors_per_second_m") or [], b.get("errors_per_second_m") or [])


def report(results):
    table = Table(["sequence", "disturbance", "> limit", "> bound", "available, %", "gap, s", "resets", "error", "x",
                   "thesis: available, %", "> limit", "resets", "error", ""])
    by_row = {}
    for result in results:
        by_row.setdefault((result["sequence"], result["disturbance"]), {})[result["estimator"]] = result
    worse = 0
    for (sequence, disturbance), pair in by_row.items():
        a, b = pair["reprojection"], pair["thesis"]
        kind = DISTURBANCES[disturbance][0]
        untouched = error(by_row.get((sequence, "none"), {}).get("reprojection", {}))
        bad = is_worse(a, b, kind)
        worse += bad
        own, other = (NONE if kind == RIG else significant(error(one), 1e3) for one in (a, b))
        ratio = significant(error(a) / untouched) if kind != RIG and error(a) is not None and untouched else NONE
        table.add(sequence, disturbance, a.get("above_limit", 0), a.get("above_bound", 0), fixed(a.get("available_percent", 0.0), 1),
                  fixed(a.get("longest_gap_s"), 2), a.get("resets", 0), own, ratio, fixed(b.get("available_percent", 0.0), 1),
                  b.get("above_limit", 0), b.get("resets", 0), other, "worse" if bad else "")
    own = [result for result in results if result["estimator"] == "reprojection"]
    return [table], (f"The default is worse than the thesis in {worse} of {len(by_row)} rows. All its messages: {validity_line(own)}\n\n"
                     + LEGEND)
