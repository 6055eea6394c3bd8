#!/usr/bin/env python3
"""Who may know whom: rsi and identify each other not at all, a room only those below it.

    rooms_test.py SOURCE_FOLDER

The order of the rooms is that of add_subdirectory in rsi/, identify/ and daemon/CMakeLists.txt, from
the ground up. What lies in rsi/ itself is below its rooms; in identify/ and daemon/, above them.
What daemon/ builds in_one_thread has no means for more: ThreadSanitizer does not see it.
The libraries never print, log or abort. Tests know Catch2 by one header. First the check has to find
what is planted in a folder of its own, then nothing in the tree.
"""
import pathlib
import re
import sys
import tempfile

STANDARD = r"<[a-z_0-9]+>"
POSIX = r"<([a-z_0-9]+|(sys|net|netinet|arpa|linux)/[a-z_0-9]+)\.h>"
TALKING = r"<(iostream|ostream|print|syncstream|cassert|assert\.h|syslog\.h)>"
BUSY = (r"<(thread|mutex|shared_mutex|condition_variable|future|stop_token|semaphore|latch|barrier"
        r"|atomic|fstream|filesystem|cstdio)>")
THREADS = re.compile(r"std::(j?thread|\w*mutex|condition_variable|atomic|future|async|call_once)\b|asio|beast")
# Another library in here needs a decision.
LAYERS = {  # may include, may not include
    "rsi": (f"{STANDARD}|{POSIX}|<boost/|<pugixml\\.hpp>|<pcap/|\"rsi/", TALKING),
    "identify": (f"{STANDARD}|<Eigen/|\"identify/", f"{TALKING}|{BUSY}"),
    "daemon": (".", "\"tests/"),
}
ENDING = re.compile(r"std::(cout|cerr|clog)|(^|[^A-Za-z0-9_])(v?f?printf|f?puts|putchar|perror|syslog"
                    r"|assert|abort|_?exit|_Exit|quick_exit|terminate)[ \t]*\(")


def rooms(root, layer):
    """From the ground up."""
    text = (root / layer / "CMakeLists.txt").read_text()
    own = [layer]
    named = [f"{layer}/{room}" for room in re.findall(r"^add_subdirectory\((\w+)\)", text, re.M)]
    return own + named if layer == "rsi" else named + own


def in_one_thread(root):
    """The units, without their endings."""
    for path in (root / "daemon").glob("*/CMakeLists.txt"):
        text = path.read_text()
        sources = re.search(r"^set\(sources\s([^)]*)\)", text, re.M)
        for files in re.findall(r"^in_one_thread\(([^)]*)\)", text, re.M):
            files = files.replace("${sources}", sources[1] if sources else "")
            yield from (path.parent / file.removesuffix(".cpp") for file in files.split())


def violations(root):
    single = set(in_one_thread(root))
    floor = {}
    for layer in LAYERS:
        for height, room in enumerate(rooms(root, layer)):
            floor[room] = height
    included = {}
    for layer, (may, may_not) in LAYERS.items():
        for path in sorted((root / layer).rglob("*.?pp")):
            name = str(path.relative_to(root))
            room = str(path.parent.relative_to(root))
            if room not in floor:
                yield f"{name}: this room is not in {layer}/CMakeLists.txt"
                continue
            for number, line in enumerate(path.read_text().splitlines(), 1):
                code = re.sub(r"//.*", "", line)
                where = f"{name}:{number}: {line.strip()}"
                if path.with_suffix("") in single and THREADS.search(code):
                    yield f"{where}  (this unit is built in_one_thread)"
                header = re.match(r'\s*#\s*include\s*([<"].*)', code)
                if not header:
                    if layer != "daemon" and ENDING.search(code):
                        yield where
                    continue
                header = header[1]
                if not re.match(may, header) or re.match(may_not, header):
                    yield where
                other = re.match(r'"((\w+)[\w/]*)/\w+\.hpp"', header)
                if other and other[2] == layer:
                    included.setdefault(name, set()).add(header[1:].split('"')[0])
                    if floor.get(other[1], 99) > floor[room]:
                        yield f"{where}  (the room is above this one)"
    yield from circles(included)
    yield from bare_catch(root)


def bare_catch(root):
    """Tests that would not build on Debian 13, whose Catch2 has other headers."""
    for path in sorted((root / "tests").rglob("*.?pp")):
        if path != root / "tests/catch.hpp" and "<catch2/" in path.read_text():
            yield f"{path.relative_to(root)}: include \"tests/catch.hpp\" in place of Catch2's own header"


def circles(included):
    done, path = set(), []

    def visit(name):
        if name in path:
            yield "a circle: " + " includes ".join(path[path.index(name):] + [name])
        elif name not in done:
            path.append(name)
            for other in sorted(included.get(name, ())):
                yield from visit(other)
            path.pop()
            done.add(name)

    for name in sorted(included):
        yield from visit(name)


def planted():
    """What the check does not see as it should."""
    cases = [
        (1, "rsi/low/some.cpp", '#include "identify/some.hpp"'),
        (1, "rsi/low/some.cpp", '#include "rsi/high/some.hpp"'),
        (0, "rsi/high/some.cpp", '#include "rsi/low/some.hpp"'),
        (0, "rsi/low/some.cpp", '#include "rsi/some.hpp"'),
        (1, "rsi/some.hpp", '#include "rsi/low/some.hpp"'),
        (1, "identify/low/some.cpp", '#include "identify/some.hpp"'),
        (0, "identify/some.hpp", '#include "identify/low/some.hpp"'),
        (1, "identify/low/some.hpp", '#include "identify/low/some.hpp"'),
        (1, "daemon/unknown/some.cpp", ""),
        (0, "daemon/high/some.cpp", '#include "rsi/high/some.hpp"'),
        (0, "daemon/high/some.cpp", "std::cout << 1;"),
        (1, "rsi/low/some.cpp", "#include <Eigen/Core>"),
        (1, "rsi/low/some.cpp", "#include <spdlog/spdlog.h>"),
        (0, "rsi/low/some.cpp", "#include <sys/eventfd.h>"),
        (1, "daemon/low/one.cpp", "std::mutex mutex;"),
        (1, "daemon/low/one.hpp", '#include "rsi/asio.hpp"'),
        (0, "daemon/low/one.cpp", "std::this_thread::sleep_for(1s);"),
        (0, "daemon/low/some.cpp", "std::mutex mutex;"),
        (1, "tests/low/some.cpp", "#include <catch2/catch.hpp>"),
        (0, "tests/catch.hpp", "#include <catch2/catch.hpp>"),
    ]
    cases += [(1, "identify/low/some.cpp", f"  #  include {header}  // needed here") for header in
              ("<thread>", "<fstream>", "<boost/asio/buffer.hpp>", "<unistd.h>", '"daemon/some.hpp"')]
    for library in ("rsi", "identify"):
        cases += [(1, f"{library}/low/some.cpp", code) for code in
                  ("std::cout << 1;", 'printf("%d", 1);', "std::abort();", "::_exit(1);",
                   "assert(n > 0);", "#include <iostream>")]
        cases += [(0, f"{library}/low/some.cpp", code) for code in
                  ("// abort() would be wrong here", "static_assert(sizeof(int) == 4);",
                   "case operation_aborted: on_exit();", "#include <charconv>")]
    for wanted, name, line in cases:
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for layer in LAYERS:
                (root / layer).mkdir()
                (root / layer / "CMakeLists.txt").write_text(
                    "add_subdirectory(low)\nadd_subdirectory(high)\n")
            (root / "daemon/low").mkdir()
            (root / "daemon/low/CMakeLists.txt").write_text("set(sources one.cpp)\nin_one_thread(${sources})\n")
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(line + "\n")
            seen = list(violations(root))
            if len(seen) != wanted:
                yield f"the check sees {seen} instead of {wanted} in {name}: {line}"


root = pathlib.Path(sys.argv[1])
found = list(planted()) + list(violations(root))
if not list((root / "rsi").rglob("*.cpp")):
    found.append(f"{root}: no sources found")
print("\n".join(found))
sys.exit(bool(found))
