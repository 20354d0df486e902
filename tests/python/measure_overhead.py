#!/usr/bin/env python3
"""measure_overhead.py DRIVE CPP_PROGRAM [ROUNDS]: what Python adds to the time of a pair.

Runs the odometry on the images of DRIVE in memory, in Python and in C++ (time_odometry.cpp) by turns, and compares the CPU
times of each pair. Run by hand on a quiet computer, with PYTHONPATH=build/release/python.
"""
import statistics
import subprocess
import sys
import time

import cartvo


def python_times(pairs, rectifier):
    odometry = cartvo.Odometry(rectifier)
    times = []
    for index, (left, right) in enumerate(pairs):
        begin = time.process_time()
        odometry.process(left, right, index * 100_000_000, index * 100_000_000)
        times.append(1e3 * (time.process_time() - begin))
    return times


def main():
    drive, program, rounds = sys.argv[1], sys.argv[2], int(sys.argv[3]) if len(sys.argv) > 3 else 10
    recording = cartvo.Recording(drive)
    rectifier = cartvo.Rectifier(recording.rig)
    pairs = [rectifier.rectify(pair.left, pair.right) for pair in recording]
    in_python, in_cpp = [], []
    for _ in range(rounds):
        in_python.append(python_times(pairs, rectifier))
        in_cpp.append([float(line) for line in subprocess.check_output([program, drive], text=True).split()])
    # The fastest round of each pair: what others do on this computer only adds.
    ratios = [min(a) / min(b) for a, b in zip(zip(*in_python), zip(*in_cpp), strict=True)]
    print(f"{len(pairs)} pairs, {rounds} rounds: Python {statistics.median(map(min, zip(*in_python))):.3f} ms, "
          f"C++ {statistics.median(map(min, zip(*in_cpp))):.3f} ms of CPU a pair; "
          f"overhead {100 * (statistics.median(ratios) - 1):+.2f} %")


if __name__ == "__main__":
    main()
