# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Twin and diagnosis of one bearing, recorded and shown in Rerun if asked for.

What is not given as an argument comes from the parameter file.
"""

from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare

FROM_FILE = 'empty: from the parameter file'
ARGUMENTS = (
    ('namespace', '', "namespace of all nodes, e.g. 'line3/bearing_7'"),
    ('params_file', '', 'parameter file (default: config/twin.yaml of this package)'),
    ('bearing', '', f'bearing of the catalogue; {FROM_FILE}'),
    ('preset', '', f'masses, load, clearance and defect size of the twin; {FROM_FILE}'),
    ('defect', '', f"none, inner, outer, ball, cage, or several: 'inner+ball'; {FROM_FILE}"),
    ('thermal_mode', '', f'paper or physical; {FROM_FILE}'),
    ('shaft_hz', '', f'shaft speed while no joint tells it, Hz; {FROM_FILE}'),
    ('record', 'true', 'record everything to MCAP'),
    ('output', '', f'bag folder of the recording; {FROM_FILE}, or bearing_twin_DATE-TIME here'),
    ('rerun_port', '', f'port of the Rerun server on this machine, 0: none; {FROM_FILE}'),
    ('use_sim_time', '', f'true: follow /clock; {FROM_FILE}'),
)
TYPES = {'shaft_hz': float, 'rerun_port': int, 'use_sim_time': bool}


def nodes(context: LaunchContext) -> list[Node]:
    """Return the nodes with the arguments that were given."""
    given = {
        name: ParameterValue(LaunchConfiguration(name), value_type=TYPES.get(name, str))
        for name, _, _ in ARGUMENTS
        if LaunchConfiguration(name).perform(context)
    }

    def node(name: str, *arguments: str, condition: IfCondition | None = None) -> Node:
        chosen = {key: given[key] for key in (*arguments, 'use_sim_time') if key in given}
        return Node(
            package='bearing_twin',
            executable=name,
            namespace=LaunchConfiguration('namespace'),
            parameters=[LaunchConfiguration('params_file'), *([chosen] if chosen else [])],
            condition=condition,
            output='screen',
        )

    return [
        node(
            'recorder',
            'output',
            'rerun_port',
            condition=IfCondition(LaunchConfiguration('record')),
        ),
        node('diagnosis', 'bearing'),
        node('twin', 'bearing', 'preset', 'defect', 'thermal_mode', 'shaft_hz'),
    ]


def generate_launch_description() -> LaunchDescription:
    """Return the description."""
    default_file = PathJoinSubstitution([FindPackageShare('bearing_twin'), 'config', 'twin.yaml'])
    arguments = [
        DeclareLaunchArgument(
            name,
            default_value=default_file if name == 'params_file' else default,
            description=text,
        )
        for name, default, text in ARGUMENTS
    ]
    return LaunchDescription([*arguments, OpaqueFunction(function=nodes)])
