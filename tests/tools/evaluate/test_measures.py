"""Error measures by independent definitions, and of paths whose errors are known."""
import math

import numpy as np
import pytest
from conftest import circle, kitti, pose, scaled, straight, tum, turn, turned_axes

SHARE = 1 / 3  # of a period


def angle(rotation):
    skew = rotation - rotation.T  # atan2: acos of the trace has no digits left at small angles
    return math.atan2(0.5 * math.hypot(skew[2, 1], skew[0, 2], skew[1, 0]), 0.5 * (np.trace(rotation) - 1))


def devkit(truth, estimate):
    """KITTI's devkit/cpp/evaluate_odometry.cpp (calcSequenceErrors): length, error of translation and of rotation of each segment."""
    distances, errors = [0.0], []
    for before, after in zip(truth, truth[1:]):
        distances.append(distances[-1] + np.linalg.norm(after[:3, 3] - before[:3, 3]))
    for first in range(0, len(truth), 10):
        for length in range(100, 900, 100):
            last = next((i for i in range(first, len(truth)) if distances[i] > distances[first] + length), None)
            if last is not None:
                error = np.linalg.inv(np.linalg.inv(estimate[first]) @ estimate[last]) @ np.linalg.inv(truth[first]) @ truth[last]
                errors.append((length, np.linalg.norm(error[:3, 3]) / length, angle(error[:3, :3]) / length))
    return errors


def evo_ape(truth, estimate):
    """evo (M. Grupp), evo_ape --align: RMSE of positions after Umeyama's alignment without scale."""
    x, y = (np.array([matrix[:3, 3] for matrix in poses]).T for poses in (estimate, truth))
    x, y = x - x.mean(1, keepdims=True), y - y.mean(1, keepdims=True)
    u, _, vt = np.linalg.svd(y @ x.T)
    rotation = u @ np.diag([1, 1, np.linalg.det(u) * np.linalg.det(vt)]) @ vt
    return math.sqrt(((rotation @ x - y) ** 2).sum(0).mean())


def evo_rpe(truth, estimate):
    """evo_rpe, delta of one frame, translation (m) and rotation angle (deg)."""
    errors = [np.linalg.inv(np.linalg.inv(t0) @ t1) @ np.linalg.inv(e0) @ e1 for t0, t1, e0, e1 in zip(truth, truth[1:], estimate, estimate[1:])]
    return [math.sqrt(np.mean(np.square(values))) for values in ([np.linalg.norm(error[:3, 3]) for error in errors],
                                                                 [math.degrees(angle(error[:3, :3])) for error in errors])]


def long_drive():
    truth, estimate = [np.eye(4)], [np.eye(4)]
    for i in range(1, 1500):
        forward, yaw, roll = 0.7 + 0.2 * math.sin(0.05 * i), 0.02 * math.sin(0.011 * i), 0.003 * math.cos(0.07 * i)
        truth.append(truth[-1] @ pose((forward, 0, 0), turn(yaw, 0, roll)))
        estimate.append(estimate[-1] @ pose((1.01 * forward + 0.004 * math.cos(0.3 * i), 0, 0),
                                            turn(yaw + 0.0004 * math.sin(0.9 * i) + 0.0001, 0, roll + 0.0001 * math.cos(i))))
    return np.array(truth), np.array(estimate)


def test_errors_are_those_of_the_devkit_and_of_evo(bench):
    truth, estimate = long_drive()
    result, errors = bench.compare(estimate, truth, form=kitti), devkit(truth, estimate)
    segments = result["segments_100_to_800_m"]
    assert [part["length_m"] for part in segments["by_length"]] == list(range(100, 900, 100))
    for part, length in [(segments, None), *((part, part["length_m"]) for part in segments["by_length"])]:
        chosen = [error for error in errors if length in (None, error[0])]
        assert part["count"] == len(chosen)
        assert part["translation_percent"] == pytest.approx(100 * np.mean([error[1] for error in chosen]), rel=1e-7)
        assert part["rotation_deg_per_m"] == pytest.approx(math.degrees(np.mean([error[2] for error in chosen])), rel=1e-6)
    assert result["ate_rmse_m"] == pytest.approx(evo_ape(truth, estimate), rel=1e-7)
    assert [result["rpe_rmse_m"], result["rpe_rmse_deg"]] == pytest.approx(evo_rpe(truth, estimate), rel=1e-6)
    assert result["association"] == "rows" and result["problem"] == "" and result["scale"] == 1.0


def test_a_scale_error_is_that_of_each_segment(bench):
    step, truth = 0.4999, straight(2001, 0.4999)  # a segment ends at the first pose beyond its length, up to a step later
    result = bench.compare(scaled(truth, 1.02), truth)
    assert result["final_drift_percent"] == pytest.approx(2, abs=1e-7) and result["rpe_rmse_m"] == pytest.approx(0.02 * step, abs=1e-8)
    for part in result["segments_5_to_40_m"]["by_length"] + result["segments_100_to_800_m"]["by_length"]:
        reached = math.ceil(part["length_m"] / step) * step
        assert part["translation_percent"] == pytest.approx(2 * reached / part["length_m"], abs=1e-6)
    # Aligned at the middle, the RMS of the residuals is that of a uniform distribution.
    assert result["ate_rmse_m"] == pytest.approx(0.02 * 2000 * step / math.sqrt(12), rel=1e-3)
    assert result["origin_rmse_m"] == pytest.approx(0.02 * 2000 * step / math.sqrt(3), rel=1e-3)
    assert "final drift of the path            2.000 %" in bench.output("estimate.txt", "truth.txt")


def test_a_yaw_drift_is_its_angle_per_metre(bench):
    step, drift = 0.4999, math.radians(0.01)
    estimate = [np.eye(4)]
    for _ in range(2000):
        estimate.append(estimate[-1] @ pose((step, 0, 0), turn(drift * step)))
    result = bench.compare(estimate, straight(2001, step))
    assert result["rpe_rmse_deg"] == pytest.approx(0.01 * step, rel=1e-4)
    assert result["final_rotation_deg"] == pytest.approx(0.01 * step * 2000, rel=1e-4)
    for part in result["segments_100_to_800_m"]["by_length"]:  # the chord of an arc ends about half its angle beside the tangent
        assert part["rotation_deg_per_m"] == pytest.approx(0.01, rel=0.006)
        assert part["translation_percent"] == pytest.approx(50 * drift * part["length_m"], rel=0.04)


def test_segments_start_at_each_pose_and_long_ones_at_each_tenth(bench):
    result = bench.compare(straight(301, 1.0001), straight(301, 1.0001))
    assert result["segments_5_to_40_m"]["by_length"][3]["count"] == 261
    assert [part["count"] for part in result["segments_100_to_800_m"]["by_length"]] == [21, 11, 1]


def test_a_standstill_has_no_percentage_and_no_segments(bench):
    result = bench.compare(straight(10, 0.001), straight(10, 0.0))
    assert result["final_drift_m"] == pytest.approx(0.009) and result["final_drift_percent"] is None and result["axes_aligned"] is None
    assert result["segments_5_to_40_m"] == {"count": 0, "translation_percent": None, "rotation_deg_per_m": None, "by_length": []}
    assert "5 to 40 m: the path is too short" in bench.output("estimate.txt", "truth.txt")
    assert "a standstill has no path to fit" in bench.error("estimate.txt", "truth.txt", "--align")


@pytest.mark.parametrize("truth, turned, found", [
    (circle(400, 30.0, 0.5), turn(0.005, -0.003, 0.004), (-0.004, 0.003, -0.005)),
    (straight(200, 0.5), turn(0.005, -0.003, 0.05), (0.0, 0.003, -0.005))])  # the rotation about a straight path is not observable
def test_axes_are_aligned_as_far_as_they_are_observable(bench, truth, turned, found):
    result = bench.compare(turned_axes(truth, turned.T), truth)
    axes = result["axes_aligned"]
    assert axes["rotation_deg"] == pytest.approx([math.degrees(value) for value in found], abs=0.02)
    assert result["segments_5_to_40_m"]["translation_percent"] == pytest.approx(100 * math.hypot(0.003, 0.005), abs=0.15)
    assert axes["segments_5_to_40_m"]["translation_percent"] == pytest.approx(0, abs=1e-3)


def test_the_truth_is_interpolated_at_the_estimates_times(bench):
    truth, later = circle(100, 10.0, 0.05), SHARE * 0.05 / 10.0
    estimate = [pose((10 * math.sin(a), 10 * (1 - math.cos(a)), 0), turn(a)) for a in (i * 0.005 + later for i in range(99))]
    bench.write("e.tum", tum(estimate, start=SHARE * 0.1))
    bench.write("t.tum", tum(truth))
    result = bench.json("e.tum", "t.tum")
    assert result["association"] == "time" and result["unmatched"] == 0 and result["rpe_rmse_m"] < 2e-5 and result["rpe_rmse_deg"] < 1e-5


def test_poses_without_a_truth_are_counted(bench):
    rows = tum(straight(50, 1.0)).splitlines(True)
    bench.write("t.tum", "".join(rows[:20] + rows[30:]))  # a second without truth
    bench.write("e.tum", tum(straight(60, 1.0)))
    result = bench.json("e.tum", "t.tum")
    assert (result["poses"], result["unmatched"]) == (40, 20)
    bench.write("t.tum", tum(straight(50, 1.0)))
    for rounding, unmatched in ((16e-6, 0), (2e-3, 1)):  # times in a camera's 90 kHz clock are rounded by some us
        bench.write("e.tum", tum(straight(50, 1.0), start=-rounding))
        assert bench.json("e.tum", "t.tum")["unmatched"] == unmatched
