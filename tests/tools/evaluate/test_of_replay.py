"""The comparison of a replay with the truth, as `cartvo replay --truth` asks for it."""
import json
import math
import pathlib
import subprocess

import numpy as np
import pytest
from conftest import CARTVO, circle, kitti, pose, straight, tum, turn


def replay(count, noise, lost=()):
    """The input of cartvo-evaluate --of-replay: a drive on a circle with errors of known covariance, lost at some pairs."""
    generator, deviations = np.random.default_rng(7), np.array([0.01, 0.005, 0.02, 0.001, 0.002, 0.0005])
    truth, motions, epochs, first, epoch, covariance = circle(count, 20.0, 0.8), [], [], [np.eye(4)], [np.eye(4)], [np.zeros((6, 6))]
    for i in range(1, count):
        error = noise * deviations * generator.standard_normal(6)
        motion = np.linalg.inv(truth[i - 1]) @ truth[i] @ pose(error[:3], turn(error[5], error[4], error[3]))
        adjoint = np.zeros((6, 6))
        R, t = motion[:3, :3].T, -motion[:3, :3].T @ motion[:3, 3]
        adjoint[:3, :3] = adjoint[3:, 3:] = R
        adjoint[:3, 3:] = np.array([[0, -t[2], t[1]], [t[2], 0, -t[0]], [-t[1], t[0], 0]]) @ R
        motions.append(motion)
        epochs.append(sum(i > pair for pair in lost))
        is_new = i > 1 and epochs[-1] != epochs[-2]
        first.append(first[-1] @ motion)
        epoch.append((np.eye(4) if is_new else epoch[-1]) @ motion)
        covariance.append((0 if is_new else adjoint @ covariance[-1] @ adjoint.T) + np.diag(deviations**2))
    return {"T_body_camera": np.eye(4).ravel().tolist(), "exposure_ns": [100_000_000 * i for i in range(count)],
            "valid": [False, *(i not in lost for i in range(1, count))], "reset_counter": [0, *epochs], "time_step": [0, *[0.1] * (count - 1)],
            "T_first_left": np.reshape(first, (-1, 16)).tolist(),
            "T_epoch_left": np.reshape(epoch, (-1, 16)).tolist(), "T_previous_current": np.reshape([np.eye(4), *motions], (-1, 16)).tolist(),
            "twist": [[None] * 6, *[[9.0, 0, 0, 0, 0, 0.4]] * (count - 1)], "motion_covariance": [np.diag(deviations**2).ravel().tolist()] * count,
            "pose_covariance": np.reshape(covariance, (-1, 36)).tolist(), "twist_covariance": [np.eye(6).ravel().tolist()] * count}


def of_replay(bench, document, truth, option="--of-replay"):
    """`truth`: text, or the name of a folder."""
    file = truth if "\n" not in truth else str(bench.write("truth", truth))
    program = pathlib.Path(CARTVO).resolve().parents[1] / "libexec/cartvo/cartvo-evaluate"
    return subprocess.run([program, option, file], input=json.dumps(document), capture_output=True, text=True, cwd=bench.folder)


def results(bench, document, truth):
    done = of_replay(bench, document, truth)
    assert done.returncode == 0 and not done.stderr, done
    return json.loads(done.stdout)


def test_a_replay_with_true_covariances_is_consistent(bench):
    found = results(bench, replay(400, 1.0), tum(circle(400, 20.0, 0.8)))
    consistency = found["consistency"]
    low, high = consistency["nees_motion"]["band_95_percent"]
    assert low < consistency["nees_motion"]["mean"] < high and consistency["nees_motion"]["samples"] == 399
    # The quantiles of chi-square with 6 n degrees of freedom over 6 n, in the approximation of Wilson and Hilferty.
    assert [low, high] == pytest.approx([(1 - 2 / (9 * 2394) + z * math.sqrt(2 / (9 * 2394))) ** 3 for z in (-1.959964, 1.959964)], abs=1e-5)
    low, high = consistency["nees_pose"]["band_95_percent"]
    assert [low, high] == pytest.approx([1.237344 / 6, 14.449375 / 6], abs=1e-5)  # from a table
    assert low < consistency["nees_pose"]["mean"] < high and consistency["nees_pose"]["samples"] == 1
    # The velocity is off by 1 m/s of 8, and states a deviation of 1 m/s.
    assert consistency["nees_velocity"]["mean"] == pytest.approx(1 / 6, abs=1e-3) and consistency["rate_error_deg_s"] < 0.01
    assert consistency["true_rate_deg_s"] == pytest.approx(math.degrees(0.4), rel=1e-3) and consistency["standing_highest_speed_m_s"] is None
    assert found["evaluation"]["poses"] == 400 and found["table"].startswith("poses compared")


def test_a_replay_with_too_small_covariances_and_losses(bench):
    consistency = results(bench, replay(400, 1.5, lost=(100, 200)), kitti(circle(400, 20.0, 0.8)))["consistency"]
    assert consistency["nees_motion"]["mean"] == pytest.approx(2.25, rel=0.15)
    assert consistency["nees_motion"]["mean"] > consistency["nees_motion"]["band_95_percent"][1]
    assert (consistency["nees_motion"]["samples"], consistency["nees_pose"]["samples"]) == (397, 3)


def test_standstill_of_a_replay_is_no_measurement(bench):
    document = replay(20, 0.0)
    for name in ("T_previous_current", "T_first_left", "T_epoch_left"):
        document[name] = [np.eye(4).ravel().tolist()] * 20
    document["exposure_ns"][19] = 10**12  # after the end of the truth
    document["twist"] = [[None] * 6, *([0, 0.03 if i == 4 else 0.01, 0, 0, 0, 0] for i in range(19))]
    found = results(bench, document, tum(straight(20, 0.0)))
    consistency = found["consistency"]
    assert (consistency["standing_pairs"], consistency["standing_highest_speed_m_s"], consistency["nees_motion"]["samples"]) == (18, 0.03, 0)
    assert consistency["nees_motion"]["mean"] is None and found["evaluation"]["unmatched"] == 1
    assert found["evaluation"]["final_drift_percent"] is None and found["evaluation"]["poses"] == 19


T_BODY_CAMERA = pose(rotation=np.array([[0, 0, 1], [-1, 0, 0], [0, -1, 0]]))  # it looks along the body's x axis
CAR = {"calib_imu_to_velo.txt": "calib_time: 25-May-2012 16:47:16\nR: 1 0 0 0 1 0 0 0 1\nT: -1 0 0\n",  # the camera is 1 m before the unit
       "calib_velo_to_cam.txt": "R: 0 -1 0 0 0 -1 1 0 0\nT: 0 0 0\n", "calib_cam_to_cam.txt": "R_rect_00: 1 0 0 0 1 0 0 0 1\n"}


def raw_recording(bench, east, yaw):
    """A raw recording of KITTI at 10 Hz from 0.1 s before 1970 on, in which the unit drives eastwards at 49 degrees north. Its name."""
    (bench.folder / "raw/oxts/data").mkdir(parents=True)
    for name, text in CAR.items():
        bench.write(name, text)
    degrees = math.degrees(1 / (6378137.0 * math.cos(math.radians(49))))
    for i, (metres, angle) in enumerate(zip(east, yaw)):
        bench.write(f"raw/oxts/data/{i:010}.txt", f"49.0 {8 + metres * degrees:.13f} 110.0 0 0 {angle:.15f} 0 0 0\n")
    bench.write("raw/oxts/timestamps.txt", "1969-12-31 23:59:59.9\n" + "".join(
        f"1970-01-01 00:00:{i // 10:02}.{i % 10}00000000\n" for i in range(len(east) - 1)))
    return "raw"


@pytest.mark.parametrize("kind", ["raw", "kitti", "tum"])
def test_errors_of_a_replay_are_in_axes_of_the_body(bench, kind):
    """The truth is 2 cm longer at each pair, and but for rows of KITTI 0.1 s longer than the replay on both sides."""
    document, T = replay(20, 0.0), T_BODY_CAMERA
    for name in ("T_first_left", "T_epoch_left"):
        document[name] = (np.linalg.inv(T) @ straight(20, 0.8) @ T).reshape(-1, 16).tolist()
    document["T_body_camera"], document["twist"][1:] = T.ravel().tolist(), [[8.0, 0, 0, 0, 0, 0.1]] * 19
    document["valid"][5] = False
    truth = {"kitti": kitti(np.linalg.inv(T) @ straight(20, 0.82) @ T), "tum": tum(straight(22, 0.82), start=-0.1)}.get(kind)
    found = results(bench, document, truth or raw_recording(bench, 0.82 * np.arange(22), np.zeros(22)))
    rows = [[float(value) if value else None for value in row.split(",")[1:]] for row in found["errors"]]
    assert rows[0] == [None] * 6 + [0] and rows[5][:6] == [None] * 6
    assert rows[10] == pytest.approx([8.0 - 8.2, 0, 0, 0, 0.1, 0, 10 * 0.02], abs=1e-5)  # Vx, Vy, Vz, pitch, yaw and roll rate, position
    assert found["evaluation"]["final_drift_percent"] == pytest.approx(100 * 0.02 / 0.82, rel=1e-5) and found["evaluation"]["unmatched"] == 0


def test_a_raw_recording_has_the_poses_of_the_camera(bench):
    raw_recording(bench, [0, 2, 4, 6], [0, 0, 0, math.pi / 2])  # turns left at the end
    document = {name: values if name == "T_body_camera" else values[:3] for name, values in replay(3, 0.0).items()}
    for name in ("T_first_left", "T_epoch_left"):
        document[name] = [np.eye(4).ravel().tolist()] * 3
    evaluation = results(bench, document, "raw/oxts")["evaluation"]
    # After the turn the camera is 1 m to the left of the unit, no longer 1 m before it: 1 m left and 3 m before the camera at the first pair.
    assert evaluation["final_drift_m"] == pytest.approx(math.hypot(1, 3), abs=1e-6) and evaluation["final_rotation_deg"] == pytest.approx(90)
    for name, text, said in (("raw/oxts/data/0000000002.txt", "49 8 110 0 0 x\n", "0000000002.txt: expected the 30 numbers of KITTI's oxts"),
                             ("calib_velo_to_cam.txt", "R: 2 0 0 0 1 0 0 0 1\nT: 0 0 0\n", "calib_velo_to_cam.txt:1: R: expected the rows of"),
                             ("calib_imu_to_velo.txt", "R: 1 0 0 0 1 0 0 0 1\nT: 0 0 nan\n", "calib_imu_to_velo.txt:2: T: expected 3 numbers"),
                             ("calib_cam_to_cam.txt", "", "R_rect_00: expected 9 numbers"),
                             ("raw/oxts/timestamps.txt", "2011-13-01 0\n", "timestamps.txt:1: expected a date and a time"),
                             ("raw/oxts/timestamps.txt", "2011-09-26 13:02:25\n", "timestamps.txt: has 1 instants for 4 files")):
        before = (bench.folder / name).read_text()
        bench.write(name, text)
        done = of_replay(bench, {}, "raw", "--check-truth")
        assert done.returncode == 1 and said in done.stderr and done.stderr.startswith("cartvo: "), done
        bench.write(name, before)
    assert of_replay(bench, {}, "raw", "--check-truth").returncode == 0
    (bench.folder / "calib_imu_to_velo.txt").unlink()
    assert "is neither in it nor in the folder above it" in of_replay(bench, {}, "raw", "--check-truth").stderr
    (bench.folder / "empty").mkdir()
    assert "contains no truth; expected a raw recording of KITTI" in of_replay(bench, {}, "empty", "--check-truth").stderr


def test_a_truth_that_does_not_fit_a_replay_is_refused(bench):
    for text, said in ((kitti(straight(19, 0.8)), "has 19 poses for 20 pairs; KITTI rows have no times"),
                       (tum(straight(19, 0.8), start=100.0), "fewer than two poses of the estimate have a truth at their time")):
        done = of_replay(bench, replay(20, 0.0), text)
        assert done.returncode == 1 and done.stderr.startswith(f"cartvo: {bench.folder / 'truth'}: ") and said in done.stderr
