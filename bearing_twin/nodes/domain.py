# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A ROS domain in which nobody else is, for runs that must hear only themselves."""

from __future__ import annotations

import os
import time

from bearing_twin.errors import BearingTwinError
import rclpy

__all__ = ['HIGHEST_DOMAIN', 'check_domain', 'inhabitants', 'quiet_domain']

HIGHEST_DOMAIN = 232
"""Above it the port numbers of DDS end."""
DOMAINS = 100
"""Domains 1 to 100 keep clear of the ports that Linux hands out by itself."""
LISTEN = 1.5
"""Time in which whoever is there has announced itself, s."""


def inhabitants(domain: int, listen: float = LISTEN) -> list[str]:
    """
    Return the nodes of a domain, heard from this machine.

    Parameters
    ----------
    domain
        The domain.
    listen
        Longest time to listen, s; whoever is heard earlier ends it.

    """
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
            # Publishers that are no ROS nodes, such as a bridge, are nobody's in the list.
            if not others and node.count_publishers('/twin_state'):
                others = ['a publisher of /twin_state']
            if others or time.monotonic() > end:
                return sorted(others)
            time.sleep(0.1)
    finally:
        node.destroy_node()
        context.shutdown()


def check_domain(domain: int) -> None:
    """Raise BearingTwinError unless ``domain`` can be used and nobody is in it."""
    if not 0 <= domain <= HIGHEST_DOMAIN:
        msg = f'ROS domain {domain} is not within 0..{HIGHEST_DOMAIN}'
        raise BearingTwinError(msg)
    others = inhabitants(domain)
    if others:
        msg = f'in ROS domain {domain} there is {others[0]} already; name another, or none'
        raise BearingTwinError(msg)


def quiet_domain(first: int, listen: float = LISTEN) -> int:
    """
    Return the first domain from ``1 + first % 100`` on in which nobody is heard.

    Parameters
    ----------
    first
        Where to begin, such as the process id.
    listen
        Time to listen in each, s.

    Raises
    ------
    BearingTwinError
        If every domain is in use.

    """
    for step in range(DOMAINS):
        domain = 1 + (first + step) % DOMAINS
        if not inhabitants(domain, listen):
            return domain
    msg = f'every ROS domain from 1 to {DOMAINS} is in use on this machine'
    raise BearingTwinError(msg)
