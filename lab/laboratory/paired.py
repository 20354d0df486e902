"""Two results of lab judge in pairs: the same drives, noise seeds and pieces, before a change and after it."""
import math

from laboratory.accuracy import groups
from laboratory.program import LabError
from laboratory.table import NONE, Table

LISTS = ("rpe_m", "rpe_deg", "nll_motion", "nll_velocity")  # a value for each message
COLUMNS = ("sequence", "set", "noise_seed", "noise", "piece", "first_pair", "pairs", *LISTS, "nees_motion", "nees_velocity", "evaluation")
FLOORS = {"rpe_m": 1e-5, "rpe_deg": 1e-4}  # a thirtieth of usual errors: those of a standing cart may be 0, without a logarithm
FEWEST_DRIVES = 4
LEGEND = """The test pairs each replay with the same one before, by messages that are VALID in both, and takes the mean of each drive: ratios of RPE and
of segments by their logarithms, differences of NLL, shares of VALID messages as they are. Replays of a drive are not independent, drives
are: ± is the standard error of the mean over drives, and a difference counts if it is outside the interval of 95 % of Student's t (1908)
with a degree of freedom less than drives (cluster means: A. Donner, N. Klar, Design and Analysis of Cluster Randomization Trials, 2000). Of
twenty comparisons without a difference one will count. A change that makes fewer messages VALID is worse, whatever the others say."""


def checked(path, results):
    """The results, if they have what is compared."""
    for number, result in enumerate(results, 1):
        if missing := [key for key in COLUMNS if not isinstance(result, dict) or key not in result]:
            raise LabError(f"{path}: result {number} has no {missing[0]}; expected results of lab judge --json; measure again with this lab")
        if len({len(result[key]) for key in LISTS}) > 1:
            raise LabError(f"{path}: result {number} has lists of unequal lengths; expected a value for each message in {', '.join(LISTS)}; "
                           "measure again with this lab")
    return results


def key_of(result):
    return tuple(result[key] for key in ("sequence", "noise_seed", "noise", "piece", "first_pair", "pairs"))


def check_same(path, before, now):
    """Refuses results of other drives, noise or pieces."""
    told, wanted = {key_of(result) for result in before}, {key_of(result) for result in now}
    if told != wanted:
        unlike = sorted(told ^ wanted)[0]
        sequence, seed, noise, piece, *_ = unlike
        raise LabError(f"{path}: has {len(told)} replays, {len(told & wanted)} of them of the {len(wanted)} to compare; "
                       f"{'only' if unlike in told else 'not'} there: {sequence}, noise seed {seed} of {noise:g} grey levels, piece {piece}; "
                       "measure both with the same options")


def quantile(freedom):
    """The value that Student's t exceeds with a probability of 2.5 %, for at least three degrees of freedom (M. Abramowitz,
    I. Stegun, 26.7.5; within 1 %)."""
    z = 1.959964
    terms = (z, (z ** 3 + z) / 4, (5 * z ** 5 + 16 * z ** 3 + 3 * z) / 96, (3 * z ** 7 + 19 * z ** 5 + 17 * z ** 3 - 15 * z) / 384)
    return sum(term / freedom ** power for power, term in enumerate(terms))


def mean_and_error(values):
    """Mean of independent values and its standard error."""
    n = len(values)
    mean = sum(values) / n
    return mean, math.sqrt(sum((value - mean) ** 2 for value in values) / (n * (n - 1))) if n > 1 else math.inf


def verdict(means, more_is_better, unit, is_ratio, digits):
    """Of the means of the drives: logarithms of ratios, or differences."""
    if len(means) < 2:
        return "not known: fewer than two drives have it"
    mean, error = mean_and_error(means)
    size, error_size = (100.0 * math.expm1(mean), 100.0 * math.exp(mean) * error) if is_ratio else (mean, error)
    if len(means) < FEWEST_DRIVES:
        return f"not known from {len(means)} drives, expected {FEWEST_DRIVES} or more ({size:+.{digits}f} ± {error_size:.{digits}f}{unit})"
    if abs(mean) <= quantile(len(means) - 1) * error:
        return f"no difference ({size:+.{digits}f} ± {error_size:.{digits}f}{unit})"
    return f"{'better' if (mean > 0) == more_is_better else 'worse'} by {abs(size):.{digits}f} ± {error_size:.{digits}f}{unit}"


def differences(before, now):
    """Of two results of one replay: by figure the logarithm of a ratio or a difference, where both have it."""
    found = {}
    for key in LISTS:
        pairs = [(a, b) for a, b in zip(before[key], now[key]) if a is not None and b is not None]
        if not pairs:
            continue
        a, b = ([pair[side] for pair in pairs] for side in (0, 1))
        if key in FLOORS:
            a, b = (math.sqrt(sum(x * x for x in side) / len(pairs) + FLOORS[key] ** 2) for side in (a, b))
            found[key] = math.log(b / a)
        else:
            found[key] = (sum(b) - sum(a)) / len(pairs)
    shares = [100.0 * sum(value is not None for value in one["rpe_m"]) / len(one["rpe_m"]) for one in (before, now)]
    found["available"] = shares[1] - shares[0]
    for key in ("translation_percent", "rotation_deg_per_m"):
        a, b = (one["evaluation"]["segments_5_to_40_m"][key] for one in (before, now))
        if a and b:
            found[key] = math.log(b / a)
    return found


# key, name, unit, whether it is a ratio, digits; segments are no reason to choose
FIGURES = [("rpe_m", "RPE mm", " %", True, 1), ("rpe_deg", "RPE deg", " %", True, 1), ("nll_motion", "NLL motion", "", False, 3),
           ("nll_velocity", "NLL velocity", "", False, 3), ("available", "available", " points of %", False, 2),
           ("translation_percent", "segments %", " %", True, 0), ("rotation_deg_per_m", "segments deg/m", " %", True, 0)]


def comparison(before, now, path):
    """A table of a row for each drive, and a line of text for each figure."""
    check_same(path, before, now)
    old = {key_of(result): result for result in before}
    header = ["drive", "VALID in both", "only before", "only now"]
    table = Table([*header, *(f"{name}, change in %" if is_ratio else name for _, name, _, is_ratio, _ in FIGURES)], "Now against before")
    means = {key: [] for key, *_ in FIGURES}
    for drive, group in groups(now, lambda r: r["sequence"]).items():
        pairs = [(old[key_of(result)], result) for result in group]
        valid = [(a is not None, b is not None) for one, other in pairs for a, b in zip(one["rpe_m"], other["rpe_m"])]
        found = [differences(*pair) for pair in pairs]
        cells = []
        for key, _, _, is_ratio, digits in FIGURES:
            values = [one[key] for one in found if key in one]
            if values:
                means[key].append(sum(values) / len(values))
            cells.append(f"{100.0 * math.expm1(means[key][-1]) if is_ratio else means[key][-1]:+.{digits}f}" if values else NONE)
        table.add(drive, *(valid.count(kind) for kind in ((True, True), (True, False), (False, True))), *cells)
    lines = [f"{name}: {verdict(means[key], key == 'available', unit, is_ratio, digits)}"
             + (" (reported only)" if name.startswith("segments") else "") for key, name, unit, is_ratio, digits in FIGURES]
    return table, lines
