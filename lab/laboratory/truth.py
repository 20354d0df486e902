"""The truth of a rendered drive, and errors of estimates under their stated covariance."""
import math

from laboratory.measure import image_times, pose_rows
from laboratory.program import LabError

KNOTS = 5  # of the polynomial that gives a velocity: 44 ms of the 90 Hz at which the truth is written
TOLERANCE = 1e-3  # s: instants may be rounded


class Truth:
    """True motions of the rectified left camera and true velocities of the body."""

    def __init__(self, source, rig):
        import cv2
        import numpy as np
        if source.body is None or not (times := image_times(source.folder)):
            raise LabError(f"{source.folder}: has no truth.tum or no times_0.txt; expected a drive of cartvo simulate --render")
        self.times = np.array(times)
        # The rotation into the rectified camera depends on the camera's pose alone.
        rotation, translation = np.array(rig.T_right_left[:3, :3]), np.array(rig.T_right_left[:3, 3])
        self.rectified_left = np.eye(4)
        self.rectified_left[:3, :3] = cv2.stereoRectify(np.eye(3), np.zeros(5), np.eye(3), np.zeros(5), rig.left.size, rotation, translation)[0]
        self.poses = np.array([[*map(float, row.split()), 0, 0, 0, 1] for row in pose_rows(source.poses)]).reshape(-1, 4, 4)
        self.body = np.array([[float(word) for word in row.split()] for row in pose_rows(source.body)])

    def pair(self, instant):
        """Number of the pair of this instant, s."""
        return int(abs(self.times - instant).argmin())

    def left_pose(self, rectified_pose):
        return self.rectified_left.T @ rectified_pose @ self.rectified_left

    def motion(self, start, end):
        """Of the rectified left camera between the instants of two pairs."""
        import numpy as np
        motion = np.linalg.inv(self.poses[self.pair(start)]) @ self.poses[self.pair(end)]
        return self.rectified_left @ motion @ self.rectified_left.T

    def twist(self, instant):
        """Velocity and angular velocity of the body in its axes; None before and behind the truth."""
        import numpy as np
        times = self.body[:, 0]
        if len(times) < KNOTS or not times[0] - TOLERANCE <= instant <= times[-1] + TOLERANCE:
            return None
        first = min(max(int(np.searchsorted(times, instant)) - KNOTS // 2, 0), len(times) - KNOTS)
        knots = self.body[first:first + KNOTS]
        values = knots[:, 1:].copy()
        values[:, 3:] *= np.where(values[:, 3:] @ values[0, 3:] < 0, -1.0, 1.0)[:, None]  # of q and -q the nearer one
        slope, value = np.polyfit(knots[:, 0] - instant, values, KNOTS - 1)[-2:]
        q, w, dq, dw = value[3:6], value[6], slope[3:6], slope[6]
        velocity = slope[:3] + 2.0 * np.cross(-q, np.cross(-q, slope[:3]) + w * slope[:3]) / (q @ q + w * w)
        rate = 2.0 * (w * dq - dw * q - np.cross(q, dq)) / (q @ q + w * w)
        return np.concatenate([velocity, rate])


def motion_error(estimate, truth):
    """Perturbation on the right that takes the estimate to the truth: translation and rotation vector (odometry_estimate.hpp)."""
    import cv2
    import numpy as np
    difference = np.linalg.inv(estimate) @ truth
    return np.concatenate([difference[:3, 3], cv2.Rodrigues(difference[:3, :3])[0].ravel()])


def likelihood(error, covariance):
    """NEES per dimension and negative log likelihood of an error with this covariance; None if it is no covariance.
    Y. Bar-Shalom, X. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001, section 5.4."""
    import numpy as np
    if not np.isfinite(covariance).all() or not np.isfinite(error).all():
        return None
    try:
        factor = np.linalg.cholesky(covariance)
    except np.linalg.LinAlgError:
        return None
    n = len(error)
    square = float((np.linalg.solve(factor, error) ** 2).sum())
    return square / n, 0.5 * square + float(np.log(factor.diagonal()).sum()) + 0.5 * n * math.log(2.0 * math.pi)


def effective_count(values):
    """Number of independent values whose mean scatters as that of these: over the sum of autocorrelations up to the first that is not
    positive (C. Geyer, Practical Markov Chain Monte Carlo, 1992)."""
    import numpy as np
    n, deviations = len(values), np.array(values) - np.mean(values) if values else []
    if n < 3 or not (variance := float(deviations @ deviations)):
        return n
    time = 1.0
    for lag in range(1, n // 2):
        correlation = float(deviations[lag:] @ deviations[:-lag]) / variance
        if correlation <= 0.0:
            break
        time += 2.0 * correlation
    return n / time
