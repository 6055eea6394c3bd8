#!/usr/bin/env python3
"""Prints the DH table of a result.json, and what is known of each number.

    python3 read_result.py RESULT.json [ANGLE_DEG ...]

With angles, one a joint, it also prints where the target is at that pose, from the DH table alone.
Python's standard library suffices.
"""
import json
import math
import sys

NUMBERS = (("b", "mm"), ("theta", "deg"), ("a", "mm"), ("alpha", "deg"), ("beta", "deg"))


def knowledge(row, name, unit):
    """What is known of a number: its 95 % half-width, or why it has none."""
    if f"{name}_{unit}" in row.get("by_convention", ()):
        return "set by convention"
    low, high = row.get(f"{name}_low_{unit}"), row.get(f"{name}_high_{unit}")
    if low is None or high is None:
        return "not determined"
    return f"+- {(high - low) / 2:.6f} {unit} (95 %)"


def rotation(axis, degrees):
    """About X, Y or Z, as four rows."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return {"x": [[1, 0, 0, 0], [0, c, -s, 0], [0, s, c, 0], [0, 0, 0, 1]],
            "y": [[c, 0, s, 0], [0, 1, 0, 0], [-s, 0, c, 0], [0, 0, 0, 1]],
            "z": [[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}[axis]


def translation(x, z):
    return [[1, 0, 0, x], [0, 1, 0, 0], [0, 0, 1, z], [0, 0, 0, 1]]


def product(*matrices):
    result = matrices[0]
    for matrix in matrices[1:]:
        result = [[sum(row[k] * matrix[k][j] for k in range(4)) for j in range(4)]
                  for row in result]
    return result


def placement(group):
    """A base or a tool of the models: x, y, z and the rotation matrix row by row."""
    return [[*(group[f"r{i}{j}"] for j in (1, 2, 3)), group[f"{axis}_mm"]]
            for i, axis in ((1, "x"), (2, "y"), (3, "z"))] + [[0, 0, 0, 1]]


def target(result, angles):
    """Tz(b) Rz(theta) Tx(a) Rx(alpha) Ry(beta) of each joint, between base and tool."""
    if "models" not in result:
        sys.exit("the arm is not completely identified: there is no model of it")
    model = result["models"]["dh"]
    homes = result.get("home_deg") or [None] * len(model["joints"])
    pose = placement(model["base"])
    for row, angle, home in zip(model["joints"], angles, homes, strict=True):
        way = row["positive"] * (angle - (home or 0))  # unknown home: angles count from there
        linear = row.get("type") == "linear"
        pose = product(pose,
                       translation(0, row["b_mm"] + (way if linear else 0)),
                       rotation("z", row["theta_deg"] + (0 if linear else way)),
                       translation(row["a_mm"], 0),
                       rotation("x", row["alpha_deg"]),
                       rotation("y", row["beta_deg"]))
    pose = product(pose, placement(model["tool"]))
    return [row[3] for row in pose[:3]]


def main(path, angles):
    with open(path, encoding="utf-8") as file:
        result = json.load(file)
    if not result["schema"].startswith("sweepd.result/"):
        sys.exit(f"{path} is no result of sweepd")
    print(f"{result['robot']}: {result['status']}, describes the {result['describes']}")
    if "reason" in result:
        print(f"because {result['reason']}")
    for row in result["dh"]:
        for name, unit in NUMBERS:
            value = row.get(f"{name}_{unit}")
            if value is not None:
                print(f"{name}{row['joint']:<2} {value:14.6f} {unit:3}  {knowledge(row, name, unit)}")
    for message in result["warnings"] + result.get("doubts", []):
        print(f"{message['code']}: {message['message']}")
    if angles:
        print("target at", ", ".join(f"{value:.4f} mm" for value in target(result, angles)))


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(sys.argv[1], [float(angle) for angle in sys.argv[2:]])
