"""Rig files, rectification, and the reader of recordings."""
import gc

import cartvo
import numpy as np
import pytest
from conftest import HEIGHT, WIDTH


def test_rig(drive, tmp_path):
    rig = cartvo.Rig.load(drive / "images/rig.yaml")
    assert rig.name == "simulated golf cart" and rig.left.size == (WIDTH, HEIGHT)
    assert rig.left.readout == 0.032 and not rig.left.is_wide and rig.left.distortion.shape == (8,)
    assert rig.baseline == pytest.approx(0.115, rel=0.01)
    assert rig.T_right_left.shape == (4, 4) and rig.T_body_camera[2, 3] == 1.9
    rig.save(tmp_path / "copy.yaml")
    assert cartvo.Rig.load(str(tmp_path / "copy.yaml")).text == rig.text == cartvo.Rig.parse(rig.text).text


def test_wrong_rig_files_are_refused(tmp_path):
    with pytest.raises(RuntimeError, match="absent.yaml"):
        cartvo.Rig.load(tmp_path / "absent.yaml")
    (tmp_path / "wrong.yaml").write_text("cartvo_rig: 1\nname: 3\nwrong: 1\n")
    with pytest.raises(RuntimeError, match="wrong.yaml"):
        cartvo.Rig.load(tmp_path / "wrong.yaml")
    with pytest.raises(TypeError):
        cartvo.Rig.load(None)
    with pytest.raises(TypeError):
        cartvo.Rectifier(None)


def test_rectifier(drive, rectifier):
    pair = next(cartvo.Recording(drive / "images"))
    left, right = rectifier.rectify(pair.left, pair.right)
    assert left.dtype == np.uint8 and left.shape == right.shape == (HEIGHT, WIDTH) and left.flags.writeable
    assert not np.array_equal(left, pair.left)
    camera = rectifier.camera
    assert (camera.width, camera.height) == (WIDTH, HEIGHT) and camera.baseline == pytest.approx(rectifier.rig.baseline)
    assert rectifier.left_mask is None
    with pytest.raises(ValueError, match=r"right: expected .* shape \(210, 340\), but got shape \(209, 340\)"):
        rectifier.rectify(pair.left, pair.right[1:])


def test_recording(drive):
    recording = cartvo.Recording(drive / "recording")
    assert recording.is_recording and recording.rig.left.size == (WIDTH, HEIGHT)
    pairs = list(recording)
    assert len(pairs) >= 30 and recording.problems == []
    with pytest.raises(StopIteration):
        next(recording)
    instants = [pair.left_exposure_ns for pair in pairs]
    assert instants == sorted(instants) and instants[0] > 1_600_000_000_000_000_000
    assert any(pair.key_frames[0] for pair in pairs) and not all(pair.key_frames[0] for pair in pairs)
    assert all(pair.offset_stddev > 0.0 for pair in pairs)


def test_images_are_views_that_outlive_the_recording(drive):
    pair = next(cartvo.Recording(drive / "recording"))
    left = pair.left
    assert np.shares_memory(left, pair.left) and not left.flags.writeable
    total = int(left.sum())
    del pair
    gc.collect()
    assert int(left.sum()) == total
    with pytest.raises(ValueError):
        left[0, 0] = 0
    with pytest.raises(ValueError):
        left.setflags(write=True)


def test_pair_of_arrays(rectifier):
    left, right = np.zeros((HEIGHT, WIDTH), np.uint8), np.ones((HEIGHT, WIDTH), np.uint8)
    pair = cartvo.Pair(left, right, 10, 20, 0.001)
    assert pair.left is left and pair.right is right and (pair.t_left, pair.t_right) == (10, 20)
    assert pair.offset_stddev == pytest.approx(0.001)
    processor = cartvo.PairProcessor(rectifier.rig)
    assert processor.process(pair).status == cartvo.Status.INVALID
    with pytest.raises(ValueError, match=r"left: expected shape \(210, 340\) as in the rig, but got \(5, 6\)"):
        processor.process(cartvo.Pair(left[:5, :6], right, 10, 20))
    with pytest.raises(TypeError):
        processor.process(None)
    with pytest.raises(TypeError, match="right: expected"):
        cartvo.Pair(left, None, 10, 20)


def test_wrong_folders_are_refused(tmp_path):
    for folder in (tmp_path, tmp_path / "absent"):
        with pytest.raises(RuntimeError, match=folder.name):
            cartvo.Recording(folder)
    with pytest.raises(TypeError):
        cartvo.Recording(None)
