"""Results of jobs: the commands that make them, and their table."""
import json
import shlex

from laboratory.program import LabError

# Options that do not change what is measured, with the number of their values.
ABOUT_OUTPUT = {"--against": 1, "--list": 1, "--merge": 1, "--only": 1, "--output": 1, "--jobs": 1, "--threads": 1, "--json": 0, "--markdown": 0}


def given(arguments):
    """The words of a command line that say what is measured."""
    kept, skip = [], 0
    for word in arguments:
        name, has_value, _ = word.partition("=")
        if skip:
            skip -= 1
        elif name in ABOUT_OUTPUT:
            skip = 0 if has_value else ABOUT_OUTPUT[name]
        else:
            kept.append(word)
    return shlex.join(kept)


def listed(program, command, arguments, folder, count):
    """A command for each job."""
    options = given(arguments)
    return [" ".join(filter(None, [shlex.quote(program), command, options, f"--only {number} --jobs 1 --json --output",
                                   shlex.quote(f"{folder}/{number}.json")])) for number in range(1, count + 1)]


def document(command, arguments, results, job=0, jobs=0):
    return {"lab": command, "options": given(arguments), "job": job, "jobs": jobs, "results": results}


def read(command, file):
    """Job, options, number of jobs and results of a file."""
    try:
        document = json.loads(file.read_text())
        lab, job, options, jobs, results = (document[key] for key in ("lab", "job", "options", "jobs", "results"))
    except (ValueError, KeyError, TypeError):
        raise LabError(f"{file}: no result of a job of lab {command} --list, nor of lab {command} --json") from None
    if lab != command:
        raise LabError(f"{file}: of other work (lab {lab} {options}); expected results of lab {command}")
    return job, options, jobs, results


def merged(command, path):
    """The results of all jobs in a folder, in the order of the jobs, or those of a file of --json."""
    if path.is_file():
        job, _, jobs, results = read(command, path)
        if job:
            raise LabError(f"{path}: only the result of job {job} of {jobs}; name the folder of all of them")
        return results
    if not path.is_dir():
        raise LabError(f"{path}: no such folder; expected the results of the jobs of lab {command} --list, or a file of --json")
    by_job = {}
    for file in sorted(path.glob("*.json")):
        job, options, jobs, results = read(command, file)
        first = next(iter(by_job.values()), (options, jobs, None))
        if (options, jobs) != first[:2]:
            raise LabError(f"{file}: of other work (lab {command} {options}, {jobs} jobs) than the others")
        if job in by_job:
            raise LabError(f"{file}: a second result of job {job}")
        by_job[job] = (options, jobs, results)
    if not by_job:
        raise LabError(f"{path}: no results (*.json) of the jobs of lab {command} --list")
    jobs = next(iter(by_job.values()))[1]
    if missing := [str(number) for number in range(1, jobs + 1) if number not in by_job]:
        raise LabError(f"{path}: results of {len(by_job)} of {jobs} jobs; missing: {', '.join(missing)}")
    return [result for _, (_, _, results) in sorted(by_job.items()) for result in results]
