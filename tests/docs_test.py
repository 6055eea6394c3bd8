#!/usr/bin/env python3
"""What the documents say is so: commands run, options exist, links lead somewhere, settings, fields,
metrics and codes are those of the program.

    docs_test.py SWEEPD SOURCE_FOLDER

First the checks have to find what is planted in folders of their own, then nothing in the documents.
"""
import csv
import json
import math
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib

MOST_LINES_OF_README = 150
COMMAND = r"(?:build/release/daemon/)?sweepd"
EXAMPLE = "python3 docs/examples"
KEYS = (("docs/live-page.md", "`/api/state`", "daemon/page/state_json.cpp"),
        ("docs/live-page.md", "Events", "daemon/page/live_json.cpp"),
        ("docs/results.md", "run.json", "daemon/results/run_json.cpp"),
        ("docs/link.md", "link.txt and link.json", "daemon/results/link_json.cpp"))
SOURCES = r"(?:rsi|identify|daemon|tests|config|scripts|docs)/[\w./-]+"


def documents(root):
    names = [*root.glob("*.md"), *root.glob("docs/**/*.md"), *root.glob("config/**/*.md")]
    return sorted(names)


def split(text):
    """The lines of code blocks, as (language, logical line), and the text without the blocks."""
    code, prose, language = [], [], None
    for line in text.splitlines():
        fence = re.match(r"\s*```(\w*)\s*$", line)
        if fence:
            language = fence[1] if language is None else None
        elif language is None:
            prose.append(line)
        elif code and code[-1][1].endswith("\\"):
            code[-1] = (language, code[-1][1][:-1].rstrip() + " " + line.strip())
        else:
            code.append((language, line.strip()))
    return code, "\n".join(prose)


# Links

def anchors(path):
    """Of a document's headings, as the sites that show Markdown make them."""
    seen, found = {}, set()
    for line in split(path.read_text(encoding="utf-8"))[1].splitlines():
        heading = re.match(r"#+ +(.*)", line)
        if heading:
            text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading[1]).lower()
            slug = re.sub(r"[^\w\- ]", "", text).replace(" ", "-")
            seen[slug] = seen.get(slug, -1) + 1
            found.add(slug + (f"-{seen[slug]}" if seen[slug] else ""))
    return found


def wrong_links(path, text):
    prose = re.sub(r"`[^`]*`", "``", split(text)[1])
    for target in re.findall(r"\]\(([^)\s]+)\)", prose):
        if re.match(r"[a-z]+:", target):
            continue
        name, _, anchor = target.partition("#")
        to = (path.parent / name) if name else path
        if not to.exists():
            yield f"there is no {name}"
        elif anchor and (to.suffix != ".md" or anchor not in anchors(to)):
            yield f"{name or 'this document'} has no heading #{anchor}"


def wrong_paths(root, text):
    """Files of the source tree that are named in backticks."""
    for name in re.findall(rf"`({SOURCES})`", text):
        if "NAME" not in name and not (root / name).exists():
            yield f"there is no {name}"


def rooms_of(root):
    """Of the three folders, from the ground up."""
    return [f"{layer}/{room}" for layer in ("rsi", "identify", "daemon")
            for room in re.findall(r"^add_subdirectory\((\w+)\)",
                                   (root / layer / "CMakeLists.txt").read_text(), re.M)]


def wrong_rooms(text, picture, rooms):
    told = re.findall(r"^\| `((?:rsi|identify|daemon)/\w+)` \|", text, re.M)
    if told != rooms:
        yield f"the rooms are {', '.join(rooms)}, not {', '.join(told)}"
    drawn = re.findall(r">(\w+)/</text>", picture)
    drawn = [name for name in drawn if name not in ("rsi", "identify", "daemon")]
    if drawn != [room.split("/")[1] for room in rooms]:
        yield f"the picture has the rooms {', '.join(drawn)}"


NAMES = r"`((?:\w+::)*\w+\(\)|k[A-Z]\w+|(?:rsi|identify|sweepd)::\w+)`"


def is_in(name, source):
    return re.search(rf"\b{name.removesuffix('()').split('::')[-1]}\b", source)


def wrong_names(text, source):
    """Functions, constants and types of the sources that are named in backticks."""
    for name in re.findall(NAMES, text):
        if not is_in(name, source):
            yield f"nothing in the sources is called {name}"


def wrong_rows(root, text):
    """Rows that say what to change, in which files, and by which name it is found in them."""
    for row in (line.split("|") for line in text.splitlines() if line.count("|") == 5):
        paths = [root / path for path in re.findall(rf"`({SOURCES})`", row[2])]
        files = [file for path in paths for file in ([path] if path.is_file() else path.glob("*.?pp"))]
        source = "".join(file.read_text(encoding="utf-8") for file in files)
        for name in re.findall(NAMES, row[3]):
            if not is_in(name, source):
                yield f"{name} is not where{row[1]}is said to be"


# Commands

def commands_in(text):
    """(line, whether it can be run): those of code blocks, and those in backticks."""
    code, prose = split(text)
    for language, line in code:
        line = re.sub(r"^sudo (-u \w+ )?", "", line)
        if language in ("", "sh") and re.match(rf"({COMMAND}|{EXAMPLE})\b", line):
            yield line, True
    for line in re.findall(rf"`(?:sudo (?:-u \w+ )?)?({COMMAND} [^`]+)`", prose):
        yield line, False


class Program:
    def __init__(self, sweepd):
        self.sweepd = sweepd
        self.options = {}
        listed = self.help().split("Commands:")[1]
        for name in re.findall(r"^  ([a-z][a-z-]*) ", listed, re.M):
            self.options[name] = set(re.findall(r"--[a-z][a-z-]*", self.help(name)))

    def run(self, *arguments):
        return subprocess.run([self.sweepd, *arguments], capture_output=True, text=True,
                              check=True).stdout

    def help(self, *command):
        return self.run(*command, "--help")

    def wrong_options(self, line):
        """`line` begins with sweepd."""
        line = re.split(r"[|;]", line.split(" #")[0])[0]
        words = line.split()[1:]
        if not words or words[0].startswith("-") or not words[0].islower():
            return
        if words[0] not in self.options:
            yield f"sweepd has no command {words[0]}: {line}"
            return
        for option in re.findall(r"(?<=\s)\[?(--[a-z][a-z-]*)", line):
            if option not in self.options[words[0]] | {"--help"}:
                yield f"sweepd {words[0]} has no {option}: {line}"


def fixtures(root, sweepd, folder):
    """What the commands of the documents need."""
    def run(*arguments):
        subprocess.run([sweepd, *map(str, arguments), "--quiet"], cwd=folder, check=True)

    shutil.copytree(root / "config", folder / "config")
    shutil.copytree(root / "docs", folder / "docs")
    shutil.copytree(root / "config", folder / "etc/sweepd")
    robot, plan = "config/robots/kr5_arc.toml", "config/plans/kr5_arc_90deg.toml"
    run("simulate", "--robot", robot, "--plan", plan, "--write", "trace.pcap")
    run("replay", "trace.pcap", "--robot", robot, "--plan", plan, "--output", "result")
    for name in ("90", "30"):
        shutil.copytree(folder / "result", folder / "out" / name)
    for name, theta4 in (("before", 0), ("after", 0.02)):
        shutil.copytree(folder / "result", folder / name)
        result = json.loads((folder / name / "result.json").read_text())
        result["dh"][3]["theta_deg"] += theta4
        (folder / name / "result.json").write_text(json.dumps(result))
    session = folder / "out/run/kr5-arc/20260101T000000Z"
    session.mkdir(parents=True)
    shutil.copy(folder / "trace.pcap", session)
    with (folder / "result/sweeps.csv").open(newline="") as file:
        points = [[row[name] for name in ("joint", "x_mm", "y_mm", "z_mm")]
                  for row in csv.DictReader(file)]
    write(folder / "points.csv", [["joint", "x_mm", "y_mm", "z_mm"], *points])
    write(folder / "bare.csv", [[*row, 0] for row in points])
    with (folder / "result/sweeps.csv").open(newline="") as file:
        names = ["x_mm", "y_mm", "z_mm", *(f"a{j}_deg" for j in range(1, 7))]
        poses = [[row[name] for name in names] for row in csv.DictReader(file)]
    write(folder / "poses.csv", [names, *poses[::40]])
    write(folder / "held-out.csv", [names, *poses[20::40]])
    noise = random.Random(1)
    with (folder / "result/samples.csv").open(newline="") as file:
        take = [[f"{float(row['t_s']) + 0.25:.3f}",
                 *(f"{float(row[f'{axis}_mm']) + noise.gauss(0, 0.02):.4f}" for axis in "xyz")]
                for row in csv.DictReader(file)]
    write(folder / "take.csv", [["t_s", "x_mm", "y_mm", "z_mm"], *take])
    write(folder / "arm.csv", [names, *poses_of_a_built_arm(root / robot)])
    result = json.loads((folder / "result/result.json").read_text())
    write(folder / "axes.csv", [["joint", "x_mm", "y_mm", "z_mm", "dx", "dy", "dz"],
                                *([joint["joint"], *joint["axis"]["point"],
                                   *joint["axis"]["direction"]] for joint in result["joints"])])
    (folder / "build/release/daemon").mkdir(parents=True)
    (folder / "bin").mkdir()
    for name in ("bin/sweepd", "build/release/daemon/sweepd"):
        (folder / name).symlink_to(sweepd)


def poses_of_a_built_arm(description):
    """80 static poses as a tracker of 0.02 mm sees them; of the arm, lengths are off by 0.5 mm and
    angles by 0.05 degrees."""
    chance = random.Random(4)
    robot = tomllib.loads(description.read_text(encoding="utf-8"))
    built = [{**row, **{key: row[key] + chance.gauss(0, 0.5 if key.endswith("_mm") else 0.05)
                        for key in ("b_mm", "theta_deg", "a_mm", "alpha_deg")}}
             for row in robot["joint"]]
    for _ in range(80):
        angles = [round(home + chance.uniform(-70, 70), 4) for home in robot["home_deg"]]
        point = robot["tool_mm"]
        for row, home, angle in reversed(list(zip(built, robot["home_deg"], angles))):
            ct, st, ca, sa = (f(math.radians(a)) for a in (
                row["theta_deg"] + row["positive"] * (angle - home), row["alpha_deg"])
                for f in (math.cos, math.sin))
            x, y, z = point[0] + row["a_mm"], ca * point[1] - sa * point[2], sa * point[1] + ca * point[2]
            point = [ct * x - st * y, st * x + ct * y, z + row["b_mm"]]
        device = [-point[1] + 2500, point[0] + 300, point[2] - 900]  # where the tracker stands
        yield [*(round(value + chance.gauss(0, 0.02), 5) for value in device), *angles]


def write(path, rows):
    with path.open("w", newline="") as file:
        csv.writer(file).writerows(rows)


def is_live(line):
    words = line.split()
    return words[1] in ("run", "listen", "publish", "collect", "watch") or (words[1] == "simulate" and "--to" in words)


def failures(lines, folder):
    """Runs lines one after the other in `folder`; a line may end with `# exit code N`."""
    environment = {**os.environ, "PATH": f"{folder}/bin:{os.environ['PATH']}", "LC_ALL": "C.UTF-8",
                   "PYTHONDONTWRITEBYTECODE": "1"}
    for line in lines:
        if line.startswith(EXAMPLE):
            program = folder / line.split()[1]
            if not program.exists():
                yield f"there is no {line.split()[1]}"
                continue
            compile(program.read_text(encoding="utf-8"), str(program), "exec")
            if "import matplotlib" in program.read_text() and not has_matplotlib():
                print(f"not run, as matplotlib is not here: {line}")
                continue
        elif is_live(line):
            continue
        expected = int((re.search(r"# exit code (\d+)", line) or [0, 0])[1])
        command = re.sub(r"(?<![\w.])/etc/sweepd", f"{folder}/etc/sweepd", line)
        command = command.replace("/var/lib/sweepd", f"{folder}/var")
        if re.match(rf"{COMMAND} check\b", command):
            command = re.sub(r"( check\b)", r"\1 --files-only", command, count=1)
        done = subprocess.run(["bash", "-c", command], cwd=folder, env=environment,
                              capture_output=True, text=True, timeout=120)
        if done.returncode != expected:
            yield f"exit code {done.returncode} instead of {expected}: {line}\n{done.stderr.strip()}"


def has_matplotlib():
    return subprocess.run(["python3", "-c", "import matplotlib"], capture_output=True).returncode == 0


# Settings

def settings_of_help(text):
    """{(table, key): default}; "required", or empty where there is neither."""
    found, table = {}, None
    for line in re.sub(r"\n {20,}", "\t", text).splitlines():
        if heading := re.match(r"(\[.*\]):$", line):
            table = heading[1]
        elif table and (key := re.match(r"  (\w+) = ", line)):
            words = line.replace("\t", " ")
            default = re.search(r"(?<= Default: ).*", words)
            found[table, key[1]] = default[0] if default else "required" if words.endswith(" Required.") else ""
    return found


def settings_of_document(text):
    """The same from tables below headings such as ### `[http]`."""
    found, table = {}, None
    for line in text.splitlines():
        if line.startswith("#"):
            heading = re.match(r"#+ `(\[+[\w.]+\]+)`$", line)
            table = heading[1] if heading else None
        elif table and (row := re.match(r"\| `(\w+)` \|", line)):
            default = line.split("|")[3].strip().strip("`")
            found[table, row[1]] = "" if default in ("none", "any") else default
    return found


def wrong_settings(document, settings):
    told, real = settings_of_document(document), settings_of_help(settings)
    if not real:
        yield "no settings found in the help"
    for table, key in sorted(told.keys() - real.keys()):
        yield f"{table} has no key {key}"
    for table, key in sorted(real.keys() - told.keys()):
        yield f"the key {key} of {table} is missing"
    for place in sorted(told.keys() & real.keys()):
        if told[place] != real[place]:
            yield f"the default of {place[1]} in {place[0]} is {real[place]}, not {told[place]}"


# Names

def property_names(schema):
    if isinstance(schema, dict):
        if isinstance(schema.get("properties"), dict):
            yield from schema["properties"]
        for value in schema.values():
            yield from property_names(value)
    elif isinstance(schema, list):
        for value in schema:
            yield from property_names(value)


def missing_names(text, names, what):
    words = set(re.findall(r"\w+", text))
    for name in sorted(set(names) - words):
        yield f"{name}, {what}, is not described"


def untold_keys(text, heading, source):
    """Keys that a source of JSON writes, and words that are values there: all stand in backticks in
    the tables below a heading."""
    section = (text.split(f"\n## {heading}\n") + [""])[1].split("\n## ")[0]
    told = re.findall(r"`(\w+)`", "".join(re.findall(r"^\|.*\n", section, re.M)))
    for key in sorted(set(re.findall(r'"([a-z]\w*)"', source)) - set(told)):
        yield f"the key {key} is not in the tables below {heading}"


def wrong_metrics(text, source):
    for name in sorted(set(re.findall(r"`(sweepd_[a-z_]+)`", text))):
        if f'"{name}"' not in source:
            yield f"there is no metric {name}"


def wrong_codes(text, source):
    """Warnings and doubts: all of the engine, and no others."""
    told = set()
    for line in text.splitlines():
        if row := re.match(r"\| (`[a-z_]+`(?:, `[a-z_]+`)*) \|", line):
            told.update(re.findall(r"`([a-z_]+)`", row[1]))
    real = set(re.findall(r'(?:\b(?:warn|doubt)\(|Warning\{|(?:warnings|doubts|advice)\.push_back\(\s*\{)\s*"([a-z]+(?:_[a-z]+)*)"', source))
    for code in sorted(real - told):
        yield f"the code {code} is not described"
    for code in sorted(told):
        if f'"{code}"' not in source:
            yield f"there is no code {code}"


def wrong_benches(text, script):
    known = {"all", *" ".join(re.findall(r"^(?:usual|named)=\(([a-z_ ]+)\)", script, re.M)).split()}
    for name in re.findall(r"scripts/bench ([a-z_]+)", text):
        if name not in known:
            yield f"scripts/bench has no {name}"


def too_long(text):
    lines = len(text.splitlines())
    if lines > MOST_LINES_OF_README:
        yield f"it has {lines} lines, more than {MOST_LINES_OF_README}"


# All of it

def problems(root, program):
    def read(name):
        return (root / name).read_text(encoding="utf-8")

    def told(path, found):
        name = path if isinstance(path, str) else path.relative_to(root)
        return (f"{name}: {problem}" for problem in found)

    for page, heading, file in KEYS:
        yield from told(page, untold_keys(read(page), heading, read(file)))
    bench = read("scripts/bench")
    yield from told("README.md", too_long(read("README.md")))
    yield from told("docs/install.md", wrong_settings(
        read("docs/install.md"), program.run("run", "--help-settings")))
    for page in ("docs/install.md", "docs/monitoring.md"):
        yield from told(page, wrong_metrics(read(page), read("daemon/page/metrics.cpp")))
    sources = "".join(path.read_text() for layer in ("rsi", "identify", "daemon")
                      for path in sorted((root / layer).rglob("*.?pp")))
    yield from told("docs/architecture.md", wrong_names(read("docs/architecture.md"), sources))
    yield from told("docs/architecture.md", wrong_rows(root, read("docs/architecture.md")))
    yield from told("docs/architecture.md", wrong_rooms(
        read("docs/architecture.md"), read("docs/architecture.svg"), rooms_of(root)))
    engine = "".join(path.read_text() for folder in ("identify", "daemon/plan", "daemon/points", "daemon/results")
                     for path in sorted((root / folder).rglob("*.cpp")))
    yield from told("docs/troubleshooting.md", wrong_codes(read("docs/troubleshooting.md"), engine))
    scripts = "".join(path.read_text() for path in sorted((root / "scripts").iterdir()))
    any_option = set().union(*program.options.values()) | set(re.findall(r"--[a-z][a-z-]*", scripts))
    with tempfile.TemporaryDirectory() as name:
        base = pathlib.Path(name) / "base"
        base.mkdir()
        fixtures(root, program.sweepd, base)
        ran = 0
        for number, path in enumerate(documents(root)):
            text = path.read_text(encoding="utf-8")
            yield from told(path, wrong_links(path, text))
            yield from told(path, wrong_paths(root, text))
            yield from told(path, wrong_benches(text, bench))
            found = list(commands_in(text))
            for line, _ in found:
                if not line.startswith(EXAMPLE):
                    yield from told(path, program.wrong_options(line))
            for option in re.findall(r"`(--[a-z][a-z-]*)", text):
                if option not in any_option:
                    yield f"{path.relative_to(root)}: nothing has an option {option}"
            lines = [line for line, can_run in found if can_run]
            if lines:
                folder = pathlib.Path(name) / str(number)
                shutil.copytree(base, folder, symlinks=True)
                yield from told(path, failures(lines, folder))
                ran += len(lines)
        if ran < 10:
            yield f"only {ran} commands found in the documents"
        results = read("docs/results.md")
        names = set(property_names(json.loads(read("docs/result.schema.json"))))
        yield from told("docs/results.md", missing_names(results, names, "of result.json"))
        names = set(property_names(json.loads(read("docs/correction.schema.json"))))
        yield from told("docs/correct.md", missing_names(read("docs/correct.md"), names, "of correction.json"))
        names = set(property_names(json.loads(read("docs/compare.schema.json"))))
        yield from told("docs/compare.md", missing_names(read("docs/compare.md"), names, "of compare --json"))
        for file in ("dh.csv", "models.csv", "sweeps.csv", "samples.csv"):
            with (base / "result" / file).open(newline="") as rows:
                columns = [column for column in next(csv.reader(rows))
                           if not re.fullmatch(r"a[3-9]_deg", column)]
            yield from told("docs/results.md", missing_names(results, columns, f"of {file}"))


def planted(program):
    """What the checks do not see as they should."""
    gap = "\n" + 26 * " "
    settings = f'a = x\n\n[http]:\n  listen = x{gap}A. Default:{gap}"off"\n  hosts = x{gap}A. Required.\n'
    table = "### `[http]`\n| `listen` | a | `\"off\"` |\n| `hosts` | a | required |\n"
    bench = "usual=(link)\nnamed=(box) # and more\n"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        here = folder / "README.md"
        here.write_text("# Some where\n\n## Some where\n\n```sh\n# no heading\n```\n")
        (folder / "rsi").mkdir()
        (folder / "rsi/here.hpp").write_text("constexpr int kHere = 1;\n")
        (folder / "bin").mkdir()
        (folder / "bin/sweepd").symlink_to(program.sweepd)
        cases = [
            (0, wrong_links(here, "[a](README.md) [b](#some-where-1) [c](README.md#some-where) [d](https://x)")),
            (0, wrong_links(here, "`[a](missing.md)`\n```\n[a](missing.md)\n```")),
            (1, wrong_links(here, "[a](missing.md)")),
            (1, wrong_links(here, "![a](docs/missing.svg)")),
            (1, wrong_links(here, "[a](#no-heading)")),
            (1, wrong_links(here, "[a](README.md#some-where-2)")),
            (1, wrong_paths(folder, "`rsi/missing.hpp` rsi/other.hpp")),
            (0, wrong_paths(folder, "`rsi/NAME_test.cpp` `other/missing`")),
            (0, wrong_rooms("| `rsi/low` | x |\n| `rsi/high` | x |", ">low/</text>>high/</text>",
                            ["rsi/low", "rsi/high"])),
            (2, wrong_rooms("| `rsi/high` | x |\n| `rsi/low` | x |", ">low/</text>",
                            ["rsi/low", "rsi/high"])),
            (2, wrong_names("`kGone` `kHere` `Some::gone()` `here()` `rsi::Here`", "kHere here Here")),
            (1, wrong_rows(folder, "| x | `rsi/here.hpp` | `kHere`, `gone()` | `rsi/here_test.cpp` |")),
            (1, wrong_settings(table.replace("hosts", "host") + "| `hosts` | a | required |\n", settings)),
            (1, wrong_settings(table.replace("| `hosts` | a | required |\n", ""), settings)),
            (1, wrong_settings(table.replace("off", "on"), settings)),
            (0, wrong_settings(table, settings)),
            (1, missing_names("a_mm_x `b`", ["a_mm", "b"], "x")),
            (0, untold_keys("\n## X\n\n| `a` | `b` |\n", "X", '{{"a", "A b"}}; json["b"]')),
            (4, untold_keys("\n## X\n`a`\n| b | `c d` |\n## Y\n| `e` |\n", "X", '{"a", "b"}; "d" "e"')),
            (1, wrong_metrics("`sweepd_a` `sweepd_b`", '{"sweepd_a", 1}')),
            (1, wrong_codes("| `one_a` | x |", 'warn("one_a", 1); doubt("two", 2)')),
            (1, wrong_codes("| `one_a`, `gone_b` | x |", 'warn("one_a", 1)')),
            (1, wrong_benches("scripts/bench link a; scripts/bench lnk", bench)),
            (1, too_long("a\n" * (MOST_LINES_OF_README + 1))),
            (0, too_long("a\n" * MOST_LINES_OF_README)),
            (1, program.wrong_options("sweepd plan --robot a --propos")),
            (1, program.wrong_options("sweepd inspect a [--csv FILE]")),
            (1, program.wrong_options("build/release/daemon/sweepd fly")),
            (0, program.wrong_options("sweepd replay a --robot b | grep --count c")),
            (0, program.wrong_options("sweepd --version")),
            (1, failures(["sweepd inspect missing.pcap"], folder)),
            (1, failures(["sweepd --version  # exit code 3"], folder)),
            (0, failures(["sweepd inspect missing.pcap  # exit code 1", "sweepd --version",
                          "sweepd run --config missing.toml"], folder)),
            (1, failures([f"{EXAMPLE}/missing.py a"], folder)),
            (3, commands_in("```sh\nsudo -u x sweepd check\nls\nsweepd plan \\\n  --propose\n"
                            "```\n```text\nsweepd run\n```\n`sweepd inspect a` `sweepd.toml`")),
        ]
        for number, (wanted, found) in enumerate(cases):
            seen = list(found)
            if len(seen) != wanted:
                yield f"planted case {number}: {seen} found instead of {wanted}"


sweepd, source = sys.argv[1:]
real = Program(str(pathlib.Path(sweepd).resolve()))
wrong = list(planted(real))
wrong += problems(pathlib.Path(source).resolve(), real)
print("\n".join(wrong))
sys.exit(bool(wrong))
