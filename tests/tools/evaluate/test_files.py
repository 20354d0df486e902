"""Formats of trajectories, their frames, and what is refused."""
import os

import numpy as np
import pytest
from conftest import kitti, straight, tum

HALF_TURNS = "0.8 0 0.6 0"  # w x y z


@pytest.mark.parametrize("text", [
    "1.5 1 2 3 0 0.6 0 0.8\n2.5 2 2 3 0 0.6 0 0.8", "1.5,1,2,3,0,0.6,0,0.8\n2.5, 2, 2, 3, 0, 0.6, 0, 0.8\n",
    b"\xef\xbb\xbf1.5 1 2 3 0 0.6 0 0.8\r\n25e-1 2 2 3 0 0.6 0 0.8 # here\r\n", "1.5 1 2 3 0 0.6 0 0.8\n2.5 2 2 3 0 0.6 0 0.8\n".encode("utf-16"),
    "# time px py pz qw qx qy qz\n1.5 1 2 3 0.8 0 0.6 0\n2.5 2 2 3 0.8 0 0.6 0\n",
    "timestamp tx ty tz qx qy qz qw\n1.5 1 2 3 0 .6 0 .8\n2.5 2 2 3 0 .6 0 .8",
    '"time","x","y","z","qw","qx","qy","qz"\n1.5,1,2,3,0.8,0,0.6,0\n2.5,2,2,3,0.8,0,0.6,0\n',
    "% t x y z qx qy qz qw\n// of a tool\n\n1.5 1 2 3 0 0.6 0 0.8\n2.500000000123 2 2 3 0 0.6 0 0.8\n",
    "Zeit;x;y;z;qx;qy;qz;qw\n1,5;1;2,0;3;0;0,6;0;0,8\n2,5;2;2;3;0;0,6;0;0,8"])
def test_tum_is_read_with_any_separators_and_comments(bench, text):
    bench.write("a.tum", text)
    bench.write("b.tum", "1.5 0 0 0 0 0 0 1\n2.5 0.28 0 0.96 0 0 0 1\n")  # the same motion: 0.28 and 0.96 in the turned axes
    result = bench.json("a.tum", "b.tum")
    assert (result["association"], result["poses"]) == ("time", 2) and result["final_drift_m"] < 1e-12 and result["path_length_m"] == pytest.approx(1)


@pytest.mark.parametrize("rest", ["", ",1,2,3,4,5,6,7,8,9"])
def test_eurocs_ground_truth_is_read_to_the_nanosecond(bench, rest):
    rows = [f"{1403636579763555584 + 50_000_000 * i},{i},2,3,{HALF_TURNS.replace(' ', ',')}{rest}\r\n" for i in range(3)]
    bench.write("data.csv", "#timestamp, p_RS_R_x [m], ..., q_RS_w [], q_RS_x []\n" + "".join(rows))
    bench.write("a.tum", "".join(f"1403636579.{763555584 + 50_000_000 * i} {i} 2 3 0 0.6 0 0.8\n" for i in range(3)))
    result = bench.json("a.tum", "data.csv")
    assert result["poses"] == 3 and result["final_drift_m"] == 0


def test_times_are_compared_if_both_files_have_them(bench):
    for name, text in (("a.tum", tum(straight(40, 1.0))), ("a.txt", kitti(straight(40, 1.0))), ("b.txt", kitti(straight(41, 1.0)))):
        bench.write(name, text)
    assert bench.json("a.tum", "a.txt")["association"] == "rows"
    assert "the estimate has 40 poses, the truth 41; KITTI rows have no times" in bench.error("a.txt", "b.txt")
    assert "rows of KITTI have no instants to which --offset could add" in bench.error("a.txt", "a.txt", "--offset", "-1e1")


def test_files_of_different_frames_are_refused(bench):
    frames = {"body": "the cart's body (x forward, y left, z up)", "camera": "the left camera (x right, y down, z forward)",
              "unmounted": "the left camera, mount unknown (x forward, y left, z up)"}
    for name, frame in frames.items():
        bench.write(name, tum(straight(50, 1.0), comment=f"# poses of {frame}: seconds x y z qx qy qz qw\n"))
    bench.write("poses.txt", kitti(straight(50, 1.0)))
    error = bench.error("body", "poses.txt")
    assert "body has poses of the cart's body, poses.txt of the left camera" in error and "compare files of the same frame" in error
    assert bench.json("camera", "poses.txt")["problem"] == "" and bench.json("body", "poses.txt", "--align")["poses"] == 50
    assert "the left camera, mount unknown" in bench.json("unmounted", "body")["problem"]
    assert bench.json("unmounted", "body", "--align")["problem"] == ""


ROW = "0 0 0 0 0 0 0 1\n"
OTHER = (":1: expected 8 numbers (TUM: seconds x y z qx qy qz qw), 12 (KITTI: a 3x4 matrix), or 8 or 17 after commas "
         "(EuRoC: ns x y z qw qx qy qz ...), ")
BAD = {
    "0,5 " * 7 + "0,5\n": OTHER + "found 16: a 4x4 matrix? Leave out its last row; decimal commas?",
    "0 1 2 3\n": OTHER + "found 4: positions only",
    "0 1 2\n": ":1: expected 8 numbers (TUM: seconds x y z qx qy qz qw), 12 (KITTI: a 3x4 matrix)",
    ROW + "1 0 0 0 0 1 0 0 0 0 1 0\n": ":2: expected 8 numbers as in the rows before, found 12",
    "# x\n0 0 zero 0 0 0 0 1\n": ":2: expected a number in column 3, found 'zero'",
    "0 0 nan 0 0 0 0 1\n": ":1: expected a number in column 3, found 'nan'",
    "0 0 1_0 0 0 0 0 1\n": ":1: expected a number in column 3, found '1_0'",
    "0 0 0 0 1 1 1 1\n": ":1: expected a unit quaternion (qx qy qz qw) in columns 5 to 8",
    "0 0 0 0 1e200 0 0 1\n": ":1: expected a unit quaternion",
    "1 0 0 0 0 1 0 0 0 0 2 0\n": ":1: expected the rows of a 3x4 pose",
    "1e200 0 0 0 0 1 0 0 0 0 1 0\n": ":1: expected the rows of a 3x4 pose",
    ROW + ROW: ":2: expected instants that increase from row to row",
    "1e300 0 0 0 0 0 0 1\n": ":1: expected an instant in seconds",
    "1403636579763555584 0 0 0 0 0 0 1\n": ":1: expected an instant in seconds, found '1403636579763555584': in milliseconds",
    "0 0 -7e150 0 0 0 0 1\n": ":1: expected metres in column 3, at most 1e9",
    "0 \x1b[31m 0 0 0 0 0 1\n": ":1: expected a number in column 2, found '\\x1b[31m'",
    "#timestamp\n1.5,0,0,0,1,0,0,0,0,0,0,0,0,0,0,0,0\n": ":2: expected an instant in nanoseconds, found '1.5'",
    "9223372036854775807,0,0,0,1,0,0,0\n": ":1: expected an instant in nanoseconds",
    "# nothing\n": ": contains no poses", "": ": contains no poses",
    "0 0 0 0 0 0 0 1" + 500 * " 7": ":1: expected 8 numbers", "\0\0\0\0": ":1: expected 8 numbers",
    "PK\3\4abc": ": cannot be read: it is a ZIP archive: unpack it", "<!DOCTYPE HTML>": ": cannot be read: it is a web page"}


@pytest.mark.parametrize("text", BAD)
def test_a_bad_trajectory_is_refused_with_its_line(bench, text):
    bench.write("good.tum", tum(straight(5, 1.0)))
    bench.write("bad.txt", text)
    assert "bad.txt" + BAD[text] in bench.error("good.tum", "bad.txt")


def test_a_file_that_cannot_be_read_is_named(bench):
    bench.write("good.tum", tum(straight(5, 1.0)))
    assert "none.txt: cannot be read: No such file or directory" in bench.error("none.txt", "good.tum")
    assert "it is a folder; expected a file, as trajectory.tum" in bench.error(".", "good.tum")
    os.mkfifo(bench.folder / "pipe")
    assert "it is a pipe or a device; expected a file" in bench.error("pipe", "good.tum")
    with open(bench.folder / "huge.tum", "wb") as file:
        file.truncate(3 << 28)
    assert "it is larger than 268435456 bytes, the limit for such a file" in bench.error("huge.tum", "good.tum")
    bench.write("one.tum", ROW)
    assert "fewer than two poses of the estimate have a truth" in bench.error("one.tum", "good.tum")


def test_any_truncation_and_damage_is_refused_or_evaluated(bench):
    """Never a traceback: in one process, which a run for each text would take too long for."""
    text = (tum(straight(6, 1.0)) + kitti(straight(2, 1.0))).encode()
    generator = np.random.default_rng(5)
    damaged = [text[:length] for length in range(0, 200, 7)]
    for _ in range(300):
        part = bytearray(text[:int(generator.integers(100, len(text)))])
        for place in generator.integers(0, len(part), 3):
            part[place] = int(generator.integers(0, 256))
        damaged.append(bytes(part))
    import sys
    from conftest import ROOT
    sys.path.insert(0, str(ROOT / "tools/evaluate"))
    from evaluation.messages import read_messages
    from evaluation.program import EvaluationError
    from evaluation.trajectory import read_trajectory
    for contents in damaged:
        for read in (read_trajectory, read_messages):
            try:
                found = read(bench.write("damaged", contents))
                assert np.isfinite(found.poses).all() and (np.diff(found.times) > 0).all()
            except EvaluationError as error:
                assert "damaged" in str(error)
