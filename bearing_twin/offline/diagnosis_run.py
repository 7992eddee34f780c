# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Run a diagnosis without node, DDS or clock: vibration messages in, output messages out."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
import math
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.checkpoints import parameters_of
from bearing_twin.assets.diagnosis import DiagnosisCore
from bearing_twin.assets.messages import features_messages
from bearing_twin.diagnosis.streaming import StreamingDiagnoser
from bearing_twin.offline.output import output
from bearing_twin.streams.vibration_input import read_vibration
import yaml

if TYPE_CHECKING:
    from bearing_twin.assets.diagnosis import Verdict
    from bearing_twin.offline.output import Output
    from bearing_twin.streams.vibration_input import VibrationBlock


class DiagnosisRun(DiagnosisCore):
    """Process vibration messages one after the other, as the diagnosis node does."""

    def __init__(self, values: Mapping[str, Any], state: bytes | None = None) -> None:
        with parameters_of('diagnosis'):
            super().__init__(values)
        self.values = dict(values)
        self.counts: Counter[str] = Counter()
        """Number of verdicts so far, by result."""
        if state is not None:
            self.diagnoser.load(state)

    def first_needed_sample(self, sample: int) -> int:
        """
        Return the index of the first sample needed to go on at ``sample`` with the loaded state.

        A series needs none before it: with its state it begins a new snapshot.
        """
        if isinstance(self.diagnoser, StreamingDiagnoser):
            return self.diagnoser.first_needed_sample(sample)
        return sample

    def reconfigure(self, values: Mapping[str, Any]) -> None:
        """Change parameters as the running node does; a new window begins."""
        self.values = dict(values)
        super().reconfigure(values)

    def checkpoint_output(self, block: VibrationBlock) -> Output:
        """Return the checkpoint before a block as the node publishes it."""
        text = yaml.safe_dump(self.values)
        return output('/diagnosis_checkpoint', self.checkpoint(block, text))

    def push(self, message: Any, *, temperature: float) -> Iterator[Output]:
        """
        Yield the node's messages for one vibration message of a file at a temperature, degC.

        A program may have made the file, with blocks that repeat the one before: none is refused.
        """
        block = read_vibration(message, self.values['axis'])
        for due in self.take(block, temperature=temperature, joint_hz=math.nan):
            yield from self.outputs(due.judge(due.excerpt.analyse()))

    def outputs(self, verdict: Verdict) -> Iterator[Output]:
        """Yield the messages that the node publishes for a verdict."""
        self.counts[verdict.result.result] += 1
        yield output('/diagnosis', verdict.diagnosis)
        for name, message in features_messages(verdict.diagnosis).items():
            yield output(f'/features/{name}', message)
        yield output('/spectrum', verdict.spectrum)
        yield output('/envelope_spectrum', verdict.envelope_spectrum)
