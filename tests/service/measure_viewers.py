#!/usr/bin/env python3
"""measure_viewers.py CARTVO CARTVOD CACHE [SECONDS [ROUNDS]]: what scrapes of /metrics and viewers of the status page cost.

Two simulated cameras repeat a drive at full size, cached in the folder CACHE. cartvod runs without viewers, with one request
of /metrics a second, with one viewer, and with 21 viewers of whom one reads slowly, SECONDS each (default 60), by turns. A
viewer asks as the page does: for a frame ten times a second, for the health once a second. Prints the latency of the odometry
(last packet to publication), invalid pairs and the CPU time of cartvod. Run by hand on a quiet computer, by
tests/support/in_network_namespace.sh.
"""
import http.client
import os
import pathlib
import socket
import statistics
import sys
import tempfile
import threading
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "support"))
from running_cart import Cameras, Daemon, Listener, await_, camera_section  # noqa: E402

CONTENT = ["--world", "turns", "--seconds", "8", "--readout-ms", "0", "--offset-ms", "0"]
PAGE_PORT, METRICS_PORT = 9465, 9464
SLOW_BYTES, SLOW_PAUSE_S = 4096, 0.1  # 40 kB/s, less than the frames have
CASES = {"nothing": (0, 0, 0), "/metrics at 1 Hz": (1, 0, 0), "1 viewer": (0, 1, 0), "20 viewers and a slow one": (0, 20, 1)}


class Viewers:
    """Clients in threads, until stop(); an error of any of them is kept."""

    def __init__(self, scrapers, viewers, slow_viewers):
        self.stopped, self.errors, self.answers = threading.Event(), [], 0
        work = [self.scrape] * scrapers + [self.view] * viewers + [self.view_slowly] * slow_viewers
        self.threads = [threading.Thread(target=self.guarded, args=(one,), daemon=True) for one in work]
        for thread in self.threads:
            thread.start()

    def guarded(self, work):
        try:
            work()
        except (OSError, AssertionError, http.client.HTTPException) as error:
            self.errors.append(error)

    def get(self, connection, path):
        connection.request("GET", path)
        answer = connection.getresponse()
        body = answer.read()
        assert answer.status in (200, 204), f"{path}: {answer.status}"
        self.answers += 1
        return body

    def scrape(self):
        connection = http.client.HTTPConnection("127.0.0.1", METRICS_PORT, timeout=10)
        while not self.stopped.wait(1.0):
            self.get(connection, "/metrics")

    def view(self):
        connection = http.client.HTTPConnection("127.0.0.1", PAGE_PORT, timeout=10)
        requests = 0
        while not self.stopped.wait(0.1):
            self.get(connection, "/frame?seen=0")
            if requests % 10 == 0:
                self.get(connection, "/health.json")
            requests += 1

    def view_slowly(self):
        while not self.stopped.is_set():
            with socket.create_connection(("127.0.0.1", PAGE_PORT), timeout=10) as connection:
                connection.sendall(b"GET /frame?seen=0 HTTP/1.1\r\nHost: 127.0.0.1:9465\r\nConnection: close\r\n\r\n")
                while not self.stopped.wait(SLOW_PAUSE_S) and connection.recv(SLOW_BYTES):
                    pass

    def stop(self):
        self.stopped.set()
        for thread in self.threads:
            thread.join()
        if self.errors:
            raise self.errors[0]


def cpu_s(pid):
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def measure(listener, daemon, clients, seconds):
    """Latencies (ms) of the pairs of `seconds`, the number of invalid ones, and the CPU time of cartvod (% of a core)."""
    viewers = Viewers(*clients)
    time.sleep(1.0)  # until all are connected
    begin, cpu = len(listener.messages), cpu_s(daemon.process.pid)
    time.sleep(seconds)
    share = 100 * (cpu_s(daemon.process.pid) - cpu) / seconds
    messages = listener.messages[begin:]
    viewers.stop()
    valid = [message["latency_ms"] for message in messages if message["valid"]]
    return valid, len(messages) - len(valid), share, viewers.answers / seconds


def percentile(values, share):
    return sorted(values)[min(int(share * len(values)), len(values) - 1)]


def main():
    cartvo, cartvod, cache = (pathlib.Path(name).resolve() for name in sys.argv[1:4])
    seconds = float(sys.argv[4]) if len(sys.argv) > 4 else 60.0
    rounds = int(sys.argv[5]) if len(sys.argv) > 5 else 3
    listener = Listener()
    results = {name: [] for name in CASES}
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        cameras = Cameras(cartvo, folder / "cameras", [*CONTENT, "--cache-dir", cache])
        daemon = Daemon(cartvod, folder, camera_section(cameras.urls, cameras.password_file) +
                        f"rig: {cameras.folder / 'rig.yaml'}\npage: {{listen: 127.0.0.1:{PAGE_PORT}}}\n"
                        f"metrics: {{listen: 127.0.0.1:{METRICS_PORT}}}\n")
        await_(lambda: sum(message["valid"] for message in listener.messages) > 20, "valid odometry")
        for _ in range(rounds):
            for case, clients in CASES.items():
                results[case].append(measure(listener, daemon, clients, seconds))
                latencies, invalid, share, answers = results[case][-1]
                print(f"  {case}: median {statistics.median(latencies):.2f} ms, p99 {percentile(latencies, 0.99):.2f} ms, "
                      f"{invalid} invalid, {share:.1f} % CPU, {answers:.0f} answers a second", flush=True)
        daemon.stop()
    print(f"{rounds} rounds of {seconds:g} s, latency of the valid pairs:")
    for case, parts in results.items():
        latencies = [value for part in parts for value in part[0]]
        print(f"{case:26} median {statistics.median(latencies):6.2f} ms, p99 {percentile(latencies, 0.99):6.2f} ms, "
              f"{len(latencies)} valid pairs, {sum(part[1] for part in parts)} invalid, "
              f"CPU {statistics.median(part[2] for part in parts):5.1f} %")


if __name__ == "__main__":
    main()
