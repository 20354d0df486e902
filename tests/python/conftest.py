"""Shared parts of the tests of the Python package. $CARTVO_TEST_DRIVE is the folder of tests/library/make_drive.py."""
import os
import pathlib

import cartvo
import numpy as np
import pytest

WIDTH, HEIGHT = 340, 210
PERIOD_NS = 100_000_000


@pytest.fixture(scope="session")
def drive():
    """The folder of a short drive."""
    folder = os.environ.get("CARTVO_TEST_DRIVE")
    if not folder:
        pytest.skip("CARTVO_TEST_DRIVE is not set: run by ctest")
    return pathlib.Path(folder)


@pytest.fixture(scope="session")
def rectifier(drive):
    return cartvo.Rectifier(cartvo.Rig.load(drive / "images/rig.yaml"))


@pytest.fixture
def camera():
    return cartvo.StereoCamera(focal_length=240.0, cx=170.0, cy=105.0, baseline=0.115, width=WIDTH, height=HEIGHT)


@pytest.fixture
def image():
    """A textured image, the same in each test."""
    return np.random.default_rng(1).integers(0, 256, (HEIGHT, WIDTH), np.uint8)


@pytest.fixture
def right(image):
    """The image that belongs to it, at a disparity of 5 px."""
    return np.roll(image, -5, axis=1)
