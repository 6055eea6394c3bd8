"""A broker and a database of the test's own, in a temporary folder, on the loopback interface."""
import os
import pathlib
import shutil
import signal
import socket
import ssl
import struct
import subprocess
import threading
import time

from free_port import free_port


def missing():
    """The first program that is not here, or nothing."""
    if not mosquitto():
        return "mosquitto"
    if not postgres():
        return "postgresql"
    if not shutil.which("openssl"):
        return "openssl"
    return None


def mosquitto():
    return shutil.which("mosquitto", path="/usr/sbin:/usr/bin:/usr/local/sbin")


def postgres():
    found = sorted(pathlib.Path("/usr/lib/postgresql").glob("*/bin/initdb"))
    return found[-1].parent if found else None


def as_nobody():
    """Neither server runs as root."""
    return ["setpriv", "--reuid=nobody", "--regid=nogroup", "--clear-groups"] if os.geteuid() == 0 else []


def until(condition, what, seconds=30):
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            raise AssertionError(f"in vain: {what}")
        time.sleep(0.05)


class Server:
    process = None

    def __init__(self, folder, name):
        self.folder = folder / name
        self.folder.mkdir()
        if os.geteuid() == 0:
            shutil.chown(self.folder, "nobody", "nogroup")
        self.log = open(self.folder.parent / f"{name}.log", "ab")

    def launch(self, *command):
        self.process = subprocess.Popen([*as_nobody(), *map(str, command)], cwd=self.folder,
                                        stdout=self.log, stderr=self.log)

    def stop(self, number=signal.SIGTERM):
        if self.process:
            self.process.send_signal(number)
            self.process.wait(30)
            self.process = None


class Broker(Server):
    """With TLS and a password where `secret` is given."""

    def __init__(self, folder, secret=None):
        super().__init__(folder, "mosquitto")
        self.port = free_port(socket.SOCK_STREAM)
        self.config = folder / "mosquitto.conf"
        access = "allow_anonymous true\n"
        if secret:
            access = self.certify(folder)
            self.accept(secret)
        self.address = f"mqtts://localhost:{self.port}" if secret else f"mqtt://127.0.0.1:{self.port}"
        self.config.write_text(f"listener {self.port} 127.0.0.1\n{access}"
                               f"persistence true\npersistence_location {self.folder}/\n"
                               "max_queued_messages 0\n")
        self.start()

    def accept(self, secret):
        file = self.folder.parent / "passwords"
        subprocess.run(["mosquitto_passwd", "-b", "-c", file, "plant", secret], check=True)
        file.chmod(0o644)

    def certify(self, folder):
        subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256",
                        "-nodes", "-days", "2", "-subj", "/CN=localhost", "-addext",
                        "subjectAltName=DNS:localhost", "-keyout", folder / "broker.key", "-out",
                        folder / "broker.pem"], check=True, stderr=self.log)
        (folder / "broker.key").chmod(0o644)  # for the user nobody, for a few seconds
        return (f"certfile {folder}/broker.pem\nkeyfile {folder}/broker.key\n"
                f"password_file {folder}/passwords\n")

    def start(self):
        self.launch(mosquitto(), "-c", self.config)
        until(self.answers, "mosquitto answers")

    def answers(self):
        with socket.socket() as probe:
            return probe.connect_ex(("127.0.0.1", self.port)) == 0


class Stranger:
    """Publishes whatever it is told to, as no sweepd would. As little of MQTT 5 as that takes."""

    def __init__(self, broker, secret):
        context = ssl.create_default_context(cafile=broker.folder.parent / "broker.pem")
        self.socket = context.wrap_socket(socket.create_connection(("127.0.0.1", broker.port), 10),
                                          server_hostname="localhost")
        head = self.text("MQTT") + bytes([5, 0xC2]) + struct.pack(">HB", 600, 0)
        self.send(0x10, head + self.text("stranger") + self.text("plant") + self.text(secret))
        assert self.answer()[1] == 0, "the broker refuses the stranger"

    @staticmethod
    def text(words):
        return struct.pack(">H", len(words.encode())) + words.encode()

    @staticmethod
    def length(size):
        code = b""
        while size > 127:
            code, size = code + bytes([size % 128 | 128]), size // 128
        return code + bytes([size])

    def send(self, kind, content):
        self.socket.sendall(bytes([kind]) + self.length(len(content)) + content)

    def exactly(self, size):
        content = b""
        while len(content) < size:
            part = self.socket.recv(size - len(content))
            assert part, "the broker closed the stranger's connection"
            content += part
        return content

    def retained(self, topic):
        """What the broker keeps under this topic."""
        self.send(0x82, struct.pack(">HB", 2, 0) + self.text(topic) + bytes([0]))
        self.answer()
        assert self.exactly(1)[0] == 0x31, "what comes is not retained"
        size, shift = 0, 0
        while True:
            part = self.exactly(1)[0]
            size, shift = size | (part & 127) << shift, shift + 7
            if part < 128:
                return self.exactly(size)

    def answer(self):
        size = self.exactly(2)[1]
        assert size < 128, "a longer answer than any that is expected"
        return self.exactly(size)

    def publish(self, topic, payload, **names):
        properties = b"".join(b"\x26" + self.text(name) + self.text(value) for name, value in names.items())
        self.send(0x32, self.text(topic) + struct.pack(">H", 1) + self.length(len(properties)) + properties
                  + payload)
        self.answer()


class Refuser:
    """A broker that lets everybody in, and nobody read."""

    def __init__(self):
        self.socket = socket.create_server(("127.0.0.1", 0))
        self.address = f"mqtt://127.0.0.1:{self.socket.getsockname()[1]}"
        threading.Thread(target=self.serve, daemon=True).start()

    def serve(self):
        while True:
            client, _ = self.socket.accept()
            with client, client.makefile("rb") as packets:
                while head := packets.read(1):
                    size, shift, part = 0, 0, 128
                    while part > 127:
                        part = packets.read(1)[0]
                        size, shift = size | (part & 127) << shift, shift + 7
                    content = packets.read(size)
                    if head[0] >> 4 == 1:
                        client.sendall(b"\x20\x03\0\0\0")
                    elif head[0] >> 4 == 8:  # not authorized
                        client.sendall(b"\x90\x04" + content[:2] + b"\0\x87")


class Database(Server):
    def __init__(self, folder, *settings):
        super().__init__(folder, "postgres")
        self.data = self.folder / "data"
        self.settings = settings
        subprocess.run([*as_nobody(), postgres() / "initdb", "--pgdata", self.data, "--auth=trust",
                        "--username=sweepd", "--no-sync", "--encoding=UTF8", "--no-locale"],
                       check=True, stdout=self.log, stderr=self.log, cwd=self.folder)
        self.start()

    @property
    def connection(self):
        return f"host={self.folder} user=sweepd dbname=postgres"

    def start(self):
        options = [word for setting in self.settings for word in ("-c", setting)]
        self.launch(postgres() / "postgres", "-D", self.data, "-k", self.folder, "-c",
                    "listen_addresses=", *options)
        until(lambda: self.ask("select 1", check=False) == "1", "PostgreSQL answers")

    def stop(self, number=signal.SIGINT):  # at once, as a restart does
        super().stop(number)

    def ask(self, sql, check=True):
        done = subprocess.run([postgres() / "psql", "-XAtq", self.connection, "-c", sql],
                              capture_output=True, text=True)
        if check and done.returncode:
            raise AssertionError(f"{sql}: {done.stderr}")
        return done.stdout.strip()
