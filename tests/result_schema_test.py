#!/usr/bin/env python3
"""result.json of all that a run can be is what docs/result.schema.json says.

    result_schema_test.py SWEEPD SOURCE_FOLDER
"""
import copy
import csv
import json
import pathlib
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

    # The schema would see what is missing, unknown or of another kind.
    for change in (lambda r: r.pop("dh"), lambda r: r.update(unheard_of=1),
                   lambda r: r["dh"][0].update(a_mm="180"),
                   lambda r: r["joints"][0]["circle"].pop("normal")):
        broken = copy.deepcopy(complete)
        change(broken)
        assert not validator.is_valid(broken), "the schema lets pass what is wrong"
