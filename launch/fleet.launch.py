# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Many bearings in one process, from a YAML of assets; recorded and shown if asked for.

What is not given as an argument comes from the parameter file, if there is one.
"""

from bearing_twin.ros.processes.launchfile import (
    Argument,
    launch_description,
    shared,
    WhenRecorded,
)
from launch import LaunchDescription


def generate_launch_description() -> LaunchDescription:
    """Return the description."""
    return launch_description(
        [
            Argument('assets_file', 'YAML of assets', shared('config', 'fleet.yaml')),
            Argument('namespace', 'namespace of all nodes'),
            Argument('params_file', 'parameter file for fleet and recorder; empty: none'),
            Argument('record', 'record to MCAP', 'false', bool),
            Argument(
                'wait_for_subscribers',
                'subscribers of each vibration for which the first block waits: the recorder',
                WhenRecorded('1', '0'),
                int,
            ),
            Argument('output', 'bag folder; empty: bearing_twin_DATE-TIME here'),
            Argument(
                'rerun_port',
                'port of the Rerun server on this machine; empty or 0: none',
                kind=int,
            ),
            Argument('use_sim_time', 'true: follow /clock', kind=bool),
        ],
        nodes={
            'recorder': ('output', 'rerun_port'),
            'fleet': ('assets_file', 'wait_for_subscribers'),
        },
        conditions={'recorder': 'record'},
    )
