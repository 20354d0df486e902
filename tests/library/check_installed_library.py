#!/usr/bin/env python3
"""check_installed_library.py CARTVO BUILD-FOLDER DRIVE: installs the component "library" into an empty folder and uses it.

Compiles each installed header alone, builds the examples by find_package and by pkg-config, and runs them: on the images
and the recording of make_drive.py, and on two simulated cameras. Run by tests/support/in_network_namespace.sh.
"""
import concurrent.futures
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/support"))
from running_cart import Cameras  # noqa: E402

# OpenCV's headers warn by themselves in C++20 where the include folder is not a system folder.
WARNINGS = ["-std=c++20", "-Wall", "-Wextra", "-Werror", "-Wno-deprecated-enum-enum-conversion"]
FEW = 4  # headers that are not worth a precompiled one
INCLUDED_BY = {"Eigen/Core": "Eigen/Geometry", "opencv2/core/types.hpp": "opencv2/core/mat.hpp"}
PAIRS = 100  # at 9 a second: on a loaded machine the clocks of the cameras are related late


def run(*command, **options):
    """The output of a command; AssertionError with it if the command fails."""
    done = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          timeout=300, **options)
    assert done.returncode == 0, f"{shlex.join(map(str, command))}: exit code {done.returncode}\n{done.stdout}"
    return done.stdout


class Installation:
    """The installed component, and the programs that are built against it."""

    def __init__(self, build, folder):
        self.folder, self.prefix = folder, folder / "usr"
        run("cmake", "--install", build, "--component", "library", "--prefix", self.prefix)
        sanitizers = re.search(r"^CARTVO_SANITIZE:STRING=(.+)$", (build / "CMakeCache.txt").read_text(), re.M)
        self.flags = [f"-fsanitize={sanitizers[1]}"] if sanitizers else []
        pc = next(self.prefix.glob("**/cartvo-vo.pc"))
        self.pkg_config_path = {"PKG_CONFIG_PATH": str(pc.parent), "PATH": "/usr/bin:/bin"}
        self.examples = sorted(next(self.prefix.glob("**/examples")).glob("0*/CMakeLists.txt"))

    def pkg_config(self, *arguments):
        return run("pkg-config", *arguments, env=self.pkg_config_path).split()

    def check_headers(self):
        """Compiles each header alone. Those that include the same ones of OpenCV and Eigen share these, precompiled."""
        include = self.prefix / "include"
        headers = sorted(include.glob("**/*.hpp"))
        assert len(headers) > 40, headers

        def foreign(header):
            names = re.findall(r"^#include <(.+)>", header.read_text(), re.M)
            return {name for name in names if name.startswith(("Eigen/", "opencv2/"))}.union(
                *(foreign(include / name) for name in names if name.startswith("cartvo/")))

        groups = {}
        for header in headers:
            names = foreign(header)
            covered = {small for small, large in INCLUDED_BY.items() if large in names}
            groups.setdefault(tuple(sorted(names - covered)), []).append(header)
        # Precompiled headers forget which warnings Eigen switches off.
        compiler = ["g++", *WARNINGS, "-Wno-ignored-attributes", *self.pkg_config("--cflags", "cartvo-pipeline")]

        def compile_alone(header, *before):
            run(*compiler, "-fsyntax-only", *before, "-include", header, "-x", "c++", "/dev/null")

        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            for number, (names, group) in enumerate(groups.items()):
                before = []
                if names and len(group) > FEW:
                    shared = self.folder / f"shared_{number}.hpp"
                    shared.write_text("".join(f"#include <{name}>\n" for name in names))
                    run(*compiler, "-x", "c++-header", shared)
                    before = ["-include", shared]
                list(pool.map(lambda header, before=before: compile_alone(header, *before), group))
        print(f"library: {len(headers)} headers compile alone")

    def build_example(self, name):
        """The programs made of an example, by find_package and by pkg-config."""
        (listing,) = (file for file in self.examples if file.parent.name == name)
        built = self.folder / name
        run("cmake", "-S", listing.parent, "-B", built, f"-DCMAKE_PREFIX_PATH={self.prefix}",
            f"-DCMAKE_CXX_FLAGS={' '.join(['-Wall -Wextra -Werror', *self.flags])}")
        run("cmake", "--build", built)
        component = re.search(r"cartvo::(\w+)", listing.read_text())[1]
        by_pkg_config = built / "by_pkg_config"
        run("g++", *WARNINGS, *self.flags, listing.parent / "main.cpp", "-o", by_pkg_config,
            *self.pkg_config("--cflags", "--libs", f"cartvo-{component}"))
        return built / name[3:], by_pkg_config


def check_odometry_on_images(program, drive):
    lines = run(program, drive / "images").splitlines()
    assert len(lines) == 36, lines
    x, y, z = map(float, lines[-1].split()[3:6])
    truth = [float(word) for word in (drive / "images/poses.txt").read_text().splitlines()[-1].split()]
    error = ((x - truth[3]) ** 2 + (y - truth[7]) ** 2 + (z - truth[11]) ** 2) ** 0.5
    assert truth[11] > 0.3 and error < 0.1, (lines[-1], truth)


def check_two_rtsp_cameras(program, drive, cameras):
    lines = run(program, drive / "images/rig.yaml", *cameras.urls, "admin", cameras.password_file, PAIRS).splitlines()
    pairs = [line for line in lines if " valid " in line or " invalid " in line]
    assert len(pairs) == PAIRS and any(" valid " in line for line in pairs), lines


def check_read_a_recording(program, drive):
    lines = run(program, drive / "recording").splitlines()
    replayed = len((drive / "replay-recording/odometry.csv").read_text().splitlines()) - 1
    assert lines[-1] == f"{replayed} pairs" and len(lines) == replayed + 1, lines
    assert "[340 x 210] px" in lines[0], lines[0]


def main():
    cartvo, build, drive = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    with tempfile.TemporaryDirectory() as folder:
        installation = Installation(build, pathlib.Path(folder))
        if not installation.flags:
            installation.check_headers()
        cameras = Cameras(cartvo, pathlib.Path(folder) / "cameras", ["--sequence", drive / "images"])
        for program in installation.build_example("01_odometry_on_images"):
            check_odometry_on_images(program, drive)
        for program in installation.build_example("02_two_rtsp_cameras"):
            check_two_rtsp_cameras(program, drive, cameras)
        for program in installation.build_example("03_read_a_recording"):
            check_read_a_recording(program, drive)
        print("library: three examples built by find_package and by pkg-config, and run")


if __name__ == "__main__":
    main()
