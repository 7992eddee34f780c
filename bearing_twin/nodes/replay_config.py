# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the replay node."""

from __future__ import annotations

from bearing_twin.errors import BearingTwinError
from bearing_twin.nodes.parameters import Spec

__all__ = ['SPECS', 'remapping']

SPECS = (
    Spec(
        name='recording',
        default='',
        description='MCAP file or bag folder to replay.',
        running=False,
    ),
    Spec(
        name='rate',
        default=1.0,
        description='Pace: recorded seconds per second.',
        low=0.001,
        high=1e6,
    ),
    Spec(name='loop', default=False, description='Start again at the end.', running=False),
    Spec(
        name='start_offset',
        default=0.0,
        description='Recorded time to skip at the start.',
        unit='s',
        low=0.0,
        high=1e9,
        running=False,
    ),
    Spec(
        name='duration',
        default=0.0,
        description='Recorded time to replay; 0: to the end.',
        unit='s',
        low=0.0,
        high=1e9,
        running=False,
    ),
    Spec(
        name='topics',
        default=[''],
        description='Topics to replay; none given: all.',
        running=False,
    ),
    Spec(
        name='remap',
        default=[''],
        description="Other names for recorded topics, each as 'recorded:=new'.",
        running=False,
    ),
    Spec(
        name='clock_rate',
        default=0.0,
        description='Rate of /clock, which then follows recorded time; 0: no /clock.',
        unit='Hz',
        low=0.0,
        high=1000.0,
        running=False,
    ),
    Spec(name='start_paused', default=False, description='Wait for ~/resume.', running=False),
    Spec(
        name='wait_for_subscribers',
        default=3.0,
        description='Longest wait at the start until every topic has a subscriber.',
        unit='s',
        low=0.0,
        high=3600.0,
        running=False,
    ),
    Spec(
        name='exit_at_end',
        default=True,
        description='End the process when everything has been replayed.',
        running=False,
    ),
)


def remapping(rules: list[str]) -> dict[str, str]:
    """
    Read rules ``recorded:=new``.

    Raises
    ------
    BearingTwinError
        If one does not read so.

    """
    names = {}
    for rule in filter(None, rules):
        recorded, separator, new = rule.partition(':=')
        if not (recorded and separator and new):
            msg = f"remap='{rule}' does not read 'recorded:=new'"
            raise BearingTwinError(msg)
        names[recorded] = new
    return names
