"""lab accuracy: one table of errors, consistency and times."""
import dataclasses

from laboratory import drives
from laboratory.measure import ESTIMATORS, Case, pooled, pooled_validity
from laboratory.options import numbers, words
from laboratory.table import NONE, Table, both, fixed, significant

HELP = "One table of errors, consistency, messages above their limits and times"
EXAMPLES = """  lab/lab accuracy --quick                                          a first look, in some minutes
  lab/lab accuracy --set reporting --seconds 8 --data none          drives on which nothing is tuned
  lab/lab accuracy --scenarios campus --bitrates-kbps 2000,4000     the effect of H.264
  lab/lab accuracy --data none --scenarios turns --offset-ms 25
  lab/lab accuracy --seeds 1,2,3 --list results > jobs              a job for each row
  sh jobs && lab/lab accuracy --merge results                       and the table of all of them"""
VALIDITY_COLUMNS = ["> limit", "> bound", "available, %", "gap, s"]
LEGEND = """set: of drives that choose a number (tuning) or report it (reporting); neither: scenario of one, seed of the other. Errors of the
left camera's path (cartvo-evaluate(1)): segments of 5 to 40 m and of 100 to 800 m (% and deg/m), from pair to pair (RPE, RMSE), final
drift. end: error of the last pose, if the cart never moves. standing: highest speed reported at a true standstill. invalid: pairs that
are not VALID, except the first; lost: pairs that were not formed. NEES: mean of the squared error over its covariance, per dimension:
1 is consistent, * is outside the 95 % band of consistent estimators (pose: an epoch counts as one sample). velocity: against the true
one at the exposure. > limit, > bound: VALID messages with an error above an alert limit, above their bound; available: share of VALID
messages; gap: longest time without one. ms: time of a pair, without reading and decoding; other jobs on the computer make it longer.
Summaries: segments, motions and NEES of all drives together; mean drift, largest end error and speed."""


def add_options(parser):
    parser.add_argument("--quick", action="store_true", help="only the drives campus and standing, six seconds each")
    parser.add_argument("--estimators", type=words(*ESTIMATORS), default=["reprojection", "thesis"], metavar="LIST")
    parser.add_argument("--offset-ms", type=float, default=0.0, metavar="MS", help="the right camera of rendered drives is exposed later")
    parser.add_argument("--readout-ms", default="0", metavar="BOTH|LEFT,RIGHT", help="readout of the rendered cameras; the odometry knows it")
    parser.add_argument("--bitrates-kbps", type=numbers(int), default=[], metavar="LIST",
                        help="the same also as H.264 at these rates, kbit/s for each camera")


def sequences(options):
    """(name, folder, drive) of real sequences and drives."""
    if options.quick:
        options.scenarios, options.seconds = ["campus", "standing"], 6.0
    found = [(folder.name, folder, None) for folder in drives.real_sequences(drives.data_folder(options.data))]
    for drive in drives.chosen_drives(options):
        drive = dataclasses.replace(drive, offset_ms=options.offset_ms, readout_ms=options.readout_ms)
        found.append((drive.name, None, drive))
    return found


def cases(options):
    return [Case(name, folder, drive, estimator, features, bitrate)
            for name, folder, drive in sequences(options)
            for bitrate in [None, *options.bitrates_kbps]
            for estimator in options.estimators for features in options.features]


def validity_cells(result):
    return [str(result.get("above_limit", 0)), str(result.get("above_bound", 0)), fixed(result.get("available_percent"), 1),
            fixed(result.get("longest_gap_s"), 2)]


def validity_line(results):
    v = pooled_validity(results)
    return (f"{v['above_limit']} of {v['judged_messages']} VALID messages above their alert limit, {v['above_bound']} above their bound; "
            f"{v['available_percent']:.1f} % of {v['messages']} messages VALID, longest gap {v['longest_gap_s']:.2f} s; largest errors "
            f"{v['largest_velocity_error_m_s']:.2g} m/s, {v['largest_rate_error_deg_s']:.2g} deg/s")


def segments_cell(segments):
    return both(fixed(segments["translation_percent"], 2), fixed(segments["rotation_deg_per_m"], 4))


def nees_cell(nees):
    if not nees or nees["mean"] is None:
        return NONE
    low, high = nees["band_95_percent"]
    return f"{significant(nees['mean'])}{'' if low <= nees['mean'] <= high else '*'} [{low:.2f}, {high:.2f}]"


def name_of(result):
    return result["sequence"] + (f", {result['bitrate_mbps']:g} Mbit/s" if result["bitrate_mbps"] else "")


def cells(result, features):
    e = result.get("evaluation")
    name = [name_of(result), result["set"] or NONE, result["estimator"] + (f", {result['features']}" if features else ""), result["pairs"]]
    if not e:
        return [*name, *[NONE] * 8, result["lost"], *[NONE] * 9]
    times = result["time_ms"] or {}
    return [*name, fixed(e["path_length_m"], 1), segments_cell(e["segments_5_to_40_m"]), segments_cell(e["segments_100_to_800_m"]),
            both(fixed(e["rpe_rmse_m"], 4), fixed(e["rpe_rmse_deg"], 4)),
            both(fixed(e["final_drift_percent"], 2), fixed(e["final_drift_m"], 2)),
            both(fixed(result["standing_end_m"], 2, 100.0), fixed(result["standing_end_deg"], 3)),
            fixed(result.get("standing_highest_speed_m_s"), 4), result["invalid"], result["lost"], result["resets"],
            *(nees_cell(result.get(f"nees_{what}")) for what in ("motion", "pose", "velocity")),
            both(fixed(times.get("median"), 1), fixed(times.get("p99"), 1)), *validity_cells(result)]


def groups(results, key):
    """Lists of the results with the same key, in the order in which they come first."""
    found = {}
    for result in results:
        found.setdefault(key(result), []).append(result)
    return found


def set_line(key, results):
    line = f"{key[0]} set, {key[1]}, {len(results)} drives: "
    segments = [(r["evaluation"]["segments_5_to_40_m"]["translation_percent"], r["sequence"]) for r in results
                if r["evaluation"]["segments_5_to_40_m"]["translation_percent"]]
    if segments:
        product = 1.0
        for value, _ in segments:
            product *= value ** (1.0 / len(segments))
        line += "5–40 m: geometric mean {} %, worst {} % ({}); ".format(significant(product), significant(max(segments)[0]), max(segments)[1])
    nees = sorted((r["nees_motion"]["mean"], r["sequence"]) for r in results if r.get("nees_motion") and r["nees_motion"]["samples"])
    if nees:
        line += f"NEES motion {nees[0][0]:.2f} ({nees[0][1]}) to {nees[-1][0]:.2f} ({nees[-1][1]}); "
    return line + f"{sum(r['invalid'] for r in results)} invalid; " + validity_line(results)


def with_growth(text, value, before):
    return text if not value or not before else f"{text} ({100.0 * (value / before - 1.0):+.0f} %)"


def bitrate_table(results):
    table = Table(["sequence", "estimator", "H.264", "5–40 m: % / deg/m", "lossless", "RPE, m", "lossless", "> limit", "> bound"],
                  "H.264 and lossless pictures")
    lossless = {(r["sequence"], r["estimator"], r["features"]): r for r in results if not r["bitrate_mbps"]}
    for r in results:
        other = lossless.get((r["sequence"], r["estimator"], r["features"]))
        if not r["bitrate_mbps"] or not other or not r.get("evaluation") or not other.get("evaluation"):
            continue
        e, o = r["evaluation"], other["evaluation"]
        s, so = e["segments_5_to_40_m"], o["segments_5_to_40_m"]
        table.add(r["sequence"], r["estimator"], f"{r['bitrate_mbps']:g} Mbit/s",
                  with_growth(segments_cell(s), s["translation_percent"], so["translation_percent"]), segments_cell(so),
                  with_growth(fixed(e["rpe_rmse_m"], 4), e["rpe_rmse_m"], o["rpe_rmse_m"]), fixed(o["rpe_rmse_m"], 4),
                  r["above_limit"], r["above_bound"])
    return table


def report(results):
    """Tables and lines of text."""
    table = Table(["sequence", "set", "estimator", "pairs", "length, m", "5–40 m: % / deg/m", "100–800 m: % / deg/m", "RPE: m / deg",
                   "drift: % / m", "end: cm / deg", "standing, m/s", "invalid", "lost", "resets", "NEES motion", "NEES pose",
                   "NEES velocity", "ms: median / p99", *VALIDITY_COLUMNS])
    several_features = len({result["features"] for result in results}) > 1
    for result in results:
        table.add(*cells(result, several_features))
    drives_only = [r for r in results if r["kind"] == "rendered" and not r["bitrate_mbps"] and r.get("evaluation")]
    lines = []
    for key, group in groups(drives_only, lambda r: (r["set"], r["estimator"], r["features"])).items():
        table.add(*cells(pooled(f"all {len(group)} drives", group), several_features))
        lines.append(set_line(key, group))
    bitrates = bitrate_table(results)
    return [table, *([bitrates] if bitrates.rows else [])], "\n".join([*lines, "", LEGEND])
