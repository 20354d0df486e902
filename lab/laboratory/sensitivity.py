"""lab sensitivity: how much the results depend on each tuned constant of the default estimator."""
import csv
import dataclasses
import json
import math
import pathlib
import tempfile

from laboratory import drives, measure
from laboratory.measure import Case
from laboratory.options import words
from laboratory.matrix import START
from laboratory.program import Cartvo, LabError
from laboratory.table import NONE, Table, fixed

HELP = "How much the results depend on each tuned constant: each a little smaller and larger, beside runs that differ by chance"
EXAMPLES = """  lab/lab sensitivity --constants list                              all of them, and the limits of the product
  lab/lab sensitivity --constants stereo.uniqueness,window.pairs
  lab/lab sensitivity --scenarios dusk,low_texture --factor 1000    each at the ends of its range"""
SET = "tuning"
LEAST_RATIO, LEAST_COUNT = 0.002, 1.0  # smallest changes by chance that count, of few runs
LEGEND = """Changes with the constant at its smaller and its larger value, geometric means over all sequences: errors of segments of 5 to 40 m, errors
from pair to pair, invalid pairs, VALID messages above an alert limit. effect: the largest of them, in multiples of the largest change by
chance (other random subsets, 2 % fewer and more landmarks). Errors are those of the body's path."""


def add_options(parser):
    parser.add_argument("--constants", type=words(), metavar="LIST", help="names, or list: print them all and measure nothing (default: all)")
    parser.add_argument("--factor", type=float, default=1.3, metavar="F", help="each is divided and multiplied by it, within its range")
    parser.add_argument("--offset-ms", type=float, default=25.0, metavar="MS", help="of the right camera (default: 25)")
    parser.add_argument("--readout-ms", default="32", metavar="BOTH|LEFT,RIGHT", help="of the cameras (default: 32)")


def text(options):
    if options.constants != ["list"]:
        return None
    cartvo = Cartvo(options.cartvo).module()
    tables = []
    for title, constants in (("Tuned constants", cartvo.tuned_constants()), ("Limits of the product", cartvo.product_limits())):
        tables.append(Table(["name", "default", "unit", "range", "source"], title))
        for one in constants:
            tables[-1].add(one.name, f"{one.default:.4g}", one.unit, f"{one.low:.4g} to {one.high:.4g}", one.source)
    return "\n".join(table.markdown() if options.markdown else table.text() for table in tables)


def values_of(constant, factor):
    """The smaller and the larger value, where the range permits one; integers change by at least one."""
    for sign, wanted in ((-1, constant.default / factor), (1, constant.default * factor)):
        if constant.is_integer and round(wanted) == round(constant.default):
            wanted = constant.default + sign
        value = min(max(wanted, constant.low), constant.high)
        if value != constant.default:
            yield sign, round(value) if constant.is_integer else value


def cases(options):
    constants = {one.name: one for one in Cartvo(options.cartvo).module().tuned_constants()}
    names = options.constants or list(constants)
    if unknown := [name for name in names if name not in constants]:
        raise LabError(f"--constants: there is no tuned constant {unknown[0]}; --constants list prints all")
    options.seconds = options.seconds or 20.0
    features = options.features[0]
    runs = [("default", 0, None)]
    runs += [("chance", number, change) for number, change in enumerate(
        [("seed", 2), ("seed", 3), ("features", round(0.98 * features)), ("features", round(1.02 * features))])]
    runs += [(name, sign, (name, value)) for name in names for sign, value in values_of(constants[name], options.factor)]
    found = [(folder.name, folder, None) for folder in drives.real_sequences(drives.data_folder(options.data or "none"))]
    found += [(drive.name, None, dataclasses.replace(drive, offset_ms=options.offset_ms, readout_ms=options.readout_ms))
              for drive in drives.chosen_drives(options, ["campus", "turns", "bumpy", "traffic"], START)]
    return [Case(name, folder, drive, features=features, labels={"constant": constant, "side": sign, "change": change})
            for constant, sign, change in runs for name, folder, drive in found]


BOUNDS = [f"{quantity}_bound_{axis}" for quantity in ("velocity", "angular_rate", "motion", "rotation") for axis in "xyz"]
TRIANGLE = [(i, j) for i in range(6) for j in range(i, 6)]
COLUMNS = ["pair", "utime_us", "valid", "reasons", "reset_counter", "x_m", "y_m", "z_m", "qw", "qx", "qy", "qz", "vx_m_s", "vy_m_s", "vz_m_s",
           "wx_rad_s", "wy_rad_s", "wz_rad_s", *(f"{name}_covariance_{'x_x' if name == 'pose' else 'vx_vx'}{'' if k == 0 else k}"
                                                 for name in ("pose", "twist") for k in range(21)), *BOUNDS]


def quaternion(rotation):
    """w, x, y, z of a rotation matrix by less than half a turn about any axis."""
    import numpy as np
    w = math.sqrt(max(0.0, 1.0 + np.trace(rotation))) / 2.0
    if w < 1e-3:
        raise LabError("a cart that has turned by 180 degrees: choose a shorter drive")
    return [w, *((rotation[k[0], k[1]] - rotation[k[1], k[0]]) / (4.0 * w) for k in ((2, 1), (0, 2), (1, 0)))]


def write_odometry(cartvo, folder, settings, out):
    """The files of cartvo replay, as far as cartvo evaluate reads it, of an odometry with these settings."""
    recording = cartvo.Recording(folder)
    processor = cartvo.PairProcessor(recording.rig, settings)
    out.mkdir()
    with open(out / "odometry.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(COLUMNS)
        for number, pair in enumerate(recording):
            e = processor.process(pair)
            bounds = [*e.velocity_bound, *e.angular_rate_bound, *e.motion_bound, *e.rotation_bound]
            row = [*e.pose[:3, 3], *quaternion(e.pose[:3, :3]), *e.velocity, *e.angular_velocity,
                   *(matrix[i, j] for matrix in (e.pose_covariance, e.twist_covariance) for i, j in TRIANGLE), *bounds]
            writer.writerow([number, round(e.exposure_ns / 1e3), int(e.valid), 0, e.epoch,
                             *("" if math.isnan(value) else f"{value:.9g}" for value in row)])
    (out / "summary.json").write_text(json.dumps({"rig": {"T_body_camera": [*recording.rig.T_body_camera[:3].ravel()]}}))


def measure_one(bench, case):
    cartvo = bench.cartvo.module()
    settings = cartvo.Settings(features=case.features)
    if change := case.labels["change"]:
        if change[0] in ("seed", "features"):
            setattr(settings, *change)
        else:
            settings.set_constant(*change)
    with tempfile.TemporaryDirectory(prefix="cartvo-lab-") as work:
        work = pathlib.Path(work)
        source = measure.source_of(measure.prepared(bench, case), work)
        try:
            write_odometry(cartvo, source.folder, settings, work / "out")
        except ValueError:  # settings that do not fit together
            return {"sequence": case.sequence, **case.labels}
        found = bench.cartvo.evaluate(work / "out/odometry.csv", source.body or source.poses, *bench.limits)
        invalid = sum(row["valid"] == "0" for row in measure.read_csv(work / "out/odometry.csv"))
    return {"sequence": case.sequence, **case.labels, "invalid": invalid, "above_limit": found["validity"]["above_limit"], "evaluation": found}


def changes(reference, results):
    """Mean logarithms of the ratios of errors, and differences of counts; None if a run was not possible."""
    if any("evaluation" not in result for result in results):
        return None
    pairs = [(after["evaluation"], before["evaluation"]) for before, after in zip(reference, results)]

    def mean(paths):
        logs = []
        for path in paths:
            for after, before in pairs:
                for key in path:
                    after, before = after[key], before[key]
                if after and before:
                    logs.append(math.log(after / before))
        return sum(logs) / len(logs) if logs else 0.0

    segments = [("segments_5_to_40_m", key) for key in ("translation_percent", "rotation_deg_per_m")]
    return {"segments": mean(segments), "relative": mean([("rpe_rmse_m",), ("rpe_rmse_deg",)]),
            **{key: sum(after[key] - before[key] for before, after in zip(reference, results)) for key in ("invalid", "above_limit")}}


def effect(change, chance):
    return max(abs(change[key]) / max(chance[key], LEAST_COUNT if key in ("invalid", "above_limit") else LEAST_RATIO) for key in chance)


def report(results):
    runs = {}
    for result in results:
        runs.setdefault((result["constant"], result["side"]), []).append(result)
    reference = runs.pop(("default", 0))
    found = {key: changes(reference, group) for key, group in runs.items()}
    by_chance = [change for (name, _), change in found.items() if name == "chance" and change]
    chance = {key: max(abs(change[key]) for change in by_chance) for key in ("segments", "relative", "invalid", "above_limit")}
    table = Table(["constant", "values", "segments %", "pair to pair %", "invalid", "> limit", "effect"])
    rows = []
    for name in dict.fromkeys(name for name, _ in runs if name != "chance"):
        sides = [(runs.get((name, side)), found.get((name, side))) for side in (-1, 1)]
        effects = [effect(change, chance) for _, change in sides if change]

        def cell(show):
            return " / ".join(show(run, change) if change else NONE for run, change in sides)

        rows.append((max(effects, default=0.0), name, cell(lambda run, _: f"{run[0]['change'][1]:.4g}"),
                     *(cell(lambda _, change, key=key: f"{100.0 * math.expm1(change[key]):+.1f}") for key in ("segments", "relative")),
                     *(cell(lambda _, change, key=key: f"{change[key]:+d}") for key in ("invalid", "above_limit"))))
    for largest, *cells in sorted(rows, reverse=True):
        table.add(*cells, fixed(largest, 1))
    table.add("by chance", "", *(f"±{100.0 * math.expm1(chance[key]):.1f}" for key in ("segments", "relative")),
              *(f"±{chance[key]}" for key in ("invalid", "above_limit")), "1.0")
    return [table], LEGEND
