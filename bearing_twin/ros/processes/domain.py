# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Join the ROS domain of the environment, or find one that no other process uses."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
import os
import socket
import sys
import time

from bearing_twin.errors import BearingTwinError, refused
from bearing_twin.quantity import check_range
from bearing_twin.ros.parameterfile import reason
from bearing_twin.ros.processes.deadlock import bounded, LEAVING
from bearing_twin.ros.processes.launching import ensure_log_folder
import rclpy

HIGHEST_DOMAIN = 232
"""Highest domain for which DDS has port numbers."""
DOMAINS = 100
"""Domains 1 to 100 do not use the ephemeral ports of Linux."""
LISTEN = 1.5
"""Time after which every participant of a domain has announced itself, s."""

# RTPS 2.5, section 9.6.2.3: first port of a domain, and ports of its participants.
FIRST_PORT, PORTS_A_DOMAIN = 7400, 250
PARTICIPANTS = range(10, 42, 2)
CLAIM = 5
"""Offset of a port that RTPS does not use; a process that holds it has claimed the domain."""


def initialise(args: Sequence[str] | None) -> None:
    """
    Initialise rclpy.

    Raises
    ------
    FileError
        If a parameter file cannot be read.
    BearingTwinError
        If a parameter file or ``ROS_DOMAIN_ID`` is invalid. For a number that is too large
        Fast DDS would end the process without naming it, and a negative one would be taken for
        the default domain.

    """
    # rclpy itself refuses a text that is no number.
    with suppress(ValueError):
        domain = int(os.environ.get('ROS_DOMAIN_ID', '0'))
        with refused():
            check_range('ROS_DOMAIN_ID', domain, 0, HIGHEST_DOMAIN, '')
    try:
        # Not as a context manager, which rclpy supports only since Kilted.
        rclpy.init(args=list(args) if args is not None else None)
    except (RuntimeError, UnicodeError) as error:
        # RCLError is a RuntimeError.
        why = reason(sys.argv if args is None else args)
        raise BearingTwinError(f'{error}{why and f"; {why}"}') from None


def inhabitants(domain: int, listen: float) -> list[str]:
    """Return the nodes of a domain that are heard within ``listen`` seconds."""
    ensure_log_folder()
    context = rclpy.Context()
    context.init(domain_id=domain)
    node = rclpy.create_node(f'domain_probe_{os.getpid()}', context=context, enable_rosout=False)
    try:
        own = (node.get_name(), node.get_namespace())
        end = time.monotonic() + listen
        while True:
            others = [
                f'{namespace.rstrip("/")}/{name}'
                for name, namespace in node.get_node_names_and_namespaces()
                if (name, namespace) != own
            ]
            # Publishers that are not ROS nodes, such as a bridge, are not in that list.
            if not others and node.count_publishers('/twin_state'):
                others = ['a publisher of /twin_state']
            if others or time.monotonic() > end:
                return sorted(others)
            time.sleep(0.1)
    finally:
        with bounded(LEAVING, 1):
            node.destroy_node()
            context.shutdown()


@contextmanager
def own_domain(first: int, listen: float = LISTEN) -> Iterator[int]:
    """
    Claim an empty domain, so that no other caller uses it at the same time.

    A participant holds one of the ports of the domain even before it has announced itself.
    Listening also finds participants that do not use UDP.

    Parameters
    ----------
    first
        Any number, such as the process id: the search begins at domain ``1 + first % 100``.
    listen
        Time to listen in each domain, s; 0 to check the ports only.

    """
    for step in range(DOMAINS):
        domain = 1 + (first + step) % DOMAINS
        claim = _bind(_port(domain) + CLAIM)
        if claim is None:
            continue
        with claim:
            if _ports_are_held(domain) or (listen and inhabitants(domain, listen)):
                continue
            yield domain
            return
    raise BearingTwinError(f'every ROS domain from 1 to {DOMAINS} is in use on this machine')


def server_port(domain: int) -> int:
    """
    Return a port of a domain that no participant uses, for a server of the claiming process.

    Examples
    --------
    >>> server_port(1)
    7899

    """
    return _port(domain + 1) - 1


def _port(domain: int) -> int:
    return FIRST_PORT + PORTS_A_DOMAIN * domain


def _bind(port: int) -> socket.socket | None:
    """Return a socket that holds a UDP port until it is closed; None if the port is in use."""
    claim = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        claim.bind(('', port))
    except OSError:
        claim.close()
        return None
    return claim


def _ports_are_held(domain: int) -> bool:
    """Return whether a local process holds a port that a participant of the domain would use."""
    for offset in (0, *PARTICIPANTS):
        claim = _bind(_port(domain) + offset)
        if claim is None:
            return True
        claim.close()
    return False
