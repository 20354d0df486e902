"""Problems that an evaluation names, and their remedies: clocks, conventions, axes; the fit; several estimates."""
import numpy as np
import pytest
from conftest import circle, kitti, pose, scaled, straight, tum, turn, turned_axes, winding

DRIVE = winding(600)


@pytest.mark.parametrize("delay, said", [
    (18.0, ("GPS time is ahead of UTC", "--offset 18.00")), (-1.5, ("the two clocks differ", "--offset -1.50")), (0.0, ())])
def test_the_offset_of_overlapping_files_is_named(bench, delay, said):
    bench.write("e.tum", tum(DRIVE))
    bench.write("t.tum", tum(DRIVE, start=delay))
    problem = bench.json("e.tum", "t.tum")["problem"]
    assert all(part in problem for part in said) and bool(problem) == bool(said)


@pytest.mark.parametrize("delay, said", [
    (-315964782.0, ("counts from 1980", "--offset -315964782.00")), (7200.0, ("difference of a time zone", "--offset 7200.00")),
    (1.7e9, ("the two clocks differ", "--offset 1700000000.00"))])
def test_the_offset_of_files_without_a_common_time_is_named(bench, delay, said):
    bench.write("e.tum", tum(winding(1000)[300:700], start=30.0 - delay))
    bench.write("t.tum", tum(winding(1000)))
    error = bench.error("e.tum", "t.tum")
    assert "fewer than two poses of the estimate have a truth at their time" in error and all(part in error for part in said)
    assert bench.json("e.tum", "t.tum", "--offset", delay)["final_drift_m"] < 1e-6


@pytest.mark.parametrize("path", [straight(200, 1.0), circle(200, 30.0, 0.5)])
def test_uniform_motion_does_not_tell_the_clock(bench, path):
    bench.write("e.tum", tum(path))
    bench.write("t.tum", tum(path, start=5.0))
    assert bench.json("e.tum", "t.tum")["problem"] == ""


def test_other_conventions_of_poses_are_named(bench):
    inverse_rotations = DRIVE.copy()
    inverse_rotations[:, :3, :3] = np.swapaxes(DRIVE[:, :3, :3], 1, 2)
    for estimate, truth, said in (
            (tum(DRIVE), tum(DRIVE, order=(3, 0, 1, 2)), "the truth is read in another convention: its quaternions"),
            (tum(DRIVE, order=(3, 0, 1, 2)), tum(DRIVE), "the estimate is read in another convention: its quaternions"),
            (kitti(np.linalg.inv(DRIVE)), kitti(DRIVE), "poses of one of the two files seem to be inverse"),
            (kitti(inverse_rotations), kitti(DRIVE), "rotations of one of the two files seem to be inverse")):
        bench.write("e", estimate)
        bench.write("t", truth)
        assert said in bench.json("e", "t")["problem"]


@pytest.mark.parametrize("rotation, said", [
    (turn(0, np.radians(1.5)), ()), (turn(0, np.radians(6.2)), ("differ by 6.2 deg", "T_body_camera", "--align")),
    (turn(0, 0, np.pi), ("differ by 180.0 deg", "forward, right, down"))])
def test_turned_axes_are_named_from_two_degrees_on(bench, rotation, said):
    problem = bench.compare(turned_axes(DRIVE, rotation), DRIVE, form=kitti)["problem"]
    assert all(part in problem for part in said) and bool(problem) == bool(said)


def test_the_fit_removes_world_axes_and_scale(bench):
    world = pose((5, -3, 2), turn(1.0, 0.2))
    moved = world @ scaled(turned_axes(DRIVE, turn(0.3, -0.2, 0.1)), 0.8)
    result = bench.compare(moved, DRIVE, "--align", "--correct-scale", form=kitti)
    assert result["scale"] == pytest.approx(1.25, abs=1e-6) and result["problem"] == ""
    assert result["origin_rmse_m"] < 1e-6 and result["final_drift_m"] < 1e-6 and result["rpe_rmse_deg"] < 1e-5
    assert bench.json("estimate.txt", "truth.txt", "--align")["scale"] == 1.0
    assert "scale of the estimate              multiplied by 1.250000" in bench.output("estimate.txt", "truth.txt", "--correct-scale")


def test_several_estimates_are_one_table(bench):
    bench.write("one.tum", tum(scaled(DRIVE, 1.02)))
    bench.write("other.tum", tum(DRIVE, start=-18.0))
    bench.write("t.tum", tum(DRIVE))
    header, one, other, problem = bench.output("one.tum", "other.tum", "--truth", "t.tum").splitlines()
    assert header.split("  ")[0] == "estimate" and "drift (%)" in header and "0.0082" in one and other.startswith("other.tum")
    assert problem.startswith("problem: other.tum: the clocks") and "--offset 18.00" in problem
    results = bench.json("one.tum", "--offset", "18", "--truth", "t.tum", "other.tum")
    assert [result["estimate"] for result in results] == ["one.tum", "other.tum"] and results[1]["final_drift_m"] < 1e-6
    assert "expected ESTIMATE TRUTH" in bench.error("one.tum", "other.tum", "t.tum", code=2)


def test_other_units_of_positions_are_named(bench):
    for scale, said in ((1000.0, "in millimetres"), (0.001, "in kilometres"), (3.2808, "in feet"), (1.3, "the baseline in the rig"), (1.05, "")):
        problem = bench.compare(DRIVE, scaled(DRIVE, scale))["problem"]
        assert said in problem and bool(problem) == bool(said), (scale, problem)
    degrees = DRIVE.copy()
    degrees[:, :2, 3] = (49.0, 8.4) + 1e-5 * DRIVE[:, [1, 0], 3]
    assert "latitude and longitude" in bench.compare(DRIVE, degrees)["problem"]
    assert bench.compare(DRIVE, scaled(DRIVE, 1.3), "--correct-scale")["problem"] == ""


def test_mirrored_axes_and_positions_without_rotations_are_named(bench):
    mirror = np.diag([1.0, -1.0, 1.0, 1.0])
    hilly = np.array([matrix @ pose(rotation=turn(0, 0.1 * np.sin(0.1 * i), 0.1 * np.sin(0.2 * i))) for i, matrix in enumerate(DRIVE)])
    positions = DRIVE.copy()
    positions[:, :3, :3] = np.eye(3)
    mirrored_positions = DRIVE.copy()
    mirrored_positions[:, 1, 3] *= -1
    for estimate, truth, said in ((hilly, mirror @ hilly @ mirror, "left-handed"), (DRIVE, mirrored_positions, "seem to be mirrored"),
                                  (DRIVE, positions, "the truth has positions only")):
        assert said in bench.compare(estimate, truth)["problem"]


def test_a_truth_of_another_point_of_the_cart_is_named(bench):
    problem = bench.compare(scaled(DRIVE, 1.002), DRIVE @ pose((1.5, -0.4, 0.8)))["problem"]
    assert "(1.5, -0.4, 0.0) m from the estimate's" in problem


def test_a_truth_of_a_part_of_the_drive_is_of_the_same_clock(bench):
    bench.write("e.tum", tum(scaled(DRIVE, 1.01)))
    for first, last in ((0, 40), (200, 230), (560, 600)):
        bench.write("t.tum", tum(DRIVE[first:last], start=0.1 * first))
        assert bench.json("e.tum", "t.tum")["problem"] == ""


def test_instants_in_milliseconds_are_named(bench):
    bench.write("e.tum", tum(DRIVE))
    bench.write("t.tum", tum(DRIVE, period=100.0))
    assert "the truth's instants are 100 s apart: are they milliseconds" in bench.error("e.tum", "t.tum")
