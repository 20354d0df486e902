#!/usr/bin/env python3
"""check_accuracy.py CARTVO --limits FILE --cache-dir DIR: holds `lab/lab accuracy` to committed limits.

FILE (JSON) lists runs: the arguments of `lab/lab accuracy`, and for each sequence of the report the largest
value that each figure may have, named by its path in the report ("evaluation/rpe_rmse_m"). An error is the median of
runs with different numbers of features, because a single one varies with the processor by half of its value; counts, and
figures of a cart that stands, are the largest. Limits are about 1.3 times the figures of the day they were committed;
those of a cart that stands, which are sums of noise, 1.2 times the largest of ten runs with 860 to 1,200 features. A
figure that is missing or not a number is a failure.

Real sequences are looked for in $CARTVO_DATA, else in ../shared/data. A run that needs them ("needs_data") is left out
where the folder is missing, unless CARTVO_REQUIRE_DATA=1. Rendered worlds are kept in DIR.
"""
import argparse
import json
import math
import os
import pathlib
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
FEATURE_COUNTS = (960, 980, 1000, 1020, 1040)


def data_folder() -> pathlib.Path:
    return pathlib.Path(os.environ.get("CARTVO_DATA") or ROOT / "../shared/data").resolve()


def figure(sequence: dict, path: str) -> float:
    """The number at a path of keys; NaN if there is none."""
    value = sequence
    for key in path.split("/"):
        value = value.get(key) if isinstance(value, dict) else None
    return float(value) if isinstance(value, (int, float)) else math.nan


def figure_of_runs(sequences: list[dict], path: str) -> float:
    """The median of a figure of an evaluation over the runs of a sequence, the largest of others; NaN if one is missing."""
    values = [figure(sequence, path) for sequence in sequences]
    if any(math.isnan(value) for value in values):
        return math.nan
    return statistics.median(values) if "/" in path else max(values)


def measure(program: str, arguments: list[str], cache: str) -> dict[str, list[dict]]:
    """The results of each sequence."""
    command = [str(ROOT / "lab/lab"), "accuracy", *arguments, "--features", ",".join(map(str, FEATURE_COUNTS)), "--estimators",
               "reprojection", "--cartvo", program, "--cache-dir", cache, "--json"]
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}: exit {done.returncode}")
    measured = {}
    for result in json.loads(done.stdout)["results"]:
        measured.setdefault(result["sequence"], []).append(result)
    return measured


def exceeded(limits: dict[str, dict[str, float]], measured: dict[str, list[dict]]) -> list[str]:
    """The figures above their limits; prints all."""
    problems = []
    for name, most in limits.items():
        if name not in measured:
            problems.append(f"{name}: not in the report, which has {', '.join(measured)}")
            continue
        for path, limit in most.items():
            value = figure_of_runs(measured[name], path)
            within = value <= limit
            print(f"{name:24} {path:54} {value:10.5g}  limit {limit:g}{'' if within else '  EXCEEDED'}", flush=True)
            if not within:
                problems.append(f"{name}: {path} is {value:.5g}: at most {limit:g} is expected")
    return problems


def check(program: str, run: dict, cache: str) -> list[str]:
    data = data_folder()
    arguments = [argument.replace("DATA", str(data)) for argument in run["arguments"]]
    if run.get("needs_data") and not data.is_dir():
        if os.environ.get("CARTVO_REQUIRE_DATA") == "1":
            return [f"{data}: no such folder, but CARTVO_REQUIRE_DATA=1"]
        print(f"left out: {data} is not on this machine")
        return []
    return exceeded(run["limits"], measure(program, arguments, cache))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--limits", type=pathlib.Path, required=True)
    parser.add_argument("--cache-dir", required=True)
    options = parser.parse_args()
    problems = [problem for run in json.loads(options.limits.read_text())["runs"]
                for problem in check(options.program, run, options.cache_dir)]
    print("\n".join(problems) if problems else "all within their limits")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
