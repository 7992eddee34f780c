# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Ports that Rerun is to serve at: Rerun itself does not say why it cannot. Does not load it."""

from __future__ import annotations

import socket


def free_port(address: str, port: int) -> int:
    """
    Return a port that can be served at an IPv4 or IPv6 address: ``port``, or any for 0.

    Raises
    ------
    OSError
        If the port is taken, or the address is not one of this machine.

    Examples
    --------
    >>> free_port('127.0.0.1', 0) > 0
    True

    """
    with socket.socket(socket.AF_INET6 if ':' in address else socket.AF_INET) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        probe.bind((address, port))
        return int(probe.getsockname()[1])
