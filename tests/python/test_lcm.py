"""Messages of cartvod, as it sent them, and bytes that are none."""
import random
import zlib

import cartvo.lcm
import numpy as np
import pytest


@pytest.fixture(scope="module")
def odometry_bytes(drive):
    return (drive / "odometry.bin").read_bytes()


@pytest.fixture(scope="module")
def health_bytes(drive):
    return (drive / "health.bin").read_bytes()


def test_odometry(odometry_bytes):
    message = cartvo.lcm.decode_odometry(odometry_bytes)
    assert message.status == cartvo.Status.VALID and message.valid and message.reasons in ([], ["zero velocity"])
    assert message.utime < message.publication_utime < message.utime + 60_000_000
    assert message.position.shape == (3,) and np.linalg.norm(message.orientation) == pytest.approx(1.0)
    assert message.pose_covariance.shape == (6, 6)
    np.testing.assert_allclose(message.twist_covariance, message.twist_covariance.T)
    assert message.features >= message.inliers > 0
    assert message.source_id > 0 and 0 < message.quality <= 100
    for bound in (message.velocity_bound, message.angular_rate_bound, message.motion_bound, message.rotation_bound):
        assert bound.shape == (3,) and np.all(bound > 0.0)
    moves = "zero velocity" not in message.reasons
    assert np.all(np.isfinite(message.acceleration) == moves) and message.acceleration_covariance.shape == (3, 3)
    assert zlib.crc32(odometry_bytes[:-4]) == int.from_bytes(odometry_bytes[-4:], "big"), "the message's own check sum"
    assert message.encode() == odometry_bytes
    assert cartvo.lcm.decode_odometry(bytearray(odometry_bytes)).utime == message.utime
    assert cartvo.lcm.decode_odometry(memoryview(odometry_bytes)).utime == message.utime


def test_health(health_bytes):
    message = cartvo.lcm.decode_health(health_bytes)
    assert message.version == cartvo.__version__ and message.left.state == cartvo.lcm.CameraState.STREAMING
    assert message.pairs > 0 and message.right.frames > 0 and message.left.last_error == ""
    assert message.odometry_state in ("tracking", "standstill", "lost")
    assert message.right_rotation_deg.shape == (3,) and message.bound_exceeded == ""
    assert message.encode() == health_bytes


def test_other_bytes_are_refused(odometry_bytes, health_bytes):
    for decode, data in ((cartvo.lcm.decode_odometry, odometry_bytes), (cartvo.lcm.decode_health, health_bytes)):
        for wrong in (b"", data[:7], data[:-1], data + b"\0", b"\0" * len(data), odometry_bytes + health_bytes):
            with pytest.raises(ValueError, match="are not a message of type cartvo"):
                decode(wrong)
        with pytest.raises(TypeError):
            decode(None)
        with pytest.raises(TypeError):
            decode("text")
        with pytest.raises(ValueError, match="contiguous"):
            decode(memoryview(data)[::2])
    with pytest.raises(ValueError):
        cartvo.lcm.decode_odometry(health_bytes)


def test_damaged_odometry_is_refused(odometry_bytes):
    for at in range(len(odometry_bytes)):
        damaged = bytearray(odometry_bytes)
        damaged[at] ^= 1 + at % 255
        with pytest.raises(ValueError, match="changed on its way|are not a message"):
            cartvo.lcm.decode_odometry(damaged)


def test_damaged_bytes_crash_nothing(health_bytes):
    generator = random.Random(1)
    decoded = 0
    for _ in range(20_000):
        data = bytearray(health_bytes)
        for _ in range(generator.randint(1, 4)):
            data[generator.randrange(8, len(data))] = generator.choice((0, 1, 127, 128, 255))
        try:
            message = cartvo.lcm.decode_health(data)
        except ValueError:
            continue
        decoded += 1
        assert isinstance(message.problem + message.left.last_error + repr(message.left.state), str)
    assert 0 < decoded < 20_000
