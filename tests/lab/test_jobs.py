"""The command line, jobs and their results."""
import json
import os
import pathlib
import subprocess
import sys

import pytest

from laboratory import drives, jobs
from laboratory.main import main, parser
from laboratory.program import LabError

LAB = str(pathlib.Path(__file__).resolve().parents[2] / "lab/lab")


def lines_of(capsys, *arguments):
    assert main("lab/lab", list(arguments)) == 0
    return capsys.readouterr().out.splitlines()


def error_of(capsys, *arguments):
    assert main("lab/lab", list(arguments)) == 1
    return capsys.readouterr().err


def test_jobs_are_commands_with_the_options_that_select(capsys):
    lines = lines_of(capsys, "accuracy", "--data", "none", "--scenarios", "turns,campus", "--seconds=8", "--estimators", "reprojection",
                     "--jobs", "2", "--list", "my results")
    assert lines == [f"lab/lab accuracy --data none --scenarios turns,campus --seconds=8 --estimators reprojection --only {n} --jobs 1 "
                     f"--json --output 'my results/{n}.json'" for n in (1, 2)]


@pytest.mark.parametrize("command, count", [(["offset", "--scenarios", "campus", "--offsets-ms", "25", "--sweeps", "fast"], 6),
                                            (["shutter", "--scenarios", "campus", "--readouts-ms", "0,32", "--offsets-ms", "0", "--no-sweep",
                                              "--shake-hz", "8"], 1 + 3 + 1 + 3),
                                            (["robustness", "--data", "none", "--scenarios", "rough"], 2 * 17),
                                            (["robustness", "--quick", "--disturbances", "text"], 2 * 2),
                                            (["speed", "--data", "none", "--sizes", "680x420", "--repeats", "2"], 2 * 2)])
def test_each_command_lists_its_jobs(capsys, command, count):
    assert len(lines_of(capsys, *command, "--list", "out")) == count


def test_real_sequences_are_those_with_a_truth(tmp_path, capsys):
    for name in ("b_drive", "a_still", "no_truth"):
        (tmp_path / name).mkdir()
    (tmp_path / "b_drive/poses.txt").touch()
    assert [path.name for path in drives.real_sequences(tmp_path)] == ["a_still", "b_drive"]
    assert len(lines_of(capsys, "accuracy", "--data", str(tmp_path), "--quick", "--list", "out")) == 2 * 4


@pytest.mark.parametrize("arguments, expected", [
    (["accuracy", "--data", "/missing"], "/missing: no such folder; --data takes"),
    (["accuracy", "--data", "none", "--scenarios", "moon"], "there is no scenario 'moon'; expected all, none, or some of campus, loop"),
    (["accuracy", "--data", "none", "--scenarios", "motorway+lively"], "no scenario 'motorway+lively'"),
    (["accuracy", "--data", "none", "--set", "reporting", "--scenarios", "campus"], "campus belongs to the tuning set"),
    (["accuracy", "--data", "none", "--set", "tuning", "--seeds", "11"], "11 belongs to the reporting set"),
    (["accuracy", "--data", "none", "--scenarios", "none"], "nothing to measure"),
    (["accuracy", "--data", "none", "--quick", "--estimators", "thesis", "--only", "3"], "--only 3: expected 1 to 2"),
    (["accuracy", "--data", "none", "--quick", "--cartvo", "/missing/cartvo"], "/missing/cartvo: no such program"),
    (["accuracy", "--merge", "/missing"], "/missing: no such folder; expected the results"),
    (["thesis", "--data", "none"], "no real sequences"),
])
def test_wrong_inputs_say_what_is_expected(capsys, arguments, expected):
    assert expected in error_of(capsys, *arguments)


@pytest.mark.parametrize("arguments, expected", [(["robustness", "--disturbances", "fog"], "expected some of none, lose10"),
                                                 (["offset", "--offsets-ms", "x"], "expected numbers separated by commas, found 'x'"),
                                                 (["accuracy", "--json", "--markdown"], "not allowed with")])
def test_wrong_options_end_with_two(capsys, arguments, expected):
    with pytest.raises(SystemExit) as end:
        parser().parse_args(arguments)
    assert end.value.code == 2 and expected in capsys.readouterr().err


def test_help_teaches():
    for command in ([], ["accuracy"], ["sensitivity"], ["robustness"]):
        done = subprocess.run([sys.executable, LAB, *command, "--help"], capture_output=True, text=True, check=True)
        assert "lab/" in done.stdout and ("Examples:" in done.stdout or not command)


def test_merged_results_give_one_table(tmp_path, result, capsys):
    for number, name in ((2, "turns 1"), (1, "campus 1")):
        document = jobs.document("accuracy", ["--data", "none"], [result(name)], number, 2)
        (tmp_path / f"{number}.json").write_text(json.dumps(document))
    lines = lines_of(capsys, "accuracy", "--merge", str(tmp_path))
    assert lines[1].startswith("campus 1") and lines[2].startswith("turns 1") and lines[3].startswith("all 2 drives")
    (tmp_path / "2.json").unlink()
    assert "results of 1 of 2 jobs; missing: 2" in error_of(capsys, "accuracy", "--merge", str(tmp_path))
    (tmp_path / "3.json").write_text(json.dumps(jobs.document("accuracy", ["--data", "other"], [], 3, 2)))
    assert "of other work" in error_of(capsys, "accuracy", "--merge", str(tmp_path))
    (tmp_path / "3.json").write_text("[]")
    assert "no result of a job" in error_of(capsys, "accuracy", "--merge", str(tmp_path))


def test_options_of_the_output_select_nothing():
    assert jobs.given(["--set", "tuning", "--only", "2", "--json", "--output=x y", "--jobs", "1", "--seeds", "1,2"]) == "--set tuning --seeds 1,2"


def test_sets_share_nothing():
    assert not set(drives.TUNING) & set(drives.REPORTING) and set(drives.LIVELY) <= {*drives.TUNING, *drives.REPORTING}
    assert drives.Drive("campus", 1, 6).set == "tuning" and drives.Drive("garage", 11, 6).set == "reporting"
    assert drives.Drive("campus", 11, 6).set == "neither"


def test_scenarios_are_those_of_the_program():
    program = os.environ.get("CARTVO_RENDER")
    if not program:
        pytest.skip("CARTVO_RENDER is not set: run by ctest")
    told = subprocess.run([program, "--help"], capture_output=True, text=True, check=True).stdout
    assert "The scenario: " + ", ".join(drives.TUNING + drives.REPORTING) in " ".join(told.split())


def test_drives_have_names_and_folders_of_their_own():
    plain = drives.Drive("turns", 1, 6.0)
    others = [plain, drives.Drive("turns", 1, 6.0, offset_ms=25.0), drives.Drive("turns", 1, 6.0, readout_ms="32,38"),
              drives.Drive("turns", 1, 6.0, liveliness=0.5, start_at=3.0), drives.Drive("turns", 1, 6.0, shake_hz=8.0, shake_degrees=0.3)]
    assert [drive.name for drive in others] == ["turns 1", "turns 1 +25 ms", "turns 1 readout 32/38 ms", "turns+lively 1 (0.5) from 3 s",
                                                "turns 1 shaken at 8 Hz"]
    assert len({drive.folder_name for drive in others}) == len(others)


def test_a_folder_is_made_once_and_only_if_that_succeeds(tmp_path):
    def fails(folder):
        folder.mkdir()
        raise LabError("no")

    with pytest.raises(LabError):
        drives.made_once(tmp_path / "drives/a", fails)
    assert not (tmp_path / "drives/a").exists()
    made = []
    for _ in range(2):
        drives.made_once(tmp_path / "drives/a", lambda folder: (folder.mkdir(), made.append(folder)))
    assert len(made) == 1 and (tmp_path / "drives/a").is_dir()
