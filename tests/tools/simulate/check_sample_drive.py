#!/usr/bin/env python3
"""Usage: check_sample_drive.py CARTVO FOLDER: the sample drive is whole, and a replay of it is as good as the pages say."""
import json
import pathlib
import subprocess
import sys
import tempfile

BYTES_AT_MOST = 8_000_000
SEGMENTS_AT_MOST = 0.25  # %
AVAILABLE_AT_LEAST = 95  # %


def main(cartvo, folder):
    folder = pathlib.Path(folder)
    subprocess.run(["sha256sum", "--check", "--quiet", "--strict", "SHA256SUMS"], cwd=folder, check=True)
    size = sum(file.stat().st_size for file in folder.rglob("*") if file.is_file())
    assert size <= BYTES_AT_MOST, f"{size} bytes"
    with tempfile.TemporaryDirectory() as output:
        replay = [cartvo, "replay", folder, "--output-dir", output, "--truth", folder / "truth.tum", "--json"]
        summary = json.loads(subprocess.run(replay, check=True, capture_output=True, text=True).stdout)
        command = [cartvo, "evaluate", "--json", f"{output}/odometry.csv", folder / "truth.tum"]
        result = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    validity = result["validity"]
    segments = result["segments_5_to_40_m"]["translation_percent"]
    assert validity["above_limit"] == 0, validity
    assert validity["available_percent"] >= AVAILABLE_AT_LEAST, validity
    assert segments <= SEGMENTS_AT_MOST, segments
    of_replay, consistency = summary["evaluation"], summary["consistency"]
    assert of_replay["poses"] == result["poses"] and of_replay["segments_5_to_40_m"]["translation_percent"] <= SEGMENTS_AT_MOST, of_replay
    assert consistency["nees_motion"]["samples"] >= AVAILABLE_AT_LEAST / 100 * of_replay["poses"] - consistency["standing_pairs"], consistency
    assert consistency["nees_velocity"]["mean"] > 0 and consistency["rate_error_deg_s"] < consistency["true_rate_deg_s"], consistency


if __name__ == "__main__":
    main(*sys.argv[1:])
