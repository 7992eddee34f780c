# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Names and types of the topics of the twin and diagnosis nodes."""

FEATURES = (
    'result',
    'level',
    'strongest_score',
    'strongest_modulation_index',
    'fault_hz',
    'rms',
)
"""
Fields of a Diagnosis that a diagnosis node also publishes on one topic each.

Rerun itself opens seven line plots of a recording: these fields and the temperature.
"""

OWN_TOPICS = {
    'temperature': 'sensor_msgs/msg/Temperature',
    'joint_states': 'sensor_msgs/msg/JointState',
    'vibration': 'bearing_twin_msgs/msg/Vibration',
    'twin_state': 'bearing_twin_msgs/msg/TwinState',
    'twin_checkpoint': 'bearing_twin_msgs/msg/Checkpoint',
    'diagnosis': 'bearing_twin_msgs/msg/Diagnosis',
    'diagnosis_checkpoint': 'bearing_twin_msgs/msg/Checkpoint',
    'calibration': 'bearing_twin_msgs/msg/Calibration',
    'envelope_spectrum': 'bearing_twin_msgs/msg/Spectrum',
    'spectrum': 'bearing_twin_msgs/msg/Spectrum',
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
