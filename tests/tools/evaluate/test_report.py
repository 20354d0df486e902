"""The report, figures and plot; the command line."""
import os
import re
import subprocess

import pytest
from conftest import CARTVO, ROOT, circle, scaled, straight, tum
from test_messages import cell, messages, text

FIGURES = ["trajectory", "error-over-distance", "error-over-time", "segments", "velocities", "rates", "nees", "velocity-bounds", "rate-bounds"]


@pytest.fixture
def drive(bench):
    """A drive on a circle with an error of 0.01 m/s, two messages of which are not VALID."""
    rows = messages(circle(100, 20.0, 0.2), [(2.01, 0, 0, 0, 0, 0.1)] * 100)
    for i in (0, 20):
        rows[i].update({cell("valid"): 0, cell("reasons"): 4, cell("velocity_bound_x"): ""})
    (bench.folder / "out").mkdir()
    bench.write("out/odometry.csv", text(rows))
    bench.write("truth.tum", tum(circle(110, 20.0, 0.2)))
    bench.write("out/summary.json", '{"rig": {"name": "a <b> rig"}, "features": 700}')
    return bench


def figures_in(page):
    return re.findall(r'<figure id="([\w-]+)">', page)


def test_the_page_has_all_figures_with_their_numbers_and_needs_no_other_file(drive):
    drive.output("out/odometry.csv", "truth.tum", "--report", "report/r.html", "--figures-dir", "report/figures", "--plot", "p.png")
    page = (drive.folder / "report/r.html").read_text()
    assert figures_in(page) == FIGURES and page.count("Numbers of this figure") == page.count("<title>") - 1 == len(FIGURES)
    for part in ("rig a &lt;b&gt; rig, features 700", "2 not valid: 2 too few matches", "VALID messages above their bound", "0 of 98",
                 "prefers-color-scheme:dark",
                 "The stated deviation of the pose in its epoch is", 'class="tiles"', "var(--blue)", "<td>forward</td>"):
        assert part in page, part
    for part in ("src=", "<script", ">nan<", "#0072b2;", "mathdefault"):
        assert part not in page.replace("--blue:#0072b2;", ""), part
    assert set(re.findall(r'(?:href|url)[=(]"?(.)', page)) <= {"#"}
    for name in FIGURES:
        assert (drive.folder / f"report/figures/{name}.svg").read_bytes().startswith(b"<?xml")
        assert (drive.folder / f"report/figures/{name}.png").read_bytes().startswith(b"\x89PNG")
    assert (drive.folder / "p.png").read_bytes().startswith(b"\x89PNG")


def test_messages_beside_the_estimate_are_used_if_they_can_be(drive):
    drive.write("out/trajectory.tum", tum(circle(100, 20.0, 0.2), start=0.2))
    drive.output("out/trajectory.tum", "truth.tum", "--report", "r.html")
    assert figures_in((drive.folder / "r.html").read_text()) == FIGURES
    drive.write("out/odometry.csv", "pair\n")
    done = drive.run("out/trajectory.tum", "truth.tum", "--report", "r.html")
    assert done.returncode == 0 and done.stderr.startswith("cartvo: warning: velocities and NEES are left out: out/odometry.csv:1: has no column")
    assert figures_in((drive.folder / "r.html").read_text()) == FIGURES[:4]
    assert "out/odometry.csv:1: has no column" in drive.error("truth.tum", "truth.tum", "--report", "r.html", "--odometry", "out/odometry.csv")


def test_the_page_of_several_estimates_has_one_table(drive):
    drive.write("one.tum", tum(scaled(circle(110, 20.0, 0.2), 1.1)))
    drive.output("one.tum", "truth.tum", "--truth", "truth.tum", "--report", "r.html", "--plot", "p.svg", "--align")
    page = (drive.folder / "r.html").read_text()
    assert "<td>one.tum</td>" in page and figures_in(page) == FIGURES[:4] and "--align" in page
    plot = (drive.folder / "p.svg").read_text()
    assert all(part in plot for part in ("one.tum", "Path from above, aligned", "distance driven (m)", "#0072b2", "#e69f00", "#222222"))


def test_any_name_of_a_file_is_shown(bench):
    names = [os.fsencode(bench.folder) + b"/" + name for name in (b"a$<b>\xff\x1b$x^.tum", b"_b.tum")]
    for name in names:
        with open(name, "w") as file:
            file.write(tum(straight(20, 1.0)))
    bench.output(*map(os.fsdecode, names), "--truth", os.fsdecode(names[1]), "--report", "r.html", "--plot", "p.svg")
    assert "a$&lt;b&gt;\\xff\\x1b$x^.tum" in (bench.folder / "p.svg").read_text() and "_b.tum" in (bench.folder / "r.html").read_text()
    assert "a$<b>\N{REPLACEMENT CHARACTER}" in bench.json(os.fsdecode(names[0]), os.fsdecode(names[1]))["estimate"]


def test_output_that_cannot_be_written_is_a_failure(bench):
    bench.write("e.tum", tum(straight(5, 1.0)))
    for redirection in (">/dev/full", ">&-"):
        done = subprocess.run(f"{CARTVO} evaluate e.tum e.tum {redirection}", shell=True, cwd=bench.folder, capture_output=True, text=True)
        assert done.returncode == 1 and "cartvo: standard output cannot be written" in done.stderr and "Traceback" not in done.stderr


def test_a_standstill_is_drawn(bench):
    bench.write("e.tum", tum(straight(5, 0.0)))
    bench.output("e.tum", "e.tum", "--report", "r.html", "--plot", "p.svg")
    assert "the path is too short" in (bench.folder / "r.html").read_text()


def test_without_matplotlib_only_drawings_fail_and_name_the_package(bench):
    bench.write("e.tum", tum(straight(5, 1.0)))
    (bench.folder / "matplotlib").mkdir()
    bench.write("matplotlib/__init__.py", "raise ImportError('not here')")
    environment = {"PYTHONPATH": str(bench.folder), "PATH": "/usr/bin:/bin"}
    assert bench.run("e.tum", "e.tum", env=environment).returncode == 0
    done = bench.run("e.tum", "e.tum", "--plot", "p.svg", env=environment)
    assert done.returncode == 1 and "install Debian's package python3-matplotlib" in done.stderr and not done.stdout


@pytest.mark.parametrize("arguments, said", [
    (["--trut", "b", "a"], "cartvo evaluate has no option --trut; did you mean --truth?"), (["a"], "expected ESTIMATE TRUTH"), ([], "found 0 files"),
    (["a", "b", "--offset", "nan"], "--offset: expected a number, found 'nan'"), (["a", "b", "--offset", "1e10"], "[-4e+09 - 4e+09], found '1e10'"),
    (["a", "b", "--alert-limits", "1,2,3"], "expected four numbers V,RATE,MOTION,ROTATION"),
    (["a", "b", "--plot", "p.pdf"], "a plot is written as .svg or .png"),
    (["a", ""], "expected a value, found an empty one"), (["a", "b", "--odometry", "o"], "is used by --report and --figures-dir only"),
    (["a", "b", "--truth", "c", "--messages", "m"], "--messages: is for a single estimate")])
def test_a_wrong_command_line_is_explained(bench, arguments, said):
    error = bench.error(*arguments, code=2)
    assert said in error and "'cartvo evaluate --help' explains the command." in error


def test_help_teaches_and_versions_agree(bench):
    text = bench.output("--help")
    assert max(map(len, text.splitlines())) <= 120 and "Examples:\n  cartvo evaluate" in text and "0.7,12,0.2,1.5" in text
    assert bench.output("--version").startswith("cartvo ")


def test_files_that_cannot_be_written_fail_before_the_work(bench):
    bench.write("e.tum", tum(straight(5, 1.0)))
    assert ".: is a folder; name a file" in bench.error("e.tum", "e.tum", "--report", ".")
    assert "no file can be made in the folder" in bench.error("e.tum", "e.tum", "--report", "e.tum/r.html")
    done = bench.run("e.tum", "e.tum", "--report", "/dev/stdout")
    assert done.returncode == 0 and done.stdout.endswith("</html>\n")


def test_names_and_limits_are_those_of_the_odometry():
    reasons = re.findall(r'^  X\(\w+, (\d+), "([^"]+)"', (ROOT / "vo_core/odometry_reason.hpp").read_text(), re.M)
    listed = (ROOT / "tools/evaluate/evaluation/page.py").read_text().partition("REASONS = (")[2].partition(")")[0]
    assert {int(bit): words for bit, words in reasons} == {1 << i: words for i, words in enumerate(re.findall(r'"([^"]+)"', listed))}
    header = (ROOT / "pipeline/protection_level.hpp").read_text()
    limits = re.findall(r"double (?:velocity|angular_rate|motion|rotation) = ([\d.]+)", header)
    assert f"DEFAULT_LIMITS = ({', '.join(limits)})" in (ROOT / "tools/evaluate/evaluation/validity.py").read_text()
