"""Replaces an arm behind a SAW driver: crtk_arm.py LOG SECONDS. Publishes /arm/measured_cp: the handle moves down slowly, is homed
after SECONDS, moves up out of the bone within a second, and down again. LOG gets a line per wrench: whether the arm was homed,
and the force."""
import math
import struct
import sys
import time

import genpy
import rospy
from geometry_msgs.msg import PoseStamped, WrenchStamped


class OperatingState(genpy.Message):
    """crtk_msgs/OperatingState; Debian has no package for it."""

    _type, _md5sum, _has_header = "crtk_msgs/OperatingState", "0" * 32, False
    _full_text = "std_msgs/Header header\nstring state\nbool is_homed\nbool is_busy\n"
    __slots__, _slot_types = ["state", "is_homed"], ["string", "bool"]

    def serialize(self, buffer):
        state = self.state.encode()
        buffer.write(struct.pack("<IIII", 0, 0, 0, 0) + struct.pack("<I", len(state)) + state)
        buffer.write(struct.pack("<??", self.is_homed, False))


def height_mm(time_s, homed_s):
    if time_s < homed_s:
        return -25 * time_s
    out_mm = -20
    if time_s < homed_s + 1:
        return -25 * homed_s + (25 * homed_s + out_mm) * (time_s - homed_s)
    return out_mm - 50 * (time_s - homed_s - 1)


rospy.init_node("arm", anonymous=True)
begun_s = time.monotonic()
with open(sys.argv[1], "w", buffering=1) as log:
    is_homed = False
    pose = rospy.Publisher("/arm/measured_cp", PoseStamped, queue_size=1, tcp_nodelay=True)
    state = rospy.Publisher("/arm/operating_state", OperatingState, queue_size=1, latch=True)
    rospy.Subscriber("/arm/servo_cf", WrenchStamped, lambda message: log.write(
        f"{int(is_homed)} {message.wrench.force.x} {message.wrench.force.y} {message.wrench.force.z}\n"), tcp_nodelay=True)
    said = None
    next_s = time.monotonic()
    while not rospy.is_shutdown():
        time_s = time.monotonic() - begun_s
        is_homed = time_s > float(sys.argv[2])
        if said != is_homed:
            said = is_homed
            state.publish(OperatingState(state="ENABLED" if is_homed else "DISABLED", is_homed=is_homed))
        message = PoseStamped()
        message.pose.position.y = 1e-3 * (height_mm(time_s, float(sys.argv[2])) - 3 * math.sin(2 * math.pi * time_s))
        message.pose.orientation.w = 1
        pose.publish(message)
        next_s = max(next_s + 1e-3, time.monotonic())
        time.sleep(max(0, next_s - time.monotonic()))
