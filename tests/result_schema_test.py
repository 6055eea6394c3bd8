#!/usr/bin/env python3
"""result.json of all that a run can be is what docs/result.schema.json says, what compare prints is
what docs/compare.schema.json says, and correction.json what docs/correction.schema.json says.

    result_schema_test.py SWEEPD SOURCE_FOLDER
"""
import copy
import csv
import json
import pathlib
import random
import subprocess
import sys
import tempfile

import jsonschema

sweepd, source = sys.argv[1], pathlib.Path(sys.argv[2])
robot = source / "config/robots/kr5_arc.toml"
schema = json.loads((source / "docs/result.schema.json").read_text(encoding="utf-8"))
jsonschema.Draft202012Validator.check_schema(schema)
validator = jsonschema.Draft202012Validator(schema)


def run(code, *arguments):
    done = subprocess.run([sweepd, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode != code:
        sys.exit(f"exit {done.returncode}, expected {code}: {arguments}\n{done.stderr}")


def check(folder, status):
    """The result that is in `folder`, valid and of this status."""
    result = json.loads((folder / "result.json").read_text(encoding="utf-8"))
    wrong = [f"{folder.name}: {error.json_path}: {error.message[:200]}"
             for error in validator.iter_errors(result)]
    if result["status"] != status:
        wrong.append(f"{folder.name}: status {result['status']}: {result.get('reason')}")
    if wrong:
        sys.exit("\n".join(wrong[:10]))
    return result


def scara(folder):
    """A robot with a linear joint, and a plan for it."""
    joints = [{"b_mm": 0.0, "theta_deg": 20.0, "a_mm": 250.0}, {"b_mm": 0.0, "theta_deg": 60.0, "a_mm": 300.0},
              {"b_mm": -120.0, "theta_deg": 15.0, "a_mm": 0.0, "type": "linear", "min_mm": 0.0, "max_mm": 200.0},
              {"b_mm": 0.0, "theta_deg": 0.0, "a_mm": 0.0}]
    sweeps = [("deg", -25.0, 65.0), ("deg", 15.0, 105.0), ("mm", 20.0, 180.0), ("deg", -75.0, 15.0)]
    home = "home_deg = [20.0, 60.0, 100.0, -30.0]\n"
    text = 'name = "SCARA"\n' + home + "tool_mm = [150.0, 60.0, 0.0]\n"
    for joint in joints:
        text += "[[joint]]\nalpha_deg = 0.0\npositive = 1\n"
        text += "".join(f"{key} = {json.dumps(value)}\n" for key, value in joint.items())
    (folder / "scara.toml").write_text(text)
    text = home + "positioning_speed_deg_s = 60.0\nacceleration_deg_s2 = 200.0\ndwell_ms = 300\n"
    for joint, (unit, start, end) in enumerate(sweeps, 1):
        text += (f"[[sweep]]\njoint = {joint}\nstart_{unit} = {start}\nend_{unit} = {end}\n"
                 f"speed_{unit}_s = 30.0\n")
    (folder / "plan.toml").write_text(text)
    return folder / "scara.toml", folder / "plan.toml"


def write(file, rows):
    with file.open("w", newline="") as out:
        writer = csv.DictWriter(out, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)


with tempfile.TemporaryDirectory() as name:
    work = pathlib.Path(name)
    trace = work / "trace.pcap"
    run(0, "simulate", "--robot", robot, "--plan", source / "config/plans/kr5_arc_30deg.toml",
        "--write", trace, "--quiet")
    run(0, "replay", trace, "--robot", robot, "--output", work / "complete", "--quiet")
    complete = check(work / "complete", "complete")
    run(0, "replay", trace, "--output", work / "unspecified", "--quiet")
    check(work / "unspecified", "complete")

    with (work / "complete/sweeps.csv").open() as lines:
        rows = list(csv.DictReader(lines))
    # A device's points: no angles, one target more.
    points = [{"joint": row["joint"], **{axis: row[axis] for axis in ("x_mm", "y_mm", "z_mm")}}
              for row in rows]
    write(work / "points.csv", points)
    run(0, "identify", work / "points.csv", "--robot", robot, "--output", work / "device", "--quiet")
    assert check(work / "device", "complete")["describes"] == "arm"
    write(work / "few.csv", [row for row in points if row["joint"] in "124"])
    run(0, "identify", work / "few.csv", "--robot", robot, "--output", work / "partial", "--quiet")
    check(work / "partial", "partial")
    # Some of the samples as static poses: from RSI, so that they are the controller's model.
    names = ["x_mm", "y_mm", "z_mm", *(f"a{j}_deg" for j in range(1, 7))]
    write(work / "poses.csv", [{key: row[key] for key in names} for row in rows[::40]])
    run(0, "identify", work / "poses.csv", "--robot", robot, "--output", work / "poses", "--quiet")
    told = check(work / "poses", "complete")
    assert told["estimator"] == "poses" and told["describes"] == "controller_model"
    write(work / "held.csv", [{key: row[key] for key in names} for row in rows[20::40]])
    run(0, "validate", work / "poses", work / "held.csv")
    # The same as a device would see them, and what they correct.
    chance = random.Random(1)
    write(work / "seen.csv", [{**{key: row[key] for key in names}, **{
        key: float(row[key]) + chance.gauss(0, 0.02) for key in names[:3]}} for row in rows[::40]])
    run(0, "identify", work / "seen.csv", "--robot", robot, "--output", work / "seen", "--quiet")
    assert check(work / "seen", "complete")["describes"] == "arm"
    corrections = jsonschema.Draft202012Validator(
        json.loads((source / "docs/correction.schema.json").read_text(encoding="utf-8")))
    point = "DECL E6AXIS X%d={A1 80.0,A2 -95.0,A3 100.0,A4 10.0,A5 70.0,A6 -20.0}\n"
    (work / "program.dat").write_text(point % 1 + point % 2)
    run(1, "correct", work / "poses", "--level", "frames")  # the controller's own model
    for level in ("frames", "mastering", "machine-data", "targets"):
        more = ["--program", work / "program.dat", "--write", work / "corrected.dat", "--leave", "X2"]
        run(0, "correct", work / "seen", "--level", level, *(more if level == "targets" else []))
        corrections.validate(json.loads((work / "seen/correction.json").read_text()))
    for row in points:
        for axis in ("x_mm", "y_mm", "z_mm"):
            row[axis] = float(row[axis]) / 1000
    write(work / "metres.csv", points)
    run(3, "identify", work / "metres.csv", "--robot", robot, "--output", work / "doubt", "--quiet")
    check(work / "doubt", "doubtful")
    still = [dict(row, x_mm=1, y_mm=2, z_mm=3) for row in points]
    write(work / "still.csv", still)
    run(1, "identify", work / "still.csv", "--robot", robot, "--output", work / "failed", "--quiet")
    check(work / "failed", "failed")
    axes = [{"joint": joint["joint"],
             **dict(zip(("x_mm", "y_mm", "z_mm"), joint["axis"]["point"])),
             **dict(zip(("dx", "dy", "dz"), joint["axis"]["direction"]))}
            for joint in complete["joints"]]
    write(work / "axes.csv", axes)
    run(0, "identify", "--axes", work / "axes.csv", "--robot", robot, "--output", work / "axes",
        "--quiet")
    check(work / "axes", "complete")

    description, plan = scara(work)
    run(0, "simulate", "--robot", description, "--plan", plan, "--write", work / "scara.pcap", "--quiet")
    run(0, "replay", work / "scara.pcap", "--robot", description, "--output", work / "scara", "--quiet")
    linear = check(work / "scara", "complete")["joints"][2]
    assert linear["type"] == "linear" and "range_mm" in linear["sweeps"][0] and "line" in linear
    with (work / "scara/sweeps.csv").open() as lines:
        points = [{key: row[key] for key in ("joint", "x_mm", "y_mm", "z_mm")} for row in csv.DictReader(lines)]
    write(work / "scara.csv", points)
    run(0, "identify", work / "scara.csv", "--robot", description, "--plan", plan, "--output",
        work / "scara-device", "--quiet")
    linear = check(work / "scara-device", "complete")["joints"][2]
    assert linear["type"] == "linear" and abs(linear["sweeps"][0]["range_mm"] - 160) < 1

    # A robot whose joint 4 has lost its zero by 0.02 degrees, with another tool, from another home.
    text = robot.read_text(encoding="utf-8").splitlines()
    theta = [at for at, line in enumerate(text) if line.startswith("theta_deg")][3]
    text[theta] = f"theta_deg = {float(text[theta].split('=')[1].split('#')[0]) + 0.02}"
    (work / "crashed.toml").write_text("\n".join(text))
    plan = (source / "config/plans/kr5_arc_90deg.toml").read_text(encoding="utf-8")
    (work / "home.toml").write_text(plan.replace("[90.0, -90.0, 90.0, 0.0, 90.0, 0.0]",
                                                 "[80.0, -95.0, 85.0, 12.5, 70.0, 5.0]"))
    assert (work / "home.toml").read_text() != plan
    for name, moved in (("same", robot), ("crashed", work / "crashed.toml")):
        run(0, "simulate", "--robot", moved, "--plan", work / "home.toml", "--write",
            work / f"{name}.pcap", "--tool-mm", "150,40,190", "--seed", "7", "--quiet")
        run(0, "replay", work / f"{name}.pcap", "--robot", robot, "--output", work / name, "--quiet")
    comparisons = jsonschema.Draft202012Validator(
        json.loads((source / "docs/compare.schema.json").read_text(encoding="utf-8")))
    for code, first, second in ((0, "complete", "same"), (0, "complete", "unspecified"),
                                (3, "complete", "crashed"), (0, "scara", "scara"), (1, "complete", "device"),
                                (1, "complete", "partial"), (1, "failed", "complete"),
                                (1, "axes", "device"), (1, "complete", "scara")):
        done = subprocess.run([sweepd, "compare", work / first, work / second / "result.json", "--json"],
                              capture_output=True, text=True)
        if done.returncode != code:
            sys.exit(f"compare {first} {second}: exit {done.returncode}, expected {code}\n"
                     f"{done.stdout}{done.stderr}")
        if code == 1:
            continue
        compared = json.loads(done.stdout)
        comparisons.validate(compared)
        changed = [number["name"] for number in compared["numbers"] if number["changed"]]
        assert changed == (["zero4_deg"] if code == 3 else []), changed

    # The schema would see what is missing, unknown or of another kind.
    for change in (lambda r: r.pop("dh"), lambda r: r.update(unheard_of=1),
                   lambda r: r["dh"][0].update(a_mm="180"),
                   lambda r: r["joints"][0]["circle"].pop("normal")):
        broken = copy.deepcopy(complete)
        change(broken)
        assert not validator.is_valid(broken), "the schema lets pass what is wrong"
