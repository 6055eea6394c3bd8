#!/usr/bin/env python3
"""What config/monitoring holds is true of a live sweepd: the alerts fire on what they are for, and
every expression of the alerts and of the dashboard gives data.

    monitoring_test.py SWEEPD SOURCE_FOLDER
"""
import contextlib
import json
import pathlib
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import urllib.parse
import urllib.request

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent.parent))
from free_port import free_port

sweepd, source = (pathlib.Path(argument).resolve() for argument in sys.argv[1:])
RULES = source / "config/monitoring/sweepd_rules.yml"
DASHBOARD = source / "config/monitoring/sweepd_dashboard.json"
PATIENCE = 30  # seconds; a machine that is free needs four


@contextlib.contextmanager
def running(folder, name, *command):
    with (folder / f"{name}.log").open("wb") as log:
        process = subprocess.Popen([str(word) for word in command], cwd=folder, stdout=log, stderr=log)
        try:
            yield process
        finally:
            process.terminate()
            process.wait()


def tested_rules(folder, rules):
    """What promtool says of its tests of these rules; empty where all pass."""
    folder.mkdir()
    shutil.copy(source / "tests/monitoring/sweepd_rules_test.yml", folder)
    (folder / "sweepd_rules.yml").write_text(rules)
    done = subprocess.run(["promtool", "test", "rules", "sweepd_rules_test.yml"], cwd=folder,
                          capture_output=True, text=True)
    return "" if done.returncode == 0 else done.stdout + done.stderr


def expressions():
    """(where it stands, as it is asked). An alert that does not fire gives data once it compares
    with `bool`; of what Grafana fills in, the usual values."""
    for rule in re.findall(r"alert: (\w+)\n +expr: (.*)\n", RULES.read_text()):
        yield rule[0], re.sub(r" (==|>|<) ", r" \1 bool ", rule[1])
    dashboard = json.loads(DASHBOARD.read_text())
    targets = [(panel["title"], target["expr"]) for panel in dashboard["panels"] for target in panel["targets"]]
    targets += [(note["name"], note["expr"].replace(" > 0", " >= 0")) for note in dashboard["annotations"]["list"]]
    for name, expression in targets:
        for told, filled in (("$__rate_interval", "20s"), ("$instance", ".*"), ("$robot", ".*")):
            expression = expression.replace(told, filled)
        yield name, expression


def wrong_table():
    """Alerts and severities of docs/monitoring.md."""
    told = set(re.findall(r"^\| `(Sweepd\w+)` \| (\w+) \|", (source / "docs/monitoring.md").read_text(), re.M))
    real = set(re.findall(r"alert: (\w+)\n(?: .*\n)*?        labels: \{ severity: (\w+) \}", RULES.read_text()))
    assert len(real) == len(re.findall("alert:", RULES.read_text()))
    for name, severity in sorted(told ^ real):
        yield f"docs/monitoring.md and the rules differ in {name}, {severity}"


def settings(folder, rsi_port, page_port):
    (folder / "sweepd.toml").write_text(
        f'[[robot]]\nname = "arc"\ndescription = "{source}/config/robots/kr5_arc.toml"\n'
        f'ethernet_config = "{source}/config/controller/krc4/sweepd_ethernet.xml"\n'
        f'listen = "127.0.0.1:{rsi_port}"\noutput = "out"\nrealtime = "off"\n'
        f'[http]\nlisten = "127.0.0.1:{page_port}"\n')


def prometheus_settings(folder, page_port):
    (folder / "prometheus.yml").write_text(
        f'global: {{scrape_interval: 1s, evaluation_interval: 1s}}\nrule_files: ["{RULES}"]\n'
        f'scrape_configs:\n- job_name: sweepd\n  static_configs: [{{targets: ["127.0.0.1:{page_port}"]}}]\n')


class Prometheus:
    def __init__(self, port):
        self.url = f"http://127.0.0.1:{port}/api/v1/"

    def ask(self, path, **query):
        with urllib.request.urlopen(self.url + path + "?" + urllib.parse.urlencode(query), timeout=10) as answer:
            return json.load(answer)["data"]

    def has(self, expression):
        return bool(self.ask("query", query=expression)["result"])


def without_data(prometheus):
    """Expressions that stay without data; waited for, as rates need several scrapes."""
    left, until = list(expressions()), time.monotonic() + PATIENCE
    assert len(left) > 40, f"only {len(left)} expressions found"
    while left and time.monotonic() < until:
        with contextlib.suppress(OSError):  # it begins to listen
            left = [(name, expression) for name, expression in left if not prometheus.has(expression)]
        if left:
            time.sleep(0.3)
    return left


def live(folder):
    rsi_port, page_port, prometheus_port = (free_port(kind) for kind in
                                            (socket.SOCK_DGRAM, socket.SOCK_STREAM, socket.SOCK_STREAM))
    settings(folder, rsi_port, page_port)
    prometheus_settings(folder, page_port)
    # A session that was cut gets its result at the start: so there is one.
    cut = folder / "out/arc/20260101T000000Z"
    cut.mkdir(parents=True)
    played = ["--robot", source / "config/robots/kr5_arc.toml", "--plan", source / "config/plans/kr5_arc_30deg.toml"]
    subprocess.run([sweepd, "simulate", *played, "--write", cut / "trace.pcap", "--quiet"], check=True)
    with running(folder, "sweepd", sweepd, "run", "--config", "sweepd.toml"), \
            running(folder, "prometheus", "prometheus", "--config.file=prometheus.yml", "--storage.tsdb.path=data",
                    f"--web.listen-address=127.0.0.1:{prometheus_port}", "--log.level=warn"), \
            running(folder, "simulate", sweepd, "simulate", *played, "--to", f"127.0.0.1:{rsi_port}", "--quiet"):
        prometheus = Prometheus(prometheus_port)
        left = without_data(prometheus)
        for name, expression in left:
            yield f"{name}: no data for {expression}"
        if left:
            yield from ((folder / f"{log}.log").read_text()[-2000:] for log in ("sweepd", "prometheus", "simulate"))
            return
        if prometheus.has("sweepd_nobody_has_this"):
            yield "planted: a metric that does not exist has data"
        rules = [rule for group in prometheus.ask("rules")["groups"] for rule in group["rules"]]
        yield from (f"{rule['name']}: {rule['lastError']}" for rule in rules if rule["health"] == "err")
        firing = {alert["labels"]["alertname"] for alert in prometheus.ask("alerts")["alerts"]
                  if alert["state"] == "firing"}
        # A machine that tests may be late; all else is well with this sweepd.
        late = {"SweepdRepliesLate", "SweepdControllerMissedReplies", "SweepdTelegramsLost"}
        yield from (f"{name} fires though nothing is wrong" for name in sorted(firing - late))


def problems(folder):
    rules = RULES.read_text()
    if said := tested_rules(folder / "rules", rules):
        yield said
    if not tested_rules(folder / "planted", rules.replace("sweepd_recording_paused == 1", "sweepd_recording_paused == 2")):
        yield "planted: an alert that never fires passes"
    yield from wrong_table()
    yield from live(folder)


for program in ("promtool", "prometheus"):
    if not shutil.which(program):
        print(f"not available here: {program}")
        sys.exit(0)
with tempfile.TemporaryDirectory() as name:
    wrong = list(problems(pathlib.Path(name)))
print("\n".join(wrong))
sys.exit(bool(wrong))
