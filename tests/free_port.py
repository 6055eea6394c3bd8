"""Ports for what a test starts."""

import random
import socket

# The kernel gives ports from 32768 on to whoever asks for any: a test beside this one might be given
# what was free there a moment ago. It gives none of these.
NOT_GIVEN = range(20000, 32768)


def free_port(kind):
    """A port of 127.0.0.1 that nobody uses, for socket.SOCK_STREAM or SOCK_DGRAM."""
    while True:
        port = random.choice(NOT_GIVEN)
        with socket.socket(socket.AF_INET, kind) as probe:
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                continue
            return port
