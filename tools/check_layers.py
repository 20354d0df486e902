#!/usr/bin/env python3
"""tools/check_layers.py: holds the includes to the layers of docs/architecture.md.

A source includes headers of its own room and of rooms below it in LAYERS, never above; no include names "..";
vo_core, capture and calib do not include each other; only tests include lab. No folder of sources holds more than 30 sources, no source more
than 400 lines.
"""
import collections
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
MOST_SOURCES, MOST_LINES = 30, 400

# Lowest first. A file that is named stands for itself, a folder for all that lies in it and is not named.
LAYERS = {
    "vo_core": [
        "vo_core/rigid_motion vo_core/stereo_camera vo_core/stereo_masks vo_core/odometry_settings vo_core/stage_observer vo_core/key_frames "
        "vo_core/odometry_reason vo_core/rig_calibration_error vo_core/image_region vo_core/landmark_view vo_core/shutter vo_core/tuned_constants "
        "vo_core/fixed_constants vo_core/self_calibration_settings",
        "vo_core/odometry_estimate",
        "vo_core/simd",
        "vo_core/geometry vo_core/image",
        "vo_core/stereo",
        "vo_core/tracking",
        "vo_core/estimation",
        "vo_core/self_calibration",
        "vo_core/integrity",
        "vo_core/window",
        "vo_core/odometry_method",
        "vo_core/track vo_core/thesis",
        "vo_core",
    ],
    "capture": ["capture/frame capture/camera_side capture/camera_source capture/encoded_unit", "capture/codec", "capture/clock",
                "capture", "capture/rtsp capture/v4l2", "capture/isapi", "capture/recording", "capture/dataset", "capture/stereo_source"],
    "calib": ["calib/model", "calib/rectification", "calib/board", "calib/format", "calib/solver"],
    "daemon": ["daemon/publish", "daemon/diagnostics", "daemon/page", "daemon/service"],
}
# The folders that each top folder may include beside itself.
BELOW = {
    "common": set(),
    "vo_core": {"common"},
    "capture": {"common"},
    "calib": {"common"},
    "client": set(),
    "pipeline": {"common", "vo_core", "capture", "calib"},
    "daemon": {"common", "vo_core", "capture", "calib", "pipeline", "cartvo"},
}
MAY_USE_LAB = ("lab/", "tests/")
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.MULTILINE)


def layer_of(path: str, layers: list[str]) -> int | None:
    """Index of the layer that names the file, else its closest folder."""
    name = path.rsplit(".", 1)[0]
    while name:
        for index, members in enumerate(layers):
            if name in members.split():
                return index
        name = name.rpartition("/")[0]
    return None


def problems_of(path: str) -> list[str]:
    text = (ROOT / path).read_text()
    top = path.split("/")[0]
    problems = []
    if (lines := text.count("\n")) > MOST_LINES:
        problems.append(f"{path}: {lines} lines: at most {MOST_LINES}; split it by responsibility")
    for included in INCLUDE.findall(text):
        if ".." in included.split("/"):
            problems.append(f"{path}: includes {included}: name the path from the root of the repository")
        if included.startswith("lab/") and not path.startswith(MAY_USE_LAB):
            problems.append(f"{path}: includes {included}: lab is a user of the product")
        if top not in BELOW:
            continue
        other = included.split("/")[0]
        if other != top:
            allowed = BELOW[top]
            if other in BELOW and other not in allowed:
                problems.append(f"{path}: includes {included}: {top} may use {', '.join(sorted(allowed)) or 'nothing'}")
            continue
        if top in LAYERS:
            own, theirs = layer_of(path, LAYERS[top]), layer_of(included, LAYERS[top])
            if own is None or theirs is None:
                problems.append(f"{path if own is None else included}: in no layer of tools/check_layers.py")
            elif theirs > own:
                problems.append(f"{path}: includes {included}, which lies above it (LAYERS in tools/check_layers.py)")
    return problems


def main() -> int:
    if {"-h", "--help"} & set(sys.argv[1:]):
        print(__doc__.rstrip())
        return 0
    paths = [path for path in subprocess.run(["git", "-C", ROOT, "ls-files", "*.cpp", "*.hpp"], capture_output=True,
                                             text=True, check=True).stdout.splitlines() if (ROOT / path).is_file()]
    problems = [problem for path in paths for problem in problems_of(path)]
    for folder, count in collections.Counter(path.rpartition("/")[0] for path in paths).items():
        if count > MOST_SOURCES:
            problems.append(f"{folder}: {count} sources: at most {MOST_SOURCES} in a folder")
    print("\n".join(problems) if problems else f"check_layers: {len(paths)} sources: in order")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
