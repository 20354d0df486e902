"""Pairs the poses of an estimate with the truth, by time or row by row, and fits the estimate to the truth."""
import dataclasses

import numpy as np

from evaluation.clock import clock_problem
from evaluation.interpolation import InterpolatedTruth
from evaluation.motion import best_rotation, inverse
from evaluation.program import EvaluationError
from evaluation.trajectory import BODY, CAMERA, read_trajectory

LATEST_NS = 4_600_000_000_000_000_000


@dataclasses.dataclass
class Fit:
    """How an estimate is compared; evo has the same names for these options."""
    offset_ns: int = 0  # added to the estimate's instants
    aligns: bool = False  # rotation and translation of the world, and rotation of the axes
    corrects_scale: bool = False  # scale of the path


@dataclasses.dataclass
class Pairing:
    """Estimate and truth at the same times, pose by pose: poses of one frame, each in its own world."""
    by_time: bool
    times: np.ndarray  # (n,) int64 ns; row by row: the rows
    estimate: np.ndarray  # (n, 4, 4)
    truth: np.ndarray  # (n, 4, 4)
    unmatched: int = 0  # poses of the estimate without a truth
    is_aligned: bool = False  # the estimate was fitted to the truth's world
    clocks_differ: bool = False  # as one of the problems says
    scale: float = 1.0  # by which the estimate's path was multiplied
    problems: list = dataclasses.field(default_factory=list)

    def placed_estimate(self):
        """(n, 4, 4), the estimate in the truth's world: as it was fitted, else such that the first poses coincide."""
        return self.estimate if self.is_aligned else self.truth[0] @ inverse(self.estimate[0]) @ self.estimate

    def placement(self):
        return "aligned" if self.is_aligned else "starts coincide"


def later(times, offset_ns):
    """Instants (ns) after --offset."""
    if abs(int(times[0]) + offset_ns) > LATEST_NS or abs(int(times[-1]) + offset_ns) > LATEST_NS:
        raise EvaluationError("--offset moves the instants beyond the year 2112; expected seconds")
    return times + offset_ns


def span(trajectory):
    return f"{1e-9 * trajectory.times[0]:.3f} s to {1e-9 * trajectory.times[-1]:.3f} s"


def unit_problem(trajectory, name):
    """Says that instants are so far apart that they are no seconds."""
    period = 1e-9 * float(np.median(np.diff(trajectory.times))) if len(trajectory.times) > 1 else 0.0
    return f"the {name}'s instants are {period:.6g} s apart: are they milliseconds or microseconds? Write seconds" if period > 10.0 else ""


def pair_by_time(estimate, truth):
    """Raises EvaluationError if fewer than two poses have a truth, see InterpolatedTruth."""
    known, poses = InterpolatedTruth(truth).at(estimate.times)
    problem = unit_problem(estimate, "estimate") or unit_problem(truth, "truth") or clock_problem(estimate, truth)
    if known.sum() < 2:
        raise EvaluationError(
            f"fewer than two poses of the estimate have a truth at their time: the estimate is of {span(estimate)}, the truth of "
            f"{span(truth)}; check that both are of one drive ('cartvo simulate' keeps the truth of an earlier run as "
            "truth-SECOND.tum) and one clock, in seconds; --offset of 'cartvo evaluate' adds to the estimate's instants"
            + (f"; {problem}" if problem else ""))
    return Pairing(True, estimate.times[known], estimate.poses[known], poses[known], int((~known).sum()),
                   clocks_differ=bool(problem), problems=[problem] if problem else [])


def pair_by_rows(estimate, truth):
    if len(estimate.times) != len(truth.times):
        raise EvaluationError(f"the estimate has {len(estimate.times)} poses, the truth {len(truth.times)}; KITTI rows have no times, "
                              "so both files must contain the same frames. Give files with times instead, as replay's "
                              "trajectory.tum and a truth.tum")
    if len(estimate.times) < 2:
        raise EvaluationError("a trajectory of one pose cannot be evaluated; at least two are needed")
    return Pairing(False, estimate.times, estimate.poses, truth.poses)


def frame_problem(estimate_file, estimated, truth_file, true, aligns):
    """The problem of a comparison of these frames; empty: none. Raises EvaluationError if both are known and cannot be compared."""
    if aligns or estimated is None or true is None or estimated == true:
        return ""
    frames = f"{estimate_file} has poses of {estimated}, {truth_file} of {true}"
    if CAMERA not in (estimated, true):
        return frames + ": state T_body_camera in the rig ('cartvo calibrate mount') and replay again, or compare with --align"
    raise EvaluationError(f"{frames}, as their first lines state (KITTI's rows are of the left camera); compare files of the same frame: of a "
                          f"replay, poses.txt is of the left camera and trajectory.tum of {BODY}; or compare with --align")


def pair_files(estimate_file, truth_file, fit):
    """Reads both files and pairs them: by time, or by rows if one is KITTI's; then fits the estimate. Errors name the files."""
    estimate, truth = read_trajectory(estimate_file), read_trajectory(truth_file)
    problem = frame_problem(estimate_file, estimate.frame, truth_file, truth.frame, fit.aligns)
    try:
        if estimate.is_kitti or truth.is_kitti:
            if fit.offset_ns:
                raise EvaluationError("rows of KITTI have no instants to which --offset could add")
            pairing = pair_by_rows(estimate, truth)
        else:
            estimate.times = later(estimate.times, fit.offset_ns)
            pairing = pair_by_time(estimate, truth)
        pairing.problems += [problem] if problem else []
        fit_estimate(fit, pairing)
    except EvaluationError as error:
        raise EvaluationError(f"{estimate_file} and {truth_file}: {error}") from None
    return pairing, truth.is_kitti


def similarity(points, to, with_scale):
    """Rotation, translation and scale that take `points` (n, 3) to `to` best (S. Umeyama, 1991)."""
    mean, mean_to = points.mean(0), to.mean(0)
    products = (to - mean_to).T @ (points - mean)
    R = best_rotation(products)
    scale = float(np.trace(R.T @ products) / ((points - mean) ** 2).sum()) if with_scale else 1.0
    return R, mean_to - scale * R @ mean, scale


def aligned_error(pairing):
    """RMSE of position (m) after the rigid alignment that minimises it."""
    points, to = pairing.estimate[:, :3, 3], pairing.truth[:, :3, 3]
    R, t, _ = similarity(points, to, False)
    return float(np.sqrt(((points @ R.T + t - to) ** 2).sum(1).mean()))


def fit_estimate(fit, pairing):
    """Fits the estimate by rotation and translation of its world and a constant rotation of its axes, by the scale of its path, or
    by both. Raises EvaluationError at a standstill, which determines none of them."""
    if not fit.aligns and not fit.corrects_scale:
        return
    points, to = pairing.estimate[:, :3, 3], pairing.truth[:, :3, 3]
    if min((p - p.mean(0)).std() for p in (points, to)) * np.sqrt(3) < 0.1:  # m, RMS about the centre
        raise EvaluationError("a standstill has no path to fit; leave out --align and --correct-scale")
    R, t, pairing.scale = similarity(points, to, fit.corrects_scale)
    pairing.estimate = pairing.estimate.copy()
    pairing.estimate[:, :3, 3] = pairing.scale * points @ (R.T if fit.aligns else np.eye(3)) + (t if fit.aligns else 0.0)
    if fit.aligns:
        pairing.is_aligned = True
        rotations = R @ pairing.estimate[:, :3, :3]
        axes = best_rotation((np.swapaxes(rotations, 1, 2) @ pairing.truth[:, :3, :3]).sum(0))
        pairing.estimate[:, :3, :3] = rotations @ axes
