"""Tables over offsets and readouts: errors of each case, and their multiples of a reference."""
from laboratory.accuracy import groups
from laboratory.measure import pooled
from laboratory.table import NONE, both, fixed, significant

# (path in the evaluation, unit of the cell) of errors whose ratios are printed
SEGMENTS = [("segments_5_to_40_m", "translation_percent"), ("segments_5_to_40_m", "rotation_deg_per_m")]
START = 1.5  # s: half a second of standing before a calm drive begins


def value(evaluation, path):
    for key in path:
        evaluation = evaluation[key]
    return evaluation


def ratios(evaluation, reference, paths):
    values = [(value(evaluation, path), value(reference, path)) for path in paths] if reference else []
    if not values or any(not one or not other for one, other in values):
        return NONE
    return " / ".join(f"{one / other:.2f}" for one, other in values)


def error_cells(evaluation, reference):
    """Segments, their ratios, RPE, its ratios."""
    segments = evaluation["segments_5_to_40_m"]
    return [both(significant(segments["translation_percent"]), significant(segments["rotation_deg_per_m"])),
            ratios(evaluation, reference, SEGMENTS),
            both(significant(evaluation["rpe_rmse_m"], 1e3), significant(evaluation["rpe_rmse_deg"])),
            ratios(evaluation, reference, [("rpe_rmse_m",), ("rpe_rmse_deg",)])]


def mean_cell(nees):
    return significant(nees["mean"]) if nees else NONE


def over_seeds(results, keys):
    """One result for each scenario and combination of labels; behind them those of all scenarios together."""
    results = [result for result in results if result.get("evaluation")]

    def labels(result):
        return tuple(result[key] for key in keys)

    def together(name, group):
        return {**pooled(name, group), **{key: group[0][key] for key in keys}}

    rows = [together(group[0]["scenario"], group) for group in groups(results, lambda r: (r["scenario"], *labels(r))).values()]
    scenarios = {row["sequence"] for row in rows}
    if len(scenarios) > 1:
        rows += [together(f"all {len(group)} drives", group) for group in groups(results, labels).values()]
    return rows


def reference_of(row, rows, labels):
    """The evaluation of the row of the same drives with these labels."""
    for other in rows:
        if other["sequence"] == row["sequence"] and all(other[key] == wanted for key, wanted in labels.items()):
            return other["evaluation"]
    return None


def clock_cell(row):
    return f"{row['offset_ms']:.4g} ms" + (f" {row['drift_ppm']:+.0f} ppm" if row["drift_ppm"] else "")


def percent(part, whole):
    return fixed(100.0 * part / whole, 1) if part is not None and whole else NONE
