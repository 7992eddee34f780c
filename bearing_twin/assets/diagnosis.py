# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Turn checked blocks of vibration into verdicts and their messages, live and offline."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
import math
from typing import Any, NamedTuple, TYPE_CHECKING

from bearing_twin.assets.checkpoints import Checkpoints
from bearing_twin.assets.messages import diagnosis_message, spectrum_message
from bearing_twin.assets.parameters.diagnosis import (
    build_bearing,
    build_diagnoser,
    build_settings,
    nominal_speed,
)
from bearing_twin.diagnosis.streaming import same_rate
from bearing_twin.errors import BearingTwinError
from bearing_twin.repeats import RepeatCheck, REPEATED
from bearing_twin.stamps import samples_ns
from bearing_twin.streams.samplerate import RateMeter
from bearing_twin.streams.shaft import NEAR, speed_doubt
from bearing_twin.streams.vibration_input import counts_doubt

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing
    from bearing_twin.diagnosis import Diagnosis as DiagnosisResult
    from bearing_twin.diagnosis.chain import Analysis, Excerpt
    from bearing_twin.diagnosis.series.snapshots import SeriesDiagnoser
    from bearing_twin.diagnosis.streaming import StreamingDiagnoser
    from bearing_twin.streams.vibration_input import VibrationBlock
    from bearing_twin_msgs.msg import Checkpoint, Diagnosis, Spectrum


class Verdict(NamedTuple):
    """A verdict and its messages."""

    result: DiagnosisResult
    diagnosis: Diagnosis
    spectrum: Spectrum
    envelope_spectrum: Spectrum


@dataclass(frozen=True)
class DueVerdict:
    """A verdict that is due. Due verdicts must be judged in order."""

    excerpt: Excerpt
    """Samples to analyse, in any thread."""
    block: VibrationBlock
    """The last block of the window."""
    diagnoser: StreamingDiagnoser | SeriesDiagnoser

    def judge(self, analysis: Analysis) -> Verdict:
        """Return the verdict on the window by its analysis."""
        result = self.diagnoser.judge(analysis)
        last, frame_id = self.block, self.block.frame_id
        before = self.excerpt.first_sample - last.first_sample
        stamp = last.stamp + samples_ns(before, last.sample_rate)
        diagnosis = diagnosis_message(
            result, stamp=stamp, frame_id=frame_id, bearing=self.excerpt.bearing.name
        )
        spectrum, envelope_spectrum = (
            spectrum_message(which, result, stamp=stamp, frame_id=frame_id)
            for which in (result.spectrum, result.envelope_spectrum)
        )
        return Verdict(result, diagnosis, spectrum, envelope_spectrum)


class DiagnosisCore:
    """
    Diagnosis with given parameters.

    ``node`` is the full name of the node; it is stored in checkpoints.
    """

    def __init__(self, values: Mapping[str, Any], node: str = '/diagnosis') -> None:
        self.diagnoser = build_diagnoser(values)
        # The state of a series, up to 1 MB, changes only once per cycle.
        period = max(values['checkpoint_period'], values['series_cycle'])
        self.checkpoints = Checkpoints('diagnosis', node, period)
        self._axis = values['axis']
        self.nominal_hz = nominal_speed(values)
        """Shaft speed by parameter, used if none is measured, Hz; NaN if it is not set."""
        self.rate_problem = ''
        """How declared sample rate and stamps contradict each other; '' if they do not."""
        self.unit_problem = ''
        """Why the samples seem to be of another unit than the block says; '' if they do not."""
        self.speed_problem = ''
        """Why the velocity of the joint seems to be in another unit; '' if it does not."""
        self._was_nominal = False
        self._rate_meter, self._declared = RateMeter(), 0.0
        self._repeat = RepeatCheck()
        self._former: VibrationBlock | None = None

    @property
    def bearing(self) -> Bearing:
        """Bearing in use."""
        return self.diagnoser.bearing

    def needs_checkpoint(self, block: VibrationBlock) -> bool:
        """
        Return whether a checkpoint is due before a block.

        After a gap one tells which samples the diagnosis has not had.
        """
        gap = self.diagnoser.has_gap(block.first_sample, block.sample_rate)
        return gap or self.checkpoints.is_due(block.first_sample)

    def reconfigure(self, values: Mapping[str, Any]) -> None:
        """Apply changed parameters; a new window begins, the baseline stays."""
        self.checkpoints.ask()
        self.nominal_hz, self._was_nominal = nominal_speed(values), False
        settings = build_settings(values)
        if bool(settings.series_cycle) != bool(self.diagnoser.settings.series_cycle):
            self.diagnoser = build_diagnoser(values)
        self.diagnoser.reconfigure(build_bearing(values), settings)

    def checkpoint(self, block: VibrationBlock, configuration: str) -> Checkpoint:
        """Return the checkpoint before a block; ``configuration`` holds the parameters (YAML)."""
        return self.checkpoints.make(
            block.first_sample,
            stamp=block.stamp,
            sample_rate=block.sample_rate,
            configuration=configuration,
            state=self.diagnoser.save(),
        )

    def admit(self, block: VibrationBlock) -> None:
        """
        Check a block against its stamp and the block before; call this before :meth:`take`.

        Raises
        ------
        BearingTwinError
            If the block has the samples of the block before, or if the declared sample rate is so
            wrong that no verdict can be trusted.

        """
        if self._repeat.repeats(block.samples):
            raise BearingTwinError(REPEATED)
        if not same_rate(self._declared, block.sample_rate):
            # A source that was set to another rate: the former one says nothing of it. One that
            # measures its rate states a slightly different one with each block.
            self._rate_meter, self._declared = RateMeter(), block.sample_rate
        self.unit_problem = counts_doubt(block)
        self._rate_meter.take(block.first_sample, block.stamp)
        problem = self._rate_meter.problem(block.sample_rate)
        self.rate_problem = problem.text if problem else ''
        if problem and problem.refused:
            raise BearingTwinError(problem.text)

    def take(
        self, block: VibrationBlock, *, temperature: float, joint_hz: float
    ) -> list[DueVerdict]:
        """
        Take one block; return the verdicts that are due.

        While the rate is not measured and the stamps contradict the declared one, none is.

        Parameters
        ----------
        block
            The block.
        temperature
            Temperature of the bearing, degC; NaN if unknown.
        joint_hz
            Shaft speed from a joint, Hz, used if the block has none; NaN: use the parameter.

        """
        series = bool(self.diagnoser.settings.series_cycle)
        ended = self.diagnoser.next_sample if series and not self.diagnoser.may_pause else None
        # Order of trust: the block, then the joint, then the parameter (nameplate speed).
        measured = joint_hz if math.isnan(block.shaft_hz) else block.shaft_hz
        # A shaft that has turned as fast as given is given in rad/s: it may slow down.
        self._was_nominal |= abs(joint_hz - self.nominal_hz) <= NEAR * self.nominal_hz
        self.speed_problem = '' if self._was_nominal else speed_doubt(joint_hz, self.nominal_hz)
        excerpts = self.diagnoser.take(
            block.first_sample,
            block.samples,
            block.sample_rate,
            self.nominal_hz if math.isnan(measured) else measured,
            speed_measured=not math.isnan(measured),
            temperature=temperature,
            unit=block.unit,
            sensor=f'{block.frame_id} {self._axis}'.strip()
            + (' simulated' if block.simulated else ''),
        )
        if excerpts and series:
            # The next block may come one cycle later.
            self.checkpoints.ask()
        former, self._former = self._former or block, block
        if self._rate_meter.doubts(block.sample_rate):
            return []
        # A snapshot that a pause or a restart of the source cuts short ended with the one before.
        return [
            DueVerdict(excerpt, former if excerpt.end == ended else block, self.diagnoser)
            for excerpt in excerpts
        ]
