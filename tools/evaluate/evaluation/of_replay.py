"""Compares a replay, pair by pair, with the truth: what `cartvo replay --truth` adds to its files.

`cartvo-evaluate --of-replay TRUTH` reads a JSON object from the standard input: "T_body_camera" (16 numbers, by rows), and lists with one value
for each pair, see Pairs. It prints a JSON object: "evaluation" and "consistency" of summary.json, "errors", a text for each row of
Motionestimation.csv, and "table". `cartvo-evaluate --check-truth TRUTH` only reads the truth."""
import json
import math
import os
import sys

import numpy as np

from evaluation.interpolation import TrueTwist
from evaluation.measures import evaluate, evaluation_json, evaluation_table, rms
from evaluation.motion import inverse, motion_vectors
from evaluation.oxts import read_oxts
from evaluation.pairing import Pairing, pair_by_time
from evaluation.program import EvaluationError, json_text, print_output
from evaluation.trajectory import Trajectory, read_trajectory
from evaluation.validity import normalised_errors

STANDING = 1e-4  # m and rad: a true motion between two pairs below both counts as standstill
STANDSTILL_MOTION, ROUNDING = 1e-3, 1e-12  # m; of the elements of an identity
TAIL = 0.025  # probability on each side of the band


def read_truth(file):
    """A trajectory, or a raw recording of KITTI."""
    return read_oxts(file) if os.path.isdir(file) else read_trajectory(file)


class Pairs:
    """Arrays over the pairs; poses (n, 4, 4), m; NaN: no value."""

    def __init__(self, replay, truth):
        def array(name, *shape):
            none = [math.nan] * math.prod(shape)
            return np.array([none if value is None else value for value in replay[name]], float).reshape(-1, *shape)
        self.times = np.array(replay["exposure_ns"], np.int64)
        self.valid = np.array(replay["valid"], bool)
        self.epochs = replay["reset_counter"]
        self.time_steps = array("time_step")  # s, since the pair from which the motion is measured; 0: no motion was measured
        self.first, self.epoch = array("T_first_left", 4, 4), array("T_epoch_left", 4, 4)
        self.motions = array("T_previous_current", 4, 4)  # of the left camera
        self.twists = array("twist", 6)  # of the body, m/s and rad/s
        self.motion_covariances, self.pose_covariances, self.twist_covariances = (
            array(f"{name}_covariance", 6, 6) for name in ("motion", "pose", "twist"))
        self.T_body_camera = np.reshape(replay["T_body_camera"], (4, 4))
        self.body = self.T_body_camera @ self.first @ inverse(self.T_body_camera)
        self.truth = np.full((len(self.times), 4, 4), np.nan)  # of the body, relative to the first known one
        self.dense_truth = self.set_truth(truth)
        self.is_known = ~np.isnan(self.truth[:, 0, 0])

    def later_pairs(self):
        """Those that are later than all before."""
        kept = []
        for i, time in enumerate(self.times.tolist()):
            if not kept or time > self.times[kept[-1]]:
                kept.append(i)
        return np.array(kept)

    def set_truth(self, file):
        """Rows of KITTI are poses of the left camera, one for each pair; rows of TUM and EuRoC are poses of the body, at any instants; a
        raw recording of KITTI has poses of the left camera at any instants. Returns the true poses of the body as densely as they are known."""
        truth, T = read_truth(file), self.T_body_camera
        if truth.is_kitti and len(truth.times) != len(self.times):
            raise EvaluationError(f"{file}: has {len(truth.times)} poses for {len(self.times)} pairs; KITTI rows have no times, so there must be "
                                  "one row for each pair")
        if truth.is_kitti:
            self.truth[:] = inverse(truth.poses[0]) @ truth.poses
        else:
            kept = self.later_pairs()
            try:
                found = pair_by_time(Trajectory(self.times[kept], self.body[kept]), truth)
            except EvaluationError as error:
                raise EvaluationError(f"{file}: {error}") from None
            self.truth[kept[np.isin(self.times[kept], found.times)]] = inverse(found.truth[0]) @ found.truth
        if truth.is_kitti or os.path.isdir(file):
            self.truth[:] = T @ self.truth @ inverse(T)
            kept = [i for i in self.later_pairs() if not np.isnan(self.truth[i, 0, 0])]
            return Trajectory(self.times[kept], self.truth[kept])
        return truth

    def reference(self, i):
        """The pair from which the motion of pair `i` is measured, which is one of those before."""
        def distance(j):
            return abs(1e-9 * int(self.times[i] - self.times[j]) - self.time_steps[i])
        j = i - 1
        while j > 0 and distance(j - 1) < distance(j):
            j -= 1
        return j

    def pairing(self):
        return Pairing(False, self.times[self.is_known], self.body[self.is_known], self.truth[self.is_known], int((~self.is_known).sum()))


def twists_of(motions):
    """(n, 6) constant twists of motions in a unit of time: J. Solà et al., A micro Lie theory, 2018, eq. 146 and 174."""
    vectors = motion_vectors(motions)
    t, w = vectors[:, :3], vectors[:, 3:]
    angle = np.maximum(np.linalg.norm(w, axis=1, keepdims=True), 1e-4)
    factor = (1.0 - 0.5 * angle / np.tan(0.5 * angle)) / angle**2
    return np.concatenate([t - 0.5 * np.cross(w, t) + factor * np.cross(w, np.cross(w, t)), w], 1)


def error_columns(pairs):
    """For each pair the text of the error columns of Motionestimation.csv: estimate minus truth of Vx, Vy, Vz, pitch, yaw and roll rate, m/s and
    rad/s, and the distance between the estimated and the true position, m; empty where the truth is unknown."""
    from_ = np.array([pairs.reference(i) if i > 0 and pairs.valid[i] else i for i in range(len(pairs.times))])
    errors = pairs.twists - twists_of(inverse(pairs.truth[from_]) @ pairs.truth) / pairs.time_steps[:, None]
    errors[from_ == np.arange(len(from_))] = np.nan
    away = np.linalg.norm(pairs.body[:, :3, 3] - pairs.truth[:, :3, 3], axis=1)
    columns = np.column_stack([errors[:, [0, 1, 2, 4, 5, 3]], away]).tolist()
    return ["".join(f",{value + 0.0:.9g}" if math.isfinite(value) else "," for value in row) for row in columns]


def band(count):
    """The central 95 % interval of the mean of `count` independent values of chi-square(6) / 6, by bisection. For an even number of degrees of
    freedom the incomplete gamma function is a sum of Poisson probabilities (M. Abramowitz, I. Stegun, 26.4.21)."""
    half_dof = 3 * count
    k = np.arange(half_dof)
    logarithms = np.concatenate([[0.0], np.cumsum(np.log(k[1:]))])  # of k!
    width = 10.0 * math.sqrt(2.0 / (6.0 * count))
    ends = []
    for probability in (1.0 - TAIL, TAIL):
        low, high = max(1e-6, 1.0 - width), 1.0 + width
        for _ in range(40):
            middle = 0.5 * (low + high)
            value = middle * half_dof
            is_below = np.exp(k * math.log(value) - value - logarithms).sum() > probability
            low, high = (middle, high) if is_below else (low, middle)
        ends.append(0.5 * (low + high))
    return ends


def errors_json(errors, covariances, groups):
    """The mean of the means of groups, each of which counts as one independent sample. A covariance that is not positive definite is only
    counted."""
    values = normalised_errors(errors, covariances)
    means = [values[np.isfinite(values) & (groups == group)].mean() for group in np.unique(groups[np.isfinite(values)])]
    return {"mean": float(np.mean(means)) if means else None, "band_95_percent": band(len(means)) if means else None, "samples": len(means),
            "unusable": int(np.isnan(values).sum())}


def consistency_json(pairs):
    """How covariances and velocities agree with the truth, each error in the frame and with the perturbation that its covariance is defined for
    (on the right, in the axes of the current frame). Each motion is a group of its own, and the poses of an epoch are one, because each has the
    errors of those before. A zero-velocity update (a motion of exactly the identity) is left out if the camera truly moved less than a millimetre:
    standstill is a decision, not a measurement."""
    T, start, epoch, group = pairs.T_body_camera, None, None, 0
    left = inverse(T) @ pairs.truth @ T
    moved, posed = [], []  # (pair, the one before), (pair, start of the epoch, epoch)
    for i in range(1, len(pairs.times)):
        if not pairs.time_steps[i] > 0:
            continue
        from_ = pairs.reference(i)
        if pairs.epochs[i] != epoch:
            epoch, start, group = pairs.epochs[i], from_, group + 1
        if pairs.is_known[i] and pairs.valid[i]:
            moved += [(i, from_)] if pairs.is_known[from_] else []
            posed += [(i, start, group)] if pairs.is_known[start] else []
    (now, before), (last, starts, epochs) = (np.array(rows, int).reshape(-1, k).T for rows, k in ((moved, 2), (posed, 3)))
    true_motions = inverse(left[before]) @ left[now]
    size, turn = (np.linalg.norm(part, axis=1) for part in np.split(motion_vectors(true_motions), 2, 1))
    stands = (size < STANDING) & (turn < STANDING)
    speeds = np.linalg.norm(pairs.twists[now[stands], :3], axis=1)
    twists, true_twists = pairs.twists[now], TrueTwist(pairs.dense_truth).at(pairs.times[now])
    has_twist = np.isfinite(true_twists).all(1)
    rated = has_twist & np.isfinite(twists).all(1)
    true_rate = math.degrees(rms(np.linalg.norm(true_twists[rated, 3:], axis=1)))
    is_update = (np.abs(pairs.motions[now] - np.eye(4)) < ROUNDING).all((1, 2)) & (size < STANDSTILL_MOTION)
    measured, with_twist = ~is_update, ~is_update & has_twist
    pose_errors = motion_vectors(inverse(pairs.epoch[last]) @ inverse(left[starts]) @ left[last])
    return {
        "nees_motion": errors_json(motion_vectors(inverse(pairs.motions[now]) @ true_motions)[measured], pairs.motion_covariances[now[measured]],
                                   now[measured]),
        "nees_pose": errors_json(pose_errors, pairs.pose_covariances[last], epochs),
        "nees_velocity": errors_json((twists - true_twists)[with_twist], pairs.twist_covariances[now[with_twist]], now[with_twist]),
        "standing_pairs": int(stands.sum()),
        "standing_highest_speed_m_s": float(np.fmax.reduce(speeds, initial=0.0)) if stands.any() else None,
        "rate_error_deg_s": math.degrees(rms(np.linalg.norm((twists - true_twists)[rated, 3:], axis=1))) if true_rate > 0 else None,
        "true_rate_deg_s": true_rate if true_rate > 0 else None}


def evaluate_replay(truth):
    pairs = Pairs(json.load(sys.stdin), truth)
    evaluation = evaluate(pairs.pairing())
    print_output(json_text({"evaluation": evaluation_json(evaluation), "consistency": consistency_json(pairs), "errors": error_columns(pairs),
                            "table": evaluation_table(evaluation)}))
