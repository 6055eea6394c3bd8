#!/usr/bin/env python3
"""`sweepd watch` beside a real exchange, in a network of the test's own.

    watch_test.py SWEEPD SOURCE_FOLDER

A simulated controller talks to another RSI server (`sweepd run`) on a loopback interface; the tap
sees what the server saw. Then that exchange is sent again over a pair of interfaces, spoilt on
purpose: each packet twice and one in a hundred not at all; inside of VLAN tags, with fragments
between. All counts are exact. Packets are missed on purpose here, so nothing depends on how busy the
machine is.
"""
import contextlib
import ctypes
import json
import os
import pathlib
import random
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time

sweepd, source = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
PORT, TCP_PORT = 49152, 49160
ROBOT = source / "config/robots/kr5_arc.toml"
PLAN = ("home_deg = [90, -90, 90, 0, 90, 0]\npositioning_speed_deg_s = 150\nacceleration_deg_s2 = 1500\n"
        "dwell_ms = 120\n" + "".join(
            f"[[sweep]]\njoint = {joint}\nstart_deg = {start}\nend_deg = {start + 20}\nspeed_deg_s = 120\n"
            for joint, start in ((1, 90), (3, 90), (5, 90), (6, 0))))
wrong = []
started = []


def check(holds, *what):
    if not holds:
        wrong.append(" ".join(map(str, what)))


def in_own_network():
    """Becomes this program again, as root of a user and a network of its own."""
    if os.environ.get("SWEEPD_OWN_NETWORK"):
        return True
    for tool in ("unshare", "ip", "setpriv"):
        if not shutil.which(tool):
            print(f"not permitted here: {tool} is not installed")
            return False
    make = ["unshare", "--map-root-user", "--net"]
    permitted = subprocess.run([*make, "sh", "-c", "ip link set lo up && ip link add tap0 type veth peer name tap1"],
                               capture_output=True, text=True)
    if permitted.returncode != 0:
        print(f"not permitted here: {permitted.stderr.strip()}")
        return False
    os.environ["SWEEPD_OWN_NETWORK"] = "1"
    os.execvp("unshare", [*make, sys.executable, *sys.argv])


class Process:
    def __init__(self, folder, name, *command):
        self.log = folder / f"{name}.log"
        with self.log.open("wb") as log:
            started.append(self)
            self.process = subprocess.Popen([str(word) for word in command], cwd=folder, stdout=log, stderr=log)

    def said(self):
        return self.log.read_text(errors="replace")

    def says(self, text, longest=20):
        until = time.monotonic() + longest
        while time.monotonic() < until:
            if text in self.said():
                return True
            time.sleep(0.02)
        return False

    def end(self):
        self.process.terminate()
        return self.process.wait(60)


def settings(folder, name, address="127.0.0.1", silence_ms=500):
    def robot(name_of_robot, port, file):
        return (f'[[robot]]\nname = "{name_of_robot}"\ndescription = "{ROBOT}"\nlisten = "{address}:{port}"\n'
                f'output = "{name}"\nethernet_config = "{source}/config/controller/{file}"\nsilence_ms = {silence_ms}\n'
                'realtime = "off"\n[robot.recording]\nkeep_free_bytes = 0\n')

    (folder / f"{name}.toml").write_text(robot("arc", PORT, "krc4/sweepd_ethernet.xml") +
                                         robot("tcp", TCP_PORT, "krc2/sweepd_tcp.xml") + '[http]\nlisten = "off"\n')
    return folder / f"{name}.toml"


def session(folder, robot="arc"):
    found = [run.parent for run in folder.glob(f"{robot}/*/run.json")]
    check(len(found) == 1, folder, "has", len(found), "sessions")
    return found[0]


def packets(trace):
    """(from the controller, source port, payload) of a recording of sweepd's."""
    data, at = trace.read_bytes(), 24
    while at + 16 <= len(data):
        size = struct.unpack_from("=I", data, at + 8)[0]
        packet = data[at + 16:at + 16 + size]
        ports = struct.unpack_from(">HH", packet, 20)
        yield ports[1] in (PORT, TCP_PORT), ports, packet[28:]
        at += 16 + size


def ipoc(payload):
    return int(re.search(rb"<IPOC>(\d+)</IPOC>", payload)[1])


def link(folder):
    return json.loads((folder / "link.json").read_text())


def counts(report):
    """What does not depend on when a telegram was stamped."""
    replies = report["replies"]
    return ({key: report["telegrams"][key] for key in
             ("received", "lost", "duplicated", "reordered", "malformed", "unanswerable", "restarts", "late_replies")},
            {key: replies[key] for key in ("sent", "repeated", "stray", "withheld")},
            replies["in_time"] + replies["late"] + replies["superseded"] + replies["unanswered"])


# A real exchange

def beside_a_server(folder):
    plan = folder / "plan.toml"
    plan.write_text(PLAN)
    server = Process(folder, "server", sweepd, "run", "--config", settings(folder, "served"))
    tap = Process(folder, "tap", sweepd, "watch", "--interface", "lo", "--config", settings(folder, "watched"))
    other = Process(folder, "other", sweepd, "watch", "--interface", "lo", "--port", PORT + 1, "--output", folder / "other")
    found = Process(folder, "found", sweepd, "watch", "--interface", "lo", "--robot", ROBOT, "--output", folder / "found")
    check(server.says("listening on UDP") and tap.says("watching UDP") and other.says("watching UDP") and
          found.says("looking for RSI"), "somebody did not begin:", tap.said(), other.said(), found.said())
    play = [sweepd, "simulate", "--robot", ROBOT, "--plan", plan, "--to"]
    over_tcp = Process(folder, "over_tcp", *play, f"127.0.0.1:{TCP_PORT}", "--cycle-ms", 12, "--ethernet-config",
                       source / "config/controller/krc2/sweepd_tcp.xml")
    played = subprocess.run([*play, f"127.0.0.1:{PORT}", "--lose-percent", "2", "--duplicate-percent", "1", "--swap-percent", "1"], capture_output=True, text=True)
    assert "played to its end" in played.stdout, played.stdout + played.stderr
    check(over_tcp.says("played to its end"), over_tcp.said())
    for robot in ("arc", "tcp"):
        check(server.says(f"{robot}: result ") and tap.says(f"{robot}: result "), "no session ended:", tap.said())
    # By the time that another tap tells of its first silence, these two would have done so.
    silent = Process(folder, "silent", sweepd, "watch", "--interface", "lo", "--port", PORT + 2, "--output", folder / "silent")
    check(silent.says("no RSI for"), silent.said())
    for robot in ("arc", "tcp"):
        behind = tap.said().split(f"{robot}: RSI from", 1)[-1]
        check(f"{robot}: RSI has been silent" in behind and "the stream has ended" in behind, behind)
        check(f"{robot}: no RSI for" not in behind, "an end is told as a fault:", behind)
    check(other.says(f"but of 127.0.0.1 with 127.0.0.1:{PORT}, "), "wrong port:", other.said())
    check(found.says("RSI of 127.0.0.1 with 127.0.0.1:491"), "not found:", found.said())
    for process in (server, tap, other, found, silent):
        check(process.end() == 0, process.log.name, process.said())
    check(not (folder / "other").exists() or not any((folder / "other").glob("*/*/trace.pcap")), "another port is recorded")

    for robot in ("tcp", "arc"):
        served, watched = session(folder / "served", robot), session(folder / "watched", robot)
        for direction in (True, False):
            seen = [[payload for to, _, payload in packets(one / "trace.pcap") if to == direction]
                    for one in (served, watched)]
            check(len(seen[0]) > 200 and seen[0] == seen[1], robot, "traces differ:", len(seen[0]), len(seen[1]))
        check(counts(link(served)) == counts(link(watched)), robot, "links differ:", counts(link(served)),
              counts(link(watched)))
    check(link(watched)["telegrams"]["duplicated"] > 3 and link(watched)["telegrams"]["lost"] > 3,
          "nothing was spoilt:", counts(link(watched)))
    run = json.loads((watched / "run.json").read_text())
    check(run["command"] == "watch" and run["watched"] == {"interface": "lo", "missed": 0, "copies": 0}, run)
    for number in ("status", "joints"):
        one, two = (json.loads((folder / "result.json").read_text())[number] for folder in (served, watched))
        if number == "status":
            check(one == two, "results differ:", one, two)
        else:
            check([joint["sweeps"] and len(joint["sweeps"]) for joint in one] ==
                  [joint["sweeps"] and len(joint["sweeps"]) for joint in two], "sweeps differ")

    subprocess.run([sweepd, "replay", watched / "trace.pcap", "--config", folder / "watched.toml", "--output",
                    folder / "replayed", "--quiet"], capture_output=True)
    for name in ("result.json", "dh.csv", "sweeps.csv", "report.txt", "samples.csv"):
        check((watched / name).read_bytes() == (folder / "replayed" / name).read_bytes(), "replay differs in", name)
    return list(packets(watched / "trace.pcap"))


# The same exchange, spoilt

def ip_packet(to_server, ports, payload, identification, fragment=0):
    addresses = (0xc0a80114, 0xc0a8010a) if to_server else (0xc0a8010a, 0xc0a80114)
    content = struct.pack(">HHHH", *ports, 8 + len(payload), 0) + payload
    return struct.pack(">BBHHHBBHII", 0x45, 0, 20 + len(content), identification & 0xffff, fragment, 64, 17, 0,
                       *addresses) + content


class Part(ctypes.Structure):  # iovec
    _fields_ = [("bytes", ctypes.c_char_p), ("size", ctypes.c_size_t)]


class Message(ctypes.Structure):  # mmsghdr
    _fields_ = [("name", ctypes.c_void_p), ("name_size", ctypes.c_uint), ("parts", ctypes.POINTER(Part)),
                ("count", ctypes.c_size_t), ("control", ctypes.c_void_p), ("control_size", ctypes.c_size_t),
                ("flags", ctypes.c_int), ("none", ctypes.c_int), ("sent", ctypes.c_uint)]


def send_at_once(wire, frames):
    """In one system call, as a switch does: this program may have to wait between two."""
    parts = [Part(frame, len(frame)) for frame in frames]
    messages = (Message * len(frames))(*(Message(parts=ctypes.pointer(part), count=1) for part in parts))
    if frames and ctypes.CDLL(None).sendmmsg(wire.fileno(), messages, len(frames), 0) != len(frames):
        raise OSError("sendmmsg")


def sent_by(interface):
    """Packets so far."""
    return int(re.search(rf"{interface}:(.*)", pathlib.Path("/proc/net/dev").read_text())[1].split()[9])


def spoilt(folder, name, exchange, send, on_end=lambda tap: None):
    """Sends each packet by `send`, at 1 ms for a cycle, and returns the tap's link report."""
    tap = Process(folder, name, sweepd, "watch", "--interface", "tap1", "--config", 
                  settings(folder, name, "0.0.0.0"))
    check(tap.says("watching UDP"), tap.said())
    sent_before = sent_by("tap1")
    with socket.socket(socket.AF_PACKET, socket.SOCK_RAW) as wire:
        wire.bind(("tap0", 0))
        due = time.monotonic()
        for number, packet in enumerate(exchange):
            send(lambda *frames: send_at_once(wire, frames), number, *packet)
            due += 0.0005
            time.sleep(max(0, due - time.monotonic()))
    check(tap.says("arc: result "), "no session ended:", tap.said())
    check(sent_by("tap1") == sent_before,
          "the tap sends")
    on_end(tap)
    check(tap.end() == 0, tap.said())
    return session(folder / name)


def doubled_and_missed(folder, exchange):
    """Each packet comes twice, of one in a hundred none does, of one in a hundred a copy is missing."""
    chance = random.Random(5)
    ends = {0, 1, len(exchange) - 1, len(exchange) - 2}
    luck = [50 if number in ends else chance.randrange(100) for number in range(len(exchange))]
    MAC = b"\x02" * 12 + b"\x08\x00"

    def send(wire, number, *packet):
        wire(*[MAC + ip_packet(*packet, number)] * {0: 0, 1: 1}.get(luck[number], 2))

    def vanish(tap):
        check(tap.says("each datagram passes tap1 2 times", 5), "doubling is not told:", tap.said())
        subprocess.run(["ip", "link", "set", "tap1", "down"], check=True)
        check(tap.says("interface tap1 is gone or down"), tap.said())
        subprocess.run(["ip", "link", "set", "tap1", "up"], check=True)
        check(tap.says("interface tap1 is there again"), tap.said())

    watched = spoilt(folder, "doubled", exchange, send, vanish)
    came = [packet for packet, fate in zip(exchange, luck) if fate != 0]
    telegrams = [ipoc(payload) for to_server, _, payload in came if to_server]
    replies = [ipoc(payload) for to_server, _, payload in came if not to_server]
    report = link(watched)
    check(report["telegrams"]["received"] == len(telegrams), report["telegrams"], len(telegrams))
    once = set(telegrams)  # the exchange itself had some twice
    check(report["telegrams"]["duplicated"] == len(telegrams) - len(once), report["telegrams"], len(once))
    check(report["telegrams"]["lost"] == (telegrams[-1] - telegrams[0]) // 4 + 1 - len(once),
          report["telegrams"], len(once))
    check(report["replies"]["sent"] == len(replies), report["replies"], len(replies))
    check(report["replies"]["stray"] == len(set(replies) - set(telegrams)), report["replies"])
    check(report["replies"]["unanswered"] + report["replies"]["superseded"] == len(set(telegrams) - set(replies)),
          report["replies"])
    run = json.loads((watched / "run.json").read_text())
    check(run["watched"]["missed"] == 0, run)
    check(run["watched"]["copies"] == sum(fate > 1 for fate in luck), run["watched"], sum(fate > 1 for fate in luck))
    seen = [payload for _, _, payload in packets(watched / "trace.pcap")]
    check(seen == [payload for _, _, payload in came], "the trace is not what came")


def tagged(folder, exchange):
    MAC = b"\x02" * 12 + b"\x81\x00\x60\x07\x08\x00"

    def send(wire, number, *packet):
        wire(MAC + ip_packet(*packet, number))
        if number % 100 == 50:
            wire(MAC + ip_packet(*packet, number, fragment=0x2000))

    watched = spoilt(folder, "tagged", exchange, send,
                     lambda tap: check(tap.says("IP fragments pass", 5), "fragments are not told:", tap.said()))
    seen = [payload for _, _, payload in packets(watched / "trace.pcap")]
    check(seen == [payload for _, _, payload in exchange], "tagged:", len(seen), len(exchange))


def pass_by(first, last, pause):
    """Telegrams and their replies, of these cycles; returns how many packets they are."""
    with socket.socket(socket.AF_PACKET, socket.SOCK_RAW) as wire:
        wire.bind(("tap0", 0))
        for cycle in range(first, last):
            number = f"<IPOC>{4 * cycle}</IPOC>".encode()
            wire.send(b"\x02" * 12 + b"\x08\x00" +
                      ip_packet(True, (50000, PORT), b"<Rob Type=\"KUKA\">" + number + b" " * 900 + b"</Rob>", 0))
            wire.send(b"\x02" * 12 + b"\x08\x00" +
                      ip_packet(False, (PORT, 50000), b"<Sen Type=\"ImFree\">" + number + b"</Sen>", 0))
            time.sleep(pause)
    return 2 * (last - first)


def stopped(folder):
    """The tap stands still for longer than a stream may be silent, while more passes than the kernel keeps for it: the
    session goes on, and what is missed is counted."""
    silence_ms = 2500
    tap = Process(folder, "stopped", sweepd, "watch", "--interface", "tap1", "--config",
                  settings(folder, "stopped", "0.0.0.0", silence_ms))
    check(tap.says("watching UDP"), tap.said())
    sent = pass_by(1000, 1100, 0.001)
    until = time.monotonic() + silence_ms / 1000 + 0.5
    tap.process.send_signal(signal.SIGSTOP)
    sent += pass_by(1100, 15000, 0)
    time.sleep(max(0, until - time.monotonic()))
    tap.process.send_signal(signal.SIGCONT)
    time.sleep(0.3)
    sent += pass_by(15000, 15100, 0.001)
    check(tap.says("arc: result "), "no session ended:", tap.said())
    check("packets were not seen by the tap" in tap.said(), tap.said())
    check(tap.end() == 0, tap.said())
    report = link(session(folder / "stopped"))
    telegrams, replies, missed = report["telegrams"], report["replies"], report["telegrams"].get("missed_by_tap", 0)
    check(missed > 1000 and telegrams["received"] + replies["sent"] + missed == sent,
          telegrams["received"], replies["sent"], missed, sent)
    check(not {"lost", "stray_replies"} & {reason["code"] for reason in report["reasons"]}, report["reasons"])


def gone(folder):
    """A stream that is cut off with its interface has its result, however long that stays away."""
    tap = Process(folder, "gone", sweepd, "watch", "--interface", "tap1", "--config", settings(folder, "gone", "0.0.0.0"))
    check(tap.says("watching UDP"), tap.said())
    pass_by(1000, 1100, 0.001)
    subprocess.run(["ip", "link", "set", "tap1", "down"], check=True)
    check(tap.says("interface tap1 is gone or down") and tap.says("arc: result "), "no session ended:", tap.said())
    subprocess.run(["ip", "link", "set", "tap1", "up"], check=True)
    check(tap.end() == 0, tap.said())


def refused(folder):
    def words(*command):
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True, cwd=folder, timeout=30)
        return done.returncode, done.stderr

    watch = (sweepd, "watch", "--port", PORT, "--interface")
    code, said = words(*watch, "missing0")
    check(code == 1 and "missing0: there is none of that name; there are any, lo, tap0, tap1" in said, code, said)
    code, said = words("setpriv", "--bounding-set=-net_raw", "--inh-caps=-net_raw", *watch, "lo")
    check(code == 1 and "not permitted: it takes the capability CAP_NET_RAW" in said, code, said)
    config = settings(folder, "none")
    code, said = words(sweepd, "watch", "--config", config, "--port", 5)
    check(code == 78 and "expected a [[robot]] with port 5" in said, code, said)


def cannot_send():
    """The library could. Nothing of sweepd calls it."""
    symbols = subprocess.run(["nm", "-D", "--undefined-only", sweepd], capture_output=True, text=True).stdout
    check("pcap_next_ex" in symbols, "pcap_next_ex is not found")
    check(not re.search("pcap_(inject|sendpacket)", symbols), "sweepd can send packets")


def main():
    if not in_own_network():
        return
    for command in ("link set lo up", "link add tap0 type veth peer name tap1"):
        subprocess.run(["ip", *command.split()], check=True)
    for name in ("tap0", "tap1"):  # nobody else says anything there
        with contextlib.suppress(OSError):
            pathlib.Path(f"/proc/sys/net/ipv6/conf/{name}/disable_ipv6").write_text("1")
        subprocess.run(["ip", "link", "set", name, "up"], check=True)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        try:
            cannot_send()
            refused(folder)
            exchange = beside_a_server(folder)
            doubled_and_missed(folder, exchange)
            tagged(folder, exchange[:400])
            stopped(folder)
            gone(folder)
        finally:
            for left in started:
                left.process.kill()
            if wrong:
                print(*wrong, sep="\n")
    sys.exit(bool(wrong))


main()
