#!/usr/bin/env python3
"""same_on_each_processor.py DIGEST [COMMAND ...]: the odometry gives the same bits on this processor, on one that has AVX2
but no AVX-512, and on one that has SSE only, which QEMU plays; and within a bound the same as COMMAND, which runs DIGEST as it
was built for another architecture (tests/system/arm64.sh).

The C library chooses its sines by the processor too, and those without fused multiply-add differ in the last bit. So
each is compared with this processor under the same sines, and those among each other within a bound. On other
architectures Eigen adds in another order, too.
"""
import os
import pathlib
import platform
import subprocess
import sys
import tempfile

SKIPPED = 77
ESTIMATES = 10  # of five pairs by two methods; the first of each has no motion
BOUND = 1e-9    # m, rad and their products; the sines' last bits make some 1e-14
PLAIN_SINES = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4"}


def drive(command: list[str], sines: dict[str, str] | None = None) -> list[list[str]]:
    """The digest's lines, in words."""
    done = subprocess.run(command, env={**os.environ, **(sines or {})}, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}: exit {done.returncode}\n{done.stderr}")
    return [line.split() for line in done.stdout.splitlines()]


def largest_difference(a: list[list[str]], b: list[list[str]]) -> float:
    """Infinite if they do not agree on which estimates are valid."""
    if [line[0] for line in a] != [line[0] for line in b]:
        return float("inf")
    return max(abs(float.fromhex(x) - float.fromhex(y)) for p, q in zip(a, b, strict=True) for x, y in
               zip(p[2:], q[2:], strict=True))


def main() -> int:
    digest = sys.argv[1]
    if platform.machine() != "x86_64":
        print("not a processor whose lesser ones QEMU could play here")
        return SKIPPED
    with tempfile.TemporaryDirectory() as folder:
        images = str(pathlib.Path(folder) / "images")
        subprocess.run([digest, "draw", images], check=True)
        command = [digest, "drive", images]
        here = {"Haswell": drive(command), "Nehalem": drive(command, PLAIN_SINES)}
        valid = sum(line[0] == "1" for line in here["Haswell"])
        # A digest that says nothing would agree with any other.
        if len(here["Haswell"]) != ESTIMATES or valid != ESTIMATES - 2:
            sys.exit(f"{valid} of {len(here['Haswell'])} estimates are valid: expected {ESTIMATES - 2} of {ESTIMATES}")
        for processor, expected in here.items():
            if drive(["qemu-x86_64", "-cpu", processor, *command]) != expected:
                sys.exit(f"{processor} gives other bits than this processor")
        if (difference := largest_difference(*here.values())) > BOUND:
            sys.exit(f"without fused multiply-add in the C library, results differ by {difference}: at most {BOUND} is expected")
        print(f"the same here, on Haswell and on Nehalem; by the C library's sines {difference:.1e}")
        if other := sys.argv[2:]:
            if (difference := largest_difference(drive([*other, "drive", images]), here["Haswell"])) > BOUND:
                sys.exit(f"{' '.join(other)} differs by {difference}: at most {BOUND} is expected")
            print(f"of another architecture the same but for {difference:.1e}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
