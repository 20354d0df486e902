"""lab thesis: tables of the thesis with the values measured here."""
from laboratory import drives
from laboratory.measure import Case, left_images, measure_all as measured
from laboratory.program import LabError
from laboratory.table import NONE, Table, fixed

HELP = "Tables 5-2 to 5-7 of V. Venkatachalapathy, Visual Odometry Estimation Using Selective Features, RIT, 2016"
EXAMPLES = """  lab/lab thesis --data ../shared/data"""
JOBS = 1
# Table 5-2: 1241x376 on the computer of the thesis, ms, 1,000 features; the sum of 9,600 is 61.2.
THESIS_MS = {"rectify": 9.98, "pyramid": 8.56, "optical_flow": 1.21, "disparity": 2.12, "reproject": 0.28, "motion": 0.60, "detect": 1.91,
             "weights": 0.80, "minimum_distance": 0.09, "all": 25.91}
MANY = 9600
LEGEND = """A dash: not known. The thesis used KITTI and New College; its values of Tables 5-3 to 5-7 and its parts of these are unknown. Body axes: x
forward, y left, z up. Times: medians of the longest sequence; sequences that are rectified already have no time of rectification."""


def add_options(parser):
    parser.description += "\nTable 5-1 (depths) and Figures 4-13 and 4-14 (corners in each window) are not among them: no command prints what they need."


def cases(options):
    folders = drives.real_sequences(drives.data_folder(options.data))
    if not folders:
        raise LabError("no real sequences; give their folder with --data")
    longest = max(folders, key=lambda folder: len(left_images(folder)))
    return [Case(folder.name, folder, estimator=estimator, features=features, labels={"times": features == MANY or folder == longest,
                                                                                      "wants": ("rates",)})
            for folder in folders for estimator, features in [("thesis", 1000), ("reprojection", 1000)]
            + ([("thesis", MANY)] if folder == longest else [])]


def measure_all(bench, cases):
    bench.alert_limits = "1e6,1e6,1e6,1e6"  # compares methods, whatever they state
    return measured(bench, cases)


def report(results):
    few, many = (next((r for r in results if r["times"] and r["estimator"] == "thesis" and r["features"] == n), None) for n in (1000, MANY))
    times = Table(["stage", "1000 features", "thesis, 1000", f"{MANY} features", f"thesis, {MANY}"], "Table 5-2: time of each stage, ms")
    for stage in few["stages_ms"] if few and many else []:
        times.add(stage, fixed(few["stages_ms"][stage], 2), fixed(THESIS_MS.get(stage), 2), fixed(many["stages_ms"][stage], 2), NONE)
    if few and many:
        times.add("all", fixed(few["time_ms"]["median"], 2), fixed(THESIS_MS["all"], 2), fixed(many["time_ms"]["median"], 2), "61.2")
    rates = Table(["sequence", "estimator", "pairs", "Vx, m/s", "Vy, m/s", "Vz, m/s", "pitch, deg/s", "yaw, deg/s", "roll, deg/s"],
                  "Tables 5-3 to 5-7: RMSE of velocity and rates")
    for r in results:
        if r["features"] != MANY and r.get("rmse"):
            rates.add(r["sequence"], r["estimator"], r["pairs"], *(fixed(r["rmse"][name], 4) for name in ("Vx", "Vy", "Vz")),
                      *(fixed(r["rmse"][f"{name}_rate"], 3, 180.0 / 3.141592653589793) for name in ("pitch", "yaw", "roll")))
    rates.add("thesis", *[NONE] * 8)
    return [times, rates], LEGEND
