"""lab speed: times of a pair, and their multiples of fixed work of OpenCV."""
import statistics
import time

from laboratory import drives
from laboratory.accuracy import groups
from laboratory.measure import ESTIMATORS, Case, left_images, measure_all as measured, prepared
from laboratory.options import numbers, words
from laboratory.table import NONE, Table, fixed

HELP = "Times of a pair and of its stages over image sizes, numbers of features and threads"
EXAMPLES = """  lab/lab speed --sizes none --features 1000                        real sequences only
  lab/lab speed --data none --sizes 680x420 --features 500,1000,2000"""
JOBS = 1  # each replay has the computer for itself
WARM_UP = 4  # pairs
LEGEND = """Time of a pair without reading files. rectified: without rectification; raw: with it. x KLT, x KLT + remap: as multiples of the time of
OpenCV on the same pictures right after, on one thread: calcOpticalFlowPyrLK with 1,000 points, 21x21, 4 levels, 30 iterations or 0.01 px;
and that with two remaps. Ratios are valid on a busy computer, milliseconds are not. Without python3-opencv there are none."""


def add_options(parser):
    parser.add_argument("--sizes", type=words(), default=["680x420", "1241x376", "1280x720", "1920x1080"], metavar="LIST",
                        help="of the pictures of a rendered campus drive of four seconds; none")
    parser.add_argument("--thread-counts", type=numbers(int), default=[1, 2], metavar="LIST", help="for the odometry")
    parser.add_argument("--estimator", choices=ESTIMATORS, default=ESTIMATORS[0])
    parser.add_argument("--repeats", type=int, default=3, metavar="N", help="of each replay")


def cases(options):
    found = [(f"campus {size}", None, drives.Drive("campus", 1, 4.0, start_at=2.0, size=size)) for size in options.sizes if size != "none"]
    found += [(folder.name, folder, None) for folder in drives.real_sequences(drives.data_folder(options.data))]
    return [Case(name, folder, drive, options.estimator, features, threads=threads,
                 labels={"threads": threads, "repeat": repeat, "wants": ("timing", "klt")})
            for name, folder, drive in found for features in options.features for threads in options.thread_counts
            for repeat in range(options.repeats)]


def reference_ms(images):
    """Median times of KLT and of two remaps; None without OpenCV or texture."""
    try:
        import cv2
        import numpy as np
    except ImportError:
        return None
    before = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        times, step = {"klt": [], "remap": []}, max(1, len(images) // 20)
        for first, second in list(zip(images, images[1:]))[::step]:
            one, other = (cv2.imread(str(file), cv2.IMREAD_GRAYSCALE) for file in (first, second))
            points = cv2.goodFeaturesToTrack(one, 1000, 1e-4, 5.0)
            if points is None or len(points) < 1000:
                continue
            height, width = one.shape
            x, y = np.meshgrid(np.arange(width, dtype=np.float32), np.arange(height, dtype=np.float32))
            maps = cv2.convertMaps(x + 2 * (y / height - 0.5), y + 2 * (x / width - 0.5), cv2.CV_16SC2)
            start = time.perf_counter()
            cv2.calcOpticalFlowPyrLK(one, other, points, None, winSize=(21, 21), maxLevel=3,
                                     criteria=(cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 30, 0.01))
            middle = time.perf_counter()
            for image in (one, other):
                cv2.remap(image, *maps, cv2.INTER_LINEAR)
            times["klt"].append(1e3 * (middle - start))
            times["remap"].append(1e3 * (time.perf_counter() - middle))
        return {name: statistics.median(values) for name, values in times.items()} if times["klt"] else None
    finally:
        cv2.setNumThreads(before)


def measure_all(bench, cases):
    """Each replay, and the reference right after it."""
    results = []
    for case in cases:
        results += measured(bench, [case])
        results[-1]["reference_ms"] = reference_ms(left_images(prepared(bench, case)))
    return results


def quantile(values, share):
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))]


def times_cells(times):
    return [fixed(statistics.median(times), 2), fixed(quantile(times, 0.99), 2), fixed(max(times), 2)]


def report(results):
    table = Table(["drive", "features", "threads", "rectified: median, ms", "p99", "max", "x KLT", "raw: median, ms", "p99", "max",
                   "x KLT + remap", "pairs/s"])
    stages = Table(["drive", "features", "threads", *results[0].get("stages_ms", {})], "Stages, median, ms (nested ones count in both)")
    for (name, features, threads), group in groups([r for r in results if r.get("timing_ms")],
                                                   lambda r: (r["sequence"], r["features"], r["threads"])).items():
        raw = [value for r in group for value in r["timing_ms"]["total"][WARM_UP:]]
        rectified = [a - b for r in group for a, b in zip(r["timing_ms"]["total"][WARM_UP:], r["timing_ms"]["rectify"][WARM_UP:])]
        ratios = [NONE, NONE]
        if all(r.get("reference_ms") for r in group):
            klt, both = ([sum(r["reference_ms"][part] for part in parts) for r in group] for parts in (("klt",), ("klt", "remap")))
            ratios = [fixed(statistics.median(times) / statistics.median(reference), 2) for times, reference in ((rectified, klt), (raw, both))]
        table.add(name, features, threads, *times_cells(rectified), ratios[0], *times_cells(raw), ratios[1],
                  fixed(1e3 / statistics.median(raw), 0))
        stages.add(name, features, threads, *(fixed(statistics.median(r["stages_ms"][stage] for r in group), 2) for stage in stages.header[3:]))
    return [table, stages], LEGEND
