"""Finds a time offset between an estimate and its truth by the correlation of speeds and rates."""
import numpy as np

from evaluation.interpolation import InterpolatedTruth
from evaluation.motion import inverse, motion_vectors

SPEED_UNIT, RATE_UNIT = 0.2, 0.02  # m/s and rad/s that a drive shows at least
LEAST_CORRELATION, LEAST_OFFSET, EQUAL = 0.8, 0.2, 0.01  # offset in s
GPS_EPOCH = 315_964_800.0  # s since 1970


def nanoseconds(seconds):
    return np.rint(1e9 * seconds).astype(np.int64)


def duration(trajectory):
    return 1e-9 * float(trajectory.times[-1] - trajectory.times[0])


def profile_of(trajectory, step):
    """(n, 4) speed and rates at each `step` (s), in the units above, without their mean; 0 where they are unknown. Neither depends on
    the world frame."""
    poses = InterpolatedTruth(trajectory)
    window = max(2.0 * step, 2e-9 * poses.period_ns)
    times = trajectory.times[0] + nanoseconds(np.arange(int(duration(trajectory) / step) + 1) * step)
    half = nanoseconds(np.float64(0.5 * window))
    (known, start), (known_end, end) = poses.at(times - half), poses.at(times + half)
    known &= known_end
    profile = np.zeros((len(times), 4))
    if known.any():
        motions = motion_vectors(inverse(start[known]) @ end[known]) / window
        values = np.column_stack([np.linalg.norm(motions[:, :3], axis=1) / SPEED_UNIT, motions[:, 3:] / RATE_UNIT])
        profile[known] = values - values.mean(0)
    return profile


def without_axes(profile):
    """(n, 2): the rates by their size, which does not depend on the axes either."""
    sizes = np.linalg.norm(profile[:, 1:], axis=1)
    return np.column_stack([profile[:, 0], sizes - sizes.mean()])


def agreement_alone(estimate, truth):
    """Correlation of two profiles about their means over these instants alone, where one file may be of a part of the drive only. Uniform
    motions agree unless they differ."""
    estimate, truth = estimate - estimate.mean(0), truth - truth.mean(0)
    squares = np.sqrt((estimate**2).sum() * (truth**2).sum())
    if squares < len(estimate):
        return 1.0 if ((estimate - truth)**2).sum() < len(estimate) else -1.0
    return float((estimate * truth).sum() / squares)


def best_agreement(estimate, truth, step, start):
    """The best offset (s, added to the estimate's instants), the correlation with it and the one without it; -1: none. `start`: s from
    the truth's first instant to the estimate's. Of maxima that are equal, as of periodic motions, the offset is the smallest one, or
    without a common time that with the most in common."""
    n, m = len(estimate), len(truth)
    lags = np.arange(-n, m + 1)  # steps by which the estimate is shifted
    first = np.maximum(lags, 0)
    common = np.minimum(n + lags, m) - first
    sums = [np.concatenate([[0.0], np.cumsum((profile**2).sum(1))]) for profile in (estimate, truth)]
    squares = np.sqrt((sums[0][first - lags + common] - sums[0][first - lags]) * (sums[1][first + common] - sums[1][first]))
    products = np.zeros(len(lags))
    products[1:-1] = sum(np.correlate(t, e, "full") for e, t in zip(estimate.T, truth.T))
    is_known = (squares >= common) & (common > 0)  # otherwise the motion is uniform
    correlations = np.where(is_known, products / np.where(is_known, squares, 1.0), -1.0)
    at = np.where(common >= max(min(n, m) // 2, 2), correlations, -1.0)
    inner = at[1:-1]
    is_maximum = (inner >= at.max() - EQUAL) & (inner >= at[:-2]) & (inner >= at[2:])
    chosen = np.flatnonzero(is_maximum) + 1
    if not len(chosen):
        return 0.0, -1.0, -1.0
    present = int(np.trunc(shift := min(max(start / step, -1e9), 1e9)) + np.trunc(2.0 * (shift - np.trunc(shift))))  # rounded
    has_common = -n < present < m
    best = chosen[np.argmin(np.abs(lags[chosen] - present)) if has_common else np.argmax(common[chosen])]
    curvature = at[best - 1] - 2.0 * at[best] + at[best + 1]
    part = 0.5 * (at[best - 1] - at[best + 1]) / curvature if curvature < 0 else 0.0
    offset = (lags[best] + min(max(part, -0.5), 0.5)) * step - start
    if not has_common or common[present + n] < 10:
        return float(offset), float(at[best]), -1.0
    begin, length = max(present, 0), common[present + n]
    alone = agreement_alone(estimate[begin - present:][:length], truth[begin:][:length])
    return float(offset), float(at[best]), max(float(correlations[present + n]), alone)


def reason_of(offset):
    """Why clocks may differ by an offset (s)."""
    size = abs(offset)
    if 12.5 < size < 18.5:
        return "GPS time is ahead of UTC, by 18 s since 2017"
    if 12.5 < GPS_EPOCH - size < 18.5:
        return "GPS time counts from 1980, and is ahead of UTC"
    if abs(size - GPS_EPOCH) < 2.0:
        return "one counts from 1980, as GPS does, the other from 1970"
    if abs(size - 37.0) < 0.5:
        return "TAI is 37 s ahead of UTC"
    if 898.0 < size < 14 * 3600 + 2.0 and abs(size - 900.0 * round(size / 900.0)) < 2.0:
        return "this is the difference of a time zone"
    return "the two clocks differ"


def clock_problem(estimate, truth):
    """Says that the clocks differ, and by how much, if speeds and rates agree much better with a time offset than without one; empty
    otherwise, also if the motion is too uniform to tell."""
    step = max(0.1, max(duration(estimate), duration(truth)) / 8000.0)
    profiles = profile_of(estimate, step), profile_of(truth, step)
    start = 1e-9 * float(estimate.times[0] - truth.times[0])
    sizes = best_agreement(*map(without_axes, profiles), step, start)
    found = best_agreement(*profiles, step, start)
    present = max(found[2], sizes[2])  # turned axes are no matter of the clock
    offset, correlation, _ = found if found[1] >= LEAST_CORRELATION else sizes
    is_better = 1.0 - present > 0.002 + 3.0 * (1.0 - correlation)
    if correlation < LEAST_CORRELATION or abs(offset) < LEAST_OFFSET or not is_better:
        return ""
    if abs(offset - round(offset)) < 0.05:  # the conventions of clocks differ by whole seconds
        offset = float(round(offset))
    without = "" if present <= -1.0 else f", without {present:.4f}"
    return (f"the clocks of the two files differ: speeds and rates agree with {offset:+.2f} s added to the estimate's instants (correlation "
            f"{correlation:.4f}{without}): {reason_of(offset)}; compare with --offset {offset:.2f}")
