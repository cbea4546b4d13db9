#!/usr/bin/env python3
"""The device's side of docs/udp-device.md in Python: udp_device.py [PORT]. Equivalent to udp_device.c, for
experiments and for import (as in crtk_bridge.py). For 1 kHz use C, whose loop does not stall."""
import math
import select
import socket
import struct
import sys
import time

HEAD = struct.Struct("<4sHHII")
REPLY = struct.Struct("<64sIIdd")
STATE = struct.Struct("<3d4dII")
WRENCH = struct.Struct("<3d3d")
REQUEST_KIND, REPLY_KIND, STATE_KIND, WRENCH_KIND = 1, 2, 3, 4

PERIOD_S = 1e-3
LAPSE_S = 5e-3  # an older wrench is zero
CONVERSATION_S = 0.1  # no states are sent to a partner silent for longer
FORCE_RATE_N_S = 4000  # fastest change that a hand can bear
TORQUE_RATE_NMM_S = 1e5


class ExampleDevice:
    """Replace this with your device."""

    name, sensed, driven, max_force_N, max_torque_Nmm = b"example device in Python", 6, 6, 10, 200

    def read_handle(self, time_s):
        """Returns position in mm (x to the operator's right, y up, z towards them), orientation (w, x, y, z),
        buttons, and 0 if it may be driven (1: not calibrated, 2: force is off). Returns None without a new measurement."""
        y_mm = 2 * math.cos(0.5 * math.pi * time_s) - 2
        return (0, y_mm, 0), (1, 0, 0, 0), 1, 0

    def drive_motors(self, force_N, torque_Nmm):
        """Drives force and torque as they act on the hand, about the handle's origin, along the same axes."""


def head(kind, sequence, is_busy=0):
    return HEAD.pack(b"OMIL", 1, kind, sequence & 0xFFFFFFFF, is_busy)


def approach(sent, wanted, most):
    way = [w - s for s, w in zip(sent, wanted)]
    length = math.hypot(*way)
    share = most / length if length > most else 1
    return [s + share * w for s, w in zip(sent, way)]


def serve(device, port=47117):
    """Runs until interrupted, and then sends zero to the motors."""
    try:
        converse(device, port)
    finally:
        device.drive_motors([0] * 3, [0] * 3)


def converse(device, port):
    to_all = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    to_all.bind(("127.0.0.1", port))
    reply = REPLY.pack(device.name, device.sensed, device.driven, device.max_force_N, device.max_torque_Nmm)
    partner, newest, asked = None, 0, ((0, 0, 0), (0, 0, 0))
    sent_N, sent_Nmm, states = [0] * 3, [0] * 3, 0
    heard_s = started_s = -math.inf
    next_s = time.monotonic()
    while True:
        while (left_s := next_s - time.monotonic()) > 0:
            if not select.select([to_all], [], [], left_s)[0]:
                continue
            datagram, sender = to_all.recvfrom(256)
            if len(datagram) < HEAD.size:
                continue
            magic, version, kind, sequence, _ = HEAD.unpack_from(datagram)
            if magic != b"OMIL" or version != 1:
                continue
            if kind == REQUEST_KIND:
                is_busy = next_s - heard_s < CONVERSATION_S and sender != partner
                to_all.sendto(head(REPLY_KIND, sequence, is_busy) + reply, sender)
            elif kind == WRENCH_KIND and len(datagram) == HEAD.size + WRENCH.size:
                talking = next_s - heard_s < CONVERSATION_S
                overtaken = (sequence - newest) & 0xFFFFFFFF in range(0x80000000, 0x100000000) or sequence == newest
                if talking and (sender != partner or overtaken):
                    continue
                numbers = WRENCH.unpack_from(datagram, HEAD.size)
                if not all(map(math.isfinite, numbers)):
                    continue
                if not talking:
                    started_s = next_s
                partner, newest, asked, heard_s = sender, sequence, (numbers[:3], numbers[3:]), time.monotonic()
        if time.monotonic() - next_s > 10 * PERIOD_S:
            next_s = time.monotonic()  # stalled: skips the missed ticks
        old = time.monotonic() - heard_s > LAPSE_S
        force_N, torque_Nmm = ((0, 0, 0), (0, 0, 0)) if old else asked
        sent_N = approach(sent_N, force_N, FORCE_RATE_N_S * PERIOD_S)
        sent_Nmm = approach(sent_Nmm, torque_Nmm, TORQUE_RATE_NMM_S * PERIOD_S)
        device.drive_motors(sent_N, sent_Nmm)
        measured = time.monotonic() - heard_s < CONVERSATION_S and device.read_handle(next_s - started_s)
        if measured:
            states += 1
            position, orientation, buttons, not_driven = measured
            state = STATE.pack(*position, *orientation, buttons, not_driven)
            to_all.sendto(head(STATE_KIND, states) + state, partner)
        next_s += PERIOD_S


if __name__ == "__main__":
    serve(ExampleDevice(), *map(int, sys.argv[1:2]))
