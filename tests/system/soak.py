"""Soak test of cartvod: two simulated cameras, faults between them and the daemon, and the truth. Run by soak.sh."""

import argparse
import os
import pathlib
import random
import signal
import socket
import statistics
import struct
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from drive_truth import Judgement, Truth  # noqa: E402
from running_cart import Listener  # noqa: E402

BUILD = os.environ["CARTVO_BUILD"]
FRAME_RATE = 18.0
CONTENT_S = 60.0
METRICS = "127.0.0.1:9464"
DISK_MB = 300  # of the recordings


class Faults:
    """Faults of one camera's connection; set by the schedule, read by the proxy's threads."""

    def __init__(self):
        self.hold_until = 0.0    # nothing is passed on until then; then all of it
        self.drop = 0            # RTP packets to leave out
        self.corrupt = 0         # RTP packets whose bytes are changed
        self.repeat = 0          # RTP packets to send twice
        self.exchange = 0        # pairs of RTP packets to exchange
        self.shift = 0           # ticks added to RTP time, until the connection ends
        self.stray = 0           # pictures with an RTP time of their own
        self.rate = None         # (bytes per second, until when)
        self.backlog = 0.0       # s that the next connection's beginning is held back, to come at once
        self.report_error = 0.0  # s by which sender reports are wrong
        self.answer = None       # what the next connection gets instead of the camera
        self.swapped_until = 0.0
        self.dead_until = 0.0    # a camera that boots refuses connections until then


class Proxy:
    """A TCP proxy of one RTSP camera, which understands interleaved packets."""

    HOSTILE = {
        "garbage": os.urandom(4000),
        "http": b"HTTP/1.1 400 Bad Request\r\nContent-Length: 3\r\n\r\nno\n",
        "redirect": b"RTSP/1.0 302 Moved\r\nCSeq: 1\r\nLocation: rtsp://192.0.2.1/other\r\n\r\n",
        "basic": b'RTSP/1.0 401 Unauthorized\r\nCSeq: 1\r\nWWW-Authenticate: Basic realm="x"\r\n\r\n',
        "huge": b"RTSP/1.0 200 OK\r\nCSeq: 1\r\nContent-Length: 1000000000\r\n\r\n" + b"v=0\r\n" * 20000,
        "headers": b"RTSP/1.0 200 OK\r\n" + b"A: b\r\n" * 20000,
        "silence": b"",
        "error": b"RTSP/1.0 503 Service Unavailable\r\nCSeq: 1\r\n\r\n",
    }

    def __init__(self, ports, seed):
        self.ports, self.faults, self.random = ports, Faults(), random.Random(seed)
        self.server = socket.create_server(("127.0.0.1", 0))
        self.port = self.server.getsockname()[1]
        self.client = None
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self):
        while True:
            client, _ = self.server.accept()
            threading.Thread(target=self.serve, args=(client,), daemon=True).start()

    def serve(self, client):
        faults = self.faults
        if time.time() < faults.dead_until:
            client.close()
            return
        answer, faults.answer = faults.answer, None
        if answer:
            try:
                client.sendall(self.HOSTILE[answer])
                time.sleep(6.0 if answer == "silence" else 0.5)
            except OSError:
                pass
            client.close()
            return
        try:
            port = self.ports[1] if time.time() < faults.swapped_until else self.ports[0]
            camera = socket.create_connection(("127.0.0.1", port))
        except OSError:
            client.close()
            return
        client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.client, faults.shift = client, 0
        if faults.backlog:
            faults.hold_until, faults.backlog = time.time() + faults.backlog, 0.0
        threading.Thread(target=self.pump, args=(client, camera), daemon=True).start()
        try:
            self.forward(camera, client)
        except OSError:
            pass
        client.close()
        camera.close()

    @staticmethod
    def pump(source, target):
        try:
            while data := source.recv(65536):
                target.sendall(data)
            target.shutdown(socket.SHUT_WR)
        except OSError:
            pass

    def forward(self, camera, client):
        data, waiting = b"", None
        while chunk := camera.recv(65536):
            data += chunk
            out = []
            while data:
                if data[:1] != b"$":
                    end = data.find(b"$")  # messages are passed on as they are
                    end = len(data) if end < 0 else end
                    out.append(data[:end])
                    data = data[end:]
                    continue
                if len(data) < 4 or len(data) < 4 + struct.unpack(">H", data[2:4])[0]:
                    break
                size = 4 + struct.unpack(">H", data[2:4])[0]
                packet, data = bytearray(data[:size]), data[size:]
                packets = self.changed(packet)
                if self.faults.exchange > 0 and packets and packet[1] == 0:
                    if waiting is None:
                        waiting = packets
                        continue
                    packets, waiting = packets + waiting, None
                    self.faults.exchange -= 1
                out += packets
            self.hold()
            self.send(client, b"".join(out))

    def changed(self, packet):
        """The interleaved packet as it is passed on: none, one or two of them."""
        faults = self.faults
        if packet[1] == 1 and len(packet) >= 32 and packet[5] == 200 and faults.report_error:
            seconds = struct.unpack(">I", packet[12:16])[0] + int(faults.report_error)
            packet[12:16] = struct.pack(">I", seconds & 0xFFFFFFFF)
        if packet[1] != 0 or len(packet) < 17:
            return [bytes(packet)]
        ticks = faults.shift
        if faults.stray > 0:
            ticks += 3600 * 90000 * (-1) ** faults.stray
            if packet[5] & 0x80:
                faults.stray -= 1
        if ticks:
            packet[8:12] = struct.pack(">I", (struct.unpack(">I", packet[8:12])[0] + ticks) & 0xFFFFFFFF)
        if faults.drop > 0:
            faults.drop -= 1
            return []
        if faults.corrupt > 0:
            faults.corrupt -= 1
            for _ in range(8):
                packet[self.random.randrange(17, len(packet))] ^= 1 << self.random.randrange(8)
        if faults.repeat > 0:
            faults.repeat -= 1
            return [bytes(packet)] * 2
        return [bytes(packet)]

    def hold(self):
        while time.time() < self.faults.hold_until:
            time.sleep(0.01)

    def send(self, client, data):
        rate = self.faults.rate
        if rate and time.time() < rate[1]:
            for at in range(0, len(data), 1400):
                client.sendall(data[at:at + 1400])
                time.sleep(1400 / rate[0])
        elif data:
            client.sendall(data)

    def close(self):
        if self.client:
            try:
                self.client.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass


def faults(rng):
    """A fault for one camera: its name and what sets it."""
    def set_(**values):
        return lambda proxy: [setattr(proxy.faults, k, v() if callable(v) else v) for k, v in values.items()]

    def closed(**values):
        def apply(proxy):
            set_(**values)(proxy)
            proxy.close()
        return apply

    seconds, packets, boot_s = rng.uniform(0.05, 2.5), rng.randrange(1, 60), rng.uniform(5.0, 30.0)
    hostile = rng.choice(list(Proxy.HOSTILE))
    return rng.choice([
        ("stall of %.2f s, then all at once" % seconds, set_(hold_until=lambda: time.time() + seconds)),
        ("connection closed", closed()),
        ("%d packets lost" % packets, set_(drop=packets)),
        ("%d packets corrupt" % packets, set_(corrupt=packets)),
        ("%d packets twice" % packets, set_(repeat=packets)),
        ("%d packets exchanged" % packets, set_(exchange=packets)),
        ("RTP time jumps by %+d s" % (packets * 40 - 1200), set_(shift=(packets * 40 - 1200) * 90000)),
        ("a picture with an RTP time of its own", set_(stray=1)),
        ("a new connection with a backlog of %.2f s" % seconds, closed(backlog=seconds)),
        ("30 kB/s for %.1f s" % (2 * seconds), set_(rate=lambda: (30e3, time.time() + 2 * seconds))),
        ("the camera boots for %.0f s, and its clock is wrong by a day" % boot_s,
         closed(dead_until=lambda: time.time() + boot_s, report_error=86400.0)),
        ("sender reports wrong by an hour", set_(report_error=3600.0)),
        ("sender reports right again", set_(report_error=0.0)),
        ("a new connection meets a server with %s" % hostile, closed(answer=hostile)),
        ("a new connection to the other camera for 3 s", closed(swapped_until=lambda: time.time() + 3.0)),
    ])


def start_cameras(folder):
    simulate = subprocess.Popen(
        [BUILD + "/tools/cartvo/cartvo", "simulate", "--world", "campus", "--seconds", str(CONTENT_S), "--size", "340x210",
         "--bitrate-kbps", "1500", "--offset-ms", "-13.9", "--readout-ms", "0", "--loop", "--output-dir", folder + "/sim",
         "--left-address", "127.0.0.1:8554", "--right-address", "127.0.0.1:8555"], stdout=subprocess.PIPE, text=True)
    for line in simulate.stdout:
        if line.startswith("content: "):
            return simulate
    sys.exit("soak: the simulated cameras did not start")


def start_daemon(folder, proxies):
    password = open(folder + "/sim/password").read()
    with open(os.open(folder + "/password", os.O_CREAT | os.O_WRONLY, 0o600), "w") as file:
        file.write(password)
    recordings = folder + "/recordings"
    os.makedirs(recordings, exist_ok=True)
    subprocess.run(["mount", "-t", "tmpfs", "-o", "size=%dm" % DISK_MB, "tmpfs", recordings], check=True)
    camera = "    url: rtsp://127.0.0.1:%d/Streaming/Channels/101\n    username: admin\n    password_file: password\n"
    with open(folder + "/cartvod.yaml", "w") as file:
        file.write("cameras:\n  left:\n" + camera % proxies[0].port + "  right:\n" + camera % proxies[1].port +
                   "rig: sim/rig.yaml\nmetrics:\n  listen: %s\nrecording:\n  directory: recordings\n  keep_free: 0.05\n" % METRICS)
    return subprocess.Popen([BUILD + "/daemon/cartvod", "--config", folder + "/cartvod.yaml"],
                            stdout=open(folder + "/log", "w"), stderr=subprocess.STDOUT)


def resources(pid):
    """Resident memory in MB, threads, and descriptors of a process."""
    with open("/proc/%d/status" % pid) as file:
        status = dict(line.split(":", 1) for line in file)
    return (int(status["VmRSS"].split()[0]) / 1024, int(status["Threads"]), len(os.listdir("/proc/%d/fd" % pid)))


def sample(pid, rows):
    """Appends the process' resources each ten seconds, until it has ended."""
    while True:
        try:
            rows.append((time.time(), *resources(pid)))
        except (OSError, KeyError):
            return
        time.sleep(10.0)


def scrape():
    """Reads /metrics once a second."""
    while True:
        try:
            urllib.request.urlopen("http://%s/metrics" % METRICS, timeout=5).read()
        except OSError:
            pass
        time.sleep(1.0)


def fill_disk(folder, seconds):
    """Leaves no space for recordings for `seconds`."""
    def fill():
        ballast = folder + "/recordings/ballast"
        space = os.statvfs(folder + "/recordings")
        try:
            with open(ballast, "wb") as file:
                file.write(bytes(max(space.f_bavail * space.f_frsize - 100_000, 0)))
        except OSError:
            pass
        time.sleep(seconds)
        pathlib.Path(ballast).unlink(missing_ok=True)  # another fault of this kind may have ended meanwhile
    threading.Thread(target=fill, daemon=True).start()


class Comparison:
    """Judges messages as they come. Each drive of the cameras has a truth of its own."""

    def __init__(self, listener, folder):
        self.listener, self.file, self.seen, self.judgement = listener, folder + "/sim/truth.tum", 0, Judgement()
        self.begin_drive()

    def begin_drive(self):
        self.truth = Truth(self.file, CONTENT_S)

    def update(self):
        """Judges the messages that have come since the last call, and returns how many were above an alert limit so far."""
        messages = self.listener.messages[self.seen:]
        self.seen += len(messages)
        self.judgement.add([m for m in messages if m["utime"] * 1e-6 >= self.truth.begin], self.truth)
        return len(self.judgement.above_limit)


def second_and_last_quarter(rows):
    """The medians of each resource over the second and the last quarter of the samples: the first quarter is warming up."""
    quarter = max(len(rows) // 4, 1)
    return [tuple(statistics.median(row[i] for row in part) for i in (1, 2, 3))
            for part in (rows[quarter:2 * quarter] or rows, rows[-quarter:])]


def main():
    parser = argparse.ArgumentParser(prog="tests/system/soak.sh", description=__doc__)
    parser.add_argument("--seconds", type=float, default=3600.0, help="duration (default: an hour)")
    parser.add_argument("--seed", type=int, default=1, help="of the faults (default: 1)")
    parser.add_argument("--keep", metavar="DIR", help="folder to keep logs and messages in")
    options = parser.parse_args()
    folder = options.keep or tempfile.mkdtemp(prefix="cartvo-soak-")
    os.makedirs(folder, exist_ok=True)
    rng = random.Random(options.seed)
    cameras = start_cameras(folder)
    proxies = [Proxy((8554, 8555), options.seed), Proxy((8555, 8554), options.seed + 1)]
    listener = Listener()
    daemon = start_daemon(folder, proxies)
    begin = time.monotonic()
    time.sleep(8.0)
    count, stops, crashes, rows = 0, 0, 0, []
    threading.Thread(target=sample, args=(daemon.pid, rows), daemon=True).start()
    threading.Thread(target=scrape, daemon=True).start()
    comparison = Comparison(listener, folder)
    while time.monotonic() < begin + options.seconds and daemon.poll() is None:
        time.sleep(rng.uniform(1.0, 12.0))
        count += 1
        before = comparison.update()
        if cameras.poll() is not None:
            crashes += 1
            print("%7.1f s  the simulated cameras ended with %d and start again" % (time.monotonic() - begin, cameras.poll()))
            cameras = start_cameras(folder)
            comparison.begin_drive()
        if rng.random() < 0.05:
            pause = rng.uniform(0.2, 2.0)
            daemon.send_signal(signal.SIGSTOP)
            time.sleep(pause)
            daemon.send_signal(signal.SIGCONT)
            stops += pause
            text = "the daemon is stopped for %.2f s" % pause
        elif rng.random() < 0.04:
            seconds = rng.uniform(1.0, 40.0)
            fill_disk(folder, seconds)
            text = "no space for recordings for %.0f s" % seconds
        else:
            side = rng.randrange(2)
            name, apply = faults(rng)
            apply(proxies[side])
            text = "%s camera: %s" % (("left", "right")[side], name)
        print("%7.1f s  %s  (%d above a limit before)" % (time.monotonic() - begin, text, before), flush=True)
    time.sleep(5.0)
    ended = daemon.poll()
    early, late = second_and_last_quarter(rows)
    for process in (daemon, cameras):
        process.terminate()
    daemon.wait(15)

    messages = listener.messages
    comparison.update()
    judgement = comparison.judgement
    gaps = sum(b["sequence"] != a["sequence"] + 1 for a, b in zip(messages, messages[1:]))
    silence = max([b["received"] - a["received"] for a, b in zip(messages, messages[1:])] or [float("inf")])
    for message, true, errors in judgement.above_limit[:20]:
        print("ABOVE A LIMIT: utime %.3f s: %s m/s, rad/s instead of %s, off by %s (bounds %s), published %.3f s later" % (
            message["utime"] * 1e-6, *(["%.2f" % v for v in values] for values in (
                (*message["velocity"], *message["rates"]), true, errors, (*message["velocity_bound"], *message["rate_bound"]))),
            message["received"] - message["utime"] * 1e-6))
    print("%d faults in %.0f s: %s; %d gaps in the sequence; longest silence %.2f s; log: %s/log" % (
        count, time.monotonic() - begin, judgement.text(), gaps, silence, folder))
    if crashes:
        print("the simulated cameras ended %d times by themselves, and were started again" % crashes)
    print("from the second to the last quarter: resident memory %.1f -> %.1f MB, threads %d -> %d, descriptors %d -> %d" % (
        early[0], late[0], early[1], late[1], early[2], late[2]))
    # A connection that is being made or closed takes some threads and descriptors.
    leaks = late[0] > early[0] + 10 or late[1] > early[1] + 3 or late[2] > early[2] + 5
    too_many = len(judgement.above_bound) > 1e-4 * judgement.judged
    failed = judgement.above_limit or too_many or judgement.judged == 0
    failed = failed or gaps or ended is not None or leaks or silence > 1.0 + (2.0 if stops else 0.0)
    print("FAILED" if failed else "passed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
