"""Runs `cartvo evaluate` on paths whose errors are known."""
import json
import math
import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[3]
CARTVO = os.environ.get("CARTVO_PROGRAM", str(ROOT / "build/release/tools/cartvo/cartvo"))
PERIOD = 0.1  # s
sys.path.insert(0, str(pathlib.Path(__file__).parent))


def turn(yaw=0.0, pitch=0.0, roll=0.0):
    """Rz(yaw) Ry(pitch) Rx(roll)."""
    (cy, sy), (cp, sp), (cr, sr) = ((math.cos(angle), math.sin(angle)) for angle in (yaw, pitch, roll))
    return np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]]) @ np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]]) @ np.array(
        [[1, 0, 0], [0, cr, -sr], [0, sr, cr]])


def pose(position=(0, 0, 0), rotation=np.eye(3)):
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotation, position
    return matrix


def straight(count, step):
    return np.array([pose((i * step, 0, 0)) for i in range(count)])


def circle(count, radius, step):
    angles = [i * step / radius for i in range(count)]
    return np.array([pose((radius * math.sin(a), radius * (1 - math.cos(a)), 0), turn(a)) for a in angles])


def winding(count):
    """A drive on a winding road whose speed changes."""
    poses, position = [], np.zeros(3)
    for i in range(count):
        yaw = 0.5 * math.sin(0.1 * i / 7.0) + 0.3 * math.sin(0.1 * i / 3.1)
        poses.append(pose(position, turn(yaw)))
        position = position + 0.1 * (4.0 + math.sin(0.1 * i / 5.0)) * turn(yaw)[:, 0]
    return np.array(poses)


def scaled(poses, scale):
    poses = poses.copy()
    poses[:, :3, 3] *= scale
    return poses


def turned_axes(poses, rotation):
    """The same path in other axes of the sensor."""
    axes = pose(rotation=rotation)
    return axes.T @ poses @ axes


def quaternion(rotation):
    """x y z w of rotations of less than half a turn."""
    w = 0.5 * math.sqrt(max(1.0 + np.trace(rotation), 1e-12))
    skew = rotation - rotation.T
    return (*(value / (4 * w) for value in (skew[2, 1], skew[0, 2], skew[1, 0])), w)


def tum(poses, start=0.0, comment="", order=(0, 1, 2, 3), period=PERIOD):
    rows = []
    for i, matrix in enumerate(poses):
        q = quaternion(matrix[:3, :3])
        rows.append(" ".join(f"{value:.12f}" for value in (start + period * i, *matrix[:3, 3], *(q[k] for k in order))))
    return comment + "".join(row + "\n" for row in rows)


def kitti(poses):
    return "".join(" ".join(f"{value:.12e}" for value in matrix[:3].ravel()) + "\n" for matrix in poses)


class Bench:
    """A folder with files, and the command in it."""

    def __init__(self, folder):
        self.folder = folder

    def write(self, name, text):
        file = self.folder / name
        file.write_bytes(text if isinstance(text, bytes) else text.encode())
        return file

    def run(self, *arguments, **options):
        return subprocess.run([CARTVO, "evaluate", *map(str, arguments)], cwd=self.folder, capture_output=True, text=True, timeout=120, **options)

    def output(self, *arguments):
        done = self.run(*arguments)
        assert done.returncode == 0, done
        return done.stdout

    def error(self, *arguments, code=1):
        done = self.run(*arguments)
        assert done.returncode == code and done.stderr.startswith("cartvo: ") and "Traceback" not in done.stderr, done
        return done.stderr

    def json(self, *arguments):
        return json.loads(self.output(*arguments, "--json"))

    def compare(self, estimate, truth, *arguments, form=tum):
        self.write("estimate.txt", form(estimate))
        self.write("truth.txt", form(truth))
        return self.json("estimate.txt", "truth.txt", *arguments)


@pytest.fixture
def bench(tmp_path):
    return Bench(tmp_path)
