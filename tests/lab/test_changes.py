"""Disturbances of a tiny drive."""
import math

import pytest

cv2 = pytest.importorskip("cv2")
np = pytest.importorskip("numpy")

from laboratory import changes, measure, speed  # noqa: E402
from laboratory.program import LabError  # noqa: E402

PAIRS, SIZE = 72, (200, 320)  # four seconds at 18 Hz
RIG = """cartvo_rig: 1
image_size: [320, 200]
left:
  fx: 240
  fy: 240
  cx: 160
  cy: 100
  distortion: [-0.1, 0, 0, 0, 0, 0, 0, 0]
right:
  fx: 240
  fy: 240
  cx: 160
  cy: 100
  distortion: [0, 0, 0, 0, 0, 0, 0, 0]
T_right_left:
  rotation:
    - [1, 0, 0]
    - [0, 1, 0]
    - [0, 0, 1]
  translation: [-0.1, 0, 0]
# the end
"""


@pytest.fixture
def source(tmp_path):
    folder = tmp_path / "drive"
    rng = np.random.default_rng(1)
    for camera in "01":
        (folder / f"image_{camera}").mkdir(parents=True)
        for pair in range(PAIRS):
            picture = cv2.GaussianBlur(rng.integers(0, 256, SIZE).astype(np.uint8), (0, 0), 2.0)
            cv2.imwrite(str(folder / f"image_{camera}/{pair:06d}.png"), picture)
        (folder / f"times_{camera}.txt").write_text("".join(f"{pair / 18 + 0.02 * int(camera):.9f}\n" for pair in range(PAIRS)))
    (folder / "poses.txt").write_text("# poses\n" + "".join(f"1 0 0 0 0 1 0 0 0 0 1 {0.1 * pair}\n" for pair in range(PAIRS)))
    (folder / "rig.yaml").write_text(RIG)
    return measure.source_of(folder, tmp_path)


def pictures(source, camera):
    return [cv2.imread(str(file), cv2.IMREAD_GRAYSCALE) for file in sorted((source.folder / f"image_{camera}").iterdir())]


def names(source, camera):
    return [file.resolve().name for file in sorted((source.folder / f"image_{camera}").iterdir())]


def changed(source, name):
    return changes.changed(None, source, name, source.folder.parent / name)


@pytest.mark.parametrize("name, count", [("every2", 36), ("every3", 24), ("bursts", 54)])
def test_pairs_are_lost_with_their_truth(source, name, count):
    lost = changed(source, name)
    kept = names(lost, 0)
    assert len(kept) == count == len(names(lost, 1)) == len(measure.pose_rows(lost.poses)) == len(measure.image_times(lost.folder))
    last = int(kept[-1][:6])
    assert float(measure.pose_rows(lost.poses)[-1].split()[11]) == pytest.approx(0.1 * last)
    assert measure.image_times(lost.folder)[-1] == pytest.approx(last / 18)


def test_random_pairs_are_the_same_each_time(source):
    times = measure.image_times(source.folder)
    kept = changes.kept_pairs("lose30", times)
    assert kept == changes.kept_pairs("lose30", times) and kept[0] == 0 and 0.5 * PAIRS < len(kept) < 0.9 * PAIRS


def test_pictures_change_in_their_part_only(source):
    before = pictures(source, 0)[3]
    text, strip, contrast = (pictures(changed(source, name), 0)[3] for name in ("text", "strip", "contrast"))
    assert (text == before).mean() > 0.5 and (text != before).any()
    assert (strip[:170] == before[:170]).all() and (strip[170:] != before[170:]).mean() > 0.9
    assert np.abs(contrast - (before / 3.0 + 85.0)).max() <= 0.5
    shifted = pictures(measure.Source(source.folder.parent / "strip", source.poses), 1)[3]
    assert (shifted[170:, :290] == strip[170:, 25:315]).mean() > 0.99, "the cart is nearer than all else: 8 % of the width"


@pytest.mark.parametrize("name, axis", [("pitch-jumps", 0), ("yaw-jumps", 1)])
def test_jumps_turn_pictures_rig_and_truth(source, name, axis):
    turned = changed(source, name)
    border = int(160 - changes.Lens(turned.rig.read_text(), "left").matrix[0, 2])
    assert turned.has_jumps and pictures(turned, 0)[0].shape == (SIZE[0] - 2 * border, SIZE[1] - 2 * border)
    rows = [np.array([*map(float, row.split())]).reshape(3, 4) for row in measure.pose_rows(turned.poses)]
    assert np.allclose(rows[0], np.eye(4)[:3], atol=1e-9) and np.allclose(rows[17][:, :3], np.eye(3), atol=1e-9)
    assert np.allclose(rows[18][:, :3], changes.rotation_about(axis, math.radians(5.0)), atol=1e-9)
    seen = cv2.phaseCorrelate(np.float64(pictures(turned, 0)[20]), np.float64(pictures(source, 0)[20][border:-border, border:-border]))[0]
    assert abs(seen[1 if axis == 0 else 0]) == pytest.approx(240 * math.tan(math.radians(2.5)), abs=1.5)


def test_faults_of_the_rig_exchange_pictures(source):
    swapped = changed(source, "swapped")
    assert (pictures(swapped, 0)[5] == pictures(source, 1)[5]).all() and (pictures(swapped, 1)[5] == pictures(source, 0)[5]).all()
    twice = changed(source, "twice")
    assert (pictures(twice, 1)[5] == pictures(source, 0)[5]).all()
    stamps = changed(source, "wrong-stamps")
    assert names(stamps, 1)[0] == "000001.png" and len(names(stamps, 1)) == PAIRS - 1
    wrong = changed(source, "wrong-rig").rig.read_text()
    _, rotation, translation = changes.matrix_of(wrong, "T_right_left")
    assert translation == [-0.05, 0.0, 0.0] and rotation[0][2] == pytest.approx(math.sin(math.radians(2.0)) * math.cos(math.radians(1.2)))
    assert wrong.endswith("# the end\n") and source.folder.joinpath("rig.yaml").read_text() == RIG


def test_simultaneous_pictures_have_the_left_instant(source):
    both = changed(source, "simultaneous")
    assert (both.folder / "times_0.txt").read_text() == (both.folder / "times_1.txt").read_text()
    assert changes.simultaneous(([0.0, 0.1, 0.2], [0.06, 0.16, 0.26]), 0.1) == [(0, 0.1), (1, 0.2)]


def test_errors_of_seconds_are_those_of_their_motions():
    rows = [f"1 0 0 0 0 1 0 0 0 0 1 {0.1 * i}" for i in range(25)]
    off = [f"1 0 0 {0.01 * i} 0 1 0 0 0 0 1 {0.1 * i}" for i in range(25)]
    assert measure.errors_per_second(off, rows, [0.1 * i for i in range(25)]) == [pytest.approx(0.1)] * 2


def test_the_truth_of_pairs_is_found_by_time(source, tmp_path):
    messages = [{"utime_us": str(round(1e6 * pair / 18))} for pair in (0, 2, 5)]
    rows = measure.pose_rows(measure.rows_of_pairs(source, messages, tmp_path))
    assert [float(row.split()[11]) for row in rows] == pytest.approx([0.0, 0.2, 0.5])
    (source.folder / "times_0.txt").unlink()
    with pytest.raises(LabError, match="72 true poses, 3 pairs and no time"):
        measure.rows_of_pairs(source, messages, tmp_path)


def test_a_standing_camera_has_equal_poses(source, tmp_path):
    (source.folder / "poses.txt").unlink()
    assert len(set(measure.pose_rows(measure.source_of(source.folder, tmp_path).poses))) == 1


def test_a_folder_without_images_or_rig_is_named(tmp_path):
    with pytest.raises(LabError, match="has no left images"):
        measure.left_images(tmp_path)
    with pytest.raises(LabError, match="has no right images"):
        changes.right_images(tmp_path)


def test_the_reference_needs_texture(source, tmp_path):
    images = measure.left_images(source.folder)[:3]
    assert min(speed.reference_ms(images).values()) > 0.0
    for number in range(2):
        cv2.imwrite(str(tmp_path / f"{number}.png"), np.full(SIZE, 100, np.uint8))
    assert speed.reference_ms(sorted(tmp_path.glob("*.png"))) is None, "fewer than 1,000 corners"
