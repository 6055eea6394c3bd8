#!/usr/bin/env python3
"""Publisher, broker, collector and database, each killed in turn: every result arrives, once, and
equal to its file to the byte.

    plant_test.py SWEEPD SOURCE_FOLDER [MINUTES]
    plant_test.py SWEEPD SOURCE_FOLDER full-spool

The broker is away for MINUTES, some seconds without it. Or the spool's disk is full.
"""
import csv
import hashlib
import json
import os
import pathlib
import random
import signal
import socket
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True
sys.path[:0] = [str(folder) for folder in pathlib.Path(__file__).parents[:2]]
from free_port import free_port
from plant_servers import Broker, Database, Refuser, Stranger, missing, until

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
        self.pages = free_port(socket.SOCK_STREAM)
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
            f'description = "{config}/robots/kr5_arc.toml"\nlisten = "127.0.0.1:{free_port(socket.SOCK_DGRAM)}"\n'
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
    for program in (collector, publisher):
        program.process.send_signal(signal.SIGHUP)
    until(lambda: collector.said("SIGHUP changes nothing") and publisher.said("SIGHUP changes nothing"), "words for it")
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

    strangers(plant, collector)
    newer_tables(plant, collector)
    ends_while_waiting(plant, collector)
    other_password(plant, again)
    refused_subscription(plant)
    silent_database(plant)

    code = subprocess.run([plant.sweepd, "compare", f"{PLACE}/20260101T120000Z", PLACE, "--database",
                           plant.database.connection], capture_output=True, text=True)
    assert code.returncode in (0, 3) and "20260107T120000Z" in code.stdout, code
    code = subprocess.run([plant.sweepd, "history", PLACE, "--database", plant.database.connection, "--csv",
                           plant.folder / "history.csv"], capture_output=True, text=True)
    assert code.returncode in (0, 3), code
    told = list(csv.DictReader((plant.folder / "history.csv").open()))
    assert [line["campaign"] for line in told] == [f"2026010{day}T120000Z" for day in range(1, 8)], told

    plant.campaign_ends(0)  # as it is made of an earlier recording
    plant.arrive()
    kept = Stranger(plant.broker, "geheim").retained(f"sweepd/1/{PLACE}/result/summary")
    assert b'"session": "20260107T120000Z"' in kept, kept
    print("the broker keeps the newest result, not the one that came last")

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
    days_of_links(plant)
    second_collector(plant)


def strangers(plant, collector):
    """What any client of the broker may send takes nothing from the robots."""
    stranger = Stranger(plant.broker, "geheim")
    result = plant.template.encode()
    state = {"schema": "sweepd.state/1", "at": "2026-01-01T12:00:00Z", "started": "2026-01-01T11:00:00Z"}
    state["robots"] = [{"robot": ROBOT, "telegrams": {"received": 7}}]
    state = json.dumps(state).encode()
    letters = random.Random(1)
    long_name = "".join(letters.choice("abcdefghijklmnopqrstuvwxyz0123456789") for _ in range(9000))
    stranger.publish("sweepd/1/odd/cell/%FF/state", state)
    for robot, session in ((f"{ROBOT}%00", "20260201T000000Z"), ("%FF", "20260201T000000Z"),
                           (long_name, "20260201T000000Z"), (ROBOT, long_name), (ROBOT, "yesterday")):
        stranger.publish(f"sweepd/1/odd/cell/{robot}/result", result, session=session)
    stranger.publish(f"sweepd/1/odd/cell/{ROBOT}/result", result)
    stranger.publish(f"sweepd/1/odd/cell/{ROBOT}/compare", b'{"schema": "sweepd.compare/1"}')
    stranger.publish("sweepd/1/odd/cell/whole/result", result, session="20260201T000000Z", started="yesterday")
    plant_rows = "select session, started is null from campaigns join robots on robots.id = robot where site = 'odd'"
    until(lambda: plant.database.ask(plant_rows), "what follows is stored")
    assert plant.database.ask(plant_rows) == "20260201T000000Z|t", plant.database.ask(plant_rows)
    assert plant.database.ask("select count(*) from refused") == "5"
    plant.database.ask("delete from refused; delete from numbers where campaign in (select campaigns.id from "
                       "campaigns join robots on robots.id = robot where site = 'odd'); delete from campaigns "
                       "where robot in (select id from robots where site = 'odd')")
    # The next counts are written with those that are refused: half a minute later.
    until(lambda: collector.said("the counts of sweepd/1/odd/cell/%FF/state are not stored"), "words", 60)
    until(lambda: plant.database.ask("select count(*) from link_days") == "1", "links of the others", 60)
    assert plant.database.ask("select count(*) from refused") == "0", "a state that is right is refused"
    print("what strangers send is refused, and keeps nothing else out")


def days_of_links(plant):
    """The longest reply of a day is one of that day, and NULL where it is not known."""
    stranger = Stranger(plant.broker, "geheim")
    collector = Program(plant.sweepd, plant.folder / "days.log", "collect", "--config",
                        plant.folder / "collect.toml")
    collector.kill()

    def tell(day, received, stream):
        state = {"schema": "sweepd.state/1", "at": f"2026-01-0{day}T12:00:00Z", "started": "2026-01-01T11:00:00Z",
                 "robots": [{"robot": "days", "telegrams": {"received": received}, "stream": stream}]}
        collector.log.write_text("")
        collector.start()
        until(lambda: collector.said("connected to the broker"), "the collector is connected")
        time.sleep(0.5)
        stranger.publish("sweepd/1/odd/cell/days/state", json.dumps(state).encode())
        time.sleep(0.5)
        assert collector.end() == 0, collector.log.read_text()
        return plant.database.ask("select day, coalesce(max_latency_us::text, 'null') from link_days join robots on "
                                  f"robots.id = robot where name = 'days' and day = '2026-01-0{day}'")

    def stream(day, longest):
        return {"since": f"2026-01-0{day}T11:30:00Z", "reply_latency": {"max_us": longest}}

    assert tell(1, 10, stream(1, 900.5)) == "2026-01-01|900.5"
    assert tell(2, 20, stream(1, 900.5)) == "2026-01-02|null", "the day before had it"
    assert tell(2, 30, stream(1, 1200)) == "2026-01-02|1200"
    assert tell(3, 40, None) == "2026-01-03|null", "there was no reply"
    assert tell(3, 50, stream(3, 300)) == "2026-01-03|300"
    print("the longest reply of a day is one of that day")


def second_collector(plant):
    """Of another name at the broker: neither throws the other out."""
    settings = (plant.folder / "collect.toml").read_text()
    (plant.folder / "second.toml").write_text(settings.replace("collect-spool", "second-spool") +
                                              'client = "second"\n')
    both = [Program(plant.sweepd, plant.folder / f"{name}-collector.log", "collect", "--config",
                    plant.folder / f"{name}.toml") for name in ("collect", "second")]
    for collector in both:
        until(lambda: collector.log.exists() and collector.said("connected to the broker"), "it is connected")
    time.sleep(2)
    for collector in both:
        assert collector.end() == 0, collector.log.read_text()
        assert "lost" not in collector.log.read_text() and "same name" not in collector.log.read_text()
    print("two collectors of two names leave each other alone")


def newer_tables(plant, collector):
    plant.database.ask("alter table migrations rename column number to id")
    collector.kill_and_start()
    plant.campaign_ends(5)
    until(lambda: collector.said("the table migrations in the database is another program's"), "words for others'")
    plant.database.ask("alter table migrations rename column id to number; "
                       "insert into migrations (number) values (99)")
    collector.kill_and_start()
    until(lambda: collector.said("the tables are those of a newer sweepd"), "words for newer tables")
    assert not collector.said("is lost: "), "a result is acknowledged that is not stored"
    plant.database.ask("delete from migrations where number = 99")
    plant.arrive()
    print("tables of another program, or of a newer sweepd: the result waits")


def ends_while_waiting(plant, collector):
    """Once the message comes while it is at work, once as soon as it is started."""
    plant.database.ask("insert into migrations (number) values (99)")
    collector.kill()
    for number in (7, None):
        collector.log.write_text("")
        collector.start()
        if number:
            plant.campaign_ends(number)
        until(lambda: collector.said("the tables are those of a newer sweepd"), "words for newer tables")
        time.sleep(1)
        assert collector.end() == 0, collector.log.read_text()
        assert collector.said("the broker keeps what it has not taken"), collector.log.read_text()
    plant.database.ask("delete from migrations where number = 99")
    collector.start()
    plant.arrive()
    print("a collector whose message waits for the database ends when it is told to, and loses nothing")


def other_password(plant, publisher):
    plant.broker.stop()
    until(lambda: publisher.said("cannot be reached (TCP/TLS connect failure)"), "the broker is missed")
    plant.broker.accept("another")
    plant.broker.start()
    until(lambda: publisher.said("Not authorized"), "words for a password that is refused", 60)
    plant.broker.stop()
    plant.broker.accept("geheim")
    plant.broker.start()
    plant.campaign_ends(6)
    plant.arrive()
    print("a password that is refused after the broker was away: told")


def refused_subscription(plant):
    config = plant.folder / "refused.toml"
    config.write_text(f'[collect]\nbroker = "{Refuser().address}"\ndatabase = "dbname=none"\nspool = "refused"\n')
    collector = Program(plant.sweepd, plant.folder / "refused.log", "collect", "--config", config)
    until(lambda: collector.log.exists() and collector.log.read_text().count("refuses the subscription") == 3,
          "words for subscriptions that are refused")
    assert collector.end() == 0, collector.log.read_text()
    print("a collector that may not read: told")


def silent_database(plant):
    with socket.create_server(("127.0.0.1", 0)) as server:
        access = f"host=127.0.0.1 port={server.getsockname()[1]} dbname=x"
        code = subprocess.run([plant.sweepd, "compare", "a/b/c", "a/b/d", "--database", access], timeout=30,
                              capture_output=True, text=True)
    assert code.returncode == 1 and "timeout expired" in code.stderr, code
    print("a database that does not answer: told")


def full_spool(plant):
    for number in range(1, 8):
        plant.campaign_ends(number)
    spool = plant.folder / "full"
    spool.mkdir()
    if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "none", spool], capture_output=True).returncode:
        print("a full spool: not tried, nothing may be mounted here")
        return
    try:
        publisher = Program(plant.sweepd, plant.folder / "full.log", "publish", "--config",
                            plant.settings_with("full"))
        until(lambda: publisher.said("make room on its disk"), "words for a full spool")
        subprocess.run(["mount", "-o", "remount,size=64m", spool], check=True)
        until(lambda: publisher.log.read_text().count(" is published\n") == len(plant.files), "all results", 90)
        assert publisher.end() == 0, publisher.log.read_text()
    finally:
        Program.all[-1].kill()
        subprocess.run(["umount", spool], check=True)
    print("a full spool: told, and all is published once there is room")


def numbers_of(text):
    return sum(isinstance(row.get(name), (int, float)) for row in json.loads(text)["dh"]
               for name in ("b_mm", "theta_deg", "a_mm", "alpha_deg", "beta_deg"))


def main():
    sweepd, source = (pathlib.Path(path).resolve() for path in sys.argv[1:3])
    what = sys.argv[3] if len(sys.argv) > 3 else ""
    if missing():
        print(f"not available here: {missing()}")
        return
    with tempfile.TemporaryDirectory(prefix="sweepd-plant-") as name:
        folder = pathlib.Path(name)
        os.chmod(folder, 0o755)
        plant = Plant(sweepd, source, folder)
        try:
            if what == "full-spool":
                full_spool(plant)
            else:
                scenario(plant, 60 * float(what) if what else 1, what != "")
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
