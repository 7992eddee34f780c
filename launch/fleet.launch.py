# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Many bearings in one process, from a YAML of assets; recorded and shown if asked for.

What is not given as an argument comes from the parameter file, if there is one.
"""

from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare

ARGUMENTS = (
    ('assets_file', '', 'YAML of assets (default: config/fleet.yaml of this package)'),
    ('namespace', '', 'namespace of all nodes'),
    ('params_file', '', 'parameter file for fleet and recorder; empty: none'),
    ('record', 'false', 'record to MCAP'),
    ('output', '', 'bag folder; empty: bearing_twin_DATE-TIME here'),
    ('rerun_port', '', 'port of the Rerun server on this machine; empty or 0: none'),
    ('use_sim_time', '', 'true: follow /clock'),
)
TYPES = {'rerun_port': int, 'use_sim_time': bool}


def nodes(context: LaunchContext) -> list[Node]:
    """Return the nodes with the arguments that were given."""
    given = {
        name: ParameterValue(LaunchConfiguration(name), value_type=TYPES.get(name, str))
        for name, _, _ in ARGUMENTS
        if LaunchConfiguration(name).perform(context)
    }
    file = LaunchConfiguration('params_file').perform(context)

    def node(name: str, *arguments: str, condition: IfCondition | None = None) -> Node:
        chosen = {key: given[key] for key in (*arguments, 'use_sim_time') if key in given}
        return Node(
            package='bearing_twin',
            executable=name,
            namespace=LaunchConfiguration('namespace'),
            parameters=[*([file] if file else []), *([chosen] if chosen else [])],
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
        node('fleet', 'assets_file'),
    ]


def generate_launch_description() -> LaunchDescription:
    """Return the description."""
    example = PathJoinSubstitution([FindPackageShare('bearing_twin'), 'config', 'fleet.yaml'])
    arguments = [
        DeclareLaunchArgument(
            name,
            default_value=example if name == 'assets_file' else default,
            description=text,
        )
        for name, default, text in ARGUMENTS
    ]
    return LaunchDescription([*arguments, OpaqueFunction(function=nodes)])
