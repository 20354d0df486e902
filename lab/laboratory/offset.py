"""lab offset: the effect of unsynchronised cameras."""
import dataclasses

from laboratory import drives
from laboratory.accuracy import VALIDITY_COLUMNS, groups, validity_cells, validity_line
from laboratory.matrix import START, clock_cell, error_cells, mean_cell, over_seeds, reference_of
from laboratory.measure import Case
from laboratory.options import numbers, words
from laboratory.table import Table, significant

HELP = "Errors over the time offset of the right camera, with both instants told and with the left one for both pictures"
EXAMPLES = """  lab/lab offset --scenarios campus --seconds 10 --offsets-ms 25 --sweeps none
  lab/lab offset --markdown                                         everything: hours of rendering"""
SET = "tuning"
CRYSTAL_PPM = 50.0  # typical of two crystals
LEGEND = """right camera: its time offset, and how much slower its clock is. two-instants: both exposure instants are told, as to cartvod;
simultaneous: the left one for both pictures, as other odometries assume. Errors of the left camera's path: segments of 5 to 40 m (% and
deg/m), from pair to pair (RPE, RMSE, mm and deg), final drift. x: as multiples of two-instants on the same drives without an offset.
NEES: mean of the squared error over its covariance, per dimension: 1 is consistent."""


def add_options(parser):
    parser.add_argument("--offsets-ms", type=numbers(), default=[0.0, 2.0, 5.0, 10.0, 15.0, 20.0, 25.0], metavar="LIST",
                        help="of the right camera; 0 is always measured")
    parser.add_argument("--sweeps", type=words("slow", "fast", "none"), default=["slow", "fast"], metavar="LIST",
                        help="clocks that drift: by 50 ppm through half a frame period (slow), by a whole frame period (fast)")
    parser.add_argument("--models", type=words("two-instants", "simultaneous"), default=["two-instants", "simultaneous"], metavar="LIST")


def slow_sweep(seconds):
    """Offset, ms, and drift, ppm: crosses half a frame period in the middle of the drive."""
    return 1e3 * (0.5 / drives.FRAME_RATE - 0.5e-6 * CRYSTAL_PPM * seconds), CRYSTAL_PPM


def fast_sweep(seconds):
    """Passes through all offsets: zero after a quarter of the drive, half a period after three quarters."""
    return -250.0 / drives.FRAME_RATE, 1e6 / drives.FRAME_RATE / seconds


def cases(options):
    options.seconds = options.seconds or 20.0
    clocks = [(0.0, 0.0)] + [(offset, 0.0) for offset in options.offsets_ms if offset]
    clocks += [{"slow": slow_sweep, "fast": fast_sweep}[sweep](options.seconds) for sweep in options.sweeps if sweep != "none"]
    return [Case(seen.name, drive=seen, features=features, change="simultaneous" if model == "simultaneous" else "",
                 labels={"scenario": drive.scenario_name, "offset_ms": offset, "drift_ppm": drift, "model": model})
            for drive in drives.chosen_drives(options, ["campus", "turns", "bumpy", "traffic"], START)
            for offset, drift in clocks for seen in [dataclasses.replace(drive, offset_ms=offset, drift_ppm=drift)]
            for model in options.models for features in options.features]


def report(results):
    table = Table(["sequence", "right camera", "model", "pairs", "5–40 m: % / deg/m", "x", "RPE: mm / deg", "x", "drift, %", "invalid",
                   "resets", "NEES motion", "NEES pose", *VALIDITY_COLUMNS])
    rows = over_seeds(results, ["features", "offset_ms", "drift_ppm", "model"])
    for row in rows:
        reference = reference_of(row, rows, {"features": row["features"], "offset_ms": 0.0, "drift_ppm": 0.0, "model": "two-instants"})
        table.add(row["sequence"], clock_cell(row), row["model"], row["pairs"], *error_cells(row["evaluation"], reference),
                  significant(row["evaluation"]["final_drift_percent"]), row["invalid"], row["resets"],
                  mean_cell(row["nees_motion"]), mean_cell(row["nees_pose"]), *validity_cells(row))
    totals = [f"{model}: {validity_line(group)}" for model, group in groups(results, lambda r: r["model"]).items()]
    return [table], "\n".join([*totals, "", LEGEND])
