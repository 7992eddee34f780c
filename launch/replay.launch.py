# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Play a recording onto ROS; by default the temperature schedule of the paper."""

from bearing_twin.ros.processes.launchfile import Argument, launch_description, shared
from launch import LaunchDescription


def generate_launch_description() -> LaunchDescription:
    """Return the description."""
    arguments = [
        Argument('recording', 'file or bag', shared('recordings', 'paper_schedule.mcap')),
        Argument('rate', 'pace', '1.0', float),
        Argument('loop', 'start again at the end', 'false', bool),
        Argument('start_offset', 's to skip', '0.0', float),
        Argument('clock_rate', 'rate of /clock, Hz; 0: no /clock', '0.0', float),
        Argument('namespace', 'namespace of the node'),
    ]
    return launch_description(
        arguments, nodes={'replay': ('recording', 'rate', 'loop', 'start_offset', 'clock_rate')}
    )
