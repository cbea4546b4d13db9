#!/usr/bin/env python3
"""Connects an arm that speaks CRTK over ROS, such as those of the SAW drivers, to osteomill as a device: docs/bridges.md.

    crtk_bridge.py /omega [--port 47117] [--wrench servo_cf] [--max-force N] [--spindle TOPIC] [--clutch TOPIC]
"""
import argparse
import math
import signal
import struct
import threading

import udp_device

try:
    import rospy
except ImportError:
    import rclpy  # ROS 2: not tested
    import rclpy.node
    import rclpy.qos
    from crtk_msgs.msg import OperatingState
from geometry_msgs.msg import PoseStamped, WrenchStamped
from sensor_msgs.msg import Joy
from std_msgs.msg import Bool


class Ros1:
    def __init__(self):
        rospy.init_node("osteomill_crtk_bridge", anonymous=True, disable_signals=True)

    def listen(self, kind, topic, heard):
        rospy.Subscriber(topic, kind, heard, queue_size=1, tcp_nodelay=True)

    def listen_to_state(self, topic, heard):
        # Parses the raw message (header, text, is_homed, is_busy), because Debian has no crtk_msgs.
        def read(message):
            raw = message._buff
            frame_end = 16 + struct.unpack_from("<I", raw, 12)[0]
            text_end = frame_end + 4 + struct.unpack_from("<I", raw, frame_end)[0]
            heard(raw[frame_end + 4:text_end].decode(), raw[text_end] != 0)

        rospy.Subscriber(topic, rospy.AnyMsg, read, queue_size=1)

    def speak(self, kind, topic, latch=False):
        return rospy.Publisher(topic, kind, queue_size=1, tcp_nodelay=True, latch=latch).publish


class Ros2:
    def __init__(self):
        rclpy.init()
        self.node = rclpy.node.Node("osteomill_crtk_bridge")
        threading.Thread(target=rclpy.spin, args=(self.node,), daemon=True).start()

    def listen(self, kind, topic, heard):
        self.node.create_subscription(kind, topic, heard, 1)

    def listen_to_state(self, topic, heard):
        self.listen(OperatingState, topic, lambda message: heard(message.state, message.is_homed))

    def speak(self, kind, topic, latch=False):
        kept = rclpy.qos.DurabilityPolicy.TRANSIENT_LOCAL if latch else rclpy.qos.DurabilityPolicy.VOLATILE
        return self.node.create_publisher(kind, topic, rclpy.qos.QoSProfile(depth=1, durability=kept)).publish


class CrtkArm:
    sensed = driven = 6
    not_driven = 1  # until the first state arrives

    def __init__(self, ros, options):
        self.name = f"CRTK {options.arm}".encode()[:64]
        self.max_force_N, self.max_torque_Nmm = options.max_force, options.max_torque
        self.measured, self.pressed = None, {}
        ros.listen(PoseStamped, f"{options.arm}/measured_cp", self.take_pose)
        ros.listen_to_state(f"{options.arm}/operating_state", self.take_state)
        for bit, topic in ((1, options.spindle), (2, options.clutch)):
            if topic:
                ros.listen(Joy, topic, lambda message, bit=bit: self.pressed.update({bit: any(message.buttons)}))
        self.send = ros.speak(WrenchStamped, f"{options.arm}/{options.wrench}")
        if options.wrench.startswith("body/"):  # use the axes of the base also for body/
            absolute = f"{options.arm}/body/set_cf_orientation_absolute"
            ros.speak(Bool, absolute, latch=True)(Bool(data=True))

    def take_pose(self, message):
        p, q = message.pose.position, message.pose.orientation
        self.measured = (1e3 * p.x, 1e3 * p.y, 1e3 * p.z), (q.w, q.x, q.y, q.z)

    def take_state(self, state, is_homed):
        self.not_driven = 1 if not is_homed else 0 if state == "ENABLED" else 2

    def read_handle(self, time_s):
        measured, self.measured = self.measured, None
        if measured is None or not all(map(math.isfinite, measured[0] + measured[1])):
            return None
        return *measured, sum(bit for bit, is_down in self.pressed.items() if is_down), self.not_driven

    def drive_motors(self, force_N, torque_Nmm):
        message = WrenchStamped()
        message.wrench.force.x, message.wrench.force.y, message.wrench.force.z = map(float, force_N)
        torque = message.wrench.torque
        torque.x, torque.y, torque.z = (1e-3 * value for value in torque_Nmm)
        self.send(message)


def main():
    options = argparse.ArgumentParser(description=__doc__.split(":")[0])
    options.add_argument("arm", help="ROS namespace of the arm, such as /omega")
    options.add_argument("--port", type=int, default=47117)
    options.add_argument("--wrench", default="servo_cf",
                         help="topic of the wrench in the namespace; body/servo_cf for dVRK arms (default: servo_cf)")
    options.add_argument("--max-force", type=float, default=5, metavar="N")
    options.add_argument("--max-torque", type=float, default=100, metavar="Nmm")
    options.add_argument("--spindle", metavar="TOPIC",
                         help="topic of the button that turns the spindle (sensor_msgs/Joy; default: none)")
    options.add_argument("--clutch", metavar="TOPIC", help="topic of the clutch button (sensor_msgs/Joy; default: none)")
    options = options.parse_args()
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        udp_device.serve(CrtkArm((Ros1 if "rospy" in globals() else Ros2)(), options), options.port)
    except KeyboardInterrupt:
        pass


if __name__ == "__main__":
    main()
