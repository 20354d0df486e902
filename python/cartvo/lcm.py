"""LCM messages of cartvod: decode_odometry(data), decode_health(data)."""
from ._cartvo import CameraHealth, CameraState, HealthMessage, OdometryMessage, decode_health, decode_odometry

__all__ = ["CameraHealth", "CameraState", "HealthMessage", "OdometryMessage", "decode_health", "decode_odometry"]
