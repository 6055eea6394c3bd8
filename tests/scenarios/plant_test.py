#!/usr/bin/env python3
"""Publisher, broker, collector and database, each killed in turn: every result arrives, once, and
equal to its file to the byte.

    plant_test.py SWEEPD SOURCE_FOLDER [MINUTES]

The broker is away for MINUTES, some seconds without it.
"""
import csv
import hashlib
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent))
from plant_servers import Broker, Database, free_port, missing, until

ROBOT = "kr5-arc"
PLACE = f"north%2F1/a%2Bb%23/{ROBOT}"  # of names that mean something in topics


class Program:
    """A sweepd that goes on until it is killed."""
    all = []

    def __init__(self, sweepd, log, *arguments):
        self.command = [sweepd, *map(str, arguments)]
        self.log = log
        self.all.append(self)
        self.start()

    def start(self):
        with open(self.log, "ab") as log:
            self.process = subprocess.Popen(self.command, stdout=log, stderr=log)

    def kill(self):
        self.process.kill()
        self.process.wait()

    def kill_and_start(self):
        self.kill()
        self.start()

    def end(self):
        self.process.send_signal(signal.SIGTERM)
        return self.process.wait(20)

    def said(self, words):
        return words in self.log.read_text(errors="replace")


class Plant:
    def __init__(self, sweepd, source, folder):
        self.sweepd, self.source, self.folder = sweepd, source, folder
        self.output = folder / "output" / ROBOT
        self.output.mkdir(parents=True)
        self.broker = Broker(folder, "geheim")
        (folder / "mqtt-password").write_text("geheim\n")
        os.environ["CREDENTIALS_DIRECTORY"] = str(folder)  # as systemd says where they are
        self.database = Database(folder, "fsync=off")
        self.pages = free_port()
        self.settings = self.settings_with("spool")
        self.template = self.a_result()
        (folder / "collect.toml").write_text(
            f'[collect]\n{self.access()}password_file = "mqtt-password"\n'
            f'database = "{self.database.connection}"\nspool = "collect-spool"\n')
        self.files = {}

    def access(self):
        return f'broker = "{self.broker.address}"\nuser = "plant"\nca_file = "broker.pem"\n'

    def settings_with(self, spool):
        config = self.source / "config"
        file = self.folder / f"{spool}.toml"
        file.write_text(
            f'[http]\nlisten = "127.0.0.1:{self.pages}"\n[[robot]]\nname = "{ROBOT}"\n'
            f'description = "{config}/robots/kr5_arc.toml"\nlisten = "127.0.0.1:{free_port()}"\n'
            f'output = "output"\n[publish]\n{self.access()}site = "north/1"\n'
            f'cell = "a+b#"\nspool = "{spool}"\n')
        return file

    def a_result(self):
        config = self.source / "config"
        robot, plan = config / "robots/kr5_arc.toml", config / "plans/kr5_arc_30deg.toml"
        for command in (["simulate", "--write", "trace.pcap"], ["replay", "trace.pcap", "--output", "r"]):
            subprocess.run([self.sweepd, *command, "--robot", robot, "--plan", plan, "--quiet"],
                           cwd=self.folder, check=True)
        return (self.folder / "r/result.json").read_text()

    def campaign_ends(self, number):
        """In the order in which the daemon writes: run.json has "ended" last."""
        session = self.output / f"2026010{number}T120000Z"
        session.mkdir()
        (session / "run.json").write_text('{"schema": "sweepd.run/1", "command": "run"}')
        (session / "result.json").write_text('{"schema": "sweepd.result/1", "status": "partial"}')
        time.sleep(0.3)  # the interim result must not be taken
        result = json.loads(self.template)
        result["dh"][3]["theta_deg"] += 0.0001 * number
        content = json.dumps(result, indent=number).encode() + b"\n"
        (session / "new").write_bytes(content)
        (session / "new").rename(session / "result.json")
        (session / "new").write_text('{"schema": "sweepd.run/1", "command": "run", "started": '
                                     f'"2026-01-0{number}T12:00:00Z", "ended": "2026-01-0{number}T12:09:00Z"}}')
        (session / "new").rename(session / "run.json")
        self.files[session.name] = content

    def stored(self):
        rows = self.database.ask("select session, sha256, encode(result, 'hex') from campaigns order by id",
                                 check=False)
        return [tuple(row.split("|")) for row in rows.splitlines()]

    def arrive(self, seconds=60):
        until(lambda: len(self.stored()) >= len(self.files), "all results arrive", seconds)
        rows = self.stored()
        assert sorted(row[0] for row in rows) == sorted(self.files), "each once"
        for session, sha256, content in rows:
            assert bytes.fromhex(content) == self.files[session], f"{session} is another than its file"
            assert sha256 == hashlib.sha256(self.files[session]).hexdigest()


def scenario(plant, outage, long):
    log = plant.folder / "publish.log"
    daemon = Program(plant.sweepd, plant.folder / "run.log", "run", "--config", plant.settings)
    until(lambda: daemon.said("pages on"), "sweepd run has pages")
    collector = Program(plant.sweepd, plant.folder / "collect.log", "collect", "--config",
                        plant.folder / "collect.toml")
    until(lambda: collector.said("connected to the broker"), "the collector is connected")
    publisher = Program(plant.sweepd, log, "publish", "--config", plant.settings)
    until(lambda: publisher.said("connected to the broker"), "the publisher is connected")
    half = plant.output / "20250101T000000Z"
    half.mkdir()
    (half / "result.json").write_text(plant.template)

    plant.broker.stop()
    for number in (1, 2, 3):
        time.sleep(outage / 3)
        plant.campaign_ends(number)
        publisher.kill_and_start()
        collector.kill_and_start()
        if long or number == 2:
            plant.database.stop()
            plant.database.start()
    plant.broker.start()
    plant.arrive()
    assert publisher.said("half deleted or half copied"), "words for the half folder"
    print("the broker was away, publisher, collector and database ended in between: 3 of 3, each once")

    plant.database.stop()
    plant.campaign_ends(4)
    until(lambda: publisher.said("the result of 20260104T120000Z is published"), "the broker has it")
    until(lambda: collector.said("the broker keeps what comes until then"), "the collector waits")
    collector.kill_and_start()  # with a message in its hand that is not acknowledged
    plant.database.start()
    plant.arrive()
    print("the collector was killed while the database was away: it has the result, once")

    published = log.read_text().count("is published")
    publisher.kill_and_start()
    until(lambda: log.read_text().count("connected to the broker") >= 2, "connected again")
    time.sleep(0.5)
    assert log.read_text().count("is published") == published, "what arrived is published again"
    publisher.end()
    again = Program(plant.sweepd, plant.folder / "again.log", "publish", "--again", "--config", plant.settings)
    until(lambda: again.log.exists() and again.log.read_text().count("is published") == 4, "all again")
    time.sleep(0.5)
    plant.arrive()
    assert plant.database.ask("select count(*) from refused") == "0"
    assert plant.database.ask("select count(*) from changes") == "3"
    assert int(plant.database.ask("select count(*) from numbers")) == 4 * numbers_of(plant.template)
    assert plant.database.ask("select array_length(covariance, 1) = array_length(covariance_names, 1) "
                              "from campaigns limit 1") == "t"
    print("all were published again: nothing is counted twice")

    code = subprocess.run([plant.sweepd, "compare", f"{PLACE}/20260101T120000Z", PLACE, "--database",
                           plant.database.connection], capture_output=True, text=True)
    assert code.returncode in (0, 3) and "20260104T120000Z" in code.stdout, code
    code = subprocess.run([plant.sweepd, "history", PLACE, "--database", plant.database.connection, "--csv",
                           plant.folder / "history.csv"], capture_output=True, text=True)
    assert code.returncode in (0, 3), code
    told = list(csv.DictReader((plant.folder / "history.csv").open()))
    assert [line["campaign"] for line in told] == [f"2026010{day}T120000Z" for day in range(1, 5)], told

    third = subprocess.run([plant.sweepd, "publish", "--config", plant.settings], capture_output=True,
                           text=True, timeout=20)
    assert third.returncode == 1 and "another `sweepd publish` uses it" in third.stderr, third
    programs = [again, collector, daemon]
    if long:
        programs.append(Program(plant.sweepd, plant.folder / "second.log", "publish", "--config",
                                plant.settings_with("other-spool")))
        until(lambda: any(program.said("two publishers for one robot") for program in programs),
              "words for two publishers", 120)
    print("two for one spool, two for one robot: told" if long else "two for one spool: told")
    until(lambda: plant.database.ask("select count(*) from link_days") == "1", "links of the day", 60)
    for program in programs:
        assert program.end() == 0, program.log.read_text()


def numbers_of(text):
    return sum(isinstance(row.get(name), (int, float)) for row in json.loads(text)["dh"]
               for name in ("b_mm", "theta_deg", "a_mm", "alpha_deg", "beta_deg"))


def main():
    sweepd, source = (pathlib.Path(path).resolve() for path in sys.argv[1:3])
    outage = 60 * float(sys.argv[3]) if len(sys.argv) > 3 else 1
    if missing():
        print(f"not available here: {missing()}")
        return
    with tempfile.TemporaryDirectory(prefix="sweepd-plant-") as name:
        folder = pathlib.Path(name)
        os.chmod(folder, 0o755)
        plant = Plant(sweepd, source, folder)
        try:
            scenario(plant, outage, len(sys.argv) > 3)
        except BaseException:
            for log in sorted(folder.glob("*.log")):
                print(f"--- {log.name}\n{log.read_text(errors='replace')[-4000:]}")
            raise
        finally:
            for program in Program.all:
                program.kill()
            plant.broker.stop()
            plant.database.stop()


main()
