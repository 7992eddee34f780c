# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Diagnosis node: vibration in, verdict and spectra out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bearing_twin.assets.parameters.diagnosis import check_diagnosis, SPECS
from bearing_twin.diagnosis.compilation import warm_up
from bearing_twin.nodes.diagnosis_topics import DiagnosisTopics
from bearing_twin.ros.health import Health
from bearing_twin.ros.lifecycle import ManagedNode


class DiagnosisNode(ManagedNode):
    """Diagnose vibration from the twin or from a real accelerometer."""

    def __init__(self) -> None:
        super().__init__('diagnosis', SPECS)

    def check(self, values: Mapping[str, Any]) -> None:
        """Refuse parameters that contradict each other."""
        check_diagnosis(values)

    def prepare(self) -> None:
        """Compile the numerical functions."""
        warm_up()

    def setup(self) -> None:
        """Build the diagnosis; create publishers, the reset service and the statuses."""
        p = self.parameters
        self._topics = DiagnosisTopics(self, p)
        self.offer('~/reset', self._topics.reset)
        self.health = Health(self, p['hardware_id'] or self.get_namespace())
        self.health.add('vibration input', self._topics.input_status)
        self.health.add('bearing', self._topics.verdict_status)

    def start(self) -> None:
        """Subscribe to the inputs."""
        self._topics.listen()
        self.get_logger().info(f'diagnosing bearing {self._topics.bearing}')

    def stop(self) -> None:
        """Save baseline and trend."""
        self._topics.keep_state()

    def apply(self, values: Mapping[str, Any]) -> None:
        """Apply changed parameters; a change of the bearing restarts the window."""
        self._topics.apply(values)


NODE = DiagnosisNode
