#!/usr/bin/env python3
"""check_secrets.py CARTVO CARTVOD: no password leaves the programs.

Runs cartvod and each command of cartvo that reads its configuration, with a canary as password, against cameras that
stream, refuse, lock, redirect, repeat what they were sent, send nothing, or are not there. Then searches all that was
written or could be seen: outputs, recordings, reports, web pages, LCM messages, notes to systemd, command lines,
environments and core dumps. Run by tests/support/in_network_namespace.sh.
"""
import base64
import hashlib
import http.client
import os
import pathlib
import re
import resource
import signal
import subprocess
import sys
import tempfile
import time
import urllib.parse

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests/support"), str(ROOT / "tools")]
from check_docs import Program  # noqa: E402
from faulty_camera import REALM, FaultyCamera  # noqa: E402
from running_cart import Cameras, Daemon, Listener, ServiceManager, await_, camera_section, start  # noqa: E402

CANARY = "Kanarie7Fq2/Zx9&w:@ %\"<ö"
CONTENT = ["--world", "turns", "--seconds", "3", "--size", "240x148", "--frame-rate", "6", "--bitrate-kbps", "400", "--readout-ms", "0",
           "--offset-ms", "0"]
# Arguments beside the configuration of the commands that need some. All others run with nothing else.
ARGUMENTS = {
    ("calibrate",): ["live", "--board", "chessboard:9x6:0.025", "--output", "out-rig.yaml", "--report", "report.html", "--page", "0"],
    ("calibrate", "readout"): ["live", "--seconds", "3", "--output", "out-readout.yaml"],
    ("camera", "apply"): ["--all", "--yes", "--timeout", "0.5"],
    ("camera", "check"): ["--json", "--timeout", "0.5"],
    ("camera", "reboot"): ["--yes", "--timeout", "0.5"],
    ("camera", "show"): ["--timeout", "0.5"],
    ("doctor",): ["--report", "report.html", "--seconds", "1"],
}
SHORT = "  answer_timeout: 0.3\n  connect_timeout: 0.5\n  stall_timeout: 0.5\n"
COMMAND_S = 2.0  # after which a command that goes on is interrupted
SCENARIOS = ("digest", "basic", "locked", "redirect", "repeat", "silent", "garbage")


def forms(password):
    """Byte strings that give the password away: as it is, encoded, or as the digest that replaces it at a login."""
    core = re.match(r"\w+", password)[0]
    found = {password.encode(), core.encode(), core.encode("utf-16-le"), core.encode().hex().encode(),
             urllib.parse.quote(password, safe="").encode(), urllib.parse.quote_plus(password).encode()}
    for before in ("", "admin:", "a", "aa"):  # base64 at each alignment, without what neighbours change
        text = base64.b64encode((before + password).encode()).decode()
        found.add(text[4 * ((len(before) + 2) // 3):-4].encode())
    for name in ("md5", "sha256"):
        found.add(hashlib.new(name, f"admin:{REALM}:{password}".encode()).hexdigest().encode())
    return {form for form in found if len(form) >= 8}


def leaks(data, secret_forms):
    return sorted({form.decode("latin-1") for form in secret_forms if form.lower() in data.lower()})


class Search:
    """Where the canary was found."""

    def __init__(self, folder):
        self.folder, self.forms, self.found, self.places = folder, forms(CANARY), [], 0

    def data(self, place, data):
        self.places += 1
        if leaked := leaks(data, self.forms):
            self.found.append(f"{place}: {leaked}")

    def process(self, pid, name):
        """The command line and environment of a running process and its children."""
        for file in ("cmdline", "environ", "comm", "status"):
            try:
                self.data(f"/proc/.../{file} of {name}", pathlib.Path(f"/proc/{pid}/{file}").read_bytes())
            except OSError:
                pass  # it has ended

    def files(self, but):
        for path in sorted(self.folder.rglob("*")):
            if path.is_file() and path not in but:
                self.data(path.relative_to(self.folder), path.read_bytes())
            self.data(f"name of {path.relative_to(self.folder)}", path.name.encode())


def commands_with_configuration(program, chain=()):
    """The commands of cartvo that read cartvod's configuration, and so the passwords that it names."""
    if "cartvod's configuration file" in program.help(*chain):
        yield chain
    for command in sorted(program.subcommands(*chain)):
        yield from commands_with_configuration(program, (*chain, command))


class Check:
    def __init__(self, cartvo, cartvod, folder):
        self.cartvo, self.cartvod, self.folder = cartvo, cartvod, folder
        self.search = Search(folder)
        self.password_file = folder / "password"
        with open(os.open(self.password_file, os.O_CREAT | os.O_WRONLY, 0o600), "w") as file:
            file.write(CANARY + "\n")
        self.program = Program(pathlib.Path(cartvo))
        self.chains = list(commands_with_configuration(self.program))
        assert set(ARGUMENTS) <= set(self.chains), f"commands without configuration: {set(ARGUMENTS) - set(self.chains)}"
        self.listener = Listener()
        self.rig = ""

    # --- running

    def run_commands(self, name, configuration):
        return self.end_commands(name, self.start_commands(name, configuration))

    def start_commands(self, name, configuration):
        """Starts all commands at the same time; they do not depend on each other."""
        running = []
        for chain in self.chains:
            folder = self.folder / name / "-".join(chain)
            folder.mkdir(parents=True)
            out = open(folder / "output", "wb")
            option = ["--config"] if "--config" in self.program.options(*chain) else []  # else the first argument
            process = start([self.cartvo, *chain, *ARGUMENTS.get(chain, []), *option, configuration], cwd=folder,
                            stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.STDOUT)
            running.append((chain, process))
            time.sleep(0.02)
            self.search.process(process.pid, " ".join(chain))
        return running

    def end_commands(self, name, running):
        """Interrupts those that go on. The exit code of each command."""
        end = time.monotonic() + COMMAND_S
        for chain, process in running:
            try:
                process.wait(max(end - time.monotonic(), 0.1))
            except subprocess.TimeoutExpired:
                self.search.process(process.pid, " ".join(chain))
                self.page(self.folder / name / "-".join(chain) / "output")
                process.send_signal(signal.SIGINT)
                try:
                    process.wait(10)
                except subprocess.TimeoutExpired:
                    process.kill()
        return {chain: process.wait() for chain, process in running}

    def page(self, output):
        """All documents of the web page that a command serves, if it says where."""
        if address := re.search(rb"http://([\d.]+:\d+)", output.read_bytes()):
            for path in ("/", "/state", "/left.jpg", "/right.jpg", "/nothing"):
                self.get(address[1].decode(), path)

    def get(self, address, path):
        connection = http.client.HTTPConnection(address, timeout=2)
        try:
            connection.request("GET", path)
            answer = connection.getresponse()
            self.search.data(f"http://{address}{path}", str(answer.headers).encode() + answer.read())
            return answer.status
        except OSError:
            return None

    def configuration(self, folder, urls, more=""):
        folder.mkdir(parents=True, exist_ok=True)
        text = camera_section(urls, self.password_file, more)
        text += f"rig: {self.rig}\nmetrics:\n  listen: 127.0.0.1:9464\nlogging:\n  level: debug\n"
        (folder / "config.yaml").write_text(text)
        return text, folder / "config.yaml"

    def run_daemon(self, name, text, until, arguments=(), end_signal=signal.SIGTERM):
        folder = self.folder / name
        folder.mkdir()
        manager = ServiceManager(folder / "notify", 15)
        daemon = Daemon(self.cartvod, folder, text, manager.environment(), arguments=arguments)
        try:
            daemon.await_log(until)
            for path in ("/metrics", "/healthz", "/"):
                await_(lambda path=path: self.get("127.0.0.1:9464", path), path)
            self.search.process(daemon.process.pid, "cartvod")
            (folder / "cartvod.yaml").write_text(text + f"lcm:\n  no_such_key: 1\n  # {time.time()}\n")
            daemon.signal(signal.SIGHUP)
            daemon.await_log("the old one stays in force")
            daemon.signal(end_signal)
            daemon.wait()
        finally:
            daemon.stop()
        self.search.data("notes to systemd", "\n".join(note for _, note in manager.notes).encode())
        return daemon

    # --- what is checked

    def check_the_search(self):
        """Leaks in plain sight are found, of each form."""
        for form in forms(CANARY):
            assert leaks(b"x" + form + b"y", self.search.forms), form
        for text in (f'rtsp://admin:{CANARY}@host/', urllib.parse.quote(CANARY), base64.b64encode(f"admin:{CANARY}".encode()).decode()):
            assert leaks(text.encode(), self.search.forms), text

    def check_core_dumps(self, end_signals, running):
        """No core is dumped by signals that dump one, though a decoy with the same limits does."""
        resource.setrlimit(resource.RLIMIT_CORE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
        decoy = start(["sleep", "60"], cwd=self.folder)
        decoy.send_signal(signal.SIGABRT)
        _, status = os.waitpid(decoy.pid, 0)
        decoy.returncode = -signal.SIGABRT
        assert os.WCOREDUMP(status), "the decoy dumped no core: this computer permits none, nothing can be checked"
        for end_signal in end_signals:
            process = running()
            process.send_signal(end_signal)
            _, status = os.waitpid(process.pid, 0)
            process.returncode = -end_signal
            assert os.WIFSIGNALED(status) and not os.WCOREDUMP(status), f"{process.args} dumped a core at signal {end_signal}"

    def check_streams(self):
        """Cameras that stream: a recording, all pages, and the end by SIGABRT."""
        cameras = Cameras(self.cartvo, self.folder / "cameras", [*CONTENT, "--cache-dir", str(self.folder / "cache")],
                          password_file=self.password_file)
        self.rig = self.folder / "cameras/rig.yaml"
        self.search.process(cameras.process.pid, "simulate")
        try:
            text, file = self.configuration(self.folder / "streams", cameras.urls)
            # The odometry channel is reserved, and the simulated cameras serve two clients: one after the other.
            self.run_daemon("streams-recorded", text, "odometry is valid", ["--record", "recording"])
            recordings = list(self.folder.rglob("recording.json"))
            assert recordings, "nothing was recorded"
            for what in ("", "verify"):
                self.run_tool("recording", what, recordings[0].parent)
            self.run_tool("replay", "", recordings[0].parent)
            codes = self.run_commands("streams", file)
            assert codes[("calibrate",)] != 0
            self.check_core_dumps((signal.SIGABRT, signal.SIGSEGV), lambda: self.streaming_daemon(text))
        finally:
            cameras.stop()

    def run_tool(self, command, what, source):
        folder = self.folder / f"{command}{what}"
        folder.mkdir()
        with open(folder / "output", "wb") as out:
            words = [word for word in (command, what) if word]
            subprocess.run([self.cartvo, *words, source], cwd=folder, stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.STDOUT)

    def streaming_daemon(self, text):
        daemon = Daemon(self.cartvod, self.folder / "aborted", text)
        daemon.await_log("odometry is valid")
        return daemon.process

    def check_faulty_cameras(self):
        for name in SCENARIOS:
            with FaultyCamera(name, "127.0.0.1"), FaultyCamera(name, "127.0.0.2"):
                urls = [f"rtsp://127.0.0.{i}/Streaming/Channels/101" for i in (1, 2)]
                authentication = "basic" if name in ("basic", "redirect", "repeat") else "digest"
                text, file = self.configuration(self.folder / name, urls, f"{SHORT}  authentication: {authentication}\n")
                running = self.start_commands(name, file)
                self.run_daemon(f"{name}-daemon", text, "left camera: ")
                self.end_commands(name, running)
        urls = ["rtsp://127.0.0.1:9/", "rtsp://no-such-host.invalid/"]
        text, file = self.configuration(self.folder / "absent", urls, SHORT)
        running = self.start_commands("absent", file)
        self.run_daemon("absent-daemon", text, "right camera: ")
        self.end_commands("absent", running)

    def check_wrong_configurations(self):
        """A password where none belongs is not repeated by the error message."""
        camera = camera_section(["rtsp://127.0.0.1/", "rtsp://127.0.0.2/"], self.password_file)
        urls = [f"rtsp://admin:{quoted}@127.0.0.1/" for quoted in (CANARY.replace('"', ""), urllib.parse.quote(CANARY, safe=""))]
        wrong = {
            "in the URL": camera.replace("rtsp://127.0.0.1/", f"'{urls[0]}'"),
            "quoted in the URL": camera.replace("rtsp://127.0.0.1/", urls[1]),
            "in an unfinished URL": camera.replace("rtsp://127.0.0.1/", f"'{urls[1]}"),
            "as a key": camera.replace("    username", f"    password: '{CANARY}'\n    username", 1),
            "as a list": camera.replace("    username: admin", f"    username: [admin, '{CANARY}']", 1),
        }
        for name, text in wrong.items():
            folder = self.folder / name.replace(" ", "-")
            folder.mkdir()
            file = folder / "wrong.yaml"
            file.write_text(text + f"rig: {self.rig}\n")
            wrong_files.append(file)
            for chain, code in self.run_commands(f"{folder.name}-commands", file).items():
                assert code != 0, f"password {name}: {' '.join(chain)} accepts it"
            with open(folder / "daemon-output", "wb") as out:
                for more in ([], ["--check-config"]):
                    code = subprocess.run([self.cartvod, "--config", file, *more], cwd=folder, stdout=out, stderr=subprocess.STDOUT,
                                          timeout=30).returncode
                    assert code == 2, f"password {name}: cartvod exits with {code}"


wrong_files = []  # that hold the canary themselves


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory(prefix="cartvo-secrets-", ignore_cleanup_errors=True) as name:
        folder = pathlib.Path(name)
        check = Check(*map(os.path.abspath, sys.argv[1:3]), folder)
        check.check_the_search()
        check.check_streams()
        check.check_faulty_cameras()
        check.check_wrong_configurations()
        for data in check.listener.datagrams:
            check.search.data("LCM", data)
        check.search.files(but=[check.password_file, *wrong_files])
        assert check.listener.datagrams and check.listener.messages
        print("\n".join(f"LEAK in {place}" for place in check.search.found) or
              f"check_secrets: {len(check.chains)} commands and cartvod, {check.search.places} places: no password")
        return 1 if check.search.found else 0


if __name__ == "__main__":
    sys.exit(main())
