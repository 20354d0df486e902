"""The report of a comparison: one HTML page, and its figures as files."""
import collections
import datetime
import html
import json
import pathlib

import numpy as np

from evaluation.chart import picture, svg_element
from evaluation.figures import evaluation_charts, verdict
from evaluation.program import NO_VALUE, EvaluationError, make_folder, printed, read_text, write_file
from evaluation.results import comparison
from evaluation.validity import validity_of

# Names of the bits of odometry_t.reasons, from the lowest on, as vo_core/odometry_reason.hpp has them.
REASONS = ("first pair", "too few features", "too few matches", "too few inliers", "high residual", "time step", "implausible motion",
           "degenerate geometry", "no pair", "damaged frame", "wrong picture size", "zero velocity", "offset uncertain", "repeated picture",
           "offset too large", "wrong stereo geometry", "bound above its alert limit")
STYLE = """:root{color-scheme:light dark;--line:#8886;--ink:#222;--grid:#dedede;--blue:#0072b2;--red:#d55e00;--green:#009e73}
@media screen and (prefers-color-scheme:dark){:root{--ink:#e4e4e4;--grid:#454545;--blue:#56b4e9;--red:#ff8c3a;--green:#2fd0a0}}
body{font-family:sans-serif;max-width:1200px;margin:2em auto;padding:0 1em}table{border-collapse:collapse;width:100%}
th,td{border:1px solid var(--line);padding:.3em .6em;text-align:left;vertical-align:top;overflow-wrap:anywhere;font-variant-numeric:tabular-nums}
main{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,520px),1fr));gap:1.5em 2em}
figure{margin:0;min-width:0;break-inside:avoid}figcaption{font-size:.9em}svg{width:100%;height:auto}svg text{fill:var(--ink)}
details{overflow-x:auto;font-size:.9em}summary{cursor:pointer}.wide{overflow-x:auto}.problem{font-weight:bold;color:var(--red)}
.tiles{display:flex;flex-wrap:wrap;gap:1em;margin-bottom:1em}.tiles div{border:1px solid var(--line);padding:.5em 1em}
.tiles b{display:block;font-size:1.6em}
@media print{main{display:block}figure{max-width:16cm;margin-bottom:1em}details:not([open]){display:none}}"""
SETTINGS = (("source", "source"), ("rig/name", "rig"), ("rig/origin", "of"), ("estimator", "estimator"), ("features", "features"),
            ("online_rig_refinement", "online rig refinement"))  # places in summary.json and their names


def paragraph(text, kind=""):
    return f"<p{kind}>{html.escape(printed(text))}</p>\n"


def table(header, rows):
    lines = ["".join(f"<{tag}>{html.escape(printed(cell))}</{tag}>" for cell in row) for tag, row in [("th", header), *(("td", row) for row in rows)]]
    return "<table>" + "\n".join(f"<tr>{line}</tr>" for line in lines) + "</table>\n"


def settings_of(compared, options):
    """Rig and settings of the replay whose summary.json is beside the estimate, as far as it has them, and the options of the comparison."""
    settings, summary = [], pathlib.Path(compared.name).parent / "summary.json"
    try:
        replay = json.loads(read_text(summary))
    except (EvaluationError, ValueError, RecursionError):
        replay = None
    for place, name in SETTINGS:
        value = replay
        for key in place.split("/"):
            value = value.get(key) if isinstance(value, dict) else None
        if isinstance(value, (str, int, float)) and not isinstance(value, bool):
            settings.append(f"{name} {value}")
    settings += [f"--offset {options.offset:.3f} s"] if options.offset else []
    return settings + [f"--{name}" for name in ("align", "correct-scale") if getattr(options, name.replace("-", "_"))]


def segment_row(name, errors):
    if not errors.count:
        return [name, NO_VALUE, "the path is too short"]
    return [name, f"{100 * errors.translation:.3f} %, {np.degrees(errors.rotation):.5f} deg/m", f"{errors.count} segments"]


def validity_rows(validity):
    return [["available", f"{validity.available_percent():.2f} % of the messages are VALID", f"longest gap {validity.longest_gap:.2f} s"],
            ["VALID messages above an alert limit", validity.of_judged(validity.above_limit),
             f"largest errors {validity.velocity_error:.3f} m/s, {validity.rate_error:.2f} deg/s"],
            ["VALID messages above their bound", validity.of_judged(validity.above_bound),
             "any component of velocity, rates or the motion of the last second"]]


def measures(compared, validity):
    """The measures looked at first in large type, and a table of all."""
    e, pairing, fraction = compared.evaluation, compared.evaluation.pairing, compared.evaluation.drift_fraction()
    tiles = [(f"{e.final_drift:.3f} m", "final drift") if fraction is None else (f"{100 * fraction:.2f} %", f"final drift of {e.path_length:.1f} m"),
             (f"{1e3 * e.rpe[0]:.1f} mm", "pose to pose (RPE)"), (f"{e.aligned:.3f} m", "position, aligned (ATE)")]
    rows = [["poses compared", len(pairing.times), ("by time" if pairing.by_time else "row by row")
             + (f", {pairing.unmatched} without a truth" if pairing.unmatched else "")],
            ["path length", f"{e.path_length:.3f} m", f"estimated {e.estimated_path_length:.3f} m"],
            ["final drift", f"{e.final_drift:.3f} m, {np.degrees(e.final_rotation):.3f} deg",
             "the path is too short for a percentage" if fraction is None else f"{100 * fraction:.3f} % of the path"],
            ["position, aligned (ATE)", f"{e.aligned:.4f} m", "RMSE after the best rigid alignment"],
            ["position, same start", f"{e.same_start:.4f} m", "RMSE"],
            ["pose to pose (RPE)", f"{e.rpe[0]:.4f} m, {np.degrees(e.rpe[1]):.4f} deg", "RMSE"],
            segment_row("segments of 5 to 40 m", e.short.all), segment_row("segments of 100 to 800 m (KITTI)", e.long.all)]
    if validity:
        tiles += [(f"{validity.available_percent():.1f} %", "of the messages are VALID"),
                  (validity.of_judged(validity.above_bound), "VALID messages above their bound")]
        rows += validity_rows(validity)
    boxes = "".join(f"<div><b>{html.escape(value)}</b>{html.escape(name)}</div>" for value, name in tiles)
    return f'<div class="tiles">{boxes}</div>\n' + table(["measure", "value", "remark"], rows)


def message_notes(compared):
    if compared.judged is None:
        return paragraph("Velocities, rates, validity and NEES are missing: they need the odometry.csv of 'cartvo replay' and a truth of the body, "
                         "see cartvo-evaluate(1), --odometry.")
    messages = compared.judged.messages
    counts = collections.Counter(", ".join(name for bit, name in enumerate(REASONS) if reasons >> bit & 1)
                                 for reasons in messages.reasons[~messages.valid].tolist())
    by_reason = "; ".join(f"{count} {reason}" for reason, count in sorted(counts.items()))
    note = f"{compared.odometry}: {len(messages.times)} messages, {(~messages.valid).sum()} not valid" + (f": {by_reason}" if by_reason else "")
    return paragraph(note) + paragraph(verdict(compared.judged))


def figure(chart, svg):
    drawn, caption = svg_element(svg, html.escape(printed(chart.title))), html.escape(chart.caption)
    return (f'<figure id="{chart.name}">\n{drawn}<figcaption>{caption}</figcaption>\n'
            f"<details><summary>Numbers of this figure</summary>\n{table(chart.columns, chart.rows)}</details></figure>\n")


def page(all_compared, charts, svgs, options, version):
    first, limits = all_compared[0], options.alert_limits
    names = ", ".join(compared.name for compared in all_compared)
    date = datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d %H:%M:%S UTC")
    body = "<h1>cartvo evaluate</h1>\n" + paragraph(f"{names} compared with {options.truth}, {date}, cartvo {version}")
    settings = settings_of(first, options)
    body += paragraph("Settings: " + ", ".join(settings)) if settings else ""
    for compared in all_compared:
        body += "".join(paragraph(f"{compared.name}: {problem}", ' class="problem"') for problem in compared.evaluation.problems)
    if len(all_compared) > 1:
        body += f'<div class="wide">{table(*comparison(all_compared, limits))}</div>\n'
    else:
        body += measures(first, first.judged and validity_of(first.judged, limits)) + message_notes(first)
    body += "<main>\n" + "".join(map(figure, charts, svgs)) + "</main>\n"
    return ('<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>cartvo evaluate: '
            f"{html.escape(printed(names))}</title>\n<style>{STYLE}</style></head><body>\n{body}</body></html>\n")


def write_report(all_compared, options, version):
    charts = evaluation_charts(all_compared, options.alert_limits)
    svgs = [picture([chart], "svg") for chart in charts]
    if options.report:
        write_file(options.report, page(all_compared, charts, svgs, options, version).encode())
    if options.figures_dir:
        make_folder(options.figures_dir)
        for chart, svg in zip(charts, svgs):
            write_file(pathlib.Path(options.figures_dir) / f"{chart.name}.svg", svg)
            write_file(pathlib.Path(options.figures_dir) / f"{chart.name}.png", picture([chart], "png"))
