#!/usr/bin/env python3
"""check_page.py packages PACKAGES | CARTVO CARTVOD CACHE PACKAGES [PICTURES]: the status page of cartvod in Chromium.

Two simulated cameras repeat a drive, cached in the folder CACHE. page/check_page.mjs drives the browser; where it says so, the
cameras or cartvod are stopped and started. Screenshots go to the folder PICTURES. Run by
tests/support/in_network_namespace.sh. Before, and where npm has a network, 'packages' installs playwright-core into the folder
PACKAGES. Without npm or Chromium the test is skipped (77), or fails with CARTVO_REQUIRE_DATA=1.
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "support"))
from check_faults import CONTENT, TIMEOUTS  # noqa: E402
from running_cart import WIDE_LIMITS, Cameras, Daemon, camera_section, start  # noqa: E402

PORT = 9465
TOKEN = "a-token-of-the-test"


def packages_problem(packages):
    """Why the browser cannot be driven; None if it can."""
    if not (shutil.which("chromium") or os.environ.get("CARTVO_CHROMIUM")):
        return "chromium is not installed (apt-get install chromium)"
    install = subprocess.run([HERE.parent / "support/npm/install.sh", packages, HERE / "page/check_page.mjs"], capture_output=True,
                             text=True, check=False)
    return install.stdout.strip() if install.returncode else None


def configuration(cameras, folder):
    token = folder / "token"
    token.touch(0o600)
    token.write_text(TOKEN)
    return (camera_section(cameras.urls, cameras.password_file, TIMEOUTS) + f"rig: {cameras.folder / 'rig.yaml'}\n"
            f"odometry: {{{WIDE_LIMITS}}}\n"
            f"recording: {{directory: {folder / 'recordings'}, start: by_hand, keep_free: 0}}\n"
            f"page: {{listen: 127.0.0.1:{PORT}, token_file: {token}}}\n")


def check_recording(folder):
    recordings = list((folder / "recordings").iterdir())
    assert len(recordings) == 1, recordings
    large = [path for path in recordings[0].rglob("*") if path.is_file() and path.stat().st_size > 10_000]
    assert len(large) >= 2, f"streams of both cameras: {list(recordings[0].rglob('*'))}"


def main():
    only_packages = sys.argv[1] == "packages"
    if problem := packages_problem(sys.argv[2 if only_packages else 4]):
        print("skipped:", problem)
        return 1 if os.environ.get("CARTVO_REQUIRE_DATA") == "1" else 77
    if only_packages:
        return 0
    cartvo, cartvod, cache, packages = sys.argv[1:5]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        pictures = pathlib.Path(sys.argv[5]) if len(sys.argv) > 5 else folder / "pictures"
        cameras = Cameras(cartvo, folder / "cameras", [*CONTENT, "--cache-dir", cache])
        daemon = Daemon(cartvod, folder, configuration(cameras, folder))
        daemon.await_log("status page: ")
        browser = start(["node", pathlib.Path(packages) / "check_page.mjs", f"http://127.0.0.1:{PORT}/", TOKEN, pictures],
                        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        for line in browser.stdout:
            print(line, end="", flush=True)
            request = line.strip()
            if request == "do: stop cameras":
                cameras.stop()
            elif request == "do: start cameras":
                cameras.start()
            elif request == "do: stop cartvod":
                assert daemon.stop() == 0, daemon.text()
            elif request == "do: start cartvod":
                daemon = Daemon(cartvod, folder, daemon.configuration.read_text())
            else:
                continue
            browser.stdin.write("done\n")
            browser.stdin.flush()
        assert browser.wait(60) == 0, f"see above; the log of cartvod:\n{daemon.text()}"
        check_recording(folder)
        assert daemon.stop() == 0, daemon.text()
        assert TOKEN not in daemon.text()
    print("check_page: in order")
    return 0


if __name__ == "__main__":
    sys.exit(main())
