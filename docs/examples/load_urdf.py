#!/usr/bin/env python3
"""Says where tool0 of a robot.urdf is at given joint angles.

    python3 load_urdf.py ROBOT.urdf ANGLE_DEG...

One angle a joint, in the controller's degrees (mm of a linear joint). Python's standard library
suffices. URDF has metres and radians.
"""
import math
import sys
import xml.etree.ElementTree as ElementTree


def product(left, right):
    return [[sum(left[i][k] * right[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def placement(xyz, rpy):
    """Translation, then Rz(yaw) Ry(pitch) Rx(roll)."""
    (x, y, z), (roll, pitch, yaw) = xyz, rpy
    cr, sr, cp, sp = math.cos(roll), math.sin(roll), math.cos(pitch), math.sin(pitch)
    cy, sy = math.cos(yaw), math.sin(yaw)
    return [[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr, x],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr, y],
            [-sp, cp * sr, cp * cr, z],
            [0, 0, 0, 1]]


def motion(joint, value):
    """What a joint does: a rotation about, or a translation along its axis, which is +-Z."""
    kind = joint.get("type")
    if kind == "fixed":
        return placement((0, 0, 0), (0, 0, 0))
    sense = numbers(joint.find("axis").get("xyz"))[2]
    if kind == "prismatic":
        return placement((0, 0, sense * value / 1000), (0, 0, 0))
    return placement((0, 0, 0), (0, 0, sense * math.radians(value)))


def numbers(text):
    return [float(number) for number in text.split()]


def main(path, values):
    joints = ElementTree.parse(path).getroot().findall("joint")
    moving = [joint for joint in joints if joint.get("type") != "fixed"]
    if len(values) != len(moving):
        sys.exit(f"expected {len(moving)} angles, one a joint, found {len(values)}")
    left = list(values)
    pose = placement((0, 0, 0), (0, 0, 0))
    for joint in joints:  # from base_link to tool0
        origin = joint.find("origin")
        pose = product(pose, placement(numbers(origin.get("xyz")), numbers(origin.get("rpy"))))
        pose = product(pose, motion(joint, left.pop(0) if joint in moving else 0))
    print("tool0 at", ", ".join(f"{1000 * row[3]:.4f} mm" for row in pose[:3]))


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(sys.argv[1], [float(value) for value in sys.argv[2:]])
