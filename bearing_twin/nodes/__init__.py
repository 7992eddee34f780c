# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""ROS 2 nodes: thin adapters around the core."""

from importlib.util import find_spec

from bearing_twin import threads as threads
from bearing_twin.errors import BearingTwinError

if find_spec('bearing_twin_msgs') is None:
    raise BearingTwinError(
        "bearing_twin_msgs is not there: build it with 'colcon build --base-paths . msg_defs' in "
        "the folder of bearing_twin and source install/setup.bash, or 'pip install ./msg_defs'"
    )

for _name in ('mcap', 'rosbags'):
    if find_spec(_name) is None:
        msg = f"{_name} is not there, and rosdep does not bring it: 'pip install mcap rosbags'"
        raise BearingTwinError(msg)
