# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Twin and diagnosis of one bearing, recorded and shown in Rerun if asked for."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare

ARGUMENTS = (
    ('namespace', '', "namespace of all nodes, e.g. 'line3/bearing_7'"),
    ('params_file', '', 'parameter file (default: config/twin.yaml of this package)'),
    ('bearing', '6307', 'bearing of the catalogue'),
    ('preset', 'incipient', 'masses, load, clearance and defect size of the twin'),
    ('defect', 'none', "none, inner, outer, ball, cage, or several: 'inner+ball'"),
    ('thermal_mode', 'paper', 'paper or physical'),
    ('shaft_hz', '25.4', 'shaft speed while no joint tells it, Hz'),
    ('record', 'true', 'record everything to MCAP'),
    ('output', '', 'bag folder of the recording; empty: bearing_twin_DATE-TIME here'),
    ('rerun_port', '9876', 'port of the Rerun server on this machine; 0: none'),
    ('use_sim_time', 'false', 'follow /clock'),
)


def generate_launch_description() -> LaunchDescription:
    """Return the description."""
    given = {name: LaunchConfiguration(name) for name, _, _ in ARGUMENTS}
    default_file = PathJoinSubstitution([FindPackageShare('bearing_twin'), 'config', 'twin.yaml'])
    arguments = [
        DeclareLaunchArgument(
            name,
            default_value=default_file if name == 'params_file' else default,
            description=text,
        )
        for name, default, text in ARGUMENTS
    ]
    clock = {'use_sim_time': ParameterValue(given['use_sim_time'], value_type=bool)}
    bearing = {'bearing': ParameterValue(given['bearing'], value_type=str)}
    twin = Node(
        package='bearing_twin',
        executable='twin',
        namespace=given['namespace'],
        parameters=[
            given['params_file'],
            clock,
            bearing,
            {
                'preset': given['preset'],
                'defect': given['defect'],
                'thermal_mode': given['thermal_mode'],
                'shaft_hz': ParameterValue(given['shaft_hz'], value_type=float),
            },
        ],
        output='screen',
    )
    diagnosis = Node(
        package='bearing_twin',
        executable='diagnosis',
        namespace=given['namespace'],
        parameters=[given['params_file'], clock, bearing],
        output='screen',
    )
    recorder = Node(
        package='bearing_twin',
        executable='recorder',
        namespace=given['namespace'],
        parameters=[
            clock,
            {
                'output': ParameterValue(given['output'], value_type=str),
                'rerun_port': ParameterValue(given['rerun_port'], value_type=int),
            },
        ],
        condition=IfCondition(given['record']),
        output='screen',
    )
    return LaunchDescription([*arguments, recorder, diagnosis, twin])
