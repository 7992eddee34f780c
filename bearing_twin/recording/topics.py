# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Names and types of the topics of twin and diagnosis."""

__all__ = ['OWN_TOPICS']

OWN_TOPICS = {
    'temperature': 'sensor_msgs/msg/Temperature',
    'joint_states': 'sensor_msgs/msg/JointState',
    'vibration': 'bearing_twin_msgs/msg/Vibration',
    'twin_state': 'bearing_twin_msgs/msg/TwinState',
    'twin_checkpoint': 'bearing_twin_msgs/msg/Checkpoint',
    'diagnosis': 'bearing_twin_msgs/msg/Diagnosis',
    'diagnosis_checkpoint': 'bearing_twin_msgs/msg/Checkpoint',
    'envelope_spectrum': 'bearing_twin_msgs/msg/Spectrum',
    'spectrum': 'bearing_twin_msgs/msg/Spectrum',
    'features': 'std_msgs/msg/Float64MultiArray',
}
"""Relative name and type."""
