"""The true motion of a simulated drive that repeats, and which VALID messages contradict it."""
import bisect
import math

LIMITS = (0.3, math.radians(3.0))  # m/s, rad/s: the default alert limits of cartvod
# An instant of a camera that is streamed is known to this, which no bound includes: the truth moves on meanwhile.
INSTANT_ERROR_S = 0.02
LOOP_MARGIN_S = 1.5  # around the jump from the content's end to its beginning, where there is no motion to measure


def product(a, b):
    """Of quaternions (x, y, z, w)."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz)


class Truth:
    """Velocity (m/s) and rates (rad/s) of the body, in its axes, at an instant; the content of `period` seconds repeats.

    From the poses of a file alone, at 1/h Hz, by differences of fourth order: exact to 1 % for motions of up to 0.11/h Hz.
    """

    def __init__(self, file, period):
        with open(file) as lines:
            rows = [list(map(float, line.split())) for line in lines if not line.startswith("#")]
        self.begin, self.period = rows[0][0], period
        self.times, self.motions = [], []
        for at in range(2, len(rows) - 2):
            near, now = rows[at - 2:at + 3], rows[at]
            step = (near[4][0] - near[0][0]) / 4
            inverse = (-now[4], -now[5], -now[6], now[7])
            turned = [product(inverse, row[4:8]) for row in near]  # relative to `now`, so that the sign can be chosen
            turned = [tuple(math.copysign(1.0, q[3]) * value for value in q) for q in turned]
            moved = [product(product(inverse, (*(a - b for a, b in zip(row[1:4], now[1:4])), 0.0)), now[4:8]) for row in near]
            self.motions.append(tuple(
                factor * (near_[0][i] - 8 * near_[1][i] + 8 * near_[3][i] - near_[4][i]) / (12 * step)
                for near_, factor in ((moved, 1.0), (turned, 2.0)) for i in range(3)))
            self.times.append(now[0] - self.begin)

    def at(self, instant):
        """Velocity and rates, or None where there is none."""
        phase = instant - self.begin
        if phase > self.period:
            phase %= self.period
        if not LOOP_MARGIN_S < phase < self.period - LOOP_MARGIN_S:
            return None
        i = bisect.bisect(self.times, phase)
        if i == 0 or i >= len(self.times):
            return None
        share = (phase - self.times[i - 1]) / (self.times[i] - self.times[i - 1])
        return [a + share * (b - a) for a, b in zip(self.motions[i - 1], self.motions[i])]


class Judgement:
    """VALID messages above an alert limit, and above their bound; and how often there is one."""

    def __init__(self, limits=LIMITS):
        self.limits = [limits[0]] * 3 + [limits[1]] * 3
        self.above_limit, self.above_bound = [], []  # (message, truth, errors)
        self.messages, self.valid, self.judged, self.longest_gap = 0, 0, 0, 0.0
        self.last_valid = None  # instant of reception

    def add(self, messages, truth):
        """Judges messages in their order. One from the future, or without numbers, is above its limit and its bound."""
        for message in messages:
            self.messages += 1
            self.valid += message["valid"]
            self.last_valid = message["received"] if self.last_valid is None else self.last_valid
            self.longest_gap = max(self.longest_gap, message["received"] - self.last_valid)
            if not message["valid"]:
                continue
            self.last_valid = message["received"]
            instant = message["utime"] * 1e-6
            true = truth.at(instant)
            if true is None:
                continue
            self.judged += 1
            errors = [abs(a - b) for a, b in zip((*message["velocity"], *message["rates"]), true)]
            is_late = instant > message["received"]
            if is_late or not all(error <= limit for error, limit in zip(errors, self.limits)):
                self.above_limit.append((message, true, errors))
            moved = [[abs(b - a) for a, b in zip(true, truth.at(instant + shift) or true)]
                     for shift in (-INSTANT_ERROR_S, INSTANT_ERROR_S)]
            bounds = (*message["velocity_bound"], *message["rate_bound"])
            known = [bound + max(before, after) for bound, before, after in zip(bounds, *moved)]
            if is_late or not all(error <= largest for error, largest in zip(errors, known)):
                self.above_bound.append((message, true, errors))

    def text(self):
        return (f"{len(self.above_limit)} of {self.judged} VALID messages above an alert limit, "
                f"{len(self.above_bound)} above their bound; available {self.valid} of {self.messages}, "
                f"{100 * self.valid / max(self.messages, 1):.1f} %, longest gap {self.longest_gap:.2f} s")
