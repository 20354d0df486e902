"""Replays a sequence and compares it with the truth: the figures of one row of a table."""
import concurrent.futures
import csv
import dataclasses
import json
import math
import pathlib
import sys
import tempfile

from laboratory import drives
from laboratory.program import LabError

ESTIMATORS = ["reprojection", "thesis"]  # the default first


@dataclasses.dataclass
class Case:
    """One replay: of a real sequence (folder) or of a rendered drive."""
    sequence: str
    folder: pathlib.Path | None = None
    drive: drives.Drive | None = None
    estimator: str = ESTIMATORS[0]
    features: int = 1000
    bitrate_kbps: int | None = None
    change: str = ""  # of the pictures, instants or the rig; see laboratory.changes
    replay_options: tuple = ()
    threads: int | None = None  # None: those of all
    labels: dict = dataclasses.field(default_factory=dict)  # columns of the table that the case is for


@dataclasses.dataclass
class Source:
    """The source of a replay, and its truth."""
    folder: pathlib.Path
    poses: pathlib.Path  # rows of the left camera
    body: pathlib.Path | None = None  # poses of the body with times, more of them than pairs
    rig: pathlib.Path | None = None  # None: that of the folder
    has_jumps: bool = False  # the truth has no velocity


@dataclasses.dataclass
class Bench:
    """Options of all measurements."""
    cartvo: object
    cache: pathlib.Path
    threads: int = 1
    alert_limits: str | None = None
    jobs: int = 1

    @property
    def limits(self):
        return ["--alert-limits", self.alert_limits] if self.alert_limits else []


def image_times(folder):
    """Instants of the left images, s, where the folder has a file of them."""
    for name in ("times_0.txt", "times.txt"):
        if (folder / name).exists():
            return [float(line) for line in (folder / name).read_text().split()]
    return None


def left_images(folder):
    for name in ("image_0", "cam0/data", "mav0/cam0/data"):
        if (folder / name).is_dir():
            return sorted(path for path in (folder / name).iterdir() if not path.name.startswith("."))
    raise LabError(f"{folder}: has no left images; expected image_0, cam0/data or mav0/cam0/data")


def pose_rows(file):
    return [line for line in file.read_text().splitlines(keepends=True) if line.strip() and not line.startswith("#")]


def source_of(folder, work):
    """A folder as it is. A standing camera has no poses.txt: all its true poses are the same."""
    poses = folder / "poses.txt"
    if not poses.exists():
        poses = work / "poses_still.txt"
        poses.write_text("1 0 0 0 0 1 0 0 0 0 1 0\n" * len(left_images(folder)))
    body = folder / "truth.tum"
    return Source(folder, poses, body if body.exists() else None)


def rows_of_pairs(source, messages, work):
    """The truth of the pairs that were formed: some of the sequence may have no partner."""
    rows, times = pose_rows(source.poses), image_times(source.folder)
    if len(rows) == len(messages):
        return source.poses
    if not times or len(times) != len(rows):
        raise LabError(f"{source.folder}: {len(rows)} true poses, {len(messages)} pairs and no time for each pose")
    by_time = {round(1e6 * time): row for time, row in zip(times, rows)}
    nearest = [min(by_time, key=lambda time, at=int(message["utime_us"]): abs(time - at)) for message in messages]
    file = work / "poses_of_pairs.txt"
    file.write_text("".join(by_time[time] for time in nearest))
    return file


def replayed(bench, case, source, out):
    """Replays the source into a folder; its summary, or None if no pair was formed."""
    arguments = ["replay", source.folder, "--output-dir", out, "--features", case.features, "--estimator", case.estimator, "--threads",
                 case.threads or bench.threads, *bench.limits, *case.replay_options, *(["--rig", source.rig] if source.rig else [])]
    truth = source.body or source.poses
    said = bench.cartvo.run(*arguments, "--truth", truth, failure_allowed=True)
    if said is None and not (out / "summary.json").exists():  # rows of the truth for pairs that were not formed, or no pair at all
        said = bench.cartvo.run(*arguments, failure_allowed=True)
    if said is None and not (out / "summary.json").exists():
        return None
    return json.loads((out / "summary.json").read_text())


def read_csv(file):
    with open(file, newline="") as text:
        return list(csv.DictReader(text))


def judged_without_velocity(validity, messages):
    """Counts of messages by their motion and rotation alone."""
    limits = dict(zip(("motion", "rotation"), (validity["alert_limits"][2], math.radians(validity["alert_limits"][3]))))
    valid = [row for row in messages if row["valid"] == "1"]

    def above(row, most):
        return any(row[f"{q}_error_{axis}"] and float(row[f"{q}_error_{axis}"]) > most(row, q, axis) for q in limits for axis in "xyz")

    return {**validity, "above_limit": sum(above(row, lambda _, q, __: limits[q]) for row in valid),
            "above_bound": sum(above(row, lambda r, q, axis: float(r[f"{q}_bound_{axis}"] or "inf")) for row in valid)}


def errors_per_second(poses, truth_rows, times):
    """Error of the path over each whole second, m."""
    import numpy as np
    estimate, truth = (np.array([[*map(float, row.split()), 0, 0, 0, 1] for row in rows]).reshape(-1, 4, 4) for rows in (poses, truth_rows))
    errors, start = [], 0
    for end, time in enumerate(times):
        if time < times[start] + 1.0 - 1e-9:
            continue
        motion, true_motion = (np.linalg.inv(path[start]) @ path[end] for path in (estimate, truth))
        errors.append(float(np.linalg.norm((np.linalg.inv(true_motion) @ motion)[:3, 3])))
        start = end
    return errors


def figures(bench, case, source, out, work):
    """Figures of a replay, named as the tables and tests/accuracy/limits.json name them."""
    summary = replayed(bench, case, source, out)
    if summary is None:
        return {"pairs": 0, "lost": len(pose_rows(source.poses))}
    messages = read_csv(out / "odometry.csv")
    poses = rows_of_pairs(source, messages, work)
    evaluation = bench.cartvo.evaluate(out / "poses.txt", poses)
    judged = bench.cartvo.evaluate(out / "odometry.csv", source.body or poses, *bench.limits, "--messages", work / "messages.csv")
    validity = judged["validity"]
    if source.has_jumps:
        validity = judged_without_velocity(validity, read_csv(work / "messages.csv"))
    stands = evaluation["final_drift_percent"] is None
    values = {"pairs": summary["pairs"], "invalid": sum(pair > 0 for pair in summary["invalid_pairs"]),
              "lost": max(0, len(pose_rows(source.poses)) - summary["pairs"]), "resets": summary["resets"],
              "standing_end_m": evaluation["final_drift_m"] if stands else None,
              "standing_end_deg": evaluation["final_rotation_deg"] if stands else None,
              "evaluation": {key: value for key, value in evaluation.items() if key not in ("estimate", "truth")},
              **summary.get("consistency", {}), **validity, "time_ms": summary["time_ms"]["total"],
              "stages_ms": {stage: times["median"] for stage, times in summary["time_ms"].items() if stage != "total"}}
    if "errors_per_second" in case.labels.get("wants", ()):
        values["errors_per_second_m"] = errors_per_second(pose_rows(out / "poses.txt"), pose_rows(poses),
                                                          [1e-6 * int(message["utime_us"]) for message in messages])
    if "timing" in case.labels.get("wants", ()):
        values["timing_ms"] = {name: [float(row[f"{name}_ms"]) for row in read_csv(out / "timing.csv")] for name in ("total", "rectify")}
    if "rates" in case.labels.get("wants", ()):
        values["rmse"] = rate_errors(read_csv(out / "Motionestimation.csv"))
    return values


def rate_errors(rows):
    """Root mean squares of the errors of velocity and rates."""
    rows = [row for row in rows if row["valid"] == "1" and row["error_Vx"]]
    names = ("Vx", "Vy", "Vz", "pitch_rate", "yaw_rate", "roll_rate")
    return {name: math.sqrt(sum(float(row[f"error_{name}"]) ** 2 for row in rows) / len(rows)) for name in names} if rows else {}


def prepared(bench, case):
    """The folder of the case: rendered and encoded, unless that is in the cache."""
    folder = drives.rendered(bench.cartvo, case.drive, bench.cache) if case.drive else case.folder
    if case.bitrate_kbps:
        name = case.drive.folder_name if case.drive else case.folder.name
        return drives.encoded(bench.cartvo, folder, name, case.bitrate_kbps, bench.cache)
    return folder


def measure(bench, case):
    """The result of a case, as JSON."""
    from laboratory import changes
    with tempfile.TemporaryDirectory(prefix="cartvo-lab-") as work:
        work = pathlib.Path(work)
        source = source_of(prepared(bench, case), work)
        if case.change:
            source = changes.changed(bench.cartvo, source, case.change, work / "changed")
        values = figures(bench, case, source, work / "out", work)
    return {"sequence": case.sequence, "kind": "rendered" if case.drive else "real", "set": case.drive.set if case.drive else None,
            "bitrate_mbps": case.bitrate_kbps / 1e3 if case.bitrate_kbps else None, "estimator": case.estimator,
            "features": case.features, **{key: value for key, value in case.labels.items() if key != "wants"}, **values}


def measure_all(bench, cases, one=measure):
    """The results one(bench, case) of the cases in their order. Drives are rendered first, each once."""
    with concurrent.futures.ThreadPoolExecutor(max(1, bench.jobs // 2)) as pool:  # rendering takes two threads
        distinct = {(case.drive or case.folder, case.bitrate_kbps): case for case in cases}
        show("rendered", [pool.submit(prepared, bench, case) for case in distinct.values()])
    with concurrent.futures.ThreadPoolExecutor(bench.jobs) as pool:
        return show("replayed", [pool.submit(one, bench, case) for case in cases])


def show(what, futures):
    """Waits for futures, with progress on a terminal. After an error nothing more begins."""
    done = 0
    try:
        for future in concurrent.futures.as_completed(futures):
            future.result()
            done += 1
            if sys.stderr.isatty():
                print(f"\r{what}: {done} of {len(futures)}", end="\n" if done == len(futures) else "", file=sys.stderr, flush=True)
    except BaseException:
        for future in futures:
            future.cancel()
        raise
    return [future.result() for future in futures]


# Several results together.


def band(samples):
    """The central 95 % interval of the mean of `samples` values of chi-square(6) / 6, by Wilson and Hilferty."""
    share = 2.0 / (9.0 * 6.0 * samples)
    return [(1.0 - share + sign * 1.959964 * math.sqrt(share)) ** 3 for sign in (-1, 1)]


def pooled_nees(results, key):
    parts = [result[key] for result in results if result.get(key) and result[key]["samples"]]
    samples = sum(part["samples"] for part in parts)
    if not samples:
        return None
    return {"mean": sum(part["mean"] * part["samples"] for part in parts) / samples, "samples": samples, "band_95_percent": band(samples)}


def pooled_segments(results, key):
    parts = [result["evaluation"][key] for result in results if result["evaluation"][key]["count"]]
    count = sum(part["count"] for part in parts)
    mean = {value: sum(part["count"] * part[value] for part in parts) / count if count else None
            for value in ("translation_percent", "rotation_deg_per_m")}
    return {"count": count, **mean}


def pooled_validity(results):
    sums = {key: sum(result.get(key, 0) for result in results) for key in
            ("messages", "valid_messages", "judged_messages", "above_limit", "above_bound")}
    most = {key: max((result.get(key) or 0.0 for result in results), default=0.0) for key in
            ("longest_gap_s", "largest_velocity_error_m_s", "largest_rate_error_deg_s")}
    return {**sums, **most, "available_percent": 100.0 * sums["valid_messages"] / max(sums["messages"], 1)}


def largest(results, key):
    return max((result[key] for result in results if result.get(key) is not None), default=None)


def pooled(name, results):
    """Results as one: counts are summed; segments, motions and NEES pooled; drift is the mean of moving sequences; end errors, speeds
    at standstill, gaps and errors of messages are maxima."""
    results = [result for result in results if result.get("evaluation")]
    first = results[0]
    motions = sum(result["evaluation"]["poses"] - 1 for result in results)
    moving = [result["evaluation"] for result in results if result["evaluation"]["final_drift_percent"] is not None]

    def mean_square(key):
        return math.sqrt(sum((r["evaluation"]["poses"] - 1) * r["evaluation"][key] ** 2 for r in results) / max(motions, 1))

    evaluation = {"poses": motions + 1, "path_length_m": sum(result["evaluation"]["path_length_m"] for result in results),
                  "rpe_rmse_m": mean_square("rpe_rmse_m"), "rpe_rmse_deg": mean_square("rpe_rmse_deg"),
                  **{key: sum(one[key] for one in moving) / len(moving) if moving else None
                     for key in ("final_drift_m", "final_drift_percent")},
                  **{key: pooled_segments(results, key) for key in ("segments_5_to_40_m", "segments_100_to_800_m")}}
    squares = [(result.get("rate_error_deg_s"), result.get("true_rate_deg_s"), result["pairs"]) for result in results]
    squares = [(error ** 2 * pairs, rate ** 2 * pairs) for error, rate, pairs in squares if rate]
    return {**{key: first[key] for key in ("kind", "set", "bitrate_mbps", "estimator", "features")}, "sequence": name,
            **{key: sum(result[key] for result in results) for key in ("pairs", "invalid", "lost", "resets")},
            **{key: largest(results, key) for key in ("standing_end_m", "standing_end_deg", "standing_highest_speed_m_s")},
            **{key: pooled_nees(results, key) for key in ("nees_motion", "nees_pose", "nees_velocity")},
            "rate_error_deg_s": math.sqrt(sum(error for error, _ in squares)) if squares else None,
            "true_rate_deg_s": math.sqrt(sum(rate for _, rate in squares)) if squares else None,
            **pooled_validity(results), "evaluation": evaluation, "time_ms": None}
