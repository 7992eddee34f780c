# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Names and types of the topics of the nodes, and constants of their messages."""

CALIBRATION = 'bearing_twin_msgs/msg/Calibration'
CHECKPOINT = 'bearing_twin_msgs/msg/Checkpoint'
DIAGNOSIS = 'bearing_twin_msgs/msg/Diagnosis'
DIAGNOSTICS = 'diagnostic_msgs/msg/DiagnosticArray'
JOINT_STATE = 'sensor_msgs/msg/JointState'
LOG = 'rcl_interfaces/msg/Log'
SPECTRUM = 'bearing_twin_msgs/msg/Spectrum'
TEMPERATURE = 'sensor_msgs/msg/Temperature'
TEXT = 'std_msgs/msg/String'
TWIN_STATE = 'bearing_twin_msgs/msg/TwinState'
VIBRATION = 'bearing_twin_msgs/msg/Vibration'

LEVEL_OK, LEVEL_SUSPECT, LEVEL_FAULT, LEVEL_NONE = range(4)
"""Constants of a Diagnosis message."""

FEATURES = ('result', 'level', 'strongest_score', 'strongest_modulation_index', 'fault_hz', 'rms')
"""
Fields of a Diagnosis that a diagnosis node also publishes on one topic each.

Rerun itself opens seven line plots of a recording: these fields and the temperature.
"""

OWN_TOPICS = {
    'temperature': TEMPERATURE,
    'joint_states': JOINT_STATE,
    'vibration': VIBRATION,
    'twin_state': TWIN_STATE,
    'twin_checkpoint': CHECKPOINT,
    'diagnosis': DIAGNOSIS,
    'diagnosis_checkpoint': CHECKPOINT,
    'calibration': CALIBRATION,
    'envelope_spectrum': SPECTRUM,
    'spectrum': SPECTRUM,
    **{f'features/{name}': 'std_msgs/msg/Float64MultiArray' for name in FEATURES},
}
"""Relative topic name and message type."""


def is_feature(topic: str) -> bool:
    """
    Return whether a topic repeats a field of a Diagnosis, for viewers without this message type.

    >>> is_feature('/line3/features/rms'), is_feature('/line3/diagnosis')
    (True, False)

    """
    *_, above, name = ('', *topic.split('/'))
    return above == 'features' and name in FEATURES
