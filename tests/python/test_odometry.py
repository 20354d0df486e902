"""Odometry on images: the results of `cartvo replay`, and wrong input."""
import gc
import math
import subprocess
import sys
import threading

import cartvo
import numpy as np
import pytest
from conftest import HEIGHT, PERIOD_NS, WIDTH

SIDE = range(6)


def replayed_rows(folder):
    """The rows of odometry.csv, as text."""
    header, *rows = (folder / "odometry.csv").read_text().splitlines()
    return [dict(zip(header.split(","), row.split(","), strict=True)) for row in rows]


def number(value):
    """As in odometry.csv."""
    return f"{value + 0.0:.9g}" if math.isfinite(value) else ""


def triangle(matrix):
    return [number(matrix[i, j]) for i in SIDE for j in SIDE[i:]]


def columns_of(row, prefix):
    return [value for name, value in row.items() if name.startswith(prefix)]


def test_pair_processor_gives_what_replay_gives(drive):
    for source in ("images", "recording"):
        recording = cartvo.Recording(drive / source)
        limits = cartvo.AlertLimits()
        if recording.is_recording:  # as its configuration
            limits.velocity, limits.angular_rate, limits.motion, limits.rotation = 100.0, math.radians(1000), 100.0, math.pi
        processor = cartvo.PairProcessor(recording.rig, unknown_readout=recording.is_recording, alert_limits=limits)
        rows, valid = replayed_rows(drive / f"replay-{source}"), 0
        for row, pair in zip(rows, recording, strict=True):
            result = processor.process(pair)
            assert int(row["valid"]) == result.status.value
            assert int(row["utime_us"]) == result.exposure_ns // 1000
            assert int(row["inliers"]) == result.camera.inliers
            assert [row["x_m"], row["y_m"], row["z_m"]] == [number(value) for value in result.pose[:3, 3]]
            assert int(row["quality"]) == result.quality and (result.quality > 0) == result.valid
            if not result.valid:
                continue
            valid += 1
            for name in ("velocity_bound", "angular_rate_bound", "motion_bound", "rotation_bound"):
                assert [row[f"{name}_{axis}"] for axis in "xyz"] == [number(value) for value in getattr(result, name)]
            velocities = [row[f"{name}_m_s"] for name in ("vx", "vy", "vz")] + [row[f"{name}_rad_s"] for name in ("wx", "wy", "wz")]
            assert velocities == [number(value) for value in (*result.velocity, *result.angular_velocity)]
            assert columns_of(row, "pose_covariance") == triangle(result.pose_covariance)
            assert columns_of(row, "twist_covariance") == triangle(result.twist_covariance)
        assert valid > len(rows) // 2


def test_pair_processor_holds_bounds_to_the_alert_limits(drive):
    limits = cartvo.AlertLimits()
    assert limits.velocity == 0.7 and limits.rotation == pytest.approx(np.radians(1.5))
    limits.velocity = 1e-9
    recording = cartvo.Recording(drive / "images")
    processor = cartvo.PairProcessor(recording.rig, alert_limits=limits)
    for pair in recording:
        result = processor.process(pair)
        assert not result.valid
    assert result.reasons[-1] == "bound above its alert limit" and result.quality == 0 and result.camera.valid
    assert "velocity is known to 0.2" in result.bound_exceeded
    assert np.all(result.velocity_bound > limits.velocity) and np.all(np.isnan(result.velocity))


def test_odometry_gives_what_the_pair_processor_gives(drive, rectifier):
    processor = cartvo.PairProcessor(rectifier.rig)
    odometry = cartvo.Odometry(rectifier)
    for pair in cartvo.Recording(drive / "images"):
        expected = processor.process(pair).camera
        estimate = odometry.process(*rectifier.rectify(pair.left, pair.right), pair.t_left, pair.t_right)
        assert estimate.valid == expected.valid and estimate.reasons == expected.reasons
        for name in ("pose", "pose_covariance", "motion", "motion_covariance", "twist_covariance"):
            np.testing.assert_array_equal(getattr(estimate, name), getattr(expected, name))
    assert estimate.valid and estimate.time_step > 0.0 and estimate.pose.shape == (4, 4)
    assert estimate.velocity[2] > 0.1  # forward
    assert estimate.rig is not None and estimate.rig.pitch.stddev > 0.0


def test_rows_may_be_apart(camera, image, right):
    padded = np.zeros((HEIGHT, WIDTH + 12), np.uint8)
    padded[:, 5:-7] = image
    whole, part = cartvo.Odometry(camera), cartvo.Odometry(camera)
    for step in range(3):
        a = whole.process(image, right, step * PERIOD_NS, step * PERIOD_NS)
        b = part.process(padded[:, 5:-7], right, step * PERIOD_NS, step * PERIOD_NS)
        assert a.detected == b.detected > 0
        np.testing.assert_array_equal(a.pose, b.pose)


@pytest.mark.parametrize(("wrong", "error", "text"), [
    (None, TypeError, "left: expected a numpy array of dtype uint8 and shape (210, 340), but got NoneType"),
    ([[0, 1]], TypeError, "but got list"),
    (np.zeros((HEIGHT, WIDTH)), TypeError, "but got dtype float64"),
    (np.zeros((HEIGHT, WIDTH), np.int8), TypeError, "but got dtype int8"),
    (np.zeros((HEIGHT, WIDTH), bool), TypeError, "but got dtype bool"),
    (np.zeros((HEIGHT, WIDTH, 3), np.uint8), ValueError, "but got shape (210, 340, 3)"),
    (np.zeros((WIDTH, HEIGHT), np.uint8), ValueError, "but got shape (340, 210)"),
    (np.zeros((0, 0), np.uint8), ValueError, "but got shape (0, 0)"),
    (np.zeros(HEIGHT * WIDTH, np.uint8), ValueError, "but got shape (71400,)"),
    (np.zeros((WIDTH, HEIGHT), np.uint8).T, ValueError, "pass numpy.ascontiguousarray(left)"),
    (np.zeros((HEIGHT, 2 * WIDTH), np.uint8)[:, ::2], ValueError, "rows are not contiguous"),
    (np.zeros((HEIGHT, WIDTH), np.uint8)[::-1], ValueError, "rows are not contiguous"),
    (np.broadcast_to(np.zeros((1, WIDTH), np.uint8), (HEIGHT, WIDTH)), ValueError, "rows are not contiguous"),
])
def test_wrong_images_are_refused(camera, image, right, wrong, error, text):
    odometry = cartvo.Odometry(camera)
    with pytest.raises(error) as raised:
        odometry.process(wrong, right, 0, 0)
    assert text in str(raised.value)
    with pytest.raises(error, match="right: expected"):
        odometry.process(image, wrong, 0, 0)
    assert odometry.process(image, right, 0, 0).reasons == ["first pair"]  # the pairs above left no trace


@pytest.mark.parametrize("instants", [(None, 0), (0.5, 0), ("0", 0), (1 << 63, 0), (1 << 62, 0), ((1 << 63) - 1, 0), (0, -(1 << 63))])
def test_wrong_instants_are_refused(camera, image, instants):
    with pytest.raises((TypeError, ValueError)):
        cartvo.Odometry(camera).process(image, image, *instants)


@pytest.mark.parametrize("stddev", [-1.0, math.nan, math.inf])
def test_wrong_offset_stddev_is_refused(camera, image, stddev):
    with pytest.raises(ValueError, match="offset_stddev"):
        cartvo.Odometry(camera).process(image, image, 0, 0, stddev)


def test_time_that_goes_back_is_a_reason(camera, image, right):
    odometry = cartvo.Odometry(camera)
    odometry.process(image, right, PERIOD_NS, PERIOD_NS)
    estimate = odometry.process(image, right, 0, 0)
    assert estimate.status == cartvo.Status.INVALID
    assert estimate.reasons == ["time step"]
    assert np.isnan(estimate.velocity).all()


def test_instants_far_apart_are_a_reason(camera, image, right):
    odometry = cartvo.Odometry(camera)
    most = (1 << 62) - 1
    for instants in ((most, -most), (-most, most), (0, 0), (most, most)):
        estimate = odometry.process(image, right, *instants)
        assert not estimate.valid and estimate.reasons


def test_results_outlive_the_odometry(camera, image):
    odometry = cartvo.Odometry(camera)
    estimate = odometry.process(image, image, 0, 0)
    del odometry
    gc.collect()
    np.testing.assert_array_equal(estimate.pose, np.eye(4))
    assert "INVALID" in repr(estimate)


def test_threads_process_one_at_a_time(camera, image):
    odometry = cartvo.Odometry(camera)
    results = []

    def work():
        results.extend(odometry.process(image, image, step, step) for step in range(5))

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(results) == 20


def test_settings(camera):
    settings = cartvo.Settings(features=500, estimator=cartvo.Estimator.THESIS)
    settings.validity.maximum_speed = 10.0
    assert settings.features == 500 and settings.validity.maximum_speed == 10.0
    cartvo.Odometry(camera, settings).set_features(200)
    with pytest.raises(TypeError, match="no setting 'feature'"):
        cartvo.Settings(feature=500)
    with pytest.raises(TypeError):
        settings.features = "many"
    with pytest.raises(ValueError, match="features"):
        cartvo.Odometry(camera, cartvo.Settings(features=1))
    with pytest.raises(ValueError, match="features"):
        cartvo.Odometry(camera).set_features(-1)


def test_tuned_constants(camera):
    constants = {constant.name: constant for constant in cartvo.tuned_constants()}
    frames, ratio = constants["window.pairs"], constants["stereo.uniqueness"]
    assert frames.is_integer and not ratio.is_integer and frames.low <= frames.default <= frames.high
    settings = cartvo.Settings()
    settings.set_constant("stereo.uniqueness", 0.5)
    assert settings.stereo.uniqueness == 0.5
    with pytest.raises(ValueError, match="no tuned constant 'stereo'"):
        settings.set_constant("stereo", 0.5)
    assert "validity.maximum_offset" in {limit.name for limit in cartvo.product_limits()}


def test_wrong_cameras_and_masks_are_refused(camera, image):
    with pytest.raises(ValueError, match="baseline"):
        cartvo.StereoCamera(240.0, 170.0, 105.0, -1.0, WIDTH, HEIGHT)
    with pytest.raises(ValueError, match="left_mask"):
        cartvo.Odometry(camera, left_mask=image[:-1])
    with pytest.raises(ValueError):
        cartvo.Odometry(camera, left_readout=math.nan)
    with pytest.raises(TypeError):
        cartvo.Odometry(None)
    black = np.zeros_like(image)
    masked = cartvo.Odometry(camera, left_mask=black, right_mask=black)
    assert masked.process(image, image, 0, 0).detected == 0


def test_first_arrays_of_several_threads_are_taken():
    program = """
import subprocess
import sys
import threading
import cartvo
import numpy as np
picture = np.zeros((4, 4), np.uint8)
start = threading.Barrier(8)
threads = [threading.Thread(target=lambda: (start.wait(), cartvo.Pair(picture, picture, 0, 0))) for _ in range(8)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
"""
    for _ in range(5):
        subprocess.run([sys.executable, "-c", program], check=True, timeout=60)
