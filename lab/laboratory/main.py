"""The command line of the laboratory."""
import argparse
import json
import sys

from laboratory import accuracy, jobs, judge, offset, options as shared, robustness, sensitivity, shutter, speed, stanford, thesis
from laboratory.measure import Bench, measure_all
from laboratory.program import Cartvo, LabError

COMMANDS = {"accuracy": accuracy, "judge": judge, "offset": offset, "shutter": shutter, "robustness": robustness, "speed": speed,
            "sensitivity": sensitivity, "thesis": thesis, "stanford": stanford}
ABOUT = """Measures the odometry on real sequences and on rendered drives with known truth, by the commands of cartvo.

A drive is rendered once, at about two pairs a second, and kept in the cache. lab/campaign judges the messages of many replays,
lab/inject_fault makes a drive with a fault. lab/README.md begins here."""


def parser():
    top = argparse.ArgumentParser(prog="lab", description=ABOUT, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = top.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for name, module in COMMANDS.items():
        command = commands.add_parser(name, help=module.HELP, description=module.HELP + ".", epilog="Examples:\n" + module.EXAMPLES,
                                      formatter_class=argparse.RawDescriptionHelpFormatter)
        module.add_options(command)
        if name == "stanford":
            continue
        shared.add_common(command, getattr(module, "JOBS", None))
        if name not in ("thesis", "speed"):
            shared.add_drives(command, getattr(module, "SET", None))
    return top


def printed(module, command, arguments, results, options, job, count):
    if options.json:
        return json.dumps(jobs.document(command, arguments, results, job, count), indent=1) + "\n"
    tables, notes = module.report(results, options) if module is judge else module.report(results)
    form = "markdown" if options.markdown else "text"
    return "\n".join([*(getattr(table, form)() for table in tables), notes]) + "\n"


def run(program, arguments):
    """The text to print, and the file to write it to, if any."""
    options = parser().parse_args(arguments)
    module, command, arguments = COMMANDS[options.command], options.command, arguments[1:]
    if hasattr(module, "text") and (text := module.text(options)) is not None:
        return text, options.output
    job, count = options.only or 0, 0
    if options.merge:
        results = jobs.merged(command, options.merge)
    else:
        cases = module.cases(options)
        count = len(cases)
        if not cases:
            raise LabError("nothing to measure: neither real sequences nor drives; give --data or --scenarios")
        if options.list:
            return "\n".join(jobs.listed(program, command, arguments, options.list, count)) + "\n", options.output
        if options.only is not None and not 1 <= options.only <= count:
            raise LabError(f"--only {options.only}: expected 1 to {count}")
        cases = cases[job - 1:job] if job else cases
        bench = Bench(Cartvo(options.cartvo), options.cache_dir.resolve(), options.threads, options.alert_limits, options.jobs)
        if hasattr(module, "measure_one"):
            results = measure_all(bench, cases, module.measure_one)
        else:
            results = getattr(module, "measure_all", measure_all)(bench, cases)
    return printed(module, command, arguments, results, options, job, count), options.output


def main(program, arguments):
    try:
        text, output = run(program, arguments)
        if output:
            output.parent.mkdir(parents=True, exist_ok=True)
            output.write_text(text)
        else:
            print(text, end="")
        return 0
    except (LabError, OSError) as problem:
        print(f"lab: {problem}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
