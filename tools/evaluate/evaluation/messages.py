"""Reads the messages of a replay from odometry.csv."""
import dataclasses
import io
import os

import numpy as np

from evaluation.motion import poses_of, rotations_of
from evaluation.program import EvaluationError, excerpt, read_text
from evaluation.trajectory import MOST_METRES, Trajectory, integer

EXPECTED = "expected the odometry.csv that 'cartvo replay' writes"
FIRST_COLUMNS = b"pair,utime_us,"
LATEST_US = 4_500_000_000_000_000  # differences of instants in ns fit into int64
TRIANGLE = 21  # values of a symmetric 6x6 matrix
INTEGERS = ("utime_us", "valid", "reasons", "reset_counter")
# The first of columns that belong together, and how many they are. Those of a pose are never empty.
COLUMNS = {"x_m": 3, "qw": 4, "vx_m_s": 3, "wx_rad_s": 3, "pose_covariance_x_x": TRIANGLE, "twist_covariance_vx_vx": TRIANGLE,
           "velocity_bound_x": 3, "angular_rate_bound_x": 3, "motion_bound_x": 3, "rotation_bound_x": 3}
POSE = 7  # values of a pose, the first ones


@dataclasses.dataclass
class Messages:
    """The messages of a drive as cartvod publishes them, see odometry_t; SI units, body axes. NaN: the message has no value."""
    times: np.ndarray  # (n,) int64 ns, exposure of the left image, to 1 us
    valid: np.ndarray  # (n,) bool
    reasons: np.ndarray  # (n,) bits of odometry_t
    resets: np.ndarray  # (n,) number of the epoch
    poses: np.ndarray  # (n, 4, 4) T_world_body in the epoch's world
    twists: np.ndarray  # (n, 6) velocity (m/s) and rates (rad/s)
    pose_covariances: np.ndarray  # (n, 6, 6)
    twist_covariances: np.ndarray  # (n, 6, 6)
    bounds: np.ndarray  # (n, 4, 3) of velocity, angular rate, motion and rotation of the last second

    def with_estimate(self):
        """Whether the pose is an estimate: of a VALID message, or of one that is too uncertain to be VALID."""
        return self.valid | np.isfinite(self.bounds[:, 0]).all(1)


def is_messages_file(file):
    """Whether a file begins as an odometry.csv does."""
    try:
        with open(file, "rb") if os.path.isfile(file) else io.BytesIO() as stream:
            return stream.read(len(FIRST_COLUMNS)) == FIRST_COLUMNS
    except OSError:
        return False


class Reader:
    def __init__(self, file):
        self.file, self.line = file, 1

    def fail(self, expected):
        raise EvaluationError(f"{self.file}:{self.line}: {expected}")

    def read_header(self, names):
        def column(name, length):
            if name not in names[:len(names) - length + 1]:
                self.fail(f"has no column '{name}'; {EXPECTED}")
            return names.index(name)
        self.count = len(names)
        self.integers = [column(name, 1) for name in INTEGERS]
        self.columns = [first + i for first, length in ((column(name, length), length) for name, length in COLUMNS.items())
                        for i in range(length)]

    def number(self, word, column, read):
        try:
            value = read(word) if word.isascii() and "_" not in word else None
        except ValueError:
            value = None
        if value is None:
            self.fail(f"expected a number in column {column + 1}, found '{excerpt(word)}'")
        return value

    def read_row(self, words):
        if len(words) != self.count:
            self.fail(f"expected {self.count} columns, found {len(words)}")
        integers = [self.number(words[column], column, integer) for column in self.integers]
        if abs(integers[0]) > LATEST_US:
            self.fail("expected utime_us in us since 1970")
        values = [self.number(words[column], column, float) if words[column] or i < POSE else np.nan
                  for i, column in enumerate(self.columns)]
        norm = np.linalg.norm(values[3:POSE])
        if not (abs(norm - 1.0) <= 1e-2 and max(map(abs, values[:3])) <= MOST_METRES):
            self.fail("expected a position of at most 1e9 m and a unit quaternion (qw qx qy qz)")
        values[3:POSE] /= norm
        return integers, values


def symmetric(triangles):
    matrices = np.empty((len(triangles), 6, 6))
    upper = np.triu_indices(6)
    matrices[:, upper[0], upper[1]] = matrices[:, upper[1], upper[0]] = triangles
    return matrices


def read_messages(file):
    """The columns may be in any order. Raises EvaluationError naming file, line and what was expected."""
    reader = Reader(file)
    lines = read_text(file).split("\n")
    if lines != [""]:
        reader.read_header(lines[0].rstrip("\r").split(","))
    rows = []
    for reader.line, line in enumerate(lines[1:], 2):
        if line:
            rows.append(reader.read_row(line.rstrip("\r").split(",")))
    if not rows:
        raise EvaluationError(f"{file}: has no rows; {EXPECTED}")
    integers = np.array([row[0] for row in rows], np.int64)
    values = np.array([row[1] for row in rows])
    times = 1000 * integers[:, 0]
    if (np.diff(times) < 0).any():
        raise EvaluationError(f"{file}: its times decrease: the camera's clock was set back, which cannot be evaluated")
    position, quaternion, twist, pose_covariance, twist_covariance, bounds = np.split(values, np.cumsum([3, 4, 6, 21, 21]), 1)
    return Messages(times, integers[:, 1] != 0, integers[:, 2], integers[:, 3], poses_of(rotations_of(quaternion), position), twist,
                    symmetric(pose_covariance), symmetric(twist_covariance), bounds.reshape(-1, 4, 3))


def body_trajectory(messages):
    """Poses of the body at each message, relative to the first one's. After a loss of tracking the new epoch continues from the
    last known pose, which messages without an estimate repeat. Omits messages that are not later than the one before."""
    times, poses, epoch = [], [], None
    T_first_epoch = T_first_body = np.eye(4)
    for time, has_estimate, reset, pose in zip(messages.times, messages.with_estimate(), messages.resets, messages.poses):
        if has_estimate and reset != epoch:
            epoch, T_first_epoch = reset, T_first_body
        if has_estimate:
            T_first_body = T_first_epoch @ pose
        if not times or time > times[-1]:
            times.append(time)
            poses.append(T_first_body)
    return Trajectory(np.array(times), np.array(poses))
