"""`cartvo evaluate`: compares an estimated trajectory with the truth."""
import os
import pathlib
import signal
import sys

import numpy as np

from evaluation.measures import evaluate
from evaluation.messages import body_trajectory, is_messages_file, read_messages
from evaluation.options import read_options
from evaluation.pairing import Fit, fit_estimate, frame_problem, later, pair_by_time, pair_files
from evaluation.program import (EvaluationError, UsageError, check_can_be_written, excerpt, occupy_standard_descriptors, print_output, warn,
                                write_file)
from evaluation.results import Compared, results_text
from evaluation.trajectory import BODY, read_trajectory
from evaluation.validity import judge, judge_file, messages_csv, read_body_truth


def fit_of(options):
    return Fit(round(1e9 * options.offset), options.align, options.correct_scale)


def compare_messages(file, options):
    """The estimate is a file of messages: the poses, velocities and bounds are theirs."""
    fit, messages = fit_of(options), read_messages(file)
    messages.times = later(messages.times, fit.offset_ns)
    truth = read_body_truth(options.truth, file, messages.times)
    try:
        pairing = pair_by_time(body_trajectory(messages), truth)
        poses = pathlib.Path(file).parent / "trajectory.tum"
        if truth.frame == BODY and poses.exists():
            problem = frame_problem(file, read_trajectory(poses).frame, options.truth, truth.frame, fit.aligns)
            pairing.problems += [problem] if problem else []
        fit_estimate(fit, pairing)
    except EvaluationError as error:
        raise EvaluationError(f"{file} and {options.truth}: {error}") from None
    return Compared(file, evaluate(pairing), False, judge(messages, truth), file)


def compare(file, options):
    if is_messages_file(file):
        return compare_messages(file, options)
    if options.messages:
        raise EvaluationError(f"{file}: is no odometry.csv, whose messages --messages writes")
    pairing, is_of_camera = pair_files(file, options.truth, fit_of(options))
    return Compared(file, evaluate(pairing), is_of_camera)


def add_messages(compared, options):
    """The messages of --odometry, or of the odometry.csv beside the estimate if there is one. The latter is not required: a problem with it
    is only a warning."""
    file = options.odometry or str(pathlib.Path(compared.name).parent / "odometry.csv")
    if compared.judged or not options.odometry and not os.path.exists(file):
        return
    try:
        compared.judged, compared.odometry = judge_file(file, options.truth, fit_of(options).offset_ns), file
    except EvaluationError as error:
        if options.odometry:
            raise
        warn(f"velocities and NEES are left out: {error}")


def run(options, version):
    for file in (options.plot, options.report, options.messages):
        if file:
            check_can_be_written(file)
    if options.plot or options.report or options.figures_dir:
        from evaluation import chart  # fails before the work if its package is missing
    all_compared = [compare(file, options) for file in options.files]
    print_output(results_text(all_compared, options))
    if options.messages:
        write_file(options.messages, messages_csv(all_compared[0].judged).encode())
    if options.plot:
        from evaluation.figures import plot_charts
        write_file(options.plot, chart.picture(plot_charts(all_compared), pathlib.PurePath(options.plot).suffix[1:]))
    if options.report or options.figures_dir:
        from evaluation.page import write_report
        for compared in all_compared:
            add_messages(compared, options)
        write_report(all_compared, options, version)


def main(version):
    """Returns the exit code: 0 success, 1 failure, 2 wrong command line."""
    for signal_number in (signal.SIGINT, signal.SIGPIPE):
        signal.signal(signal_number, signal.SIG_DFL)
    occupy_standard_descriptors()
    np.seterr(all="ignore")  # values that are no numbers are shown as such
    try:
        if sys.argv[1:2] in (["--of-replay"], ["--check-truth"]):  # see `cartvo replay --truth`
            from evaluation.of_replay import evaluate_replay, read_truth
            (evaluate_replay if sys.argv[1] == "--of-replay" else read_truth)(*sys.argv[2:3])
            return 0
        options = read_options(sys.argv[1:], version)
        if options:
            run(options, version)
        return 0
    except UsageError as error:
        print(f"cartvo: {excerpt(str(error), 4000)}\n'cartvo evaluate --help' explains the command.", file=sys.stderr)
        return 2
    except EvaluationError as error:
        lines = str(error).split("\n")
        print("cartvo: " + "\n".join(excerpt(line, 4000) for line in lines), file=sys.stderr)
        return 1
    except MemoryError:
        print("cartvo: the memory does not suffice for these files", file=sys.stderr)
        return 1
