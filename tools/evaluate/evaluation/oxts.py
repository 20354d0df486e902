"""Reads the truth of KITTI's raw recordings."""
import calendar
import math
import os
import pathlib
import re

import numpy as np

from evaluation.motion import inverse, poses_of, quaternions_of, rotations_by, rotations_of
from evaluation.program import EvaluationError, excerpt, read_text
from evaluation.trajectory import CAMERA, Trajectory, number

INSTANT = re.compile(r"(\d{4})-(\d\d)-(\d\d) (\d\d):(\d\d):(\d\d)(?:\.(\d+))?", re.ASCII)  # UTC
LARGEST = (89.0, 360.0, 1e5, 10.0, 10.0, 10.0)  # latitude, longitude (deg), altitude (m), roll, pitch, yaw (rad)
EARTH_RADIUS, MOST_DISTANCE = 6378137.0, 100.0  # m; the latter between two sensors of one vehicle


def read_instants(file):
    """ns since 1970."""
    instants = []
    for line_number, line in enumerate(read_text(file).split("\n"), 1):
        if not line.strip():
            continue
        parts = INSTANT.fullmatch(line.strip())
        if not parts or not 1 <= int(parts[2]) <= 12:
            raise EvaluationError(f"{file}:{line_number}: expected a date and a time such as 2011-09-26 13:02:25.594360375 instead of "
                                  f"'{excerpt(line.strip())}'")
        instants.append(10**9 * calendar.timegm(tuple(map(int, parts.groups()[:6]))) + int((parts[7] or "").ljust(9, "0")[:9]))
        if len(instants) > 1 and instants[-1] <= instants[-2]:
            raise EvaluationError(f"{file}:{line_number}: expected instants that increase from line to line")
    return instants


def calibration(recording, name):
    """The file's rows of numbers by their name: (place, words). It is in the recording or in the folder above it."""
    for folder in (recording, recording.parent):
        if (folder / name).exists():
            lines = enumerate(read_text(folder / name).split("\n"), 1)
            return {line.partition(":")[0]: (f"{folder / name}:{i}: {line.partition(':')[0]}: ", line.partition(":")[2].split()) for i, line in lines}
    raise EvaluationError(f"{recording}: {name} is neither in it nor in the folder above it; it is part of KITTI's calibration of that day, and is "
                          "needed to compare its GPS and inertial unit with the camera")


def matrix_of(rows, key, count, name):
    place, words = rows.get(key, (f"{name}: {key}: ", []))
    values = [number(word) for word in words]
    if len(values) != count or None in values:
        raise EvaluationError(f"{place}expected {count} numbers")
    R = np.reshape(values, (-1, 3))
    if count == 9 and (np.abs(R) > 2).any() or count == 9 and (np.abs(R @ R.T - np.eye(3)).max() > 1e-3 or np.linalg.det(R) < 0):
        raise EvaluationError(f"{place}expected the rows of a rotation")
    if count == 3 and not math.hypot(*values) <= MOST_DISTANCE:
        raise EvaluationError(f"{place}expected a translation in metres, at most 100 m")
    return rotations_of(quaternions_of(R)) if count == 9 else R[0]


def camera_from_unit(recording):
    rectified = matrix_of(calibration(recording, "calib_cam_to_cam.txt"), "R_rect_00", 9, "calib_cam_to_cam.txt")
    T = poses_of(rectified, np.zeros(3))
    for name in ("calib_velo_to_cam.txt", "calib_imu_to_velo.txt"):
        rows = calibration(recording, name)
        T = T @ poses_of(matrix_of(rows, "R", 9, name), matrix_of(rows, "T", 3, name))
    return T


def read_packet(file):
    values = [number(word) for word in read_text(file).split()]
    if len(values) < len(LARGEST) or None in values or any(abs(value) > largest for value, largest in zip(values, LARGEST)):
        raise EvaluationError(f"{file}: expected the 30 numbers of KITTI's oxts: latitude, longitude, altitude, roll, pitch, yaw and others")
    return values[:len(LARGEST)]


def read_oxts(folder):
    """The poses that the GPS and inertial unit of a raw recording measured, as those of the rectified camera 0 (left, grey) in the world of the
    unit's first pose, in Mercator's projection as in KITTI's development kit. `folder`: the recording or its subfolder oxts, with
    timestamps.txt and data/NUMBER.txt; the calibration lies in the recording or in the folder above it."""
    whole = pathlib.Path(os.path.abspath(folder))
    recording = whole if (whole / "oxts").is_dir() else whole.parent
    oxts = recording / "oxts"
    files = sorted((oxts / "data").glob("*.txt"))
    if not files:
        raise EvaluationError(f"{folder}: contains no truth; expected a raw recording of KITTI with oxts/timestamps.txt and "
                              "oxts/data/0000000000.txt, or a file with poses")
    instants = read_instants(oxts / "timestamps.txt")
    if len(instants) != len(files):
        raise EvaluationError(f"{oxts / 'timestamps.txt'}: has {len(instants)} instants for {len(files)} files in {oxts / 'data'}")
    T_unit_camera = inverse(camera_from_unit(recording))
    latitude, longitude, altitude, roll, pitch, yaw = np.array([read_packet(file) for file in files]).T
    radius = EARTH_RADIUS * math.cos(math.radians(latitude[0]))  # the scale of the projection
    north = radius * np.log(np.tan(np.radians(90.0 + latitude) / 2))
    turns = [rotations_by(angles[:, None] * np.eye(3)[axis]) for axis, angles in enumerate((roll, pitch, yaw))]
    unit = poses_of(turns[2] @ turns[1] @ turns[0], np.column_stack([radius * np.radians(longitude), north, altitude]))
    return Trajectory(np.array(instants, np.int64), inverse(unit[0]) @ unit @ T_unit_camera, False, CAMERA)
