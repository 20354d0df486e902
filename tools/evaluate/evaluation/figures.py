"""The figures of a comparison: paths, errors, segments, velocities, rates, consistency, bounds."""
import numpy as np

from evaluation.chart import BLUE, GREEN, INK, OF_ESTIMATES, RED, Chart, Panel, Series
from evaluation.motion import angles_of, inverse
from evaluation.program import NO_VALUE, excerpt, significant
from evaluation.segments import distances_along

MOST_ROWS = 30  # of a table of numbers
ONE_NEES = (1.237344 / 6, 14.449375 / 6)  # quantiles 2.5 % and 97.5 % of chi-square with 6 degrees of freedom, over 6
CELLS_PER_DECADE = 25
TWISTS = (("velocities", "Velocity in body axes over time", ("forward", "left", "up"), "m/s", 1.0,
           "Velocity of the body's origin as published, with twice its standard deviation. The true velocity is the derivative of splines through "
           "the true positions."),
          ("rates", "Angular rates in body axes over time", ("roll rate", "pitch rate", "yaw rate"), "deg/s", 180 / np.pi,
           "Rates about the forward, left and upward axis as published; the truth as for velocities."))
BOUNDS = (("velocity-bounds", "Error of velocities against their bound (Stanford diagram)", TWISTS[0],
           "Each dot is a component of the velocity of a VALID message, and dots in the same place are one. Below the line the error is above the "
           "bound that the message states; to the right of the upright dashed line it is above the alert limit. A message with a bound above the "
           "level dashed line is not VALID. The table has those nearest to their bound or above it."),
          ("rate-bounds", "Error of angular rates against their bound (Stanford diagram)", TWISTS[1], "As for velocities."))


def spread(count):
    """At most MOST_ROWS indices of `count` values, evenly spread, with the first and the last."""
    return np.linspace(0, count - 1, min(count, MOST_ROWS)).astype(int).tolist()


def text(value, decimals):
    return f"{value:.{decimals}f}" if np.isfinite(value) else NO_VALUE


def table_of(compared, all_compared, row):
    """Rows of a figure's numbers; of several estimates each begins with the name."""
    return [compared.name, *row] if len(all_compared) > 1 else row


def columns_of(all_compared, columns):
    return ["estimate", *columns] if len(all_compared) > 1 else columns


def name_of(compared, all_compared, alone):
    """In a legend; matplotlib leaves out names that begin with "_"."""
    return excerpt(" " * compared.name.startswith("_") + compared.name, 200) if len(all_compared) > 1 else alone


def pose_errors(compared):
    """(n,) distances along the truth (m), errors of position (m) and of rotation (deg) of the placed estimate."""
    pairing = compared.evaluation.pairing
    errors = inverse(pairing.truth) @ pairing.placed_estimate()
    return distances_along(pairing.truth), np.linalg.norm(errors[:, :3, 3], axis=1), np.degrees(angles_of(errors[:, :3, :3]))


def seconds_of(compared):
    """(n,) s of the compared poses since the first message, or since the first pose; None if nothing has instants."""
    pairing, judged = compared.evaluation.pairing, compared.judged
    if not pairing.by_time and (judged is None or len(judged.messages.times) != len(pairing.times)):
        return None
    times = pairing.times if pairing.by_time else judged.messages.times
    return 1e-9 * (times - (judged.messages.times[0] if judged else times[0]))


def ground_paths(all_compared):
    """The true path and the estimates, each (n, 2), on the ground plane of the truth's first pose, and the names of the axes. Forward is up,
    unless the path is longer forward than sideways: then it is to the right. The truth is that part of it that most poses have."""
    pairings = [compared.evaluation.pairing for compared in all_compared]
    longest = max(pairings, key=lambda pairing: len(pairing.truth))
    axes = np.array([[0, 0, 1], [-1, 0, 0]] if all_compared[0].is_of_camera else [[1, 0, 0], [0, 1, 0]])  # forward and left
    def on_ground(poses):
        return (inverse(longest.truth[0]) @ poses)[:, :3, 3] @ axes.T
    paths = [on_ground(longest.truth), *(on_ground(pairing.placed_estimate()) for pairing in pairings)]
    width, height = np.ptp(paths[0], axis=0)
    if width >= height:
        return paths, "forward (m)", "left (m)"
    return [path[:, ::-1] * (-1, 1) for path in paths], "right (m)", "forward (m)"


def not_valid(compared):
    """Indices of the compared poses of messages that are not valid, except the first message."""
    if compared.judged is None:
        return []
    pairing, messages = compared.evaluation.pairing, compared.judged.messages
    invalid = np.flatnonzero(~messages.valid[1:]) + 1
    if not pairing.by_time:
        return invalid[invalid < len(pairing.times)]
    return np.flatnonzero(np.isin(pairing.times // 1000, messages.times[invalid] // 1000))  # messages have us


def path_chart(all_compared):
    (truth, *paths), horizontal, vertical = ground_paths(all_compared)
    def dots(name, colour, points):
        return Series(name, colour, points[:, 0], points[:, 1], "dots")
    series, ends, invalid, rows = [Series("truth", INK, *truth.T, "dashed")], [], [], []
    for i, (compared, path) in enumerate(zip(all_compared, paths)):
        colour = OF_ESTIMATES[i % len(OF_ESTIMATES)]
        series.append(Series(name_of(compared, all_compared, "estimate"), colour, *path.T))
        ends.append(dots(name_of(compared, all_compared, "end of estimate") if len(all_compared) == 1 else "", colour, path[-1:]))
        invalid.append(path[not_valid(compared)])
        errors = pose_errors(compared)[1]
        rows += [table_of(compared, all_compared, [text(path[j, 0], 2), text(path[j, 1], 2), text(errors[j], 3)]) for j in spread(len(path))]
    series += [dots("start", GREEN, truth[:1]), dots("end of truth", INK, truth[-1:]), *ends]
    invalid = np.concatenate(invalid)
    if len(invalid):
        series.append(dots("not valid", RED, invalid))
    low, high = (function([function(path, axis=0) for path in (truth, *paths)], axis=0) for function in (np.min, np.max))
    height = int(min(max(1.25 * 524 * (high[1] - low[1]) / max(high[0] - low[0], 1e-3), 180), 460))  # little room beside the paths
    return Chart("trajectory", f"Path from above, {all_compared[0].evaluation.pairing.placement()}", horizontal, [Panel(vertical, series, height)],
                 "All paths on the ground plane of the truth's first pose.",
                 columns_of(all_compared, [f"estimate, {horizontal}", f"estimate, {vertical}", "error of position (m)"]), rows, has_equal_scale=True)


def error_chart(all_compared, name, title, x_title, caption, x_of):
    """Errors of position and rotation over x."""
    found = [(x_of(compared), *pose_errors(compared)[1:]) for compared in all_compared]
    panels = []
    for k, unit in ((1, "position (m)"), (2, "rotation (deg)")):
        series = [Series(name_of(compared, all_compared, ""), OF_ESTIMATES[i % len(OF_ESTIMATES)], errors[0], errors[k])
                  for i, (compared, errors) in enumerate(zip(all_compared, found))]
        end = f", at the end {significant(found[0][k][-1])}" if len(found) == 1 else ""
        panels.append(Panel(f"{unit}, at most {significant(max(errors[k].max() for errors in found))}{end}", series, 150, contains_zero=True))
    rows = [table_of(compared, all_compared, [text(errors[0][j], 2), text(errors[1][j], 3), text(errors[2][j], 3)])
            for compared, errors in zip(all_compared, found) for j in spread(len(errors[0]))]
    return Chart(name, f"{title}, {all_compared[0].evaluation.pairing.placement()}", x_title, panels, caption,
                 columns_of(all_compared, [x_title, "position (m)", "rotation (deg)"]), rows)


def distance_chart(all_compared):
    return error_chart(all_compared, "error-over-distance", "Error of the pose over distance", "distance driven (m)",
                       "Distance and angle between the estimated and the true pose.", lambda compared: pose_errors(compared)[0])


def segments_of(compared):
    """(n, 4) length, count, translation (%) and rotation (deg/m); the short ones first."""
    evaluation = compared.evaluation
    return np.array([(e.length, e.count, 100 * e.translation, np.degrees(e.rotation))
                     for e in (*evaluation.short.each, *evaluation.long.each)]).reshape(-1, 4)


def segment_chart(all_compared):
    found = [segments_of(compared) for compared in all_compared]
    panels = []
    for k, title in ((2, "translation (% of the length)"), (3, "rotation (deg/m)")):
        series = []
        for i, (compared, errors) in enumerate(zip(all_compared, found)):
            for style in ("line", "dots"):
                series.append(Series(name_of(compared, all_compared, "") if style == "line" else "", OF_ESTIMATES[i % len(OF_ESTIMATES)],
                                     errors[:, 0], errors[:, k], style))
        panels.append(Panel(title, series, 140, contains_zero=True))
    rows = [table_of(compared, all_compared, [f"{e[0]:.0f}", f"{e[1]:.0f}", f"{e[2]:.3f}", f"{e[3]:.5f}"])
            for compared, errors in zip(all_compared, found) for e in errors]
    return Chart("segments", "Error of segments by their length", "length of the segments (m)", panels,
                 "Error of the motion between two poses that are a length apart on the true path, divided by that length. 100 to 800 m as in KITTI's "
                 "devkit, starting at each tenth pose; 5 to 40 m starting at each pose.",
                 columns_of(all_compared, ["length (m)", "segments", "translation (%)", "rotation (deg/m)"]), rows)


def message_seconds(judged):
    return 1e-9 * (judged.messages.times - judged.messages.times[0])


def invalid_spans(judged):
    """Parts of the time (s) in which messages are not valid, without the first message, which can have no motion."""
    seconds, spans = message_seconds(judged), []
    for i in np.flatnonzero(~judged.messages.valid[1:]) + 1:
        start, end = seconds[i], seconds[min(i + 1, len(seconds) - 1)]
        if spans and spans[-1][1] == start:
            spans[-1] = (spans[-1][0], end)
        else:
            spans.append((start, end))
    return spans


def twist_chart(judged, first, definition):
    """Velocities (`first` 0) or rates (3) against the truth."""
    name, title, axes, unit, factor, caption = definition
    messages, seconds = judged.messages, message_seconds(judged)
    values = factor * np.where(messages.valid[:, None], messages.twists, np.nan)
    truth = factor * judged.true_twists
    deviations = factor * np.sqrt(np.maximum(np.diagonal(messages.twist_covariances, axis1=1, axis2=2), 0.0))
    deviations[~messages.valid] = np.nan
    panels, columns, cells = [], ["time (s)"], []
    for axis, axis_name in enumerate(axes, first):
        value, deviation = values[:, axis], deviations[:, axis]
        errors = (value - truth[:, axis])[np.isfinite(value - truth[:, axis])]
        rmse = text(np.sqrt(np.mean(errors**2)) if len(errors) else np.nan, 3)
        band = Series("estimate ±2 σ", BLUE, seconds, np.column_stack([value - 2 * deviation, value + 2 * deviation]))
        panels.append(Panel(f"{axis_name} ({unit}), RMSE {rmse}", [Series("estimate", BLUE, seconds, value),
                                                                 Series("truth", INK, seconds, truth[:, axis], "dashed")], 115, band))
        columns += [f"{axis_name}{part} ({unit})" for part in ("", " truth", " σ")]
        cells += [value, truth[:, axis], deviation]
    rows = [[text(seconds[i], 2), *(text(cell[i], 3) for cell in cells)] for i in spread(len(seconds))]
    return Chart(name, title, "time (s)", panels, caption, columns, rows)


def verdict(judged):
    """Whether the stated covariances are right, in words. A factor on a deviation is the root of that on NEES."""
    sentences = []
    for name, nees in zip(("velocities and rates", "pose in its epoch"), judged.nees):
        known = nees[~np.isnan(nees)]
        if not len(known):
            sentences.append(f"Of the {name} there is no value: no VALID message with a motion has a truth and a usable covariance.")
            continue
        factor = np.sqrt(known.mean())
        if factor > 1.5:
            sentences.append(f"The errors of the {name} are {significant(factor)} times the stated deviation: it is too small here.")
        elif factor < 1 / 1.5:
            sentences.append(f"The stated deviation of the {name} is {significant(1 / max(factor, 1e-6))} times too large here.")
        else:
            sentences.append(f"The stated deviation of the {name} fits the errors.")
    return " ".join(sentences)


def nees_chart(judged):
    """None without a value."""
    seconds, panels, names = message_seconds(judged), [], ("velocities and rates", "pose in its epoch")
    ends = seconds[[0, -1]]
    for name, nees in zip(names, judged.nees):
        known = nees[~np.isnan(nees)]
        if len(known):
            inside = 100 * np.mean((ONE_NEES[0] <= known) & (known <= ONE_NEES[1]))
            band = Series("95 % of χ²(6) / 6", GREEN, ends, np.array([ONE_NEES, ONE_NEES]))
            panels.append(Panel(f"{name}: mean {significant(known.mean())}, {inside:.0f} % inside",
                                [Series("NEES / 6", BLUE, seconds, np.where(nees > 0, nees, np.nan)),
                                 Series("1: consistent", INK, ends, np.ones(2), "dashed")], 140, band, is_logarithmic=True))
    if not panels:
        return None
    caption = (verdict(judged) + " Squared error over its covariance, divided by the six dimensions. If covariances are right, 95 % of the values "
               "lie in the interval; above it errors are larger than stated. Errors of poses are correlated: each contains those before. An "
               "error of the truth counts as one of the estimate.")
    rows = [[text(seconds[i], 2), *(NO_VALUE if np.isnan(nees[i]) else significant(nees[i]) for nees in judged.nees)] for i in spread(len(seconds))]
    return Chart("nees", "Consistency of covariances (NEES) over time", "time (s)", panels, caption, ["time (s)", *names], rows)


def motion_charts(judged):
    """Charts of velocities, rates and consistency; none without a VALID message."""
    if not judged.messages.valid.any():
        return []
    charts = [twist_chart(judged, 0, TWISTS[0]), twist_chart(judged, 3, TWISTS[1]), nees_chart(judged)]
    return [chart for chart in charts if chart]


def distinct_dots(errors, bounds):
    """Thousands of messages would make a page slow without showing more."""
    cells = np.rint(CELLS_PER_DECADE * np.log10(np.column_stack([errors, bounds])))
    kept = np.unique(cells, axis=0, return_index=True)[1]
    return errors[kept], bounds[kept]


def bound_chart(judged, quantity, limit, definition):
    """A Stanford diagram; None without an error. `quantity`: 0 velocity, 1 rates; `limit`: m/s or deg/s."""
    name, title, (_, _, axes, unit, factor, _), caption = definition
    of_message, axis = np.nonzero(~np.isnan(judged.errors[:, quantity]))
    if not len(axis):
        return None
    errors = factor * judged.errors[of_message, quantity, axis]
    bounds = factor * judged.messages.bounds[of_message, quantity, axis]
    ratios = np.where(np.isnan(bounds), np.inf, errors / bounds)
    largest = np.fmax.reduce(np.concatenate([errors, bounds]), initial=2 * limit)
    low, high = 10.0 ** np.floor(np.log10(1e-3 * limit)), 10.0 ** np.ceil(np.log10(min(largest, 1e4 * limit)))
    series = []
    for label, colour, chosen in (("within its bound", BLUE, ~(ratios > 1)), ("above its bound", RED, ratios > 1)):
        dots = distinct_dots(np.clip(errors[chosen], low, high), np.clip(np.nan_to_num(bounds[chosen], nan=low), low, high))
        series.append(Series(label, colour, *dots, "dots"))
    lines = np.array([[low, limit], [high, limit], [np.nan, np.nan], [limit, low], [limit, high]])
    series += [Series("error = bound", INK, np.array([low, high]), np.array([low, high])), Series("alert limit", GREEN, *lines.T, "dashed")]
    seconds = message_seconds(judged)
    rows = [[text(seconds[of_message[i]], 2), axes[axis[i]], significant(errors[i]), NO_VALUE if np.isnan(bounds[i]) else significant(bounds[i])]
            for i in np.argsort(-ratios, kind="stable")[:MOST_ROWS]]
    return Chart(name, title, f"error ({unit})", [Panel(f"bound ({unit})", series, 400, is_logarithmic=True)], caption,
                 ["time (s)", "component", f"error ({unit})", f"bound ({unit})"], rows, is_x_logarithmic=True)


def evaluation_charts(all_compared, limits):
    """Charts over time need files with instants or messages; those of messages are of a single estimate."""
    charts = [path_chart(all_compared), distance_chart(all_compared)]
    judged = all_compared[0].judged if len(all_compared) == 1 else None
    over_time = []
    if all(seconds_of(compared) is not None for compared in all_compared):
        caption = "The same errors over time" + ("; a red bar below shows when messages were not valid." if judged else ".")
        over_time.append(error_chart(all_compared, "error-over-time", "Error of the pose over time", "time (s)", caption, seconds_of))
    charts += over_time + ([segment_chart(all_compared)] if any(len(segments_of(compared)) for compared in all_compared) else [])
    if judged is None:
        return charts
    of_messages = motion_charts(judged)
    for chart in over_time + of_messages:
        chart.marked, chart.marked_name = invalid_spans(judged), "not valid"
    bounds = [bound_chart(judged, quantity, limits[quantity], BOUNDS[quantity]) for quantity in (0, 1)]
    return charts + of_messages + [chart for chart in bounds if chart]


def plot_charts(all_compared):
    return [path_chart(all_compared), distance_chart(all_compared)]
