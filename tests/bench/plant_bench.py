#!/usr/bin/env python3
"""Many robots' publishers against one mosquitto, one `sweepd collect` and one PostgreSQL: an hour of
plant time, compressed. A state of each robot every 10 s, a campaign of each robot in the hour.

    plant_bench.py BUILD_FOLDER [--robots N] [--minutes N] [--per-second N]
"""
import argparse
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "tests/scenarios"))
from plant_servers import Broker, Database, missing, until


def cpu_s(process):
    """Of it and its children that have ended."""
    fields = pathlib.Path(f"/proc/{process.pid}/stat").read_text().rsplit(")", 1)[1].split()
    return sum(map(int, fields[11:15])) / os.sysconf("SC_CLK_TCK")


def cpu_of_database(database):
    """Of all its processes; of those that have ended, the first one knows."""
    pids = subprocess.run(["pgrep", "-P", str(database.process.pid)], capture_output=True, text=True)
    total = cpu_s(database.process)
    for pid in pids.stdout.split():
        try:
            fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
            total += sum(map(int, fields[11:13])) / os.sysconf("SC_CLK_TCK")
        except FileNotFoundError:
            pass
    return total


def rss_mb(process):
    return next(int(line.split()[1]) / 1024 for line in
                pathlib.Path(f"/proc/{process.pid}/status").read_text().splitlines() if "VmHWM" in line)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--robots", type=int, default=1000)
    parser.add_argument("--minutes", type=int, default=60)
    parser.add_argument("--per-second", type=int, default=20000)
    options = parser.parse_args()
    if missing():
        sys.exit(f"plant_bench: {missing()} is not here: scripts/setup --plant")
    resource.setrlimit(resource.RLIMIT_NOFILE, (resource.getrlimit(resource.RLIMIT_NOFILE)[1],) * 2)
    build = options.build.resolve()
    sweepd = build / "daemon/sweepd"
    with tempfile.TemporaryDirectory(prefix="sweepd-bench-") as name:
        folder = pathlib.Path(name)
        os.chmod(folder, 0o755)
        robot, plan = ROOT / "config/robots/kr5_arc.toml", ROOT / "config/plans/kr5_arc_30deg.toml"
        for command in (["simulate", "--write", "trace.pcap"], ["replay", "trace.pcap", "--output", "r"]):
            subprocess.run([sweepd, *command, "--robot", robot, "--plan", plan, "--quiet"], cwd=folder, check=True)
        broker, database = Broker(folder), Database(folder)
        (folder / "collect.toml").write_text(
            f'[collect]\nbroker = "mqtt://127.0.0.1:{broker.port}"\ndatabase = "{database.connection}"\n'
            'spool = "collect-spool"\n')
        with open(folder / "collect.log", "wb") as log:
            collector = subprocess.Popen([sweepd, "collect", "--config", folder / "collect.toml"],
                                         stdout=log, stderr=log)
        until(lambda: "connected" in (folder / "collect.log").read_text(), "the collector is connected")
        before = cpu_of_database(database)
        start = time.monotonic()
        subprocess.run([build / "tests/bench/bench_plant", "--broker", f"mqtt://127.0.0.1:{broker.port}",
                        "--result", folder / "r/result.json", "--folder", folder, "--robots",
                        str(options.robots), "--minutes", str(options.minutes), "--per-second",
                        str(options.per_second)], check=True, stderr=subprocess.DEVNULL)
        end = time.monotonic()
        ask = database.ask
        until(lambda: int(ask("select count(*) from campaigns") or 0) == options.robots, "all stored", 600)
        print(f"all results in the database {time.monotonic() - end:.1f} s later")
        print(f"a result has {(folder / 'r/result.json').stat().st_size / 1000:.0f} kB, in the database "
              f"{int(ask('''select pg_total_relation_size('campaigns')''')) / options.robots / 1000:.0f} kB, "
              f"its numbers {int(ask('''select pg_total_relation_size('numbers')''')) / options.robots / 1000:.1f} kB")
        print(f"each once: {ask('select count(*) = count(distinct (robot, session, sha256)) from campaigns')}, "
              f"refused: {ask('select count(*) from refused')}")
        for what, process in (("mosquitto", broker.process), ("sweepd collect", collector)):
            print(f"{what}: {cpu_s(process):.1f} s of processor time, {rss_mb(process):.0f} MB at most")
        print(f"PostgreSQL: {cpu_of_database(database) - before:.1f} s of processor time")
        print(f"all of it took {end - start:.1f} s, an hour of plant time is {options.minutes / 60 * 3600 / (end - start):.0f} times as long")
        collector.terminate()
        collector.wait(20)
        print(f"robots with links of the day: {ask('select count(*) from link_days')}, received telegrams "
              f"{ask('select sum(received) from link_days')}")
        broker.stop()
        database.stop()


main()
