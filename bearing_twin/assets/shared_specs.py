# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Parameters that several nodes have alike."""

from __future__ import annotations

from bearing_twin.assets.spec import Spec

__all__ = [
    'CHECKPOINT_PERIOD',
    'GEOMETRY',
    'HARDWARE_ID',
    'JOINT',
    'STATE_DIRECTORY',
    'STATE_RATE',
    'SUBSCRIBERS',
]

CHECKPOINT_PERIOD = Spec(
    name='checkpoint_period',
    default=10.0,
    description='Time between checkpoints, from which a recording can be re-run.',
    unit='s',
    low=1.0,
    high=3600.0,
    running=False,
)

GEOMETRY = Spec(
    name='geometry',
    default='',
    description="Own bearing as 'Z,D_BALL_MM,D_PITCH_MM,ANGLE_DEG', used where bearing is ''.",
)

HARDWARE_ID = Spec(
    name='hardware_id',
    default='',
    description="Asset that /diagnostics speaks of; '' for the node's namespace.",
    running=False,
)

JOINT = Spec(
    name='joint',
    default='',
    description="Joint of joint_states that turns with the shaft; '' for none.",
    running=False,
)

STATE_DIRECTORY = Spec(
    name='state_directory',
    default='',
    description="Folder of saved states; '' for bearing_twin in ROS_HOME (~/.ros).",
    running=False,
)

STATE_RATE = Spec(
    name='state_rate',
    default=0.0,
    description='States a second of each twin, besides one at once where an input, a parameter or '
    'a counter has changed; 0: one a block.',
    unit='Hz',
    low=0.0,
    high=1000.0,
    running=False,
)

SUBSCRIBERS = Spec(
    name='wait_for_subscribers',
    default=0,
    description='Subscribers of vibration for which the first block waits, for 10 s at most.',
    low=0,
    high=100,
    running=False,
)
