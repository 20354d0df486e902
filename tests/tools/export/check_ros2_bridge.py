#!/usr/bin/env python3
"""check_ros2_bridge.py LCM-GEN: the conversions of tools/ros2_bridge, on messages as LCM sends them.

The node itself runs against modules that stand in for ROS 2: they record what is published.
"""
import math
import pathlib
import socket
import subprocess
import sys
import tempfile
import types
import unittest
import zlib

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools/ros2_bridge"))
import ros_odometry  # noqa: E402


class Auto:
    """A message whose fields appear when they are used."""

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        value = Auto()
        setattr(self, name, value)
        return value


def stand_in_for_ros(published):
    class Publisher:
        def __init__(self, topic):
            self._topic = topic

        def publish(self, message):
            published.append((self._topic, message))

    class Node:
        def __init__(self, name):
            pass

        def declare_parameter(self, name, value):
            return types.SimpleNamespace(value={"group": "127.0.0.1", "port": 0}.get(name, value))

        def create_publisher(self, kind, topic, depth):
            return Publisher(topic)

    class TransformBroadcaster:
        def __init__(self, node):
            pass

        def sendTransform(self, transform):
            published.append(("tf", transform))

    modules = {"rclpy": {"ok": lambda: True}, "rclpy.node": {"Node": Node}, "geometry_msgs": {},
               "geometry_msgs.msg": {"TransformStamped": Auto}, "nav_msgs": {}, "nav_msgs.msg": {"Odometry": Auto},
               "tf2_ros": {"TransformBroadcaster": TransformBroadcaster}}
    for name, contents in modules.items():
        module = types.ModuleType(name)
        vars(module).update(contents)
        sys.modules[name] = module


class Conversion(unittest.TestCase):
    def message(self, sequence, **changes):
        message = odometry_t()
        message.sequence, message.publication_utime, message.utime = sequence, 1000 * sequence, 1700000000123456
        message.status = odometry_t.VALID
        half = math.sqrt(0.5)
        message.position_world_body, message.orientation_world_body = [1.0, 2.0, 0.0], [half, 0.0, 0.0, half]
        message.velocity_body, message.angular_velocity_body = [2.0, 0.0, 0.0], [0.0, 0.0, 0.1]
        message.pose_covariance_body = [float(i == j) * (i + 1) for i in range(6) for j in range(6)]
        message.twist_covariance_body = [0.5] * 36
        for name, value in changes.items():
            setattr(message, name, value)
        return message

    def packet(self, sequence):
        body = self.message(sequence).encode()[:-4]
        return b"LC02\0\0\0\1CARTVO_ODOMETRY\0" + body + zlib.crc32(body).to_bytes(4, "big")

    def test_pose_in_odom_and_twist_in_base_link(self):
        values = ros_odometry.OdometryConverter().convert(self.message(1))
        self.assertEqual(values.stamp, (1700000000, 123456000))
        self.assertEqual(values.position, (1.0, 2.0, 0.0))
        self.assertAlmostEqual(values.orientation[2], math.sqrt(0.5))
        self.assertAlmostEqual(values.orientation[3], math.sqrt(0.5))
        self.assertEqual(values.linear, (2.0, 0.0, 0.0))
        diagonal = [values.pose_covariance[7 * i] for i in range(6)]
        for found, expected in zip(diagonal, [2, 1, 3, 5, 4, 6]):
            self.assertAlmostEqual(found, expected)

    def test_what_must_not_be_published(self):
        converter = ros_odometry.OdometryConverter()
        self.assertIsNone(converter.convert(self.message(1, status=odometry_t.INVALID)))
        self.assertIsNotNone(converter.convert(self.message(3)))
        self.assertIsNone(converter.convert(self.message(3)), "repeated")
        self.assertIsNone(converter.convert(self.message(2)), "late")

    def test_a_pose_that_begins_again_goes_on(self):
        converter = ros_odometry.OdometryConverter()
        converter.convert(self.message(1))
        ahead = {"position_world_body": [1.0, 0.0, 0.0], "orientation_world_body": [1.0, 0.0, 0.0, 0.0]}
        values = converter.convert(self.message(2, reset_counter=1, **ahead))
        for found, expected in zip(values.position, (1.0, 3.0, 0.0)):
            self.assertAlmostEqual(found, expected)
        restarted = converter.convert(self.message(0, reset_counter=1, publication_utime=9000, **ahead))
        self.assertAlmostEqual(restarted.position[1], 4.0)

    def test_packets(self):
        packet = self.packet(1)
        self.assertEqual(ros_odometry.message_of_packet(packet, odometry_t.decode).sequence, 1)
        body = packet[24:]
        for other in (b"", b"LC03" + packet[4:], b"LC02\0\0\0\1OTHER\0" + body, packet[:40],
                      packet[:24] + b"\1" * len(body), packet[:100] + bytes([packet[100] ^ 1]) + packet[101:]):
            self.assertIsNone(ros_odometry.message_of_packet(other, odometry_t.decode))

    def test_node(self):
        published = []
        stand_in_for_ros(published)
        opened = types.SimpleNamespace(packets=[self.packet(1)])

        def receive(size):
            if opened.packets:
                return opened.packets.pop()
            sys.modules["rclpy"].ok = lambda: False
            raise socket.timeout

        import cartvo_ros2_bridge
        cartvo_ros2_bridge.open_multicast = lambda group, port: types.SimpleNamespace(recv=receive)
        cartvo_ros2_bridge.Bridge()._thread.join(60)
        (topic, odometry), (tf, transform) = published
        self.assertEqual((topic, tf), ("odometry", "tf"))
        self.assertEqual((odometry.header.frame_id, odometry.child_frame_id), ("odom", "base_link"))
        self.assertEqual(odometry.pose.pose.position.y, 2.0)
        self.assertEqual(odometry.twist.twist.linear.x, 2.0)
        self.assertEqual(transform.transform.translation.y, 2.0)
        self.assertEqual(transform.child_frame_id, "base_link")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.argv.pop(1), "-p", "--ppath", folder, ROOT / "daemon/messages/odometry_t.lcm"], check=True)
        sys.path.insert(0, folder)
        sys.dont_write_bytecode = True
        from cartvo import odometry_t
        unittest.main()
