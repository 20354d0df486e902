"""Segments of a path: their errors, and the rotation of the axes that makes them small."""
import typing

import numpy as np

from evaluation.motion import angles_of, best_rotation, inverse, poses_of, rotations_by, vectors_of

# KITTI's segments (A. Geiger et al., "Are we ready for autonomous driving?", 2012, and its devkit), and shorter ones for sequences
# that are too short for them, m.
LONG, SHORT = (100, 200, 300, 400, 500, 600, 700, 800), (5, 10, 20, 40)
LEAST_SPREAD = 0.01  # of displacements across the path: the squared sine of six degrees


class SegmentErrors(typing.NamedTuple):
    """Mean errors of the motion between two poses whose true distance along the path is a length, divided by it."""
    length: float  # m; 0: all lengths together
    count: int
    translation: float  # fraction of the length
    rotation: float  # rad/m


class Segments(typing.NamedTuple):
    all: SegmentErrors  # mean over all segments of all lengths, as in the devkit
    each: list  # SegmentErrors; lengths without a segment are omitted


class AlignedAxes(typing.NamedTuple):
    """Errors after rotation of the estimate's axes into the truth's."""
    rotation: np.ndarray  # (3,) rotation vector, rad
    short: Segments


def distances_along(poses):
    """(n,) distance along the path from its start to each pose, m."""
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(poses[:, :3, 3], axis=0), axis=1))])


def segment_ends(distances, length, step):
    """First and last poses of segments that start at each step-th pose and end at the first pose farther along the path than the
    length, as in KITTI's devkit."""
    first = np.arange(0, len(distances), step)
    last = np.searchsorted(distances, distances[first] + length, "right")
    return first[last < len(distances)], last[last < len(distances)]


def motion_errors(estimate, truth, first, last):
    """(n, 4, 4) from the estimated to the true motions between poses."""
    return inverse(inverse(estimate[first]) @ estimate[last]) @ (inverse(truth[first]) @ truth[last])


def mean_errors(length, errors):
    """Of errors (n, 2) that are divided by their lengths."""
    return SegmentErrors(length, len(errors), *(map(float, errors.mean(0)) if len(errors) else (0.0, 0.0)))


def segment_errors(estimate, truth, lengths, step):
    distances, parts = distances_along(truth), []
    for length in lengths:
        errors = motion_errors(estimate, truth, *segment_ends(distances, length, step))
        parts.append(np.column_stack([np.linalg.norm(errors[:, :3, 3], axis=1), angles_of(errors[:, :3, :3])]) / length)
    each = [mean_errors(float(length), part) for length, part in zip(lengths, parts) if len(part)]
    return Segments(mean_errors(0.0, np.concatenate(parts)), each)


def axes_rotation(estimate, truth):
    """The constant rotation from the estimate's axes to the truth's for which the translations over short segments agree best, as a
    rotation vector. A truth measured by other sensors depends on the calibration of their mounting: an error of that angle displaces
    the end of each motion by the angle times its length, which no odometry can observe. The rotation about a path that is straight
    within about six degrees is not observable and zero. None if the path is too short for a segment."""
    distances, displacements = distances_along(truth), []
    for length in SHORT:
        first, last = segment_ends(distances, length, 1)
        displacements.append([(inverse(poses[first]) @ poses[last])[:, :3, 3] / length for poses in (estimate, truth)])
    of_estimate, of_truth = (np.concatenate(parts) for parts in zip(*displacements))
    if not len(of_estimate):
        return None
    spread = np.linalg.eigvalsh(of_estimate.T @ of_estimate / len(of_estimate))
    if spread[2] <= 1e-9:  # a standstill
        return np.zeros(3)
    products = of_truth.T @ of_estimate
    u, sizes, vt = np.linalg.svd(products)
    if spread[0] + spread[1] >= LEAST_SPREAD * spread.sum() and sizes[1] > 1e-9 * sizes[0]:
        return vectors_of(best_rotation(products))
    # Of a straight path, also one forth and back, only its direction is known.
    axis = np.cross(vt[0], u[:, 0])
    sine = np.linalg.norm(axis)
    return axis * (np.arctan2(sine, vt[0] @ u[:, 0]) / sine if sine > 1e-12 else 1.0)


def aligned_axes(estimate, truth):
    rotation = axes_rotation(estimate, truth)
    if rotation is None:
        return None
    turn = poses_of(rotations_by(rotation), np.zeros(3))
    turned = turn @ inverse(estimate[0]) @ estimate @ inverse(turn)
    return AlignedAxes(rotation, segment_errors(turned, truth, SHORT, 1))
