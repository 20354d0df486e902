"""Programs of a cart for tests in Python: simulated cameras, cartvod, and a subscriber of its messages.

Run the test in a network namespace of its own (tests/support/in_network_namespace.sh).
"""
import atexit
import os
import pathlib
import signal
import socket
import struct
import subprocess
import threading
import time

GROUP, PORT = "239.255.76.67", 7667
VALID = 1
REASON_NO_PAIR = 256
PATIENCE_S = 60.0  # until something must have happened, on a busy computer


def await_(condition, what, seconds=PATIENCE_S):
    """Waits until the condition holds and returns its value; AssertionError after `seconds`."""
    end = time.monotonic() + seconds
    while True:
        if value := condition():
            return value
        if time.monotonic() > end:
            raise AssertionError(f"after {seconds:g} s: not seen: {what}")
        time.sleep(0.02)


def start(command, **options):
    """Starts a program that ends with the test at the latest."""
    process = subprocess.Popen(command, **options)
    atexit.register(lambda: process.poll() is None and process.kill())
    return process


# Of the section odometry: what tests of everything else than accuracy use, whose worlds are small and drives short.
WIDE_LIMITS = "alert_limits: {velocity: 100, angular_rate: 1000, motion: 100, rotation: 180}"


class Listener:
    """Receives the datagrams of an LCM group in a thread; decodes CARTVO_ODOMETRY (daemon/messages/odometry_t.lcm)."""

    def __init__(self, port=PORT):
        self.messages, self.datagrams, self.last_odometry = [], [], b""
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 20)
        self.socket.bind(("", port))
        group = socket.inet_aton(GROUP) + socket.inet_aton("127.0.0.1")
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, group)
        threading.Thread(target=self.listen, daemon=True).start()

    def listen(self):
        while True:
            data = self.socket.recv(65536)
            if data[:4] != b"LC02":
                continue
            channel, body = data[8:].split(b"\0", 1)
            if channel != b"CARTVO_ODOMETRY":
                self.datagrams.append(data)
                continue
            self.last_odometry = data
            values = struct.unpack_from(">8xqqqqqqqbibi3d4d36d3d3d36d3d9d3d3d", body)
            self.messages.append({
                "received": time.time(), "utime": values[0], "published": values[2], "sequence": values[4],
                "latency_ms": 1e-3 * (values[2] - values[1]),  # of a pair, from its last packet to the publication
                "valid": values[7] == VALID, "reasons": values[8], "velocity": values[54:57], "rates": values[57:60],
                "velocity_bound": values[108:111], "rate_bound": values[111:114]})

    def problems(self):
        """The texts of the last health message, as bytes; empty before the first."""
        return next((data for data in reversed(self.datagrams) if b"CARTVO_HEALTH\0" in data), b"")

    def valid_since(self, instant):
        return [m for m in list(self.messages) if m["valid"] and m["received"] > instant]

    def invalid_since(self, instant):
        return [m for m in list(self.messages) if not m["valid"] and m["received"] > instant]


class ServiceManager:
    """Stands in for systemd: receives what cartvod notifies (sd_notify(3))."""

    def __init__(self, path, watchdog_s):
        self.notes, self.path, self.watchdog_s = [], str(path), watchdog_s
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.socket.bind(self.path)
        threading.Thread(target=self.listen, daemon=True).start()

    def listen(self):
        while True:
            self.notes.append((time.monotonic(), self.socket.recv(65536).decode()))

    def environment(self):
        return {"NOTIFY_SOCKET": self.path, "WATCHDOG_USEC": str(int(1e6 * self.watchdog_s))}

    def is_ready(self):
        return any("READY=1" in note for _, note in list(self.notes))

    def restarts_after(self, instant):
        """cartvod has asked for a restart since `instant` (time.monotonic())."""
        return any(at > instant and "WATCHDOG=trigger" in note for at, note in list(self.notes))

    def fed_s_ago(self):
        fed = [at for at, note in list(self.notes) if "WATCHDOG=1" in note or "EXTEND_TIMEOUT" in note]
        return time.monotonic() - fed[-1] if fed else float("inf")


class Cameras:
    """`cartvo simulate`: two cameras that repeat a rendered drive."""

    def __init__(self, cartvo, folder, content, ports=(8554, 8555), password_file=None):
        folder.mkdir(parents=True, exist_ok=True)
        self.folder, self.log = folder, folder / "simulate.log"
        self.urls = [f"rtsp://127.0.0.1:{port}/Streaming/Channels/101" for port in ports]
        self.command = [cartvo, "simulate", *content, "--loop", "--output-dir", folder, "--left-address", f"127.0.0.1:{ports[0]}",
                        "--right-address", f"127.0.0.1:{ports[1]}"]
        if password_file:
            self.command += ["--password-file", password_file]
        self.password_file = password_file or folder / "password"
        self.process = None
        self.start()

    def start(self):
        with open(self.log, "w") as log:
            self.process = start(self.command, stdout=log, stderr=subprocess.STDOUT)
        await_(lambda: "\ncontent: " in self.log.read_text() or self.process.poll() is not None, "cameras", 300)
        assert self.process.poll() is None, self.log.read_text()

    def stop(self):
        self.process.kill()
        self.process.wait()


class Daemon:
    """cartvod in a folder of its own, with its log."""

    count = 0

    def __init__(self, cartvod, folder, configuration, environment=None, prefix=(), arguments=()):
        Daemon.count += 1
        folder.mkdir(parents=True, exist_ok=True)
        self.log = folder / f"cartvod-{Daemon.count}.log"
        self.configuration = folder / "cartvod.yaml"
        self.configuration.write_text(configuration)
        command = [*prefix, cartvod, "--config", self.configuration, *arguments]
        with open(self.log, "w") as log:
            self.process = start(command, stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT, cwd=folder,
                                 env={**os.environ, **(environment or {})})

    def text(self):
        return self.log.read_text(errors="replace")

    def await_log(self, text, seconds=PATIENCE_S):
        try:
            await_(lambda: text in self.text(), f"'{text}' in the log", seconds)
        except AssertionError as error:
            raise AssertionError(f"{error}; the log:\n{self.text()}") from None

    def signal(self, number):
        self.process.send_signal(number)

    def wait(self, seconds=PATIENCE_S):
        """The exit code: negative if a signal ended it."""
        return self.process.wait(seconds)

    def stop(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGCONT)
            self.process.terminate()
        return self.wait()


def camera_section(urls, password_file, more=""):
    """The part cameras: of a configuration."""
    text = "cameras:\n"
    for side, url in zip(("left", "right"), urls, strict=True):
        text += f"  {side}:\n    url: {url}\n    username: admin\n    password_file: {pathlib.Path(password_file)}\n"
    return text + more
