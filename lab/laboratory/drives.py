"""Real sequences and rendered drives: names, sets, and the one call that renders."""
import dataclasses
import fcntl
import os
import pathlib
import shutil
import tempfile

from laboratory.program import ROOT, LabError

# Numbers of the estimator are chosen on the tuning set, none on the reporting set; they share no scenario and no seed.
TUNING = ("campus loop turns traffic standing stop_and_go exposure underpass glare dusk low_texture bumpy reversing motorway rough "
          "rough_road").split()
REPORTING = "garage hedges rain flicker slope bridge crowd wind tunnel".split()
LIVELY = "campus turns traffic stop_and_go bumpy garage hedges rain slope crowd".split()  # driven in a lively way, too
FIRST_REPORTING_SEED = 10
SETS = {"tuning": (TUNING, 1), "reporting": (REPORTING, 11)}  # scenarios and default seed
FRAME_RATE = 18.0
RENDERING = 4  # part of the names of folders in the cache; increase it when the same drive gives other pictures


def set_of_scenario(scenario):
    return "tuning" if scenario in TUNING else "reporting"


def set_of_seed(seed):
    return "tuning" if seed < FIRST_REPORTING_SEED else "reporting"


@dataclasses.dataclass(frozen=True)
class Drive:
    """A rendered drive: the options of `cartvo simulate --render`."""
    scenario: str
    seed: int
    seconds: float
    liveliness: float = 0.0
    start_at: float | None = None
    offset_ms: float = 0.0
    drift_ppm: float = 0.0
    readout_ms: str = "0"  # of both cameras, or LEFT,RIGHT
    shake_hz: float = 0.0
    shake_degrees: float = 0.0
    size: str = "680x420"

    @property
    def set(self):
        return set_of_scenario(self.scenario) if set_of_scenario(self.scenario) == set_of_seed(self.seed) else "neither"

    @property
    def scenario_name(self):
        return self.scenario + ("+lively" if self.liveliness > 0 else "")

    @property
    def name(self):
        parts = [f"{self.scenario_name} {self.seed}"]
        parts += [f"({self.liveliness:g})"] if 0 < self.liveliness < 1 else []
        parts += [f"from {self.start_at:g} s"] if self.start_at is not None else []
        parts += [f"{self.offset_ms:+g} ms"] if self.offset_ms else []
        parts += [f"{self.drift_ppm:+.4g} ppm"] if self.drift_ppm else []
        parts += [f"readout {self.readout_ms.replace(',', '/')} ms"] if self.readout_ms not in ("0", "0,0") else []
        parts += [f"shaken at {self.shake_hz:g} Hz"] if self.shake_degrees else []
        return " ".join(parts)

    @property
    def options(self):
        options = ["--world", self.scenario, "--seed", self.seed, "--seconds", f"{self.seconds:g}", "--offset-ms", f"{self.offset_ms:.10g}",
                   "--readout-ms", self.readout_ms, "--frame-rate", f"{FRAME_RATE:g}", "--size", self.size]
        options += ["--offset-drift-ppm", f"{self.drift_ppm:.10g}"] if self.drift_ppm else []
        options += ["--liveliness", f"{self.liveliness:g}"] if self.liveliness else []
        options += ["--start-at", f"{self.start_at:g}"] if self.start_at is not None else []
        options += ["--shake-hz", f"{self.shake_hz:g}", "--shake-degrees", f"{self.shake_degrees:g}"] if self.shake_degrees else []
        return [str(option) for option in options]

    @property
    def folder_name(self):
        words = (word.removeprefix("--") for word in self.options if word not in ("--world", "--size", "--seconds"))
        return f"drive-{RENDERING}-" + "-".join(words).replace(",", "_")


def made_once(folder, make):
    """The folder, made by make(temporary folder) if it is missing: by one process at a time, and only if it succeeds."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    if folder.is_dir():
        return folder
    with open(folder.parent / f".{folder.name}.lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not folder.is_dir():
            with tempfile.TemporaryDirectory(dir=folder.parent, prefix=".making-") as part:
                make(pathlib.Path(part) / "made")
                os.rename(pathlib.Path(part) / "made", folder)
    return folder


def rendered(cartvo, drive, cache):
    """The folder of the drive in the cache, with its truth. The only place that renders."""
    return made_once(cache / "drives" / drive.folder_name,
                     lambda folder: cartvo.run("simulate", "--render", *drive.options, "--output-dir", folder))


def encoded(cartvo, folder, name, bitrate_kbps, cache):
    """The same pictures as a recording in H.264."""
    return made_once(cache / "encoded" / f"{name}-{bitrate_kbps}kbps",
                     lambda made: cartvo.run("simulate", "--sequence", folder, "--encode", "--bitrate-kbps", bitrate_kbps, "--no-cache",
                                             "--output-dir", made))


# Choosing drives and sequences.


def data_folder(named):
    """Folder of real sequences, or None. `named`: of --data."""
    if named == "none":
        return None
    folder = pathlib.Path(named or os.environ.get("CARTVO_DATA") or ROOT.parent / "shared/data")
    if folder.is_dir():
        return folder.resolve()
    if named or os.environ.get("CARTVO_DATA"):
        raise LabError(f"{folder}: no such folder; --data takes a folder of image folders as cartvo replay reads them, or none")
    return None


def real_sequences(data):
    """Image folders with poses.txt, and those of a standing camera, *_still."""
    if data is None:
        return []
    folders = sorted(path for path in data.iterdir() if path.is_dir() and (
        (path / "poses.txt").exists() or path.name.endswith("_still")))
    if not folders:
        raise LabError(f"{data}: contains no sequence; expected folders of images with poses.txt, or whose name ends in _still")
    return folders


def scenarios_of(names, chosen_set, tuning_default=None):
    """(scenario, lively) of the names of --scenarios; without names: all of the set, or tuning_default of the tuning set."""
    known = TUNING + REPORTING
    if not names:
        names = tuning_default if tuning_default and chosen_set == "tuning" else ["all"]
    chosen = []
    for name in names:
        scenario, _, lively = name.partition("+")
        if name == "none":
            continue
        if name == "all":
            for one, (scenarios, _) in SETS.items():
                if chosen_set in (None, one):
                    chosen += [(scenario, False) for scenario in scenarios]
                    chosen += [(scenario, True) for scenario in scenarios if scenario in LIVELY]
        elif scenario not in known or lively not in ("", "lively") or (lively and scenario == "motorway"):
            raise LabError(f"--scenarios: there is no scenario '{name}'; expected all, none, or some of {', '.join(known)}, each also "
                           "with +lively but motorway")
        else:
            if chosen_set not in (None, set_of_scenario(scenario)):
                raise LabError(f"--scenarios: {name} belongs to the {set_of_scenario(scenario)} set, not to the {chosen_set} set")
            chosen.append((scenario, bool(lively)))
    return chosen


def default_seconds(scenario):
    return {"loop": 75.0, "campus": 60.0, "standing": 22.0}.get(scenario, 40.0)


def chosen_drives(options, tuning_default=None, start_at=None):
    """The drives of the options. start_at: of calm drives, if --start-at does not say another."""
    drives = []
    for seed in options.seeds or []:
        if options.set not in (None, set_of_seed(seed)):
            raise LabError(f"--seeds: {seed} belongs to the {set_of_seed(seed)} set, not to the {options.set} set")
    for scenario, lively in scenarios_of(options.scenarios, options.set, tuning_default):
        for seed in options.seeds or [SETS[set_of_scenario(scenario)][1]]:
            drives.append(Drive(scenario, seed, options.seconds or default_seconds(scenario),
                                liveliness=options.liveliness if lively else 0.0,
                                start_at=options.start_at if options.start_at is not None else None if lively else start_at))
    return drives


def linked(folder, target):
    """A copy of a folder, of links."""
    shutil.copytree(folder, target, copy_function=lambda source, to: os.symlink(pathlib.Path(source).resolve(), to))
    return target
