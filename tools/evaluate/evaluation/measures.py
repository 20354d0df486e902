"""The error measures of a trajectory, as a table and as JSON."""
import dataclasses

import numpy as np

from evaluation.conventions import convention_problem
from evaluation.motion import angles_of
from evaluation.pairing import Pairing, aligned_error
from evaluation.segments import LONG, SHORT, AlignedAxes, Segments, aligned_axes, distances_along, motion_errors, segment_errors

LEAST_PATH = 1.0  # m; at a standstill a percentage is meaningless


@dataclasses.dataclass
class Evaluation:
    pairing: Pairing
    path_length: float  # of the truth, m
    estimated_path_length: float
    final_drift: float  # m, between the two ends if the starts coincide
    final_rotation: float  # rad
    rpe: tuple  # RMSE of the motion from pose to pose, m and rad
    aligned: float  # RMSE of position after the best rigid alignment (ATE), m
    same_start: float  # RMSE of position as placed_estimate() lies, m
    short: Segments
    long: Segments
    axes: AlignedAxes | None  # None without a short segment
    problems: list  # why the comparison may be meaningless, with the remedies

    def drift_fraction(self):
        """Of the path length; None if that is too short."""
        return self.final_drift / self.path_length if self.path_length >= LEAST_PATH else None


def rms(values):
    return float(np.sqrt(np.mean(np.square(values)))) if len(values) else np.nan


def evaluate(pairing):
    estimate, truth = pairing.estimate, pairing.truth
    end = motion_errors(estimate, truth, [0], [-1])[0]
    steps = motion_errors(estimate, truth, slice(0, -1), slice(1, None))
    away = pairing.placed_estimate()[:, :3, 3] - truth[:, :3, 3]
    evaluation = Evaluation(
        pairing, float(distances_along(truth)[-1]), float(distances_along(estimate)[-1]),
        float(np.linalg.norm(end[:3, 3])), float(angles_of(end[:3, :3])),
        (rms(np.linalg.norm(steps[:, :3, 3], axis=1)), rms(angles_of(steps[:, :3, :3]))),
        aligned_error(pairing), rms(np.linalg.norm(away, axis=1)),
        segment_errors(estimate, truth, SHORT, 1), segment_errors(estimate, truth, LONG, 10), aligned_axes(estimate, truth),
        list(pairing.problems))
    if not pairing.clocks_differ:  # poses of other instants tell nothing about conventions
        problem = convention_problem(evaluation)
        evaluation.problems += [problem] if problem else []
    return evaluation


def row(name, text):
    return f"{name:<34} {text}\n"


def segment_row(name, errors, remark=""):
    return f"  {name:<12} {errors.count:9d} {100 * errors.translation:12.3f} {np.degrees(errors.rotation):16.5f}{remark}\n"


def segment_table(title, segments):
    if not segments.all.count:
        return f"{title}: the path is too short\n"
    rows = [segment_row(f"{errors.length:.0f} m", errors) for errors in segments.each] + [segment_row("all", segments.all)]
    return f"{title:<14} {'segments':>9} {'transl. %':>12} {'rotation deg/m':>16}\n" + "".join(rows)


def evaluation_table(evaluation):
    """Text in metres, percent and degrees."""
    pairing, fraction = evaluation.pairing, evaluation.drift_fraction()
    text = row("poses compared", f"{len(pairing.times)}, {'by time' if pairing.by_time else 'row by row'}"
               + (f", {pairing.unmatched} without a truth" if pairing.unmatched else ""))
    text += row("path length", f"{evaluation.path_length:.3f} m (estimated: {evaluation.estimated_path_length:.3f} m)")
    if pairing.scale != 1.0:
        text += row("scale of the estimate", f"multiplied by {pairing.scale:.6f}")
    text += row("final drift", f"{evaluation.final_drift:.3f} m, {np.degrees(evaluation.final_rotation):.3f} deg")
    if fraction is not None:
        text += row("final drift of the path", f"{100 * fraction:.3f} %")
    text += row("pose to pose (RPE, RMSE)", f"{evaluation.rpe[0]:.4f} m, {np.degrees(evaluation.rpe[1]):.4f} deg")
    text += row("position, aligned (ATE, RMSE)", f"{evaluation.aligned:.4f} m")
    text += row("position, same start (RMSE)", f"{evaluation.same_start:.4f} m")
    text += segment_table("5 to 40 m", evaluation.short)
    if evaluation.axes:
        x, y, z = np.round(np.degrees(evaluation.axes.rotation), 3) + 0.0  # no -0.000
        text += segment_row("axes aligned", evaluation.axes.short.all, f"  (turned by {x:.3f}, {y:.3f}, {z:.3f} deg)")
    text += segment_table("100 to 800 m", evaluation.long)
    return text + "".join(f"problem: {problem}\n" for problem in evaluation.problems)


def errors_json(errors):
    is_known = errors.count > 0
    return {**({"length_m": errors.length} if errors.length else {}), "count": errors.count,
            "translation_percent": 100 * errors.translation if is_known else None,
            "rotation_deg_per_m": float(np.degrees(errors.rotation)) if is_known else None}


def segments_json(segments):
    return {**errors_json(segments.all), "by_length": [errors_json(errors) for errors in segments.each]}


def evaluation_json(evaluation):
    """Each key names its unit. Values that do not apply are None."""
    pairing, fraction, axes = evaluation.pairing, evaluation.drift_fraction(), evaluation.axes
    return {
        "association": "time" if pairing.by_time else "rows", "poses": len(pairing.times), "unmatched": pairing.unmatched,
        "path_length_m": evaluation.path_length, "estimated_path_length_m": evaluation.estimated_path_length, "scale": pairing.scale,
        "final_drift_m": evaluation.final_drift, "final_drift_percent": None if fraction is None else 100 * fraction,
        "final_rotation_deg": float(np.degrees(evaluation.final_rotation)),
        "rpe_rmse_m": evaluation.rpe[0], "rpe_rmse_deg": float(np.degrees(evaluation.rpe[1])),
        "ate_rmse_m": evaluation.aligned, "origin_rmse_m": evaluation.same_start,
        "segments_5_to_40_m": segments_json(evaluation.short), "segments_100_to_800_m": segments_json(evaluation.long),
        "problem": "; ".join(evaluation.problems),
        "axes_aligned": axes and {"rotation_deg": np.degrees(axes.rotation).tolist(), "segments_5_to_40_m": segments_json(axes.short)}}
