"""The true motion of a simulated drive that repeats, and which VALID messages contradict it."""
import bisect

# A VALID velocity is wrong if it differs from the truth by more than this and by more than six standard deviations.
TOLERANCE = 0.10  # m/s: the truth's differences, and 20 ms of utime at 3 m/s^2
DEVIATIONS = 6.0
LOOP_MARGIN_S = 1.5  # around the jump from the content's end to its beginning, where there is no motion to measure


class Truth:
    """Velocity of the body, in its axes, at an instant; the content of `period` seconds repeats."""

    def __init__(self, file, period):
        with open(file) as lines:
            rows = [list(map(float, line.split())) for line in lines if not line.startswith("#")]
        self.begin, self.period = rows[0][0], period
        self.times, self.velocities = [], []
        for before, now, after in zip(rows, rows[1:], rows[2:]):
            x, y, z, w = now[4:8]
            d = [(b - a) / (after[0] - before[0]) for a, b in zip(before[1:4], after[1:4])]
            # d in body axes: the rotation's inverse.
            tx, ty, tz = (2 * (-y * d[2] + z * d[1]), 2 * (-z * d[0] + x * d[2]), 2 * (-x * d[1] + y * d[0]))
            self.velocities.append((d[0] + w * tx - y * tz + z * ty, d[1] + w * ty - z * tx + x * tz,
                                    d[2] + w * tz - x * ty + y * tx))
            self.times.append(now[0] - self.begin)

    def at(self, instant):
        """The velocity, or None where there is none."""
        phase = instant - self.begin
        if phase > self.period:
            phase %= self.period
        if not LOOP_MARGIN_S < phase < self.period - LOOP_MARGIN_S:
            return None
        i = bisect.bisect(self.times, phase)
        if i == 0 or i >= len(self.times):
            return None
        share = (phase - self.times[i - 1]) / (self.times[i] - self.times[i - 1])
        return [a + share * (b - a) for a, b in zip(self.velocities[i - 1], self.velocities[i])]


def wrong_velocities(messages, truth):
    """VALID messages whose velocity is not the truth's, or from the future, and the number of those that were compared."""
    wrong, compared = [], 0
    for message in messages:
        true = truth.at(message["utime"] * 1e-6) if message["valid"] else None
        if true is None:
            continue
        compared += 1
        error = sum((a - b) ** 2 for a, b in zip(message["velocity"], true)) ** 0.5
        late = message["utime"] * 1e-6 > message["received"]
        if late or not error <= max(TOLERANCE, DEVIATIONS * message["deviation"]):
            wrong.append((message, true, error))
    return wrong, compared
