#!/usr/bin/env python3
"""cartvo_ros2_bridge.py: publishes cartvod's odometry as nav_msgs/msg/Odometry, and odom -> base_link on /tf.

Run it where ROS 2 is sourced and lcm-gen -p has made the Python types; README.md beside it has the steps. Parameters:
group and port (of lcm.url), odom_frame, base_frame, publish_tf.
"""
import socket
import struct
import threading

import rclpy
from cartvo import odometry_t
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
from rclpy.node import Node
from ros_odometry import OdometryConverter, message_of_packet
from tf2_ros import TransformBroadcaster


def open_multicast(group, port):
    listener = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    listener.bind((group, port))
    listener.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, struct.pack("=4sl", socket.inet_aton(group), 0))
    listener.settimeout(0.5)
    return listener


class Bridge(Node):
    def __init__(self):
        super().__init__("cartvo_bridge")
        self._odom_frame = self.declare_parameter("odom_frame", "odom").value
        self._base_frame = self.declare_parameter("base_frame", "base_link").value
        publish_tf = self.declare_parameter("publish_tf", True).value
        group = self.declare_parameter("group", "239.255.76.67").value
        port = self.declare_parameter("port", 7667).value
        self._publisher = self.create_publisher(Odometry, "odometry", 10)
        self._broadcaster = TransformBroadcaster(self) if publish_tf else None
        self._converter = OdometryConverter()
        self._listener = open_multicast(group, port)
        self._thread = threading.Thread(target=self._receive, daemon=True)
        self._thread.start()

    def _receive(self):
        while rclpy.ok():
            try:
                packet = self._listener.recv(65535)
            except socket.timeout:
                continue
            message = message_of_packet(packet, odometry_t.decode)
            values = self._converter.convert(message) if message is not None else None
            if values is not None:
                self.publish(values)

    def publish(self, values):
        odometry = Odometry()
        odometry.header.stamp.sec, odometry.header.stamp.nanosec = values.stamp
        odometry.header.frame_id = self._odom_frame
        odometry.child_frame_id = self._base_frame
        pose, twist = odometry.pose.pose, odometry.twist.twist
        pose.position.x, pose.position.y, pose.position.z = values.position
        pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w = values.orientation
        odometry.pose.covariance = values.pose_covariance
        twist.linear.x, twist.linear.y, twist.linear.z = values.linear
        twist.angular.x, twist.angular.y, twist.angular.z = values.angular
        odometry.twist.covariance = values.twist_covariance
        self._publisher.publish(odometry)
        if self._broadcaster is None:
            return
        transform = TransformStamped()
        transform.header = odometry.header
        transform.child_frame_id = self._base_frame
        moved = transform.transform
        moved.translation.x, moved.translation.y, moved.translation.z = values.position
        moved.rotation = pose.orientation
        self._broadcaster.sendTransform(transform)


def main():
    rclpy.init()
    bridge = Bridge()
    try:
        rclpy.spin(bridge)
    except KeyboardInterrupt:
        pass
    finally:
        bridge.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
