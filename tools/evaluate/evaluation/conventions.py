"""Tests other readings of poses: units, orders of quaternions, directions of poses, axes, another point of the cart."""
import numpy as np

from evaluation.segments import SHORT, aligned_axes, segment_ends, distances_along
from evaluation.motion import angles_of, inverse, quaternions_of, rotations_of

INVERT = "inverse (from the world to the camera or body): invert them"


def with_rotations(poses, rotations):
    changed = poses.copy()
    changed[:, :3, :3] = rotations
    return changed


def mirrored(poses):
    """In axes whose y points to the other side; which side is no matter once the axes are aligned."""
    mirror = np.diag([1.0, -1.0, 1.0, 1.0])
    return mirror @ poses @ mirror


# Inverse poses of one file agree with the other's as well as the reverse: both stand for "one of the files".
READINGS = (
    (lambda poses: with_rotations(poses, rotations_of(np.roll(quaternions_of(poses[:, :3, :3]), -1, axis=1))),
     "its quaternions seem to be written with w first, or the other's with w last: name the columns in a comment in front of the rows, "
     "such as '# t x y z qw qx qy qz'"),
    (inverse, f"the poses of one of the two files seem to be {INVERT}"),
    (lambda poses: with_rotations(poses, np.swapaxes(poses[:, :3, :3], 1, 2)), f"the rotations of one of the two files seem to be {INVERT}"))
MIRRORED = (
    (mirrored, "the axes of one of the two files seem to be left-handed (Unreal, CARLA, AirSim, Unity): change the signs of y, qx and qz"),
    (lambda poses: with_rotations(mirrored(poses), poses[:, :3, :3]),
     "the positions of one of the two files seem to be mirrored (left-handed axes, or two columns exchanged): change the sign of y"))

UNITS = {1000.0: "millimetres", 100.0: "centimetres", 1 / 0.3048: "feet", 0.001: "kilometres"}  # by their number in a metre
LEAST_SCALE, LEAST_PATH = 1.1, 1.0  # of a wrong unit or baseline; m
LEAST_MIRRORED = 0.03  # disagreement; less of it is that of a path in a plane, which a turn by 180 deg explains as well
LEAST_ARM, MOST_ARM = 0.1, 10.0  # m, of two points of a cart


def are_degrees(positions, length):
    """Whether the first two columns are latitude and longitude: far from 0 and hardly changing on a path of some length (m)."""
    changes, sizes = np.ptp(positions[:, :2], axis=0), abs(positions[0, :2])
    return length > LEAST_PATH and changes.max() < 1e-4 * length and (sizes > 1e3 * changes).all() and sizes.max() <= 180


def disagreement(axes):
    """Of short segments once the axes are aligned: translation and, 5 m away, rotation. Of readings that differ by turned axes, those
    with less of a turn agree better."""
    errors = axes.short.all
    return errors.translation + 5.0 * errors.rotation + 1e-3 * np.linalg.norm(axes.rotation)


def scale_problem(pairing):
    """Whether a known unit explains it, and a text that says that the two paths differ by a constant scale. The scale is taken of the
    larger displacements over a hundredth of the poses, so that neither the noise of a standing truth nor a lost part counts."""
    ends = max(len(pairing.times) // 100, 1)
    estimated, true = (np.linalg.norm(poses[ends:, :3, 3] - poses[:-ends, :3, 3], axis=1) for poses in (pairing.estimate, pairing.truth))
    if are_degrees(pairing.truth[:, :3, 3], np.ptp(pairing.estimate[:, :3, 3], axis=0).max()):
        return True, "the truth's positions are degrees of latitude and longitude: write metres east and north (ENU, UTM)"
    moving = (estimated > 0.5 * estimated.max(initial=0.0)) & (true > 0.0)
    if pairing.scale != 1.0 or not moving.any() or max(estimated.sum(), true.sum()) < LEAST_PATH * ends:
        return False, ""
    low, ratio, high = np.quantile(true[moving] / estimated[moving], (0.25, 0.5, 0.75))
    if max(ratio, 1 / ratio) < LEAST_SCALE or high > 1.2 * low:
        return False, ""
    for count, unit in UNITS.items():
        if abs(ratio / count - 1.0) < 0.1:
            return True, f"the truth's path is {ratio:.4g} times as long as the estimate's: its positions seem to be in {unit}, write metres"
    return False, (f"the truth's path is {ratio:.3f} times as long as the estimate's everywhere: the baseline in the rig or the size of the board's "
                   "squares is wrong by this, or a file is not in metres; compare with --correct-scale")


def rotation_problem(pairing):
    """Says that one file has positions only: its rotations are all the same, although the other one's turn."""
    turned = [np.degrees(angles_of(inverse(poses[:1])[:, :3, :3] @ poses[:, :3, :3])).max() for poses in (pairing.estimate, pairing.truth)]
    if min(turned) > 1e-3 or max(turned) < 2.0:
        return ""
    return (f"{'the truth' if turned[1] < turned[0] else 'the estimate'} has positions only, its rotations are all the same: segments and "
            "drift mean nothing, only 'position, aligned (ATE)' does")


def least_squares(columns, values):
    """The unknowns, and the RMS of what they leave. Those that are not determined are 0."""
    matrix = columns.reshape(-1, columns.shape[-1])
    sizes = np.maximum(np.linalg.norm(matrix, axis=0), 1e-12)
    unknowns = np.linalg.lstsq(matrix / sizes, values.ravel(), rcond=0.02)[0] / sizes
    return unknowns, float(np.sqrt(np.mean((matrix @ unknowns - values.ravel())**2)))


def arm_problem(evaluation):
    """Says that the truth is of another point of the cart, if a constant distance of the two explains most of what neither turned axes
    nor a scale do. The distance along an axis about which the path does not turn is unknown and counts as 0."""
    estimate, truth, parts = evaluation.pairing.estimate, evaluation.pairing.truth, []
    for length in SHORT:
        first, last = segment_ends(distances_along(truth), length, 1)
        of_estimate, of_truth = (inverse(poses[first]) @ poses[last] for poses in (estimate, truth))
        moved = of_estimate[:, :3, 3:]
        turned = np.cross(moved.swapaxes(1, 2), np.eye(3)).swapaxes(1, 2)  # by a small rotation of the axes, but for the sign
        parts.append(np.concatenate([moved, turned, of_truth[:, :3, :3] - np.eye(3), of_truth[:, :3, 3:] - moved], 2) / length)
    columns = np.concatenate(parts)
    if len(columns) < 2:
        return ""
    apart, without = columns[:, :, 7], least_squares(columns[:, :, :4], columns[:, :, 7])[1]
    unknowns, left = least_squares(columns[:, :, :7], apart)
    x, y, z = np.round(unknowns[4:], 1) + 0.0
    if left > 0.5 * without or without < 0.002 or not LEAST_ARM <= max(abs(x), abs(y), abs(z)) < MOST_ARM:
        return ""
    return (f"the truth seems to be of another point of the cart, ({x:.1f}, {y:.1f}, {z:.1f}) m from the estimate's in the axes of these files "
            "(x y z), such as an antenna of GNSS: write the truth of the point that the estimate is of, or state T_body_camera in the rig")


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
    pairing = evaluation.pairing
    is_unit, scale = scale_problem(pairing)
    if problem := scale if is_unit else rotation_problem(pairing):
        return problem
    if evaluation.axes is None:
        return ""
    present = disagreement(evaluation.axes)
    if present < 0.003:
        return axes_problem(evaluation)
    best, problem = present / 3.0, ""
    for read, text in READINGS if present < LEAST_MIRRORED else READINGS + MIRRORED:
        for name in ("the estimate", "the truth"):
            estimate, truth = evaluation.pairing.estimate, evaluation.pairing.truth
            axes = aligned_axes(read(estimate), truth) if name == "the estimate" else aligned_axes(estimate, read(truth))
            if axes and disagreement(axes) < best - 1e-6:
                best, problem = disagreement(axes), f"{name} is read in another convention: {text}"
    is_turned = np.linalg.norm(evaluation.axes.rotation) > np.radians(45.0)
    return problem or scale or (not is_turned and arm_problem(evaluation)) or axes_problem(evaluation)
