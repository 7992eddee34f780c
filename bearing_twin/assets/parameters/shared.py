# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Parameters that several nodes have in common."""

from __future__ import annotations

from bearing_twin.assets.parameters.spec import fixed, parameter

AUTOSTART = fixed(
    'autostart', True, 'Configure and activate at start; false leaves that to a lifecycle '
    'manager.', read_only=True,
)  # fmt: skip

CHECKPOINT_PERIOD = fixed(
    'checkpoint_period', 10.0, 'Time between checkpoints, from which a recording can be re-run.',
    's', 1.0, 3600.0,
)  # fmt: skip

GEOMETRY = parameter(
    'geometry', '', "Own bearing as 'Z,D_BALL_MM,D_PITCH_MM,ANGLE_DEG', or for a diagnosis its "
    "fault orders 'BPFO=ORDER,BPFI=ORDER,BSF=ORDER'; used where bearing is ''."
)  # fmt: skip

HARDWARE_ID = fixed(
    'hardware_id', '', "Asset named on /diagnostics; '': the namespace of the node."
)

JOINT = fixed('joint', '', "Joint of joint_states that turns with the shaft; '' for none.")

STATE_DIRECTORY = fixed(
    'state_directory', '', "Folder of saved states; '' for bearing_twin in ROS_HOME (~/.ros)."
)

STATE_OWNER = fixed(
    'state_owner', '', 'Full name under which the node learnt the state, if it was another.',
)  # fmt: skip

STATE_RATE = fixed(
    'state_rate', 0.0, 'Rate of twin_state of each twin; a change of an input, a parameter or a '
    'counter is published at once besides. 0: one a block.', 'Hz', 0.0, 1000.0,
)  # fmt: skip

SUBSCRIBERS = fixed(
    'wait_for_subscribers', 0, 'Subscribers of vibration for which the first block waits, at most '
    '10 s.', '', 0, 100,
)  # fmt: skip
