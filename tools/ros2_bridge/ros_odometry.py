"""Converts messages of CARTVO_ODOMETRY to the values of nav_msgs/msg/Odometry. Needs no ROS.

REP-103, REP-105: the pose is that of base_link in odom, the twist is in the axes of base_link. cartvo's body axes are those
of base_link: x forward, y left, z up.
"""
import dataclasses
import zlib

CHANNEL = b"CARTVO_ODOMETRY"
MAGIC_SHORT_MESSAGE = b"LC02"  # of LCM's UDP packets; cartvo's messages are never fragmented


def message_of_packet(packet, decode):
    """The odometry in a packet of LCM, by lcm-gen's odometry_t.decode; None for other channels and other types, and for one that was
    changed on its way: its last four bytes are the CRC-32 of the others."""
    if packet[:4] != MAGIC_SHORT_MESSAGE:
        return None
    channel, _, body = packet[8:].partition(b"\0")
    if channel != CHANNEL or zlib.crc32(body[:-4]) != int.from_bytes(body[-4:], "big"):
        return None
    try:
        return decode(body)
    except Exception:  # lcm-gen's code raises ValueError for another type and struct.error for a short one
        return None


def multiply(p, q):
    """The product of two quaternions w x y z."""
    pw, px, py, pz = p
    qw, qx, qy, qz = q
    return (pw * qw - px * qx - py * qy - pz * qz, pw * qx + px * qw + py * qz - pz * qy,
            pw * qy - px * qz + py * qw + pz * qx, pw * qz + px * qy - py * qx + pz * qw)


def rotation_matrix(q):
    w, x, y, z = q
    return ((1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
            (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
            (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)))


def rotate(q, vector):
    return tuple(sum(a * b for a, b in zip(row, vector)) for row in rotation_matrix(q))


def rotated_covariance(q, rows):
    """R C R^T of each 3x3 block of a 6x6 matrix, row by row."""
    matrix = rotation_matrix(q)

    def element(i, j):
        block_i, block_j = 3 * (i // 3), 3 * (j // 3)
        return sum(matrix[i % 3][k] * rows[6 * (block_i + k) + block_j + m] * matrix[j % 3][m]
                   for k in range(3) for m in range(3))

    return [element(i, j) for i in range(6) for j in range(6)]


@dataclasses.dataclass
class RosOdometry:
    """The values of nav_msgs/msg/Odometry."""
    stamp: tuple  # seconds, nanoseconds
    position: tuple
    orientation: tuple  # x y z w, as in ROS
    pose_covariance: list  # in the axes of odom
    linear: tuple
    angular: tuple
    twist_covariance: list  # in the axes of base_link


class OdometryConverter:
    """Converts messages one after another. A pose that began again goes on from the last one, since odom must not jump."""

    def __init__(self):
        self._last = None  # newest message
        self._epoch_position, self._epoch_orientation = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)  # epoch's world in odom
        self._position, self._orientation = self._epoch_position, self._epoch_orientation  # last valid pose in odom

    def convert(self, message):
        """None for a message that must not be published: INVALID, repeated, or older than the newest."""
        if self._is_old(message):
            return None
        if self._last is not None and self._begins_epoch(message):
            self._epoch_position, self._epoch_orientation = self._position, self._orientation
        self._last = message
        if message.status != message.VALID:
            return None
        turned = rotate(self._epoch_orientation, message.position_world_body)
        self._position = tuple(a + b for a, b in zip(self._epoch_position, turned))
        self._orientation = multiply(self._epoch_orientation, message.orientation_world_body)
        w, x, y, z = self._orientation
        return RosOdometry((message.utime // 1000000, message.utime % 1000000 * 1000), self._position, (x, y, z, w),
                           rotated_covariance(self._orientation, message.pose_covariance_body),
                           tuple(message.velocity_body), tuple(message.angular_velocity_body),
                           list(message.twist_covariance_body))

    def _is_old(self, message):
        """A lower sequence that was published later is a daemon that began again."""
        last = self._last
        return (last is not None and message.sequence <= last.sequence
                and message.publication_utime <= last.publication_utime)

    def _begins_epoch(self, message):
        return message.reset_counter != self._last.reset_counter or message.sequence <= self._last.sequence
