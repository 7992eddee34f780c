# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Beside one machine: adapter and diagnosis of its accelerometer, its twin, and a recorder.

The twin sends its vibration on ``twin/vibration``, so that each stream has one source. The
recorder takes the namespace of the machine, its temperature and speed wherever they are, and
``/diagnostics``, which all machines share. What dies is started again, the recorder beside what it
has recorded before. All end with the launch.
"""

from bearing_twin.ros.processes.launchfile import (
    Argument,
    launch_description,
    shared,
    WhenRecorded,
)
from launch import LaunchDescription
from launch.substitutions import LaunchConfiguration

WAIT = 'wait_for_subscribers'


def generate_launch_description() -> LaunchDescription:
    """Return the description."""
    measured = {name: LaunchConfiguration(name) for name in ('temperature', 'joint_states')}
    # Where they are not in the namespace.
    beside = [part for topic in measured.values() for part in ('|', topic)]
    return launch_description(
        [
            Argument('namespace', "namespace of the machine, e.g. 'line3/fan_7'", 'machine'),
            Argument('params_file', 'parameter file', shared('config', 'machine.yaml')),
            Argument('samples', 'topic of the accelerometer', 'samples'),
            Argument('temperature', 'topic of the temperature at the outer ring', 'temperature'),
            Argument('joint_states', 'topic of the shaft speed', 'joint_states'),
            Argument('twin', 'run the twin beside the machine', 'true', bool),
            Argument('calibrate', 'fit the twin to the machine', 'false', bool),
            Argument('record', 'record to MCAP', 'true', bool),
            Argument(
                WAIT,
                "subscribers of the twin's vibration for which it waits: the recorder",
                WhenRecorded('1', '0'),
                int,
            ),
            Argument('regex', 'topics to record', ['{namespace}/.*|/diagnostics', *beside]),
            Argument('output', 'bag folder; empty: bearing_twin_DATE-TIME here'),
            Argument('rerun_port', 'port of the Rerun server; empty or 0: none', kind=int),
            Argument('use_sim_time', 'true: follow /clock', kind=bool),
        ],
        nodes={
            'recorder': ('output', 'rerun_port', 'regex'),
            'diagnosis': (),
            'adapter': (),
            'twin': (WAIT,),
            'calibration': (),
        },
        conditions={'recorder': 'record', 'twin': 'twin', 'calibration': 'calibrate'},
        remappings={
            'adapter': {
                'samples': LaunchConfiguration('samples'),
                'imu': LaunchConfiguration('samples'),
            },
            'twin': {'vibration': 'twin/vibration', **measured},
            'diagnosis': measured,
            'calibration': measured,
        },
        respawned=('adapter', 'diagnosis', 'twin', 'calibration', 'recorder'),
    )
