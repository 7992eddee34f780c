# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Play a recording onto ROS; by default the temperature schedule of the paper."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare


def generate_launch_description() -> LaunchDescription:
    """Return the description."""
    schedule = PathJoinSubstitution(
        [FindPackageShare('bearing_twin'), 'recordings', 'paper_schedule.mcap']
    )
    arguments = [
        DeclareLaunchArgument('recording', default_value=schedule, description='file or bag'),
        DeclareLaunchArgument('rate', default_value='1.0', description='pace'),
        DeclareLaunchArgument('loop', default_value='false', description='start again at the end'),
        DeclareLaunchArgument('start_offset', default_value='0.0', description='s to skip'),
        DeclareLaunchArgument(
            'clock_rate', default_value='0.0', description='rate of /clock, Hz; 0: no /clock'
        ),
        DeclareLaunchArgument('namespace', default_value='', description='namespace of the node'),
    ]
    replay = Node(
        package='bearing_twin',
        executable='replay',
        namespace=LaunchConfiguration('namespace'),
        parameters=[
            {
                'recording': ParameterValue(LaunchConfiguration('recording'), value_type=str),
                'rate': ParameterValue(LaunchConfiguration('rate'), value_type=float),
                'loop': ParameterValue(LaunchConfiguration('loop'), value_type=bool),
                'start_offset': ParameterValue(
                    LaunchConfiguration('start_offset'), value_type=float
                ),
                'clock_rate': ParameterValue(LaunchConfiguration('clock_rate'), value_type=float),
            }
        ],
        output='screen',
    )
    return LaunchDescription([*arguments, replay])
