"""Reads trajectories in the formats of TUM, KITTI and EuRoC."""
import dataclasses
import math
import re

import numpy as np

from evaluation.motion import poses_of, quaternions_of, rotations_of
from evaluation.program import EvaluationError, excerpt, read_text

TUM, KITTI, EUROC = 8, 12, 17  # numbers of a row; EuRoC's also has 8, without velocity and biases
CAMERA, UNMOUNTED, BODY = "the left camera", "the left camera, mount unknown", "the cart's body"
AXES = {CAMERA: "x right, y down, z forward", UNMOUNTED: "x forward, y left, z up", BODY: "x forward, y left, z up"}
MOST_SECONDS, MOST_METRES = 4.5e9, 1e9  # differences of instants fit into int64; nine decimals of a coordinate are written
INSTANT = re.compile(r"(\d+)(?:\.(\d*))?", re.ASCII)


@dataclasses.dataclass
class Trajectory:
    """Poses of one frame in one world, in the order of time."""
    times: np.ndarray  # (n,) int64, ns; of KITTI the row's index
    poses: np.ndarray  # (n, 4, 4), m
    is_kitti: bool = False
    frame: str | None = None  # a key of AXES, or None: unknown


def number(word):
    """A finite number, else None; float() would also take 1_000."""
    try:
        value = float(word) if word.isascii() and "_" not in word else math.nan
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def integer(word):
    """An int64, else None."""
    value = int(word) if re.fullmatch(r"-?\d{1,19}", word, re.ASCII) else None
    return value if value is not None and abs(value) < 2**63 else None


class Row:
    """The words of a line and its place."""

    def __init__(self, file, line, words):
        self.file, self.line, self.words = file, line, words

    def fail(self, expected):
        raise EvaluationError(f"{self.file}:{self.line}: {expected}")

    def numbers(self, first=0):
        values = [number(word) for word in self.words[first:]]
        if None in values:
            index = first + values.index(None)
            self.fail(f"expected a number in column {index + 1}, found '{excerpt(self.words[index])}'")
        return values

    def check_metres(self, values, columns):
        for value, column in zip(values, columns):
            if abs(value) > MOST_METRES:
                self.fail(f"expected metres in column {column}, at most 1e9")

    def seconds(self):
        """Decimal seconds as ns, exactly: a double resolves times since 1970 only to 0.2 us."""
        word, seconds = self.words[0], self.numbers()[0]
        if abs(seconds) > MOST_SECONDS:
            self.fail(f"expected an instant in seconds, found '{excerpt(word)}': in milliseconds, microseconds or nanoseconds? "
                      "(nanoseconds are read in EuRoC's files, which separate columns by commas)")
        plain = INSTANT.fullmatch(word)
        if not plain:
            return round(1e9 * seconds)
        return int(plain[1]) * 10**9 + int((plain[2] or "").ljust(9, "0")[:9])

    def nanoseconds(self):
        value = integer(self.words[0])
        if value is None or abs(value) > 1e9 * MOST_SECONDS:
            self.fail(f"expected an instant in nanoseconds, found '{excerpt(self.words[0])}'")
        return value

    def stamped_pose(self, is_w_first):
        """Position and quaternion (w, x, y, z) in the columns from the second on."""
        numbers = self.numbers(1)[:7]
        self.check_metres(numbers[:3], (2, 3, 4))
        x, y, z, w = numbers[3:] if not is_w_first else (*numbers[4:], numbers[3])
        norm = math.sqrt(w * w + x * x + y * y + z * z) if max(map(abs, numbers[3:])) < 10 else math.inf
        if not abs(norm - 1.0) <= 1e-2:
            self.fail(f"expected a unit quaternion ({'qw qx qy qz' if is_w_first else 'qx qy qz qw'}) in columns 5 to 8")
        return (*numbers[:3], w / norm, x / norm, y / norm, z / norm)

    def matrix(self):
        numbers = self.numbers()
        self.check_metres(numbers[3::4], (4, 8, 12))
        matrix = np.reshape(numbers, (3, 4))
        R = np.clip(matrix[:, :3], -10, 10)
        if np.abs(R @ R.T - np.eye(3)).max() > 1e-3 or np.linalg.det(R) < 0:
            self.fail("expected the rows of a 3x4 pose; its left 3x3 part is not a rotation")
        return matrix


def names_w_first(comment):
    """Whether a comment or header names a quaternion's columns with w before x, such as "# t px py pz qw qx qy qz"."""
    comment = comment.lower()
    for w, x in (("qw", "qx"), ("q_w", "q_x"), ("q_rs_w", "q_rs_x"), ("orientation.w", "orientation.x")):
        if w in comment and x in comment:
            return comment.index(w) < comment.index(x)
    return False


def comment_start(line, is_in_front):
    """At '#', or 0 if the line begins with '%' or '//', or is a header of names in front of the rows."""
    content = line.lstrip(' \t"')
    word = re.split(r"[ \t,;]", content, maxsplit=1)[0].lower()
    is_header = is_in_front and "a" <= word[:1] <= "z" and word not in ("nan", "inf")
    if is_header or content.startswith(("%", "//")):
        return 0
    found = line.find("#")
    return len(line) if found < 0 else found


# The usual meaning of rows with as many numbers, and what to do; as tools/trajectory/trajectory.cpp.
HINTS = {
    1: ": messages as text, as of 'ros2 topic echo'? Save them as TUM's rows, as by 'evo_traj --save_as_tum'",
    4: ": positions only, or latitude and longitude? Poses in metres with rotations are needed",
    7: ": Euler angles? Write quaternions, or is the instant missing?",
    16: ": a 4x4 matrix? Leave out its last row; decimal commas? Write points",
}


def format_of(row, has_commas):
    count, instant = len(row.words), integer(row.words[0])
    if count == EUROC or count == TUM and has_commas and instant is not None and instant >= 10**14:
        return EUROC
    if count in (TUM, KITTI):
        return count
    return row.fail("expected 8 numbers (TUM: seconds x y z qx qy qz qw), 12 (KITTI: a 3x4 matrix), or 8 or 17 after commas "
                    f"(EuRoC: ns x y z qw qx qy qz ...), found {count}{HINTS.get(count, '')}")


def rows_of(file, text):
    """The rows, their format, and whether comments say that quaternions have w first. Blanks, commas or semicolons separate
    the columns; with semicolons, commas are decimal points."""
    rows, row_format, is_w_first = [], TUM, False
    for line_number, line in enumerate(text.split("\n"), 1):
        start = comment_start(line, not rows)
        is_w_first = is_w_first or names_w_first(line[start:])
        line = line[:start]
        separator = ","
        if ";" in line:
            line, separator = line.replace(",", "."), ";"
        words = line.replace(separator, " ").split()
        if not words:
            continue
        row = Row(file, line_number, words)
        if not rows:
            row_format = format_of(row, separator in line)
        elif len(words) != len(rows[0].words):
            row.fail(f"expected {len(rows[0].words)} numbers as in the rows before, found {len(words)}")
        rows.append(row)
    if not rows:
        raise EvaluationError(f"{file}: contains no poses")
    return rows, row_format, is_w_first


def frame_of(text, row_format):
    """The frame that the first line states. KITTI's rows are of the left camera, unless a first line states another one."""
    for frame, axes in AXES.items():
        if text.startswith(f"# poses of {frame} ({axes})"):
            return frame
    return CAMERA if row_format == KITTI else None


def read_trajectory(file):
    """Raises EvaluationError naming file, line and what was expected."""
    text = read_text(file)
    rows, row_format, is_w_first = rows_of(file, text)
    if row_format == KITTI:
        matrices = np.array([row.matrix() for row in rows])
        times = np.arange(len(rows))
        poses = poses_of(rotations_of(quaternions_of(matrices[:, :, :3])), matrices[:, :, 3])
    else:
        times = [row.nanoseconds() if row_format == EUROC else row.seconds() for row in rows]
        values = np.array([row.stamped_pose(is_w_first or row_format == EUROC) for row in rows])
        for before, after, row in zip(times, times[1:], rows[1:]):
            if after <= before:
                row.fail("expected instants that increase from row to row")
        poses = poses_of(rotations_of(values[:, 3:]), values[:, :3])
    return Trajectory(np.array(times, np.int64), poses, row_format == KITTI, frame_of(text, row_format))
