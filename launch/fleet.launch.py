# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Many bearings in one process, from a YAML of assets; recorded and shown if asked for."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare


def generate_launch_description() -> LaunchDescription:
    """Return the description."""
    example = PathJoinSubstitution([FindPackageShare('bearing_twin'), 'config', 'fleet.yaml'])
    arguments = [
        DeclareLaunchArgument('assets_file', default_value=example, description='YAML of assets'),
        DeclareLaunchArgument('namespace', default_value='', description='namespace of all nodes'),
        DeclareLaunchArgument('record', default_value='false', description='record to MCAP'),
        DeclareLaunchArgument(
            'output',
            default_value='',
            description='bag folder; empty: bearing_twin_DATE-TIME here',
        ),
        DeclareLaunchArgument(
            'rerun_port', default_value='0', description='port of the Rerun server; 0: none'
        ),
        DeclareLaunchArgument('use_sim_time', default_value='false', description='follow /clock'),
    ]
    clock = {'use_sim_time': ParameterValue(LaunchConfiguration('use_sim_time'), value_type=bool)}
    fleet = Node(
        package='bearing_twin',
        executable='fleet',
        namespace=LaunchConfiguration('namespace'),
        parameters=[
            clock,
            {
                'assets_file': ParameterValue(LaunchConfiguration('assets_file'), value_type=str),
            },
        ],
        output='screen',
    )
    recorder = Node(
        package='bearing_twin',
        executable='recorder',
        namespace=LaunchConfiguration('namespace'),
        parameters=[
            clock,
            {
                'output': ParameterValue(LaunchConfiguration('output'), value_type=str),
                'rerun_port': ParameterValue(LaunchConfiguration('rerun_port'), value_type=int),
            },
        ],
        condition=IfCondition(LaunchConfiguration('record')),
        output='screen',
    )
    return LaunchDescription([*arguments, recorder, fleet])
