# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Twin and diagnosis of one bearing, recorded and shown in Rerun if asked for.

What is not given as an argument comes from the parameter file.
"""

from bearing_twin.ros.processes.launchfile import (
    Argument,
    launch_description,
    shared,
    WhenRecorded,
)
from launch import LaunchDescription

WAIT = 'wait_for_subscribers'
FILE = 'empty: from the parameter file'


def generate_launch_description() -> LaunchDescription:
    """Return the description."""
    return launch_description(
        [
            Argument('namespace', "namespace of all nodes, e.g. 'line3/bearing_7'"),
            Argument('params_file', 'parameter file', shared('config', 'twin.yaml')),
            Argument('bearing', f'bearing of the catalogue; {FILE}'),
            Argument('preset', f'masses, load, clearance and defect size of the twin; {FILE}'),
            Argument('defect', f"none, inner, outer, ball, cage, or 'inner+ball'; {FILE}"),
            Argument('thermal_mode', f'paper or physical; {FILE}'),
            Argument('shaft_hz', f'shaft speed while no joint tells it, Hz; {FILE}', kind=float),
            Argument('record', 'record everything to MCAP', 'true', bool),
            Argument(
                WAIT,
                'subscribers of vibration for which the twin waits: recorder and diagnosis',
                WhenRecorded('2', '1'),
                int,
            ),
            Argument('output', f'bag folder; {FILE}, or bearing_twin_DATE-TIME here'),
            Argument(
                'rerun_port',
                f'port of the Rerun server on this machine, 0: none; {FILE}',
                kind=int,
            ),
            Argument('use_sim_time', f'true: follow /clock; {FILE}', kind=bool),
        ],
        nodes={
            'recorder': ('output', 'rerun_port'),
            'diagnosis': ('bearing',),
            'twin': ('bearing', 'preset', 'defect', 'thermal_mode', 'shaft_hz', WAIT),
        },
        conditions={'recorder': 'record'},
    )
