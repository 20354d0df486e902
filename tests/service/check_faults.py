#!/usr/bin/env python3
"""check_faults.py CARTVO CARTVOD CACHE FAULT: what controllers receive from cartvod during a fault.

Two simulated cameras repeat a drive. In no fault a VALID message may contradict the true motion. FAULT is the name of one
of the functions below, or 'all'; 'prepare' only renders the drive into the folder CACHE. Run by
tests/support/in_network_namespace.sh.
"""
import ctypes
import math
import os
import pathlib
import signal
import socket
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from drive_truth import Judgement, Truth  # noqa: E402
from running_cart import GROUP, PORT, WIDE_LIMITS, Cameras, Daemon, Listener, ServiceManager, await_, camera_section  # noqa: E402

CONTENT_S, FRAME_RATE = 8, 10
CONTENT = ["--world", "turns", "--seconds", str(CONTENT_S), "--size", "320x200", "--frame-rate", str(FRAME_RATE), "--bitrate-kbps", "1500",
           "--readout-ms", "0", "--offset-ms", "0"]
OTHER_RATE = ["--world", "turns", "--seconds", "3", "--size", "320x200", "--frame-rate", "7", "--bitrate-kbps", "1500", "--readout-ms", "0",
              "--offset-ms", "0"]
# Short, so that a test takes seconds; a simulated camera answers DESCRIBE only at its next key picture.
TIMEOUTS = "  answer_timeout: 1.5\n  connect_timeout: 1.5\n  stall_timeout: 0.5\n"
READER_S = 2 * (2 * 1.5 + 1.5)  # after which a camera's reader counts as stalled
WATCHDOG_S = 4.0
INVALID_WITHIN_S = 1.5  # of cameras that are gone: stall_timeout, and a busy computer
REASONS_OF_GEOMETRY = 32768
PTRACE_DETACH, PTRACE_SEIZE, PTRACE_INTERRUPT = 17, 0x4206, 0x4207
libc = ctypes.CDLL(None, use_errno=True)


class Drive:
    """The cameras, a subscriber, and a folder; checks at the end that no VALID message was above its bound."""

    def __init__(self, cartvo, cartvod, cache, folder):
        self.cartvo, self.cartvod, self.cache, self.folder = cartvo, cartvod, cache, folder
        self.listener = Listener()
        self.cameras = Cameras(cartvo, folder / "cameras", [*CONTENT, "--cache-dir", cache])
        self.drives = [[self.truth(), float("inf")]]  # with the time at which its cameras stopped
        self.daemons = []

    def truth(self):
        return Truth(self.cameras.folder / "truth.tum", CONTENT_S)

    def stop_cameras(self):
        self.cameras.stop()
        self.drives[-1][1] = time.time()

    def restart_cameras(self):
        """The drive begins anew."""
        self.cameras.start()
        self.drives.append([self.truth(), float("inf")])

    def configuration(self, urls=None):
        return (camera_section(urls or self.cameras.urls, self.cameras.password_file, TIMEOUTS) +
                f"rig: {self.cameras.folder}/rig.yaml\nodometry:\n  features: 300\n  {WIDE_LIMITS}\n")

    def start(self, configuration=None, **options):
        daemon = Daemon(self.cartvod, self.folder, configuration or self.configuration(), **options)
        self.daemons.append(daemon)
        return daemon

    def start_valid(self, **options):
        begin = time.time()
        daemon = self.start(**options)
        self.await_valid(begin)
        return daemon

    def await_valid(self, since, count=5):
        await_(lambda: len(self.listener.valid_since(since)) >= count, "VALID messages")
        return self.listener.valid_since(since)[0]["received"] - since

    def await_invalid(self, since):
        """Waits for three INVALID messages in a row, and returns when the first came, s after `since`."""
        def found():
            messages = [m for m in list(self.listener.messages) if m["received"] > since]
            for a, b, c in zip(messages, messages[1:], messages[2:]):
                if not (a["valid"] or b["valid"] or c["valid"]):
                    return a["received"] - since
            return None
        return await_(found, "INVALID messages")

    def await_health(self, text, seconds=60.0):
        begin = time.time()
        try:
            await_(lambda: text.encode() in self.listener.problems(), f"'{text}' in a health message", seconds)
        except AssertionError as error:
            raise AssertionError(f"{error}: {self.listener.problems()}; {self.daemons[-1].text()}") from None
        return time.time() - begin

    def finish(self):
        for daemon in self.daemons:
            daemon.stop()
        self.cameras.stop()
        for truth, end in self.drives:
            messages = [m for m in self.listener.messages if truth.begin <= m["utime"] * 1e-6 < end]
            judgement = Judgement((100.0, math.radians(1000.0)))  # of WIDE_LIMITS
            judgement.add(messages, truth)
            refuted = judgement.above_limit + judgement.above_bound
            assert not refuted, f"{judgement.text()}: {refuted[:3]}"


def sequences_have_no_gap(messages):
    return all(b["sequence"] == a["sequence"] + 1 for a, b in zip(messages, messages[1:]))


# --- the faults


def stuck_stage(drive):
    """Each thread of cartvod is stopped in turn: VALID goes on without it, or the watchdog restarts the daemon."""
    manager = ServiceManager(drive.folder / "notify", WATCHDOG_S)
    daemon = drive.start_valid(environment=manager.environment(), arguments=["--record", drive.folder / "recording"])
    starved, triggered = 0, 0
    for thread in sorted(map(int, os.listdir(f"/proc/{daemon.process.pid}/task"))):
        begin, instant = time.time(), time.monotonic()
        assert libc.ptrace(PTRACE_SEIZE, thread, None, None) == 0, os.strerror(ctypes.get_errno())
        libc.ptrace(PTRACE_INTERRUPT, thread, None, None)
        os.waitpid(thread, 0x40000000)  # __WALL
        time.sleep(1.5)
        late = begin + 0.5  # what had been decoded already is still published
        await_(lambda late=late, instant=instant: drive.listener.valid_since(late) or manager.fed_s_ago() > WATCHDOG_S or
               manager.restarts_after(instant), "VALID, or the watchdog unfed or triggered", max(READER_S, WATCHDOG_S) + 5)
        if not drive.listener.valid_since(late):
            triggered += manager.restarts_after(instant)
            starved += 1
        libc.ptrace(PTRACE_DETACH, thread, None, None)
        drive.await_valid(time.time())
    print(f"stuck_stage: {starved} threads were missed, {triggered} of them by a restart that cartvod asked for")
    assert starved >= 3, "both cameras' readers and the odometry"
    assert triggered >= 2, "both cameras' readers"


def out_of_memory(drive):
    """No memory is left: cartvod ends with an error, so that systemd restarts it."""
    daemon = drive.start_valid()
    with open(f"/proc/{daemon.process.pid}/statm") as statm:
        size = int(statm.read().split()[0]) * os.sysconf("SC_PAGESIZE")
    subprocess.run(["prlimit", f"--pid={daemon.process.pid}", f"--as={size}"], check=True)
    drive.stop_cameras()  # connecting again needs memory
    drive.restart_cameras()
    code = daemon.wait()
    assert code == 1, f"exit code {code}: {daemon.text()}"
    assert "memory" in daemon.text().splitlines()[-1], daemon.text()
    drive.start_valid()


def full_disk(drive):
    """The disk of the recording is full: a message says so, and the odometry goes on."""
    folder = drive.folder / "full"
    folder.mkdir()
    # The daemon's own mount: 300 kB, less than a second of both streams.
    mount = ["unshare", "--mount", "sh", "-c", f'mount -t tmpfs -o size=300k tmpfs {folder} && exec "$@"', "sh"]
    for keep_free, problem in (("1", "must be kept free"), ("0", "No space left on device")):
        text = drive.configuration() + f"recording:\n  directory: {folder}\n  keep_free: {keep_free}\n"
        daemon = drive.start_valid(prefix=mount, configuration=text)
        drive.await_health(problem)
        daemon.await_log(problem)
        begin = time.time()
        drive.await_valid(begin, FRAME_RATE)
        assert daemon.stop() == 0


def killed(drive):
    """SIGKILL: silence, then a new daemon at once; the recording so far is whole."""
    daemon = drive.start_valid(arguments=["--record", drive.folder / "recording"])
    daemon.signal(signal.SIGKILL)
    daemon.wait()
    begin = time.time()
    drive.start()
    seconds = drive.await_valid(begin)
    restarted = [m for m in drive.listener.messages if m["received"] > begin]
    assert restarted[0]["sequence"] == 0 and not restarted[0]["valid"]
    assert sequences_have_no_gap(restarted)
    print(f"killed: VALID {seconds:.1f} s after the new start")
    verified = subprocess.run([drive.cartvo, "recording", "verify", drive.folder / "recording"], capture_output=True, text=True)
    assert verified.returncode == 0, verified.stdout + verified.stderr


def cameras_gone(drive):
    """Both cameras go and come back: INVALID, then VALID, from the same process."""
    daemon = drive.start_valid()
    begin = time.time()
    drive.stop_cameras()
    seconds = drive.await_invalid(begin)
    assert seconds < INVALID_WITHIN_S, f"INVALID only after {seconds:.2f} s"
    assert not drive.listener.valid_since(begin + INVALID_WITHIN_S)
    drive.restart_cameras()
    print(f"cameras_gone: INVALID after {seconds:.2f} s, VALID {drive.await_valid(time.time()):.1f} s after the cameras answer")
    assert daemon.process.poll() is None
    assert sequences_have_no_gap(drive.listener.messages)


def route(action):
    subprocess.run(["ip", "route", action, f"{GROUP}/32", "dev", "lo"], check=True)


def no_lcm(drive):
    """No route for LCM at the start: an error that names the remedy. Lost later: it is said, and messages go on."""
    route("delete")
    daemon = drive.start()
    assert daemon.wait() == 1
    assert "no route for the multicast group" in daemon.text() and "ip route add" in daemon.text(), daemon.text()
    route("add")
    manager = ServiceManager(drive.folder / "notify", WATCHDOG_S)
    daemon = drive.start_valid(environment=manager.environment())
    route("delete")
    begin = time.time()
    daemon.await_log("the route for LCM's multicast group 239.255.76.67 is gone")
    drive.await_valid(begin + 0.5)
    assert manager.fed_s_ago() < WATCHDOG_S and daemon.process.poll() is None
    route("add")
    drive.await_valid(time.time())


def broken_reload(drive):
    """SIGHUP with a broken configuration: an error, and the old configuration in force without a gap; also without a log."""
    daemon = drive.start_valid()
    for broken in ("cameras: [", "no_such_key: 1\n", ""):
        begin, before = time.time(), daemon.text().count("the old one stays in force")
        daemon.configuration.write_text(broken)
        daemon.signal(signal.SIGHUP)
        await_(lambda before=before: daemon.text().count("the old one stays in force") > before, "the error")
        drive.await_valid(begin, FRAME_RATE)
    daemon.signal(signal.SIGPIPE)  # as of a log that is no longer read
    drive.await_valid(time.time(), FRAME_RATE)
    assert daemon.process.poll() is None
    assert sequences_have_no_gap(drive.listener.messages)


def second_daemon(drive):
    """A second daemon refuses to start, on the same host and on another one, and publishes nothing."""
    first = drive.start_valid()
    second = drive.start()
    assert second.wait() == 1
    assert f"another cartvod (process {first.process.pid}) publishes CARTVO_ODOMETRY" in second.text(), second.text()
    drive.await_valid(time.time())
    assert sequences_have_no_gap(drive.listener.messages), "messages of two daemons"
    # On another host: in another network namespace, whose messages arrive here.
    raw = drive.listener.last_odometry
    first.stop()
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    began = time.time()
    second = drive.start()
    while second.process.poll() is None and time.time() < began + 30:
        sender.sendto(raw, (GROUP, PORT))
        time.sleep(0.2)
    assert second.wait() == 1
    assert "not started: another program publishes CARTVO_ODOMETRY" in second.text(), second.text()
    others = [m for m in drive.listener.messages if m["received"] > began and m["sequence"] == 0]
    assert not others, "it had published already"


def swapped_cameras(drive):
    """Left and right camera exchanged: a plain sentence within 5 s of driving, and no VALID message."""
    begin = time.time()
    drive.start(drive.configuration(drive.cameras.urls[::-1]))
    await_(lambda: any(m["reasons"] & REASONS_OF_GEOMETRY for m in drive.listener.invalid_since(begin)), "wrong stereo geometry")
    pairs = [m for m in drive.listener.messages if m["reasons"] & 256 == 0]
    seconds = next(m for m in pairs if m["reasons"] & REASONS_OF_GEOMETRY)["received"] - pairs[0]["received"]
    drive.await_health("the left and the right picture are exchanged")
    print(f"swapped_cameras: found {seconds:.1f} s after the first pair")
    assert seconds < 5.0
    assert not drive.listener.valid_since(begin)


def unlike_rates(drive):
    """Two cameras with unlike frame rates: health names both rates."""
    other = Cameras(drive.cartvo, drive.folder / "other", [*OTHER_RATE, "--cache-dir", drive.cache], (8556, 8557),
                    drive.cameras.password_file)
    drive.start(drive.configuration([drive.cameras.urls[0], other.urls[1]]))
    drive.await_health("set both to the same frame rate")
    other.stop()
    drive.drives.clear()  # the right camera shows another instant of the drive, so that there is no truth to hold the messages to


FAULTS = [stuck_stage, out_of_memory, full_disk, killed, cameras_gone, no_lcm, broken_reload, second_daemon, swapped_cameras,
          unlike_rates]


def main():
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    cartvo, cartvod, cache = map(os.path.abspath, sys.argv[1:4])
    if sys.argv[4] == "prepare":
        for content in (CONTENT, OTHER_RATE):
            subprocess.run([cartvo, "simulate", *content, "--cache-dir", cache, "--prepare-only"], check=True)
        return
    for fault in FAULTS:
        if sys.argv[4] not in (fault.__name__, "all"):
            continue
        begin = time.time()
        with tempfile.TemporaryDirectory(prefix="cartvo-fault-", ignore_cleanup_errors=True) as name:
            drive = Drive(cartvo, cartvod, cache, pathlib.Path(name))
            fault(drive)
            drive.finish()
        print(f"check_faults: {fault.__name__}: in order, {time.time() - begin:.0f} s", flush=True)


if __name__ == "__main__":
    main()
