#!/usr/bin/env python3
"""make_drive.py CARTVO CARTVOD FOLDER: makes a short drive for the tests of the library.

FOLDER then holds the drive as images (images), as recorded by cartvod from two simulated cameras (recording), what `cartvo
replay` makes of both (replay-images, replay-recording), and two LCM messages (odometry.bin, health.bin). Run by tests/support/in_network_namespace.sh.
"""
import pathlib
import shutil
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from running_cart import VALID, WIDE_LIMITS, Cameras, Daemon, Listener, await_, camera_section  # noqa: E402

CONTENT = ["--world", "loop", "--seconds", "4", "--size", "340x210", "--frame-rate", "9"]
STATUS = 8 + 7 * 8  # offset of odometry_t.status, after the fingerprint and seven numbers of 8 bytes
LEAST_MESSAGES = 30  # VALID, of the recorded seconds


def body(datagram):
    """The message in a datagram of LCM."""
    return datagram[8:].partition(b"\0")[2]


def valid_body(datagram):
    """As above, if it is an odometry_t that is VALID; else nothing."""
    message = body(datagram)
    return message if message[STATUS:STATUS + 1] == bytes([VALID]) else b""


def record(cartvo, cartvod, folder):
    cameras = Cameras(cartvo, folder / "cameras", ["--sequence", folder / "images"])
    listener = Listener()
    begin = time.time()
    daemon = Daemon(cartvod, folder / "daemon",
                    camera_section(cameras.urls, cameras.password_file) + f"rig: {folder}/images/rig.yaml\nodometry: {{{WIDE_LIMITS}}}\n",
                    arguments=["--record", folder / "recordings"])
    try:
        await_(lambda: len(listener.valid_since(begin)) >= LEAST_MESSAGES, "odometry while recording")
        odometry = await_(lambda: valid_body(listener.last_odometry), "a VALID message")
        health = await_(lambda: body(listener.problems()), "a message of health")
    except AssertionError as error:
        raise AssertionError(f"{error}; the log:\n{daemon.text()}") from None
    (folder / "odometry.bin").write_bytes(odometry)
    (folder / "health.bin").write_bytes(health)
    assert daemon.stop() == 0, daemon.text()
    cameras.stop()
    (recording,) = (path.parent for path in (folder / "recordings").glob("**/recording.json"))
    recording.rename(folder / "recording")


def main():
    cartvo, cartvod, folder = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    subprocess.run([cartvo, "simulate", *CONTENT, "--render", "--output-dir", folder / "images"], check=True, stdout=subprocess.DEVNULL)
    record(cartvo, cartvod, folder)
    for source, options in (("images", []), ("recording", ["--clock", "recorded"])):
        subprocess.run([cartvo, "replay", folder / source, *options, "--output-dir", folder / f"replay-{source}"], check=True,
                       stdout=subprocess.DEVNULL)


if __name__ == "__main__":
    main()
