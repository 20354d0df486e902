"""Rigid motions as 4x4 matrices, rotations as 3x3 matrices, quaternions (w, x, y, z) and rotation vectors (rad). Each function
takes arrays with any leading dimensions."""
import numpy as np


def poses_of(rotations, positions):
    poses = np.zeros((*np.shape(positions)[:-1], 4, 4))
    poses[..., :3, :3] = rotations
    poses[..., :3, 3] = positions
    poses[..., 3, 3] = 1.0
    return poses


def inverse(poses):
    rotations = np.swapaxes(poses[..., :3, :3], -1, -2)
    return poses_of(rotations, -(rotations @ poses[..., :3, 3:])[..., 0])


def rotations_of(quaternions):
    """Of unit quaternions."""
    w, x, y, z = np.moveaxis(np.asarray(quaternions, float), -1, 0)
    return np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
                     2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                     2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], -1).reshape(*w.shape, 3, 3)


def quaternions_of(rotations):
    """Unit quaternions with w >= 0. The rows of 4 q q^T are parallel to q; that of a large component has most digits
    (S. Shepperd, Quaternion from rotation matrix, 1978). Rounded matrices give what Eigen makes of them."""
    m = np.moveaxis(np.asarray(rotations), (-2, -1), (0, 1))
    xx, yy, zz = m[0, 0], m[1, 1], m[2, 2]
    wx, wy, wz = m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]
    xy, xz, yz = m[1, 0] + m[0, 1], m[0, 2] + m[2, 0], m[2, 1] + m[1, 2]
    rows = np.stack([np.stack(row, -1) for row in ((1 + xx + yy + zz, wx, wy, wz), (wx, 1 + xx - yy - zz, xy, xz),
                                                   (wy, xy, 1 - xx + yy - zz, yz), (wz, xz, yz, 1 - xx - yy + zz))], -2)
    row = np.where(xx + yy + zz > 0, 0, 1 + np.argmax(np.stack([xx, yy, zz], -1), -1))
    q = np.take_along_axis(rows, row[..., None, None], -2)[..., 0, :]
    return q / np.linalg.norm(q, axis=-1, keepdims=True) * np.where(q[..., :1] < 0, -1.0, 1.0)


def vectors_of(rotations):
    """Rotation vectors; exact for small angles, where arccos of the trace is not."""
    q = quaternions_of(rotations)
    sine = np.linalg.norm(q[..., 1:], axis=-1, keepdims=True)
    angle = 2.0 * np.arctan2(sine, q[..., :1])
    return q[..., 1:] * np.where(sine > 1e-150, angle / np.maximum(sine, 1e-150), 2.0)


def angles_of(rotations):
    return np.linalg.norm(vectors_of(rotations), axis=-1)


def rotations_by(vectors):
    """The rotations of rotation vectors."""
    vectors = np.asarray(vectors, float)
    half = 0.5 * np.linalg.norm(vectors, axis=-1, keepdims=True)
    return rotations_of(np.concatenate([np.cos(half), 0.5 * vectors * np.sinc(half / np.pi)], -1))


def motion_vectors(motions):
    """Translation and rotation vector, (..., 6), as vectorFromMotion of vo_core/rigid_motion.hpp: not along a screw."""
    return np.concatenate([motions[..., :3, 3], vectors_of(motions[..., :3, :3])], -1)


def best_rotation(products):
    """The rotation R that maximises the trace of R^T `products`; with the sum of to * from^T, the one that takes the vectors
    `from` to `to` best (W. Kabsch, 1976)."""
    u, _, vt = np.linalg.svd(products)
    return u @ np.diag([1.0, 1.0, np.sign(np.linalg.det(u) * np.linalg.det(vt))]) @ vt
