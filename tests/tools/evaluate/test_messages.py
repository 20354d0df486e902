"""Messages of an odometry.csv: errors above limits and bounds, availability, the true velocity."""
import csv
import json
import math

import numpy as np
import pytest
from conftest import kitti, pose, quaternion, straight, tum, turn

SPEED, LEAD = 2.0, 2  # m/s; true poses before the first message
TRIANGLE = [f"c{i}" for i in range(20)]
COLUMNS = ["pair", "utime_us", "valid", "reasons", "reset_counter", "offset_us", "x_m", "y_m", "z_m", "qw", "qx", "qy", "qz", "vx_m_s", "vy_m_s",
           "vz_m_s", "wx_rad_s", "wy_rad_s", "wz_rad_s", "pose_covariance_x_x", *TRIANGLE, "twist_covariance_vx_vx", *TRIANGLE, "features",
           *(f"{q}_bound_{axis}" for q in ("velocity", "angular_rate", "motion", "rotation") for axis in "xyz")]


def triangle(variance):
    return [variance if i == j else 0 for i in range(6) for j in range(i, 6)]


def messages(poses, twists, bound=0.2, variance=1e-4):
    """Rows of VALID messages at 10 Hz, the first LEAD periods after the truth's first pose."""
    rows = []
    for i, (matrix, twist) in enumerate(zip(poses, twists)):
        *xyz, w = quaternion(matrix[:3, :3])
        values = [i, 100_000 * (i + LEAD), 1, 0, 0, 0, *matrix[:3, 3], w, *xyz, *twist, *triangle(variance), *triangle(variance), 7, *[bound] * 12]
        rows.append(dict(zip(range(len(COLUMNS)), values)))
    return rows


def cell(name):
    return COLUMNS.index(name)


def drive(count):
    return messages(straight(count, 0.1 * SPEED), [(SPEED, 0, 0, 0, 0, 0)] * count)


def text(rows):
    return ",".join(COLUMNS) + "\n" + "".join(",".join(str(value) for value in row.values()) + "\n" for row in rows)


def judge(bench, rows, *options):
    bench.write("odometry.csv", text(rows))
    bench.write("truth.tum", tum(straight(60, 0.1 * SPEED)))
    return bench.json("odometry.csv", "truth.tum", "--alert-limits", f"0.3,{math.degrees(0.05)},0.15,{math.degrees(0.025)}", *options)["validity"]


def test_a_large_error_counts_however_uncertain_it_is_said_to_be(bench):
    rows = drive(50)
    rows[20].update({cell("vx_m_s"): SPEED + 1.0, cell("velocity_bound_x"): 500})
    found = judge(bench, rows)
    assert (found["above_limit"], found["above_bound"], found["judged_messages"]) == (1, 0, 50)
    assert found["largest_velocity_error_m_s"] == pytest.approx(1) and found["alert_limits"][0] == 0.3


def test_each_component_counts_against_its_own_bound(bench):
    rows = drive(50)
    for row in rows:
        row[cell("vy_m_s")] = 0.15
    rows[10].update({cell("vz_m_s"): 0.1, cell("velocity_bound_x") + 2: 0.09})
    rows[11].update({cell("wz_rad_s"): 0.04, cell("angular_rate_bound_x") + 2: 0.03})
    rows[12][cell("velocity_bound_x")] = ""  # VALID, and states none
    rows[13][cell("wz_rad_s")] = 0.06
    rows[14][cell("vx_m_s")] = ""  # VALID, and no number
    found = judge(bench, rows)
    assert (found["above_bound"], found["above_limit"]) == (4, 2)
    assert found["largest_rate_error_deg_s"] == pytest.approx(math.degrees(0.06)) and found["largest_velocity_error_m_s"] is None


def test_the_motion_of_the_last_second_counts_within_an_epoch(bench):
    rows = drive(50)
    for row in rows[20:]:  # 18 cm too far in one step: for ten messages
        row[cell("x_m")] += 0.18
    found = judge(bench, rows)
    assert (found["above_limit"], found["above_bound"]) == (10, 0)
    for row in rows[20:]:
        row[cell("reset_counter")] = 1
    assert judge(bench, rows)["above_limit"] == 0


def test_availability_and_the_longest_gap(bench):
    rows = drive(41)
    assert judge(bench, rows)["longest_gap_s"] == pytest.approx(0.1)
    for i in (0, 1, 2, 20, 21, 22, 23, 40):
        rows[i][cell("valid")] = 0
    found = judge(bench, rows)
    assert found["available_percent"] == pytest.approx(100 * 33 / 41) and found["valid_messages"] == 33
    assert found["longest_gap_s"] == pytest.approx(0.5)  # from message 19 to 24
    assert judge(bench, rows[:25] + rows[35:])["longest_gap_s"] == pytest.approx(1.1)  # pairs that never came


def test_the_table_and_the_file_of_messages(bench):
    rows = drive(50)
    rows[20].update({cell("vx_m_s"): SPEED + 1, **{cell("velocity_bound_x") + i: 100 for i in range(12)}})
    judge(bench, rows)
    table = bench.output("odometry.csv", "truth.tum", "--messages", "new/m.csv")
    assert "VALID above an alert limit         1 of 50 (0.7 m/s, 12 deg/s, 0.2 m, 1.5 deg)" in table
    assert "50 of 50, 100.00 %, longest gap 0.10 s" in table and "VALID above their bound            0 of 50" in table
    with open(bench.folder / "new/m.csv", newline="") as file:
        row = list(csv.DictReader(file))[20]
    assert (row["utime_us"], row["valid"], row["velocity_error_x"], row["velocity_bound_x"]) == ("2200000", "1", "1", "100")
    assert float(row["motion_error_x"]) < 1e-9 and len(row) == 26
    assert "is no odometry.csv" in bench.error("truth.tum", "truth.tum", "--messages", "m.csv")


def test_the_true_velocity_is_that_between_poses_as_far_as_their_rate_allows(bench):
    """A cart that swings about all axes, in front of poses at 18 Hz: 0.5 Hz is resolved, 5 Hz in part, a gap not at all."""
    for hz, least, most in ((0.5, 0, 0.002), (5.0, 0.02 * math.pi, 0.15 * math.pi)):
        def at(t, phase=2 * math.pi * hz):
            return pose((2 * t, 0.05 * math.sin(phase * t), 0), turn(0.3 * t + 0.1 * math.sin(phase * t)))
        times = 0.1 * (np.arange(40) + LEAD)
        twists = [(*at(t)[:3, :3].T @ (2, 0.1 * math.pi * hz * math.cos(2 * math.pi * hz * t), 0), 0, 0,
                   0.3 + 0.2 * math.pi * hz * math.cos(2 * math.pi * hz * t)) for t in times]
        bench.write("odometry.csv", text(messages([at(t) for t in times], twists)))
        rows = tum([at(i / 18) for i in range(81)], period=1 / 18).splitlines(True)
        bench.write("truth.tum", "".join(rows))
        found = bench.json("odometry.csv", "truth.tum")["validity"]
        assert least <= math.radians(found["largest_rate_error_deg_s"]) <= most and found["judged_messages"] == 40
    bench.write("truth.tum", "".join(rows[:20] + rows[40:]))
    assert 15 < bench.json("odometry.csv", "truth.tum")["validity"]["judged_messages"] < 32


def test_the_path_continues_across_epochs(bench):
    rows = drive(30)
    for i, row in enumerate(rows[11:], 1):  # a new epoch begins at the last known pose
        row.update({cell("reset_counter"): 1, cell("x_m"): 0.2 * i})
    rows[10].update({cell("valid"): 0, cell("velocity_bound_x"): ""})  # has no estimate
    judge(bench, rows)
    result = bench.json("odometry.csv", "truth.tum")
    assert result["poses"] == 30 and result["final_drift_m"] == pytest.approx(0.2) and result["estimated_path_length_m"] == pytest.approx(28 * 0.2)


def test_a_truth_of_the_camera_needs_the_mount(bench):
    rows, mount = drive(50), [0, 0, 1, 0, -1, 0, 0, 0, 0, -1, 0, 0]
    bench.write("odometry.csv", text(rows))
    T = np.vstack([np.reshape(mount, (3, 4)), [0, 0, 0, 1]])
    bench.write("poses.txt", kitti(np.linalg.inv(T) @ straight(50, 0.1 * SPEED) @ T))
    assert "summary.json: cannot be read" in bench.error("odometry.csv", "poses.txt")
    bench.write("summary.json", '{"rig": {"T_body_camera": [1, 2]}}')
    assert "summary.json: has no rig.T_body_camera of 12 numbers" in bench.error("odometry.csv", "poses.txt")
    bench.write("summary.json", json.dumps({"rig": {"T_body_camera": mount}}))
    result = bench.json("odometry.csv", "poses.txt")
    assert result["final_drift_m"] < 1e-9 and result["validity"]["largest_velocity_error_m_s"] < 1e-9
    bench.write("poses.txt", kitti(straight(49, 1.0)))
    assert "has 49 poses for 50 messages" in bench.error("odometry.csv", "poses.txt")


@pytest.mark.parametrize("change, said", [
    ({"qw": 0.5}, ":3: expected a position of at most 1e9 m and a unit quaternion"), ({"x_m": "nan"}, ":3: expected a position"),
    ({"x_m": ""}, ":3: expected a number in column 7, found ''"), ({"vx_m_s": "fast"}, ":3: expected a number in column 14, found 'fast'"),
    ({"utime_us": 9 * 10**15}, ":3: expected utime_us in us since 1970"), ({"utime_us": "1.5"}, ":3: expected a number in column 2, found '1.5'"),
    ({"utime_us": 0}, ": its times decrease"), ({"reasons": "1,2"}, f":3: expected {len(COLUMNS)} columns, found {len(COLUMNS) + 1}")])
def test_a_bad_row_is_refused_with_its_line(bench, change, said):
    rows = drive(5)
    rows[1].update({cell(name): value for name, value in change.items()})
    bench.write("odometry.csv", text(rows))
    bench.write("truth.tum", tum(straight(60, 0.2)))
    assert "odometry.csv" + said in bench.error("odometry.csv", "truth.tum")
    bench.write("odometry.csv", "pair,utime_us,valid\n")
    assert "odometry.csv:1: has no column 'reasons'; expected the odometry.csv that" in bench.error("odometry.csv", "truth.tum")


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_any_numbers_in_messages_are_judged_and_drawn(bench, seed):
    generator, rows = np.random.default_rng(seed), drive(50)
    for row in rows:
        for column in np.flatnonzero(generator.random(len(COLUMNS)) < 0.1).tolist():
            if column > cell("qz"):
                row[column] = str(generator.choice(["", "inf", "-inf", "nan", "1e308", "-1e308", "1e-308", "-0", "7"]))
        row.update({cell("valid"): int(generator.random() < 0.8), cell("reset_counter"): int(generator.integers(3)), cell("reasons"): -2**31})
    assert judge(bench, rows, "--messages", "m.csv", *(["--report", "r.html"] if seed == 1 else []))["messages"] == 50
