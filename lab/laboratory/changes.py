"""Disturbances: copies of an image folder with lost pairs, changed pictures, instants or a wrong rig."""
import math
import os
import pathlib
import random
import re
import shutil

from laboratory.measure import Source, image_times, left_images, pose_rows
from laboratory.program import LabError

PAIRS, PICTURE, JUMPS, EXPOSURE, RIG = "pairs", "picture", "jumps", "exposure", "rig"
DISTURBANCES = {  # name: (kind, what it is)
    "none": ("", "the sequence as it is"),
    "lose10": (PAIRS, "10 % of the pairs are lost at random"),
    "lose20": (PAIRS, "20 %"),
    "lose30": (PAIRS, "30 %"),
    "bursts": (PAIRS, "a second of every four is lost"),
    "every2": (PAIRS, "only every second pair"),
    "every3": (PAIRS, "only every third pair"),
    "text": (PICTURE, "date and name are written into the pictures"),
    "strip": (PICTURE, "a part of the cart covers the lowest 15 % of the pictures"),
    "contrast": (PICTURE, "a third of the contrast"),
    "pitch-jumps": (JUMPS, "the cameras are turned by 5 degrees in pitch and back, each second"),
    "yaw-jumps": (JUMPS, "the same in yaw"),
    "half-period": (EXPOSURE, "the right camera is exposed half a period later; rendered drives only"),
    "swapped": (RIG, "left and right are exchanged"),
    "twice": (RIG, "both cameras are the left one"),
    "wrong-rig": (RIG, "the right camera is turned by 2 degrees of yaw and 1.2 of pitch against the rig file, and twice as far away"),
    "wrong-stamps": (RIG, "right pictures of the next pair"),
}
JUMP = math.radians(5.0)


def right_images(folder):
    name = next((name for name in ("image_1", "cam1/data", "mav0/cam1/data") if (folder / name).is_dir()), None)
    if name is None:
        raise LabError(f"{folder}: has no right images; expected image_1, cam1/data or mav0/cam1/data")
    return sorted(path for path in (folder / name).iterdir() if not path.name.startswith("."))


def times_of(folder):
    """Instants of the left and of the right images, s."""
    left = image_times(folder)
    if left is None:  # EuRoC: names are ns
        left, right = ([1e-9 * int(image.stem) for image in images] for images in (left_images(folder), right_images(folder)))
        return left, right
    right = folder / "times_1.txt"
    return left, [float(line) for line in right.read_text().split()] if right.exists() else left


def cartvo_rig(cartvo, folder, target):
    """The rig of a folder as a file of cartvo."""
    if (folder / "rig.yaml").exists():
        shutil.copy(folder / "rig.yaml", target)
        return target
    import cv2
    height, width = cv2.imread(str(left_images(folder)[0]), cv2.IMREAD_GRAYSCALE).shape
    files = [path for path in [folder / "calib.txt"] if path.exists()] or [
        found for side in "01" for found in [folder / f"cam{side}/sensor.yaml", folder / f"mav0/cam{side}/sensor.yaml"] if found.exists()]
    if not files:
        raise LabError(f"{folder}: has no rig; expected rig.yaml, calib.txt or cam0/sensor.yaml")
    size = ["--size", f"{width}x{height}"] if files[0].name == "calib.txt" else []
    cartvo.run("calibrate", "convert", *files, *size, "--unusual-geometry", "--output", target)
    return target


def write_folder(target, left, right, times, poses):
    """A folder of links, in the layout of cartvo simulate --render."""
    for camera, images, instants in (("0", left, times[0]), ("1", right, times[1])):
        (target / f"image_{camera}").mkdir(parents=True)
        for number, image in enumerate(images):
            os.symlink(image.resolve(), target / f"image_{camera}" / f"{number:06d}{image.suffix}")
        (target / f"times_{camera}.txt").write_text("".join(f"{time:.9f}\n" for time in instants))
    (target / "poses.txt").write_text("".join(poses))


def kept_pairs(name, times):
    """Numbers of the pairs that are not lost; the first is not."""
    rng = random.Random(7)
    keep = {"every2": lambda i: i % 2 == 0, "every3": lambda i: i % 3 == 0, "bursts": lambda i: int(times[i] - times[0]) % 4 != 3}.get(
        name, lambda _: rng.random() >= int(name.removeprefix("lose")) / 100.0)
    return [i for i in range(len(times)) if keep(i) or i == 0]


def simultaneous(times, period):
    """For each right image the left instant that is within half a period, each used once: its number and the instant."""
    partner, found = 0, []
    for number, right in enumerate(times[1]):
        while partner < len(times[0]) and times[0][partner] < right - period / 2:
            partner += 1
        if partner == len(times[0]):
            break
        if times[0][partner] <= right + period / 2:
            found.append((number, times[0][partner]))
            partner += 1
    return found


# Rig files of cartvo, by text: their values stand in lines that cartvo itself writes.


def matrix_of(text, name):
    """Rotation and translation of a transform in a rig file."""
    part = re.search(rf"^{name}:.*?translation: \[[^\]]*\]", text, re.S | re.M)
    rows = [[float(value) for value in row.split(",")] for row in re.findall(r"\[([^\]]*)\]", part[0])]
    return part, rows[:3], rows[3]


def with_matrix(text, name, rotation, translation):
    part, _, _ = matrix_of(text, name)
    lines = "".join(f"    - [{', '.join(f'{value:.17g}' for value in row)}]\n" for row in rotation)
    return (f"{text[:part.start()]}{name}:\n  rotation:\n{lines}  translation: [{', '.join(f'{value:.17g}' for value in translation)}]"
            f"{text[part.end():]}")


def rotation_about(axis, angle):
    """Of a camera's axis: 0 right (pitch), 1 down (yaw)."""
    import numpy as np
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]] if axis == 0 else [[c, 0, s], [0, 1, 0], [-s, 0, c]])


def wrong_rig(file):
    import numpy as np
    text = file.read_text()
    _, rotation, translation = matrix_of(text, "T_right_left")
    error = rotation_about(1, math.radians(2.0)) @ rotation_about(0, math.radians(1.2))
    file.write_text(with_matrix(text, "T_right_left", error @ np.array(rotation), [0.5 * value for value in translation]))


class Lens:
    """A camera of a rig file."""

    def __init__(self, text, side):
        import numpy as np
        part = re.search(rf"^{side}:\n((?:  .*\n)+)", text, re.M)[1]
        values = {name: float(re.search(rf"^  {name}: (\S+)", part, re.M)[1]) for name in ("fx", "fy", "cx", "cy")}
        self.matrix = np.array([[values["fx"], 0, values["cx"]], [0, values["fy"], values["cy"]], [0, 0, 1]])
        self.distortion = np.array([float(value) for value in re.search(r"distortion: \[([^\]]*)\]", part)[1].split(",")])
        self.is_wide = bool(re.search(r"^  lens: wide", part, re.M) or re.search(r"^lens: wide", text, re.M))

    def border(self, width, height, angle):
        """The part that a camera turned by the angle does not see at each side, px: the largest motion of a pixel of a pinhole camera."""
        (fx, _, cx), (_, fy, cy) = self.matrix[:2]
        x, y = max(cx, width - cx) / fx, max(cy, height - cy) / fy
        return math.ceil(max(fx, fy) * math.tan(angle) * (1 + max(x * x, y * y)))

    def turned_positions(self, width, height, border, rotation):
        """For each pixel of the smaller picture of a turned camera its place in the picture as it is."""
        import cv2
        import numpy as np
        x, y = np.meshgrid(np.arange(border, width - border, dtype=float), np.arange(border, height - border, dtype=float))
        points = np.stack([x, y], axis=-1).reshape(-1, 1, 2)
        model, distortion = (cv2.fisheye, self.distortion[:4]) if self.is_wide else (cv2, self.distortion)
        rays = cv2.convertPointsToHomogeneous(model.undistortPoints(points, self.matrix, distortion)).reshape(-1, 3) @ rotation.T
        places, _ = model.projectPoints(rays.reshape(-1, 1, 3), np.zeros(3), np.zeros(3), self.matrix, distortion)
        return places.reshape(x.shape[0], x.shape[1], 2).astype(np.float32)


def write_text(image, number):
    """Date, time and the name of the camera, as cameras write them into their pictures."""
    import cv2
    height, width = image.shape
    scale = width / 680.0
    for text, at in ((f"2026-11-26 Thu 10:42:{10 + number // 18 % 50}", (int(12 * scale), height // 12)),
                     ("Camera 01", (width * 2 // 3, height - height // 25))):
        for grey, thickness in ((0, 4), (255, 2)):
            cv2.putText(image, text, at, cv2.FONT_HERSHEY_SIMPLEX, 0.9 * scale, grey, max(1, int(thickness * scale)), cv2.LINE_8)
    return image


def cover_by_cart(image, is_left):
    """Part of the cart at the lower edge, a metre before the cameras."""
    import cv2
    import numpy as np
    rows, width = image.shape[0] * 15 // 100, image.shape[1]
    texture = np.random.default_rng(7).normal(90.0, 120.0, (rows, 2 * width)).clip(0, 255).astype(np.uint8)
    shift = 0 if is_left else width * 8 // 100
    image[-rows:] = cv2.GaussianBlur(texture, (0, 0), 2.0)[:, shift:shift + width]
    return image


def rewrite_pictures(target, change):
    """Replaces the links of a folder by pictures changed by change(image, is_left, number)."""
    import cv2
    for camera in "01":
        for number, file in enumerate(sorted((target / f"image_{camera}").iterdir())):
            image = change(cv2.imread(str(file), cv2.IMREAD_GRAYSCALE), camera == "0", number)
            file.unlink()
            if not cv2.imwrite(str(file.with_suffix(".png")), image, [cv2.IMWRITE_PNG_COMPRESSION, 1]):
                raise LabError(f"{file}: cannot be written")


def jump(name, target, rig, times, poses):
    """Turns both cameras by half of the jump to one side and to the other; the truth likewise. The truth of the turned poses."""
    import cv2
    import numpy as np
    text = rig.read_text()
    height, width = cv2.imread(str(left_images(target)[0]), cv2.IMREAD_GRAYSCALE).shape
    turns = [rotation_about(0 if name == "pitch-jumps" else 1, sign * JUMP / 2) for sign in (-1, 1)]
    _, right_left, _ = matrix_of(text, "T_right_left")
    right_left, lenses = np.array(right_left), (Lens(text, "left"), Lens(text, "right"))
    border = max(lens.border(width, height, JUMP / 2) for lens in lenses)
    if 2 * border >= min(width, height):
        raise LabError(f"{name}: the pictures are too small for a turn by 5 degrees")
    maps = [[lenses[0].turned_positions(width, height, border, turn),
             lenses[1].turned_positions(width, height, border, right_left @ turn @ right_left.T)] for turn in turns]
    side = [[int(max(time - times[0][0], 0.0)) % 2 for time in instants] for instants in times]
    rewrite_pictures(target, lambda image, is_left, number: cv2.remap(
        image, maps[side[0 if is_left else 1][number]][0 if is_left else 1], None, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE))
    for number in (0, 1):
        text = re.sub(rf"(^{('left', 'right')[number]}:\n(?:  .*\n)*?  cx: )(\S+)(\n  cy: )(\S+)",
                      lambda m: f"{m[1]}{float(m[2]) - border!r}{m[3]}{float(m[4]) - border!r}", text, count=1, flags=re.M)
    rig.write_text(re.sub(r"^image_size: .*$", f"image_size: [{width - 2 * border}, {height - 2 * border}]", text, count=1, flags=re.M))
    true_poses = [np.array([*map(float, row.split())]).reshape(3, 4) for row in poses]
    turned = [np.hstack([pose[:, :3] @ turns[which], pose[:, 3:]]) for pose, which in zip(true_poses, side[0])]
    first = np.linalg.inv(np.vstack([turned[0], [0, 0, 0, 1]]))
    rows = [(first @ np.vstack([pose, [0, 0, 0, 1]]))[:3].ravel() for pose in turned]
    return [" ".join(f"{value:.12e}" for value in row) + "\n" for row in rows]


def changed(cartvo, source, name, target):
    """The source with a disturbance, or with the left instants for both pictures ("simultaneous"), as a folder of its own."""
    left, right, times, poses = left_images(source.folder), right_images(source.folder), times_of(source.folder), pose_rows(source.poses)
    kind, body = DISTURBANCES.get(name, ("", ""))[0], source.body
    if kind == PAIRS:
        kept = kept_pairs(name, times[0])
        left, right, poses = ([items[i] for i in kept if i < len(items)] for items in (left, right, poses))
        times = tuple([instants[i] for i in kept if i < len(instants)] for instants in times)
    elif name == "simultaneous":
        period = min((ones[-1] - ones[0]) / (len(ones) - 1) for ones in times)
        partners = simultaneous(times, period)
        right, times = [right[number] for number, _ in partners], (times[0], [time for _, time in partners])
    elif name == "swapped":
        left, right = right, left
    elif name == "twice":
        right = left[:len(right)]
    elif name == "wrong-stamps":
        right, times = right[1:], (times[0], times[1][:-1])
    write_folder(target, left, right, times, poses)
    rig = cartvo_rig(cartvo, source.folder, pathlib.Path(target) / "rig.yaml")
    if name == "wrong-rig":
        wrong_rig(rig)
    if kind == PICTURE:
        rewrite_pictures(target, {"text": lambda image, _, number: write_text(image, number), "strip": lambda image, is_left, _: cover_by_cart(
            image, is_left), "contrast": lambda image, _, __: (image / 3.0 + 85.0).round().astype("uint8")}[name])
    if kind == JUMPS:
        (target / "poses.txt").write_text("".join(jump(name, target, rig, times, poses)))
        body = None
    return Source(target, target / "poses.txt", body, rig, kind == JUMPS)
