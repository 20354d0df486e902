"""True poses, velocities and rates at any instant."""
import numpy as np

from evaluation.motion import poses_of, quaternions_of, rotations_by, rotations_of, vectors_of

TOLERANCE_NS = 1_000_000  # times in a camera's 90 kHz clock are rounded by some us
# Widest gap of a truth over which to interpolate: three of its median periods, but at least the first and at most the second of
# these. Milliseconds that were read as seconds leave longer ones.
LEAST_GAP_NS, MOST_GAP_NS = 250_000_000, 6_000_000_000


class InterpolatedTruth:
    """True poses by interpolation between neighbours that are close enough: translation linearly, rotation by slerp."""

    def __init__(self, truth):
        self.truth = truth
        periods = np.sort(np.diff(truth.times))
        self.period_ns = int(periods[len(periods) // 2]) if len(periods) else 0  # median
        self.most_gap_ns = min(max(3 * self.period_ns, LEAST_GAP_NS), MOST_GAP_NS)

    def at(self, times):
        """Whether the truth is known at each instant (ns), and (n, 4, 4) poses, which mean nothing where it is not. Within 1 ms
        before the first or behind the last pose the truth is that pose."""
        known_times, poses = self.truth.times, self.truth.poses
        inside = np.clip(times, known_times[0], known_times[-1])
        after = np.searchsorted(known_times, inside)
        before = np.where(known_times[after] == inside, after, after - 1)
        gap = known_times[after] - known_times[before]
        known = (np.abs(times - inside) <= TOLERANCE_NS) & (gap <= self.most_gap_ns)
        share = ((inside - known_times[before]) / np.maximum(gap, 1))[:, None]
        start, end = poses[before], poses[after]
        turn = vectors_of(np.swapaxes(start[:, :3, :3], 1, 2) @ end[:, :3, :3])
        return known, poses_of(start[:, :3, :3] @ rotations_by(share * turn), (1 - share) * start[:, :3, 3] + share * end[:, :3, 3])


def end_slope(times, values):
    """Derivative at the first of four knots of the cubic through them; `values`: (4, k)."""
    slope = 0.0
    for i in (1, 2, 3):
        share = np.prod([(times[0] - times[j]) / (times[i] - times[j]) for j in (1, 2, 3) if j != i])
        slope = slope + (share * values[i] - values[0]) / (times[i] - times[0])
    return slope


def spline_slopes(times, values):
    """Slopes (n, k) of the cubic splines with continuous second derivatives through values (n, k) at `times` (s): elimination of a
    tridiagonal system, with the slopes of cubics at the ends."""
    slopes, upper = np.zeros_like(values), np.zeros(len(times))
    slopes[0], slopes[-1] = end_slope(times[:4], values[:4]), end_slope(times[:-5:-1], values[:-5:-1])
    steps, rises = np.diff(times), np.diff(values, axis=0)
    right = 3.0 * ((steps[1:] / steps[:-1])[:, None] * rises[:-1] + (steps[:-1] / steps[1:])[:, None] * rises[1:])
    for i in range(1, len(times) - 1):
        diagonal = 2.0 * (steps[i - 1] + steps[i]) - steps[i] * upper[i - 1]
        upper[i] = steps[i - 1] / diagonal
        slopes[i] = (right[i - 1] - steps[i] * slopes[i - 1]) / diagonal
    for i in range(len(times) - 2, 0, -1):
        slopes[i] -= upper[i] * slopes[i + 1]
    return slopes


class TrueTwist:
    """Velocity and rates of the body from true poses alone: cubic splines through positions and unit quaternions. Poses closer
    together than 20 ms are thinned to that, because the noise of a position (sigma) becomes one of the velocity (1.2 sigma /
    spacing). At a spacing h the error of an oscillation's velocity is 0.1 % of its amplitude at 0.10 / h, 1 % at 0.18 / h and 10 %
    at 0.30 / h; faster motions are not resolved."""

    def __init__(self, truth):
        gaps = np.flatnonzero(np.diff(truth.times) > InterpolatedTruth(truth).most_gap_ns) + 1
        self.pieces = []  # (times, values, slopes) of parts without a gap
        for part in np.split(np.arange(len(truth.times)), gaps):
            knots, last = [], None
            for i, time in zip(part, truth.times[part].tolist()):
                if last is None or time - last >= 20_000_000:
                    knots.append(i)
                    last = time
            if len(knots) >= 4:
                times, poses = truth.times[knots], truth.poses[knots]
                q = quaternions_of(poses[:, :3, :3])  # of q and -q the one nearer to the quaternion before
                q[1:] *= np.cumprod(np.where((q[1:] * q[:-1]).sum(1) < 0, -1.0, 1.0))[:, None]
                values = np.concatenate([poses[:, :3, 3], q], 1)
                self.pieces.append((times, values, spline_slopes(1e-9 * (times - times[0]), values)))

    def at(self, instants):
        """(n, 6) velocity (m/s) and rates (rad/s) in body axes at instants (ns). NaN before the second and behind the last pose but
        one (by more than 1 ms), where the slope at the end counts too much, and in gaps."""
        twists = np.full((len(instants), 6), np.nan)
        for times, values, slopes in self.pieces:
            inside = np.clip(instants, times[1], times[-2])
            here = np.flatnonzero((np.abs(instants - inside) <= TOLERANCE_NS) & np.isnan(twists[:, 0]))
            after = np.searchsorted(times[:-1], inside[here], "right")
            before = after - 1
            step = 1e-9 * (times[after] - times[before])[:, None]
            u = 1e-9 * (inside[here] - times[before])[:, None] / step
            rise, start, end = values[after] - values[before], step * slopes[before], step * slopes[after]
            square, cube = 3.0 * rise - 2.0 * start - end, start + end - 2.0 * rise
            value = values[before] + u * (start + u * (square + u * cube))
            slope = (start + u * (2.0 * square + 3.0 * u * cube)) / step
            q, rate = value[:, 3:], slope[:, 3:]
            norm = np.linalg.norm(q, axis=1, keepdims=True)
            rotation = rotations_of(q / norm)
            twists[here, :3] = (np.swapaxes(rotation, 1, 2) @ slope[:, :3, None])[..., 0]
            w, v = q[:, :1], q[:, 1:]  # the vector part of conjugate(q) * rate
            twists[here, 3:] = 2.0 / norm**2 * (w * rate[:, 1:] - rate[:, :1] * v - np.cross(v, rate[:, 1:]))
        return twists
