"""Tests other readings of poses: orders of quaternions, directions of poses, axes."""
import numpy as np

from evaluation.segments import aligned_axes
from evaluation.motion import inverse, quaternions_of, rotations_of

INVERT = "inverse (from the world to the camera or body): invert them"


def with_rotations(poses, rotations):
    changed = poses.copy()
    changed[:, :3, :3] = rotations
    return changed


# Inverse poses of one file agree with the other's as well as the reverse: both stand for "one of the files".
READINGS = (
    (lambda poses: with_rotations(poses, rotations_of(np.roll(quaternions_of(poses[:, :3, :3]), -1, axis=1))),
     "its quaternions seem to be written with w first, or the other's with w last: name the columns in a comment in front of the rows, "
     "such as '# t x y z qw qx qy qz'"),
    (inverse, f"the poses of one of the two files seem to be {INVERT}"),
    (lambda poses: with_rotations(poses, np.swapaxes(poses[:, :3, :3], 1, 2)), f"the rotations of one of the two files seem to be {INVERT}"))


def disagreement(axes):
    """Of short segments once the axes are aligned: translation and, 5 m away, rotation. Of readings that differ by turned axes, those
    with less of a turn agree better."""
    errors = axes.short.all
    return errors.translation + 5.0 * errors.rotation + 1e-3 * np.linalg.norm(axes.rotation)


def axes_problem(evaluation):
    """The rotation of the axes if it is larger than an error of a mounting and explains the disagreement."""
    rotation = np.degrees(evaluation.axes.rotation)
    turned = np.linalg.norm(rotation)
    if turned <= 2.0 or evaluation.axes.short.all.translation > 0.7 * evaluation.short.all.translation:
        return ""
    x, y, z = rotation / turned
    remedy = ("is one of the left camera (poses.txt of a replay, KITTI) and the other of the cart's body (trajectory.tum), or in axes "
              "forward, right, down (NED)? Compare files of the same frame" if turned > 45.0 else
              "the mount of a sensor is unknown or wrong: state T_body_camera in the rig ('cartvo calibrate mount')")
    return (f"the axes of the two files differ by {turned:.1f} deg: the estimate's are turned about ({x:.2f}, {y:.2f}, {z:.2f}); {remedy}; or "
            "compare with --align")


def convention_problem(evaluation):
    """Says that a file's poses are of another convention than they were read in, or that the axes of the two files are turned, if short
    segments then agree much better; empty otherwise."""
    if evaluation.axes is None:
        return ""
    present = disagreement(evaluation.axes)
    if present < 0.003:
        return axes_problem(evaluation)
    best, problem = present / 3.0, ""
    for read, text in READINGS:
        for name in ("the estimate", "the truth"):
            estimate, truth = evaluation.pairing.estimate, evaluation.pairing.truth
            axes = aligned_axes(read(estimate), truth) if name == "the estimate" else aligned_axes(estimate, read(truth))
            if axes and disagreement(axes) < best - 1e-6:
                best, problem = disagreement(axes), f"{name} is read in another convention: {text}"
    return problem or axes_problem(evaluation)
