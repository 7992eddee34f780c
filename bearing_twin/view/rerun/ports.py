# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Addresses and ports that Rerun is to serve at. Does not load Rerun."""

from __future__ import annotations

import socket


def free_port(address: str, port: int) -> int:
    """
    Return a port that can be served at an IPv4 or IPv6 address: ``port``, or any for 0.

    Rerun itself does not say why it cannot serve there.

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


def bracketed(address: str) -> str:
    """
    Return an address as it is written before a port: IPv6 in brackets.

    Examples
    --------
    >>> bracketed('::1'), bracketed('127.0.0.1')
    ('[::1]', '127.0.0.1')

    """
    return f'[{address}]' if ':' in address else address
