"""lab judge: likelihood and NEES, the truth of a drive, the paired test, wrong inputs."""
import json
import math
import pathlib
import types

import pytest

np = pytest.importorskip("numpy")

from laboratory import jobs, judge, measure, paired, truth  # noqa: E402
from laboratory.main import main, parser  # noqa: E402
from laboratory.program import LabError  # noqa: E402

DRIVES, MESSAGES = 10, 60


def replay(drive, seed, piece, scale, rng, common):
    """A result of random errors; `common` has those that estimators of the same pictures share."""
    def rms(spread):
        return [float(abs(scale * spread * (0.8 * a + 0.6 * b))) for a, b in zip(common, rng.standard_normal(MESSAGES))]

    segments = {"count": 10, "translation_percent": 0.1, "rotation_deg_per_m": 0.01}
    nees = {"mean": 1.0, "samples": MESSAGES}
    nll = [float(value) for value in scale * common ** 2 - 50.0]
    return {"sequence": f"drive {drive}", "set": "tuning", "noise_seed": seed, "noise": 2.0, "piece": piece, "first_pair": 72 * piece,
            "pairs": MESSAGES + 1, "features": 1000, "rpe_m": rms(3e-4), "rpe_deg": rms(2e-3), "nll_motion": nll, "nll_velocity": nll,
            "nees_motion": nees, "nees_velocity": nees, "evaluation": {"segments_5_to_40_m": segments, "segments_100_to_800_m": {"count": 0}}}


def results_of(scale, stream, drives=DRIVES):
    """Drives of unlike difficulty, three pieces with two noise seeds each."""
    shared, own = np.random.default_rng(1), np.random.default_rng(stream)
    return [replay(drive, seed, piece, scale * (1.0 + 0.3 * drive), own, shared.standard_normal(MESSAGES))
            for drive in range(drives) for seed in (1, 2) for piece in range(3)]


def lines_of(before, now):
    return dict(line.split(": ", 1) for line in paired.comparison(before, now, "before.json")[1])


def test_the_likelihood_is_that_of_the_normal_distribution():
    nees, nll = truth.likelihood(np.array([3.0]), np.array([[4.0]]))
    assert nees == pytest.approx(2.25) and nll == pytest.approx(1.125 + math.log(2.0) + 0.5 * math.log(2.0 * math.pi))
    rng = np.random.default_rng(3)
    root = rng.standard_normal((6, 6))
    covariance, error = root @ root.T, rng.standard_normal(6)
    nees, nll = truth.likelihood(error, covariance)
    square = error @ np.linalg.inv(covariance) @ error
    assert nees == pytest.approx(square / 6.0)
    assert nll == pytest.approx(0.5 * (square + math.log(np.linalg.det(2.0 * math.pi * covariance))))
    assert truth.likelihood(error, 0.0 * covariance) is None and truth.likelihood(error, math.nan * covariance) is None


def test_errors_with_their_covariance_have_a_nees_within_its_band():
    rng, root = np.random.default_rng(4), np.diag([1e-4, 2e-4, 3e-4, 1e-5, 2e-5, 3e-5]) @ (np.eye(6) + 0.3)
    values = [truth.likelihood(root @ rng.standard_normal(6), root @ root.T)[0] for _ in range(400)]
    low, high = measure.band(truth.effective_count(values))
    assert low < np.mean(values) < high


def test_the_effective_number_is_that_of_an_autoregression():
    rng, values = np.random.default_rng(5), [0.0]
    for _ in range(20000):
        values.append(0.8 * values[-1] + rng.standard_normal())
    assert truth.effective_count(values) / len(values) == pytest.approx(0.2 / 1.8, rel=0.25)
    assert truth.effective_count([]) == 0 and truth.effective_count([1.0] * 5) == 5


def test_the_perturbation_is_on_the_right():
    turn = np.eye(4)
    turn[:3, :3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    step = np.eye(4)
    step[:3, 3] = [0.1, 0.0, 0.0]
    assert truth.motion_error(turn, turn @ step) == pytest.approx([0.1, 0, 0, 0, 0, 0])
    assert truth.motion_error(step, step @ turn) == pytest.approx([0, 0, 0, 0, 0, math.pi / 2])


@pytest.fixture
def circle(tmp_path):
    """A drive on a circle of 5 m at 0.5 rad/s, and the truth of its camera, which is the body."""
    def pose(t):
        return 5.0 * math.sin(0.5 * t), 5.0 * (1.0 - math.cos(0.5 * t)), 0.5 * t

    body, rows = "", ""
    for i in range(181):
        x, y, yaw = pose(i / 90)
        body += f"{i / 90:.9f} {x:.9f} {y:.9f} 0 0 0 {-math.sin(yaw / 2):.9f} {-math.cos(yaw / 2):.9f}\n"
    for i in range(37):
        x, y, yaw = pose(i / 18)
        rows += f"{math.cos(yaw)} {-math.sin(yaw)} 0 {x} {math.sin(yaw)} {math.cos(yaw)} 0 {y} 0 0 1 0\n"
    (tmp_path / "times_0.txt").write_text("".join(f"{i / 18:.9f}\n" for i in range(37)))
    (tmp_path / "truth.tum").write_text("# poses\n" + body)
    (tmp_path / "poses.txt").write_text(rows)
    right_left = np.eye(4)
    right_left[:3, 3] = [-0.1, 0.002, 0.001]
    rig = types.SimpleNamespace(T_right_left=right_left, left=types.SimpleNamespace(size=(680, 420)))
    return truth.Truth(measure.source_of(tmp_path, tmp_path), rig)


def test_the_truth_has_motions_and_velocities(circle):
    assert circle.twist(1.0) == pytest.approx([2.5, 0, 0, 0, 0, 0.5], abs=1e-5)
    assert circle.twist(2.0) == pytest.approx([2.5, 0, 0, 0, 0, 0.5], abs=1e-4), "the last instant"
    assert circle.twist(2.1) is None
    motion = circle.motion(0.5, 0.5 + 1 / 18)
    assert np.linalg.norm(motion[:3, 3]) == pytest.approx(10.0 * math.sin(0.25 / 18), rel=1e-6)
    rectified = circle.rectified_left[:3, :3] @ [0.1, -0.002, -0.001]
    assert rectified == pytest.approx([math.hypot(0.1, 0.002, 0.001), 0, 0], abs=1e-9), "the right camera lies on the x axis"


def estimate_at(circle, instant, **changed):
    camera = types.SimpleNamespace(motion=circle.motion(instant - 1 / 18, instant), time_step=1 / 18, motion_covariance=1e-8 * np.eye(6))
    twist = circle.twist(instant)
    return types.SimpleNamespace(**{"valid": True, "camera": camera, "exposure_ns": round(1e9 * instant), "velocity": twist[:3],
                                    "angular_velocity": twist[3:], "twist_covariance": 1e-4 * np.eye(6), **changed})


def test_a_message_is_judged_by_its_own_covariance(circle):
    path = {17: np.eye(4), 18: circle.motion(17 / 18, 1.0)}
    exact = judge.errors_of(estimate_at(circle, 1.0), path, circle)
    assert exact["rpe_m"] < 1e-9 and exact["nees_velocity"] < 1e-9
    assert exact["nll_motion"] == pytest.approx(3.0 * math.log(2.0 * math.pi * 1e-8))
    off = judge.errors_of(estimate_at(circle, 1.0, velocity=circle.twist(1.0)[:3] + [0.03, 0, 0]), path, circle)
    assert off["nees_velocity"] == pytest.approx(9.0 / 6.0) and off["nll_velocity"] - exact["nll_velocity"] == pytest.approx(4.5)
    path[18][0, 3] += 0.002
    moved = judge.errors_of(estimate_at(circle, 1.0), path, circle)
    assert moved["rpe_m"] == pytest.approx(0.002) and moved["nees_motion"] < 1e-9, "the pose was published, the motion is as estimated now"
    assert judge.errors_of(estimate_at(circle, 1.0, valid=False), path, circle) is None
    assert judge.errors_of(estimate_at(circle, 1.0, twist_covariance=np.zeros((6, 6))), path, circle) is None
    found = judge.statistics([None, None, exact])
    assert found["rpe_m"][0] is None and found["nll_motion"][1] < 0 and found["nees_velocity"]["samples"] == 1


def test_noise_is_the_same_for_the_same_seed():
    cartvo = types.SimpleNamespace(Pair=lambda left, right, *_: (left, right))
    grey = np.full((40, 60), 100, np.uint8)
    pair = types.SimpleNamespace(left=grey, right=grey, t_left=0, t_right=0, offset_stddev=0.0)

    def noisy(seed, number):
        return judge.with_noise(cartvo, pair, number, {"noise_seed": seed, "noise": 2.0})

    one, again, other, later = noisy(1, 5), noisy(1, 5), noisy(2, 5), noisy(1, 6)
    assert (one[0] == again[0]).all() and (one[0] != other[0]).any() and (one[0] != later[0]).any() and (one[0] != one[1]).any()
    assert np.std(one[0].astype(float)) == pytest.approx(math.hypot(2.0, 0.29), rel=0.05)
    assert noisy(0, 5) is pair


def test_a_difference_of_five_percent_is_found():
    lines = lines_of(results_of(1.0, 2), results_of(0.95, 2))
    assert lines["RPE mm"].startswith("better by 4.") or lines["RPE mm"].startswith("better by 5.")
    worse = lines_of(results_of(1.0, 2), results_of(1.05, 3))
    assert worse["RPE mm"].startswith("worse by ") and worse["NLL motion"].startswith("worse by ")
    size = float(worse["RPE mm"].split()[2])
    assert size == pytest.approx(5.0, abs=2.5), "other own errors, the same common ones"


def test_equal_estimators_have_no_difference():
    for stream in (3, 4, 5):
        lines = lines_of(results_of(1.0, 2), results_of(1.0, stream))
        assert lines["RPE mm"].startswith("no difference (") and lines["RPE deg"].startswith("no difference (")
    same = lines_of(results_of(1.0, 2), results_of(1.0, 2))
    assert same["NLL motion"] == "no difference (+0.000 ± 0.000)" and same["available"].startswith("no difference")


def test_replays_of_a_drive_do_not_count_as_independent():
    mean, error = paired.mean_and_error([0.0, 0.1, 0.2])
    assert mean == pytest.approx(0.1) and error == pytest.approx(0.1 / math.sqrt(3))
    assert lines_of(results_of(1.0, 2, 3), results_of(0.9, 2, 3))["RPE mm"].startswith("not known from 3 drives, expected 4 or more (-")
    assert [paired.quantile(n) for n in (3, 9, 30)] == pytest.approx([3.182, 2.262, 2.042], rel=0.01)


def test_an_estimator_does_not_win_by_being_invalid():
    before, now = results_of(1.0, 2), results_of(1.0, 2)
    for result in now:
        order = sorted(range(MESSAGES), key=lambda i: -result["rpe_m"][i])
        for key in paired.LISTS:
            result[key] = [None if i in order[:6] else value for i, value in enumerate(result[key])]
    lines = lines_of(before, now)
    assert lines["RPE mm"].startswith("no difference") and lines["available"].startswith("worse by 10.00 ± 0.00")


def test_the_table_pools_messages_and_tests_against_a_file(tmp_path, capsys):
    files = {"before.json": results_of(1.0, 2), "now.json": results_of(0.95, 2)}
    for name, results in files.items():
        (tmp_path / name).write_text(json.dumps(jobs.document("judge", [], results)))
    assert main("lab/lab", ["judge", "--merge", str(tmp_path / "now.json"), "--against", str(tmp_path / "before.json")]) == 0
    told = capsys.readouterr().out
    assert "all 10 drives" in told and "VALID in both" in told and "RPE mm: better by" in told and "segments %: no difference" in told
    f = judge.figures([{**results_of(1.0, 2)[0], "rpe_m": [0.003, None, 0.004, None]}])
    assert f["rpe_mm"] == pytest.approx(1e3 * math.sqrt(12.5e-6)) and f["available"] == 50.0


def test_wrong_files_say_what_is_expected(tmp_path, capsys):
    def error_of(before, now):
        for name, results in (("before.json", before), ("now.json", now)):
            (tmp_path / name).write_text(json.dumps(jobs.document("judge", [], results)))
        assert main("lab/lab", ["judge", "--merge", str(tmp_path / "now.json"), "--against", str(tmp_path / "before.json")]) == 1
        return capsys.readouterr().err

    good = results_of(1.0, 2)
    without = [{key: value for key, value in result.items() if key != "nll_motion"} for result in good]
    assert "before.json: result 1 has no nll_motion; expected results of lab judge --json; measure again" in error_of(without, good)
    assert "now.json: result 1 has no nll_motion" in error_of(good, without)
    assert "not there: drive 9, noise seed 1 of 2 grey levels, piece 0; measure both with the same" in error_of(results_of(1.0, 2, 9), good)
    assert "only there: drive 9" in error_of(good, results_of(1.0, 2, 9))
    short = [{**result, "rpe_m": [0.1]} for result in good]
    assert "before.json: result 1 has lists of unequal lengths" in error_of(short, good)
    (tmp_path / "before.json").write_text(json.dumps(jobs.document("accuracy", [], [])))
    assert main("lab/lab", ["judge", "--merge", str(tmp_path / "now.json"), "--against", str(tmp_path / "before.json")]) == 1
    assert "before.json: of other work (lab accuracy" in capsys.readouterr().err


def test_other_drives_are_refused_before_anything_is_measured(tmp_path):
    (tmp_path / "before.json").write_text(json.dumps(jobs.document("judge", [], results_of(1.0, 2))))
    options = parser().parse_args(["judge", "--scenarios", "campus", "--against", str(tmp_path / "before.json")])
    with pytest.raises(LabError, match="measure both with the same options"):
        judge.cases(options)
    cases = judge.cases(parser().parse_args(["judge", "--scenarios", "campus,turns+lively", "--seconds", "8", "--noise-seeds", "0,3"]))
    assert len(cases) == 2 * 2 * 2 and cases[1].labels == {"noise_seed": 0, "noise": 2.0, "piece": 1, "first_pair": 72, "pairs": 72}
    assert cases[0].drive.start_at == 1.5 and cases[-1].drive.start_at is None, "at rest, and in motion"
    for wrong in (["--data", str(pathlib.Path("/data"))], ["--piece-seconds", "20"], ["--noise-seeds", "-1,2"]):
        with pytest.raises(LabError, match=wrong[0]):
            judge.cases(parser().parse_args(["judge", "--scenarios", "campus", *(f"{a}" for a in [f"{wrong[0]}={wrong[1]}"])]))
