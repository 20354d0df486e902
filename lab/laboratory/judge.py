"""lab judge: the figures that tell two estimators apart, over noise seeds and many short drives."""
import dataclasses
import itertools
import math
import pathlib
import tempfile

from laboratory import drives, jobs, measure, paired
from laboratory.accuracy import groups, nees_cell, segments_cell
from laboratory.matrix import START
from laboratory.measure import Case
from laboratory.options import numbers
from laboratory.program import LabError
from laboratory.table import Table, both, fixed, significant
from laboratory.truth import Truth, effective_count, likelihood, motion_error

HELP = "RPE, likelihood of the truth and consistency over noise seeds and short drives, with a paired test against earlier results"
EXAMPLES = """  lab/lab judge --json --output before.json                    the tuning set, before a change
  lab/lab judge --against before.json                          after it: the table, and better or worse by how much
  lab/lab judge --scenarios campus,turns+lively --seconds 8 --noise-seeds 1,2,3
  lab/lab judge --json --output now.json && lab/lab judge --merge now.json --against before.json"""
SET = "tuning"
STANDING = 1e-3  # m: a true motion below it at a reported standstill is no sample, as in cartvo replay
LEGEND = """Each rendered drive is cut into pieces, which the odometry begins anew, and replayed with each noise seed: noise that is added to the
pictures as they were rendered (0: none). Of VALID messages: RPE: root mean square error of the motion since the pair before, by the
published poses. NLL: mean negative log likelihood (nats a message) of the true motion of the rectified left camera, and of the true
velocity and rates of the body, under their stated covariance: smaller is better. NEES: mean per dimension; * is outside the 95 % band of a
consistent estimator with as many independent messages as their autocorrelation says. A standstill that is stated as such is no sample of
NLL and NEES. available: share of VALID messages; one without a usable covariance counts as INVALID. Segments of 5 to 40 m scatter by a
quarter over noise seeds: they are reported, and no reason to choose."""


def add_options(parser):
    parser.add_argument("--noise-seeds", type=numbers(int), default=[1, 2], metavar="LIST", help="each piece with each (default: 1,2)")
    parser.add_argument("--noise", type=float, default=2.0, metavar="LEVELS", help="standard deviation of the added noise in grey levels; "
                        "that of the renderer is 1 to 2 by day (default: 2)")
    parser.add_argument("--piece-seconds", type=float, default=4.0, metavar="N", help="length of a piece of a drive (default: 4)")
    parser.add_argument("--offset-ms", type=float, default=0.0, metavar="MS", help="the right camera is exposed later")
    parser.add_argument("--readout-ms", default="0", metavar="BOTH|LEFT,RIGHT", help="readout of the cameras; the odometry knows it")
    parser.add_argument("--estimator", choices=measure.ESTIMATORS, default=measure.ESTIMATORS[0])
    parser.add_argument("--against", type=pathlib.Path, metavar="FILE|DIR",
                        help="earlier results (--json, or of jobs): prints by how much these are better or worse")


def cases(options):
    if options.data not in (None, "none"):
        raise LabError("--data: judge needs an exact truth, and measures rendered drives only; choose them with --scenarios")
    options.seconds = options.seconds or 12.0
    pieces = math.floor(options.seconds / options.piece_seconds + 1e-9)
    if pieces < 1 or min(options.noise_seeds) < 0:
        raise LabError(f"--piece-seconds {options.piece_seconds:g}, --noise-seeds: expected at most the {options.seconds:g} s of a drive, and "
                       "seeds from 0")
    length = round(options.piece_seconds * drives.FRAME_RATE)
    found = [dataclasses.replace(drive, offset_ms=options.offset_ms, readout_ms=options.readout_ms)
             for drive in drives.chosen_drives(options, None, START)]
    cases = [Case(drive.name, None, drive, estimator=options.estimator, features=options.features[0],
                  labels={"noise_seed": seed, "noise": options.noise, "piece": piece, "first_pair": piece * length, "pairs": length})
             for drive in found for seed in options.noise_seeds for piece in range(pieces)]
    if options.against:
        paired.check_same(options.against, earlier(options.against), [{"sequence": case.sequence, **case.labels} for case in cases])
    return cases


def earlier(path):
    return paired.checked(path, jobs.merged("judge", path))


def with_noise(cartvo, pair, number, labels):
    """The pair with independent noise on both pictures, the same at each call."""
    import numpy as np
    if labels["noise_seed"] == 0:
        return pair
    rng = np.random.default_rng([labels["noise_seed"], number])
    pictures = [(picture + labels["noise"] * rng.standard_normal(picture.shape, np.float32)).round().clip(0, 255).astype(np.uint8)
                for picture in (pair.left, pair.right)]
    return cartvo.Pair(*pictures, pair.t_left, pair.t_right, pair.offset_stddev)


def alert_limits(cartvo, text):
    limits = cartvo.AlertLimits()
    if text:
        limits.velocity, rate, limits.motion, rotation = map(float, text.split(","))
        limits.angular_rate, limits.rotation = math.radians(rate), math.radians(rotation)
    return limits


def errors_of(estimate, path, truth):
    """Errors of a message by name; None if it is INVALID or has no usable covariance. path: published poses by the number of the pair."""
    import numpy as np
    camera = estimate.camera
    if not estimate.valid or not camera.time_step > 0.0:
        return None
    end = 1e-9 * estimate.exposure_ns
    start = end - camera.time_step
    true_motion, true_twist = truth.motion(start, end), truth.twist(end)
    published = motion_error(np.linalg.inv(path[truth.pair(start)]) @ path[truth.pair(end)], true_motion)
    error = motion_error(camera.motion, true_motion)
    found = {"rpe_m": math.hypot(*published[:3]), "rpe_deg": math.degrees(math.hypot(*published[3:]))}
    if abs(camera.motion - np.eye(4)).max() < 1e-12 and math.hypot(*true_motion[:3, 3]) < STANDING:
        return found
    parts = {"motion": likelihood(error, camera.motion_covariance)}
    if true_twist is not None:
        parts["velocity"] = likelihood(np.concatenate([estimate.velocity, estimate.angular_velocity]) - true_twist, estimate.twist_covariance)
    if None in parts.values():
        return None
    return {**found, **{f"{name}_{what}": value for what, both in parts.items() for name, value in zip(("nees", "nll"), both)}}


def measure_one(bench, case):
    """The figures of a piece of a drive with a noise seed."""
    cartvo, labels = bench.cartvo.module(), case.labels
    messages, path, start, last = [], {}, None, None
    with tempfile.TemporaryDirectory(prefix="cartvo-lab-") as work:
        work = pathlib.Path(work)
        source = measure.source_of(measure.prepared(bench, case), work)
        recording = cartvo.Recording(source.folder)
        truth = Truth(source, recording.rig)
        estimator = getattr(cartvo.Estimator, case.estimator.upper())
        processor = cartvo.PairProcessor(recording.rig, cartvo.Settings(features=case.features, estimator=estimator),
                                         alert_limits=alert_limits(cartvo, bench.alert_limits))
        for number, pair in itertools.islice(enumerate(recording), labels["first_pair"], labels["first_pair"] + labels["pairs"]):
            estimate = processor.process(with_noise(cartvo, pair, number, labels))
            if last and estimate.epoch != last[0]:  # an epoch begins at the pair before
                start = path[last[1]]
            last = estimate.epoch, truth.pair(1e-9 * estimate.exposure_ns)
            path[last[1]] = estimate.camera.pose if start is None else start @ estimate.camera.pose
            messages.append(errors_of(estimate, path, truth))
        if len(path) < 2:
            raise LabError(f"{source.folder}: has no pairs from number {labels['first_pair']} on; expected {labels['pairs']}; remove the "
                           "folder, so that it is rendered again")
        for name, poses in (("poses", map(truth.left_pose, path.values())), ("truth", (truth.poses[number] for number in path))):
            (work / f"{name}.txt").write_text("".join(" ".join(f"{value:.12g}" for value in pose[:3].ravel()) + "\n" for pose in poses))
        evaluation = bench.cartvo.evaluate(work / "poses.txt", work / "truth.txt")
    return {"sequence": case.sequence, "set": case.drive.set, "features": case.features, **labels, **statistics(messages),
            "evaluation": {key: evaluation[key] for key in ("segments_5_to_40_m", "segments_100_to_800_m")}}


def statistics(messages):
    """Lists of a value for each message, null where it has none, and both NEES. The first pair has no motion."""
    errors = [found or {} for found in messages[1:]]
    nees = {}
    for what in ("motion", "velocity"):
        values = [error[f"nees_{what}"] for error in errors if f"nees_{what}" in error]
        nees[f"nees_{what}"] = {"mean": sum(values) / len(values) if values else None, "samples": effective_count(values)}
    return {**{key: [float(f"{error[key]:.6g}") if key in error else None for error in errors] for key in paired.LISTS}, **nees}


def figures(results):
    """Figures of several results together."""
    def values(key):
        return [value for result in results for value in result[key] if value is not None]

    def mean(values):
        return sum(values) / len(values) if values else None

    rms = [math.sqrt(mean([value * value for value in values(key)])) if values(key) else None for key in ("rpe_m", "rpe_deg")]
    return {"rpe_mm": rms[0] and 1e3 * rms[0], "rpe_deg": rms[1], **{key: mean(values(key)) for key in ("nll_motion", "nll_velocity")},
            **{key: measure.pooled_nees(results, key) for key in ("nees_motion", "nees_velocity")},
            "available": 100.0 * len(values("rpe_m")) / sum(len(result["rpe_m"]) for result in results),
            "segments": measure.pooled_segments(results, "segments_5_to_40_m")}


def report(results, options):
    if options.merge:
        paired.checked(options.merge, results)
    table = Table(["drive", "set", "replays", "RPE: mm / deg", "NLL motion", "NLL velocity", "NEES motion", "NEES velocity", "available, %",
                   "5–40 m: % / deg/m"])
    rows = groups(results, lambda r: r["sequence"])
    for name, group in [*rows.items(), (f"all {len(rows)} drives", results)]:
        f = figures(group)
        table.add(name, group[0]["set"], len(group), both(fixed(f["rpe_mm"], 3), fixed(f["rpe_deg"], 4)), fixed(f["nll_motion"], 2),
                  fixed(f["nll_velocity"], 2), nees_cell(f["nees_motion"]), nees_cell(f["nees_velocity"]), significant(f["available"]),
                  segments_cell(f["segments"]))
    if not options.against:
        return [table], LEGEND
    compared, lines = paired.comparison(earlier(options.against), results, options.against)
    return [table, compared], "\n".join([*lines, "", LEGEND, paired.LEGEND])
