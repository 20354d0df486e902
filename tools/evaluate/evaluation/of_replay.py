"""Compares a replay, pair by pair, with the truth: the part of summary.json that `cartvo replay --truth` adds.

`cartvo-evaluate --of-replay` reads a JSON object from the standard input: "T_body_camera" (16 numbers, by rows), "truth" (the file of the body's
poses, or null: those of the pairs), and lists with one value for each pair, see Pairs. It prints a JSON object: "evaluation" and "consistency" of
summary.json, and "table"."""
import json
import math
import sys

import numpy as np

from evaluation.interpolation import TrueTwist
from evaluation.measures import evaluate, evaluation_json, evaluation_table, rms
from evaluation.motion import inverse, motion_vectors
from evaluation.pairing import Pairing
from evaluation.program import json_text, print_output
from evaluation.trajectory import Trajectory, read_trajectory
from evaluation.validity import normalised_errors

STANDING = 1e-4  # m and rad: a true motion between two pairs below both counts as standstill
STANDSTILL_MOTION, ROUNDING = 1e-3, 1e-12  # m; of the elements of an identity
TAIL = 0.025  # probability on each side of the band


class Pairs:
    """Arrays over the pairs; poses (n, 4, 4), m; NaN: no value."""

    def __init__(self, replay):
        def array(name, *shape):
            none = [math.nan] * math.prod(shape)
            return np.array([none if value is None else value for value in replay[name]], float).reshape(-1, *shape)
        self.times = np.array(replay["exposure_ns"], np.int64)
        self.valid = np.array(replay["valid"], bool)
        self.epochs = replay["reset_counter"]
        self.time_steps = array("time_step")  # s, since the pair from which the motion is measured; 0: no motion was measured
        self.truth = array("truth_of_body", 4, 4)  # of the body
        self.first, self.epoch = array("T_first_left", 4, 4), array("T_epoch_left", 4, 4)
        self.motions = array("T_previous_current", 4, 4)  # of the left camera
        self.twists = array("twist", 6)  # of the body, m/s and rad/s
        self.motion_covariances, self.pose_covariances, self.twist_covariances = (
            array(f"{name}_covariance", 6, 6) for name in ("motion", "pose", "twist"))
        self.T_body_camera = np.reshape(replay["T_body_camera"], (4, 4))
        self.is_known = ~np.isnan(self.truth[:, 0, 0])

    def reference(self, i):
        """The pair from which the motion of pair `i` is measured, which is one of those before."""
        def distance(j):
            return abs(1e-9 * int(self.times[i] - self.times[j]) - self.time_steps[i])
        j = i - 1
        while j > 0 and distance(j - 1) < distance(j):
            j -= 1
        return j

    def pairing(self):
        T = self.T_body_camera
        estimate = T @ self.first[self.is_known] @ inverse(T)
        return Pairing(False, self.times[self.is_known], estimate, self.truth[self.is_known], int((~self.is_known).sum()))

    def body_poses(self):
        """The true poses at the pairs, in the order of time."""
        kept, last = [], -math.inf
        for i in np.flatnonzero(self.is_known).tolist():
            if self.times[i] > last:
                kept.append(i)
                last = self.times[i]
        return Trajectory(self.times[kept], self.truth[kept])


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


def consistency_json(pairs, truth):
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
    twists, true_twists = pairs.twists[now], TrueTwist(truth).at(pairs.times[now])
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


def evaluate_replay():
    replay = json.load(sys.stdin)
    pairs = Pairs(replay)
    truth = read_trajectory(replay["truth"]) if replay["truth"] else pairs.body_poses()
    evaluation = evaluate(pairs.pairing())
    print_output(json_text({"evaluation": evaluation_json(evaluation), "consistency": consistency_json(pairs, truth),
                            "table": evaluation_table(evaluation)}))
