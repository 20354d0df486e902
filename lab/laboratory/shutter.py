"""lab shutter: the effect of rolling shutters."""
import dataclasses

from laboratory import drives
from laboratory.accuracy import VALIDITY_COLUMNS, groups, validity_cells, validity_line
from laboratory.matrix import START, clock_cell, error_cells, mean_cell, over_seeds, percent, reference_of
from laboratory.measure import Case
from laboratory.offset import fast_sweep
from laboratory.options import numbers, words
from laboratory.table import NONE, Table

HELP = "Errors over the readout of rolling shutters, over offsets and vibrations, with known, estimated and ignored readouts"
EXAMPLES = """  lab/lab shutter --scenarios turns --readouts-ms 0,32 --offsets-ms 0 --no-sweep --shake-degrees 0
  lab/lab shutter --scenarios campus --readouts-ms 0 --offsets-ms 0 --no-sweep --shake-hz 8"""
SET = "tuning"
LEGEND = """readout: time from the exposure of the upper edge of a picture to that of the lower one, left / right if they differ. right camera:
its time offset, and how much slower its clock is. shaken: vibration of the mount. known: the odometry has the true readout; estimated: it
begins with 32 ms and 40 %; ignored: it assumes a global shutter. Errors of the left camera's path: segments of 5 to 40 m (% and deg/m),
from pair to pair (RPE, RMSE, mm and deg). x: as multiples of those with a global shutter on the same drives. NEES: mean of the squared
error over its covariance, per dimension. rates: RMS error of the published angular velocity over the RMS of the true one."""


def add_options(parser):
    parser.add_argument("--readouts-ms", type=words(), default=["0", "16", "32", "38", "-32", "32/38"], metavar="LIST",
                        help="of both cameras, or LEFT/RIGHT; 0 is the reference of the others")
    parser.add_argument("--offsets-ms", type=numbers(), default=[0.0, 25.0], metavar="LIST", help="of the right camera")
    parser.add_argument("--no-sweep", action="store_true", help="leave out the right camera that runs free")
    parser.add_argument("--shake-hz", type=numbers(), default=[1.0, 3.0, 5.0, 8.0, 12.0], metavar="LIST",
                        help="vibrations of the mount, each with synchronised cameras, a global shutter and --shake-readout-ms")
    parser.add_argument("--shake-degrees", type=float, default=0.3, metavar="A", help="in pitch, 0.6 of it in roll; 0: none")
    parser.add_argument("--shake-readout-ms", default="32", metavar="BOTH|LEFT/RIGHT")
    parser.add_argument("--models", type=words("known", "estimated", "ignored"), default=["known", "estimated", "ignored"], metavar="LIST")


def seen_as(options, drive):
    """The drive with each readout, offset and vibration; a global shutter first."""
    clocks = [(offset, 0.0) for offset in options.offsets_ms] + ([] if options.no_sweep else [fast_sweep(options.seconds)])
    change = dataclasses.replace
    for offset, drift in clocks:
        for readout in options.readouts_ms:
            yield change(drive, offset_ms=offset, drift_ppm=drift, readout_ms=readout.replace("/", ","))
    for frequency in options.shake_hz if options.shake_degrees else []:
        for readout in dict.fromkeys(["0", options.shake_readout_ms]):
            yield change(drive, readout_ms=readout.replace("/", ","), shake_hz=frequency, shake_degrees=options.shake_degrees)


def is_measured(readout, model):
    """A global shutter only as known; estimated ones begin with a positive readout."""
    values = [float(value) for value in readout.split(",")]
    if not any(values):
        return model == "known"
    return model != "estimated" or min(values) > 0.0


def cases(options):
    options.seconds = options.seconds or 20.0
    told = {"known": (), "estimated": ("--readout-ms", "unknown"), "ignored": ("--readout-ms", "0")}
    return [Case(seen.name, drive=seen, features=features, replay_options=told[model],
                 labels={"scenario": drive.scenario_name, "readout_ms": seen.readout_ms, "offset_ms": seen.offset_ms,
                         "drift_ppm": seen.drift_ppm, "shake_hz": seen.shake_hz, "model": model})
            for drive in drives.chosen_drives(options, ["campus", "turns", "bumpy", "traffic"], START)
            for seen in dict.fromkeys(seen_as(options, drive))
            for model in options.models if is_measured(seen.readout_ms, model) for features in options.features]


def report(results):
    table = Table(["sequence", "readout, ms", "right camera", "shaken, Hz", "model", "5–40 m: % / deg/m", "x", "RPE: mm / deg", "x",
                   "NEES motion", "NEES velocity", "rates, %", *VALIDITY_COLUMNS])
    rows = over_seeds(results, ["features", "readout_ms", "offset_ms", "drift_ppm", "shake_hz", "model"])
    for row in rows:
        reference = reference_of(row, rows, {**{key: row[key] for key in ("features", "offset_ms", "drift_ppm", "shake_hz")},
                                             "readout_ms": "0"})
        table.add(row["sequence"], row["readout_ms"].replace(",", " / "), clock_cell(row), f"{row['shake_hz']:g}" if row["shake_hz"] else NONE,
                  row["model"], *error_cells(row["evaluation"], reference), mean_cell(row["nees_motion"]), mean_cell(row["nees_velocity"]),
                  percent(row["rate_error_deg_s"], row["true_rate_deg_s"]), *validity_cells(row))
    totals = [f"{model}: {validity_line(group)}" for model, group in groups(results, lambda r: r["model"]).items()]
    return [table], "\n".join([*totals, "", LEGEND])
