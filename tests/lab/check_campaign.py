#!/usr/bin/env python3
"""check_campaign.py CAMPAIGN CARTVO: the table, files and exit code of lab/campaign, with a replay of made-up messages.

The messages of a drive at 2 m/s, judged by the real `cartvo evaluate`. With an unknown readout one of them is off by 1 m/s if
the environment has FAULT, and states that it may be off by 100 m/s.
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

PAIRS, PERIOD = 40, 0.1
REPLAY = """#!/usr/bin/env python3
import os, pathlib, sys
arguments = sys.argv[1:]
if arguments[0] != "replay":
    os.execv({cartvo!r}, [{cartvo!r}, *arguments])
out = pathlib.Path(arguments[arguments.index("--output-dir") + 1])
readout = arguments[arguments.index("--readout-ms") + 1]
triangle = [f"c{{i}}" for i in range(20)]
names = ["pair", "utime_us", "valid", "reasons", "reset_counter", "x_m", "y_m", "z_m", "qw", "qx", "qy", "qz", "vx_m_s", "vy_m_s",
         "vz_m_s", "wx_rad_s", "wy_rad_s", "wz_rad_s", "pose_covariance_x_x", *triangle, "twist_covariance_vx_vx", *triangle,
         *(f"{{q}}_bound_{{axis}}" for q in ("velocity", "angular_rate", "motion", "rotation") for axis in "xyz")]
rows = [names]
for pair, time in enumerate(map(float, open(arguments[1] + "/times_0.txt"))):
    off = readout == "unknown" and pair == 10 and "FAULT" in os.environ
    rows.append([pair, round(1e6 * time), int(pair > 0), 0, 0, 2.0 * time, 0, 0, 1, 0, 0, 0, 3.0 if off else 2.0, 0, 0, 0, 0, 0,
                 *[1.0] * 42, *[100.0 if off else 0.1] * 12])
(out / "odometry.csv").write_text("".join(",".join(map(str, row)) + "\\n" for row in rows))
"""


def write_drive(folder):
    for camera in "01":
        (folder / f"image_{camera}").mkdir(parents=True)
        for pair in range(PAIRS):
            (folder / f"image_{camera}" / f"{pair:06d}.png").touch()
        (folder / f"times_{camera}.txt").write_text("".join(f"{1.0 + PERIOD * pair:.9f}\n" for pair in range(PAIRS)))
    (folder / "rig.yaml").write_text("left:\n  readout: 0.03  # s\nright:\n  readout: 0.03  # s\n")
    (folder / "truth.tum").write_text("".join(f"{PERIOD * i:.9f} {2.0 * PERIOD * i} 0 0 0 0 0 1\n" for i in range(PAIRS + 15)))


def main():
    campaign, cartvo = sys.argv[1], str(pathlib.Path(sys.argv[2]).resolve())
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        write_drive(folder / "drive")
        program = folder / "cartvo"
        program.write_text(REPLAY.format(cartvo=cartvo))
        program.chmod(0o755)

        def run(**environment):
            return subprocess.run([campaign, folder / "drive", "--output", folder / "out", "--cartvo", program, "--features", "1000",
                                   "--starts", "2"], capture_output=True, text=True, env={**os.environ, **environment})

        good = run()
        assert good.returncode == 0, good
        assert "met     VALID messages above an alert limit: 0: 0" in good.stdout, good.stdout
        document = json.loads((folder / "out/campaign.json").read_text())
        assert [row["readout"] for row in document["rows"]] == ["+10%", "-10%", "told", "unknown"], document["rows"]
        from_within = sum(1 for replay in document["replays"] if replay["cut"] == "from-26")
        assert from_within == 4 and document["total"]["above_bound"] == 0, document["total"]
        assert (folder / "out/messages.csv").read_text().count("\n") == 1 + document["total"]["messages"]
        assert "#d55e00" not in (folder / "out/stanford.svg").read_text(), "no error is above its bound"

        fault = run(FAULT="1")
        assert fault.returncode == 1, fault
        rows = {row["readout"]: row for row in json.loads((folder / "out/campaign.json").read_text())["rows"]}
        assert rows["unknown"]["above_limit"] == 4 and rows["told"]["above_limit"] == 0, rows
        assert rows["unknown"]["largest_velocity_error_m_s"] > 0.99, rows
        assert rows["unknown"]["above_bound"] == 0, rows

        (folder / "drive/truth.tum").write_text("5 0 0 0 0 0 0 1\n")
        broken = run()
        assert broken.returncode == 1 and "failed: " in broken.stdout, broken


if __name__ == "__main__":
    main()
