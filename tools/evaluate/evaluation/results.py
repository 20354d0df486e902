"""The results of a comparison as text and as JSON."""
import dataclasses

import numpy as np

from evaluation.measures import Evaluation, evaluation_json, evaluation_table
from evaluation.program import NO_VALUE, json_text, text_table
from evaluation.validity import Judged, validity_json, validity_of, validity_table


@dataclasses.dataclass
class Compared:
    """An estimate that was compared with the truth."""
    name: str  # of its file
    evaluation: Evaluation
    is_of_camera: bool  # axes of the poses: x right, z forward; else x forward, y left
    judged: Judged | None = None  # its messages, as far as they are known
    odometry: str = ""  # their file


def comparison(all_compared, limits):
    """Header and rows of a table of several estimates."""
    def percent(segments):
        return f"{100 * segments.all.translation:.3f}" if segments.all.count else NO_VALUE
    rows = []
    for compared in all_compared:
        e, fraction = compared.evaluation, compared.evaluation.drift_fraction()
        rows.append([compared.name, str(len(e.pairing.times)), f"{e.path_length:.2f}", f"{e.final_drift:.3f}",
                     NO_VALUE if fraction is None else f"{100 * fraction:.3f}", f"{e.rpe[0]:.4f}", f"{np.degrees(e.rpe[1]):.4f}",
                     f"{e.aligned:.4f}", percent(e.short), percent(e.long),
                     f"{validity_of(compared.judged, limits).available_percent():.2f}" if compared.judged else NO_VALUE])
    return ["estimate", "poses", "path (m)", "drift (m)", "drift (%)", "RPE (m)", "RPE (deg)", "ATE (m)", "5 to 40 m (%)", "100 to 800 m (%)",
            "VALID (%)"], rows


def results_json(compared, options):
    judged = compared.judged
    validity = {"validity": validity_json(validity_of(judged, options.alert_limits), options.alert_limits)} if judged else {}
    return {"estimate": compared.name, "truth": options.truth, **evaluation_json(compared.evaluation), **validity}


def results_text(all_compared, options):
    if options.json:
        results = [results_json(compared, options) for compared in all_compared]
        return json_text(results if len(results) > 1 else results[0])
    if len(all_compared) > 1:
        problems = [f"problem: {c.name}: {problem}\n" for c in all_compared for problem in c.evaluation.problems]
        return text_table(*comparison(all_compared, options.alert_limits)) + "".join(problems)
    judged = all_compared[0].judged
    validity = validity_table(validity_of(judged, options.alert_limits), options.alert_limits) if judged else ""
    return evaluation_table(all_compared[0].evaluation) + validity
