#!/usr/bin/env python3
"""same_on_each_processor.py DIGEST [COMMAND ...]: test that the odometry gives the same bits on this processor, on one
with AVX2 but without AVX-512, and on one with SSE only (both emulated by QEMU). With COMMAND, which runs DIGEST built for
another architecture (tests/system/arm64.sh), the results must also agree with that one within BOUND.

The C library selects its sine functions by processor as well, and those without fused multiply-add differ in the last bit.
Each emulated processor is therefore compared with this one under the same sines, and the two sines with each other within
BOUND. On other architectures Eigen also adds in another order.
"""
import os
import pathlib
import platform
import subprocess
import sys
import tempfile

SKIPPED = 77
METHODS = 2
ESTIMATES = 5 * METHODS  # the first pair of each has no motion
BOUND = 1e-9    # m, rad and their products; the last bits of the sines cause some 1e-14
PLAIN_SINES = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4"}


def drive(command: list[str], sines: dict[str, str] | None = None) -> list[list[str]]:
    """Runs COMMAND with the given sines; returns the words of each line of its output."""
    done = subprocess.run(command, env={**os.environ, **(sines or {})}, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}: exit {done.returncode}\n{done.stderr}")
    return [line.split() for line in done.stdout.splitlines()]


def largest_difference(a: list[list[str]], b: list[list[str]]) -> float:
    """Largest difference of two outputs; infinite if different estimates are valid."""
    if [line[0] for line in a] != [line[0] for line in b]:
        return float("inf")
    return max(abs(float.fromhex(x) - float.fromhex(y)) for p, q in zip(a, b, strict=True) for x, y in
               zip(p[2:], q[2:], strict=True))


def main() -> int:
    digest = sys.argv[1]
    if platform.machine() != "x86_64":
        print("skipped: this machine is not x86_64, so that QEMU cannot emulate its older processors")
        return SKIPPED
    with tempfile.TemporaryDirectory() as folder:
        images = str(pathlib.Path(folder) / "images")
        subprocess.run([digest, "draw", images], check=True)
        command = [digest, "drive", images]
        here = {"Haswell": drive(command), "Nehalem": drive(command, PLAIN_SINES)}
        valid = sum(line[0] == "1" for line in here["Haswell"])
        # Two empty outputs would agree.
        if len(here["Haswell"]) != ESTIMATES or valid != ESTIMATES - METHODS:
            sys.exit(f"{valid} of {len(here['Haswell'])} estimates are valid: expected {ESTIMATES - METHODS} of {ESTIMATES}")
        for processor, expected in here.items():
            if drive(["qemu-x86_64", "-cpu", processor, *command]) != expected:
                sys.exit(f"{processor} gives different bits than this processor")
        if (difference := largest_difference(*here.values())) > BOUND:
            sys.exit(f"without fused multiply-add in the C library, results differ by {difference}: expected at most {BOUND}")
        print(f"same bits here, on Haswell and on Nehalem; difference by the C library's sines {difference:.1e}")
        if other := sys.argv[2:]:
            if (difference := largest_difference(drive([*other, "drive", images]), here["Haswell"])) > BOUND:
                sys.exit(f"{' '.join(other)} differs by {difference}: expected at most {BOUND}")
            print(f"difference to the other architecture {difference:.1e}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
