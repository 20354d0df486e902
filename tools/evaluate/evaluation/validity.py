"""Judges the messages of cartvod by the truth: errors, bounds, availability, consistency of covariances."""
import dataclasses
import functools
import json
import pathlib

import numpy as np

from evaluation.interpolation import InterpolatedTruth, TrueTwist
from evaluation.measures import row
from evaluation.messages import Messages, read_messages
from evaluation.motion import inverse, motion_vectors
from evaluation.pairing import later
from evaluation.program import EvaluationError, read_text
from evaluation.trajectory import CAMERA, read_trajectory

QUANTITIES = ("velocity", "angular_rate", "motion", "rotation")  # the order of errors, bounds and limits
DEFAULT_LIMITS = (0.7, 12.0, 0.2, 1.5)  # alert limits of cartvod: m/s, deg/s, m, deg
MOTION_SPAN_NS, ROUNDING_NS = 1_000_000_000, 1_000_000  # a frame period divides a second up to a rounding


def body_from_camera(summary):
    """T_body_camera (4x4) of a replay's summary.json."""
    try:
        matrix = json.loads(read_text(summary))["rig"]["T_body_camera"]
        pose = np.vstack([np.reshape([float(value) for value in matrix], (3, 4)), [0, 0, 0, 1]])
    except (ValueError, KeyError, TypeError, IndexError, RecursionError):
        raise EvaluationError(f"{summary}: has no rig.T_body_camera of 12 numbers, with which a truth of the left camera is converted to "
                              "the body; replay with this release of cartvo") from None
    return pose


def read_body_truth(file, odometry, times):
    """True poses of the body for the messages of an odometry.csv. Times of KITTI rows are those of the messages (ns), row by row. A truth
    of the left camera, which KITTI rows are, is converted to the body with the summary.json beside the odometry.csv."""
    truth = read_trajectory(file)
    if truth.is_kitti:
        if len(truth.times) != len(times):
            raise EvaluationError(f"{file}: has {len(truth.times)} poses for {len(times)} messages; KITTI rows have no times, so there must be "
                                  "one for each message")
        truth.times = times
    if truth.frame == CAMERA:
        T_body_camera = body_from_camera(pathlib.Path(odometry).parent / "summary.json")
        truth.poses = T_body_camera @ truth.poses @ inverse(T_body_camera)
    return truth


def normalised_errors(errors, covariances):
    """(n,) NEES over its dimension, e' P^-1 e / 6 (Y. Bar-Shalom, X. R. Li, T. Kirubarajan, "Estimation with Applications to Tracking and
    Navigation", 2001, 5.4.2); NaN where a covariance is not positive definite or a value is unknown."""
    result = np.full(len(errors), np.nan)
    for i in np.flatnonzero(np.isfinite(errors).all(1) & np.isfinite(covariances).all((1, 2))):
        try:
            result[i] = (np.linalg.solve(np.linalg.cholesky(covariances[i]), errors[i]) ** 2).sum() / 6
        except np.linalg.LinAlgError:
            pass
    return result


def motion_references(messages):
    """For each message the oldest VALID one of the same epoch in the last second, from which its motion counts; itself if there is
    none, and for messages that are not VALID."""
    valid, resets, times = messages.valid.tolist(), messages.resets.tolist(), messages.times.tolist()
    references, oldest = list(range(len(times))), 0
    for i in np.flatnonzero(messages.valid).tolist():
        while oldest < i and not (valid[oldest] and resets[oldest] == resets[i]
                                  and times[i] - times[oldest] <= MOTION_SPAN_NS + ROUNDING_NS):
            oldest += 1
        references[i] = min(oldest, i)
    return np.array(references)


@dataclasses.dataclass
class Judged:
    """Messages and the truth of the body at their instants."""
    messages: Messages
    is_known: np.ndarray  # (n,) whether the true pose is known
    truth: np.ndarray  # (n, 4, 4)
    true_twists: np.ndarray  # (n, 6), NaN where unknown

    @functools.cached_property
    def errors(self):
        """(n, 4, 3) magnitude of each component's error in body axes; NaN where the truth is unknown or the message is not VALID,
        infinite where a VALID message has no number. Motion and rotation: since the reference, because those are the poses that a
        controller may compare; NaN without one."""
        messages, from_ = self.messages, motion_references(self.messages)
        now = np.arange(len(from_))
        estimated = inverse(messages.poses[from_]) @ messages.poses
        exact = inverse(self.truth[from_]) @ self.truth
        errors = np.concatenate([messages.twists - self.true_twists, motion_vectors(inverse(estimated) @ exact)], 1)
        errors = np.abs(np.where(np.isfinite(errors), errors, np.inf)).reshape(-1, 4, 3)
        errors[~messages.valid | np.isnan(self.true_twists[:, 0]), :2] = np.nan
        errors[~messages.valid | (from_ == now) | ~self.is_known | ~self.is_known[from_], 2:] = np.nan
        return errors

    @functools.cached_property
    def nees(self):
        """(n,) normalised errors of the twist, and of the pose since the start of its epoch, which is the message before the epoch's first
        estimate; NaN where the truth is unknown or the message is not VALID. A standstill with a twist of zero has none of the twist."""
        messages, starts, epoch, start = self.messages, [], None, 0
        for i, (has_estimate, reset) in enumerate(zip(messages.with_estimate().tolist(), messages.resets.tolist())):
            if has_estimate and reset != epoch:
                epoch, start = reset, max(i, 1) - 1
            starts.append(start)
        twists = np.where((messages.valid & (messages.twists != 0).any(1))[:, None], messages.twists - self.true_twists, np.nan)
        poses = motion_vectors(inverse(messages.poses) @ inverse(self.truth[starts]) @ self.truth)
        poses[~(messages.valid & self.is_known & self.is_known[starts])] = np.nan
        return normalised_errors(twists, messages.twist_covariances), normalised_errors(poses, messages.pose_covariances)


def judge(messages, truth):
    is_known, poses = InterpolatedTruth(truth).at(messages.times)
    return Judged(messages, is_known, poses, TrueTwist(truth).at(messages.times))


def judge_file(odometry, truth_file, offset_ns):
    """Raises EvaluationError also if no message has a truth at its time."""
    messages = read_messages(odometry)
    messages.times = later(messages.times, offset_ns)
    judged = judge(messages, read_body_truth(truth_file, odometry, messages.times))
    if np.isnan(judged.true_twists[:, 0]).all():
        raise EvaluationError(f"{odometry} and {truth_file}: no message has a truth at its time; check that both use the same clock")
    return judged


@dataclasses.dataclass
class Validity:
    """Quality of VALID messages: how many have an error above a limit that does not depend on what they state, how many one above the
    bound that they state, and how often there is one."""
    messages: int
    valid: int
    judged: int  # VALID messages with a true velocity or motion
    above_limit: int  # of these, any component's error exceeds its alert limit
    above_bound: int  # of these, any component's error exceeds the message's bound, or has none
    longest_gap: float  # s, between two VALID messages, or before the first or behind the last one
    velocity_error: float  # m/s, largest error of a component of a VALID velocity
    rate_error: float  # deg/s, of a VALID angular rate

    def available_percent(self):
        return 100.0 * self.valid / self.messages

    def of_judged(self, count):
        return f"{count} of {self.judged}"


def validity_of(judged, limits):
    """`limits`: m/s, deg/s, m, deg."""
    messages, errors = judged.messages, judged.errors
    def exceeding(most):
        return int((~np.isnan(errors) & ~(errors <= most)).any((1, 2)).sum())
    si = np.multiply(limits, (1.0, np.pi / 180, 1.0, np.pi / 180))[:, None]
    last, longest = messages.times[0], 0
    for time, valid in zip(messages.times, messages.valid):
        longest, last = max(longest, time - last), time if valid else last
    largest = [float(np.fmax.reduce(errors[:, i], axis=None, initial=0.0)) for i in (0, 1)]
    return Validity(len(messages.times), int(messages.valid.sum()), int((~np.isnan(errors[:, 0, 0]) | ~np.isnan(errors[:, 2, 0])).sum()),
                    exceeding(si), exceeding(messages.bounds), 1e-9 * float(longest), largest[0], float(np.degrees(largest[1])))


def validity_table(validity, limits):
    """Lines in the form of evaluation_table()."""
    velocity, rate, motion, rotation = limits
    return (row("available: VALID messages", f"{validity.valid} of {validity.messages}, {validity.available_percent():.2f} %, longest gap "
                f"{validity.longest_gap:.2f} s")
            + row("VALID above an alert limit", f"{validity.of_judged(validity.above_limit)} ({velocity:g} m/s, {rate:g} deg/s, {motion:g} m, "
                  f"{rotation:g} deg)")
            + row("VALID above their bound", validity.of_judged(validity.above_bound))
            + row("largest error of a VALID message", f"{validity.velocity_error:.3f} m/s, {validity.rate_error:.2f} deg/s"))


def validity_json(validity, limits):
    return {"messages": validity.messages, "valid_messages": validity.valid, "judged_messages": validity.judged,
            "above_limit": validity.above_limit, "above_bound": validity.above_bound, "available_percent": validity.available_percent(),
            "longest_gap_s": validity.longest_gap, "largest_velocity_error_m_s": validity.velocity_error,
            "largest_rate_error_deg_s": validity.rate_error, "alert_limits": list(limits)}


def messages_csv(judged):
    """A row for each message: instant, validity, errors and bounds (m/s, rad/s, m, rad)."""
    names = [f"{quantity}_{kind}_{axis}" for kind in ("error", "bound") for quantity in QUANTITIES for axis in "xyz"]
    values = np.concatenate([judged.errors, judged.messages.bounds], 1).reshape(-1, len(names)).tolist()
    rows = (",".join([str(time // 1000), str(int(valid)), *("" if value != value else f"{value:.6g}" for value in of_message)])
            for time, valid, of_message in zip(judged.messages.times.tolist(), judged.messages.valid, values))
    return "".join(line + "\n" for line in [",".join(["utime_us", "valid", *names]), *rows])
