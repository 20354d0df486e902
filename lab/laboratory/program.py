"""Runs the programs of cartvo."""
import json
import os
import pathlib
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


class LabError(Exception):
    """A wrong input or a program that failed; the message is for the user."""


class Cartvo:
    """The program cartvo: the named one, else that of the release build, else the installed one."""

    def __init__(self, path=None):
        built = ROOT / "build/release/tools/cartvo/cartvo"
        found = path or (str(built) if built.is_file() else shutil.which("cartvo"))
        if not found or not shutil.which(found):
            raise LabError(f"{found or built}: no such program; build it (tools/build), or name it with --cartvo")
        self.path = found

    def run(self, *arguments, failure_allowed=False):
        """The output of a command. With failure_allowed: None if it fails."""
        command = [self.path, *map(str, arguments)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode == 0:
            return done.stdout
        if failure_allowed:
            return None
        raise LabError(f"{' '.join(command)}: exit code {done.returncode}\n{done.stderr[-1000:].strip()}")

    def module(self):
        """The Python module cartvo of the program's build; of an installed program the installed one."""
        built = pathlib.Path(shutil.which(self.path)).resolve().parent.parent.parent
        if (built / "CMakeCache.txt").exists() and str(built / "python") not in sys.path:
            sys.path.insert(0, str(built / "python"))
        try:
            import cartvo
        except ImportError as error:
            raise LabError(f"the Python module cartvo is missing ({error}); build it (cmake -D CARTVO_PYTHON=ON), or install python3-cartvo"
                           ) from None
        if (built / "CMakeCache.txt").exists() and built not in pathlib.Path(cartvo.__file__).resolve().parents:
            raise LabError(f"{cartvo.__file__}: not of the build of {self.path}; build its Python module (cmake -D CARTVO_PYTHON=ON)")
        return cartvo

    def evaluate(self, estimate, truth, *arguments):
        return json.loads(self.run("evaluate", estimate, truth, "--json", *arguments))


def processors():
    return len(os.sched_getaffinity(0))
