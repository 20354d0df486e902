"""lab/campaign and lab/stanford with made-up messages; needs the program."""
import os
import pathlib
import subprocess
import sys

import pytest

from laboratory.main import main

TESTS = pathlib.Path(__file__).resolve().parent


def test_campaign():
    program = os.environ.get("CARTVO_PROGRAM")
    if not program:
        pytest.skip("CARTVO_PROGRAM is not set: run by ctest")
    subprocess.run([sys.executable, TESTS / "check_campaign.py", TESTS.parents[1] / "lab/campaign", program], check=True)


def test_stanford(tmp_path, capsys):
    names = [f"{quantity}_{what}_{axis}" for quantity in ("velocity", "angular_rate") for what in ("error", "bound") for axis in "xyz"]
    file = tmp_path / "messages.csv"
    file.write_text(",".join(["valid", *names]) + "\n" + ",".join(["1", *["0.1"] * 3, *["0.01"] * 3, *["0.01"] * 6]) + "\n")
    assert main("lab/lab", ["stanford", str(file)]) == 0
    assert "#d55e00" in capsys.readouterr().out, "errors above their bound"
    file.write_text("valid,pair\n1,1\n")
    assert main("lab/lab", ["stanford", str(file)]) == 1
    assert "expected a file of cartvo evaluate --messages" in capsys.readouterr().err
