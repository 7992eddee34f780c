# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Schedule the calibrations of a twin from blocks of vibration, and build their messages."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import replace
import json
import math
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.calibration.fitted import GEOMETRY, Similarity
from bearing_twin.assets.calibration.record import Record
from bearing_twin.assets.calibration.task import Task
from bearing_twin.assets.calibration.verdict import NewestVerdict, RecordVerdict
from bearing_twin.assets.messages import floats, message_header
from bearing_twin.assets.parameters.diagnosis import build_bearing
from bearing_twin.calibration import Calibration as FitResult
from bearing_twin.calibration.candidates.passage import load_range
from bearing_twin.calibration.fit import decimated
from bearing_twin.calibration.residual import MOVED, ResidualDecision, Residuals
from bearing_twin.diagnosis.streaming import same_rate
from bearing_twin.dynamics.equations.sensor_path import BAND_HZ
from bearing_twin.dynamics.parameters import check_bearing
from bearing_twin.errors import BearingTwinError
from bearing_twin.packed import pack, unpack
from bearing_twin.quantity import signed
from bearing_twin.stamps import samples_ns
from bearing_twin.streams.samplerate import off_rate, REFUSED
from bearing_twin_msgs.msg import Calibration
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.assets.calibration.task import Fit
    from bearing_twin.calibration.answer.impacts import Impacts
    from bearing_twin.streams.vibration_input import VibrationBlock
    from bearing_twin_msgs.msg import Diagnosis


_VERSION = 2005
SHARE = 1.0 / 3.0
"""Largest average share of one core for the fits: 10 s in 30 s."""
MOST_SEEN = 100
"""Number of earlier fits, at other speeds, whose impact spacing is compared with the newest."""
DECISION_S = 60.0
"""Time between two decisions on the residual, s; its alarm rate is derived for this interval."""
STALE_PERIODS = 3.0
"""Age from which on the newest calibration is stale, in periods between calibrations."""
REPAIRED_S = 60.0
"""Time for which a bearing with a defect has to be healthy again to count as replaced, s. The
diagnosis holds a verdict over several windows of a few seconds each."""
REPAIRED = (
    'a defect was named and is gone since the healthy twin was fitted: if the bearing was '
    'repaired, call ~/reset to learn it anew'
)


class CalibrationCore:
    """Calibration with given parameters, without clocks, threads or topics."""

    def __init__(self, values: Mapping[str, Any]) -> None:
        self._values = values
        self.bearing = build_bearing(values)
        low, high = values['load_low'], values['load_high']
        if bool(low) != bool(high) or low > high:
            msg = f'load_low={low} N and load_high={high} N are no range; give both, or neither'
            raise BearingTwinError(msg)
        self._load = (low, high) if high else None
        check_bearing(self.bearing)
        load_range(self.bearing, self._load)
        self._record = Record()
        self._newest_verdict = NewestVerdict(self.bearing)
        self._next = self._rested = self._decided = self._compared = -math.inf
        self._residuals = Residuals()
        self._reference: dict[str, Any] | None = None
        self._seen: deque[Impacts] = deque(maxlen=MOST_SEEN)
        self._latest: FitResult | None = None
        self._concluded = -math.inf
        self._repairs = 0
        # To detect a repair: whether a defect was named, and since when the bearing is healthy.
        self._damaged, self._well_since = False, math.inf
        self._changed = ''
        self.unexplained = ResidualDecision(math.nan, '', math.nan, 'nothing was fitted yet')
        self.waiting = ''
        """What a fit needs besides vibration; '' if nothing is missing."""

    @property
    def progress(self) -> str:
        """Sentence on the length of the vibration collected so far."""
        record = self._record
        held = record.held / record.sample_rate if record.held else 0.0
        return f'{held:.1f} s of vibration of the {self._values["window"]:g} s that a fit takes'

    def verdict(self, message: Diagnosis) -> None:
        """Take a verdict; it determines the place of the defect, and whether the machine is ok."""
        record = self._record
        self._newest_verdict.take(message, record.newest.frame_id if record.held else None)

    def take(
        self, block: VibrationBlock, *, temperature: float, shaft_hz: float, now: float
    ) -> Task | None:
        """
        Take a block; return the task of the next fit if it is due, else None.

        Parameters
        ----------
        block
            The block.
        temperature
            Temperature of the bearing, degC; NaN if unknown.
        shaft_hz
            Shaft speed if the block has none, Hz; NaN if unknown.
        now
            Time of any monotonic clock, s.

        """
        wanted = round(self._values['window'] * block.sample_rate)
        if math.isnan(block.shaft_hz):
            block = replace(block, shaft_hz=shaft_hz)
        self._record.add(block, wanted)
        heard = self._heard()
        self._follow_repair(heard, now)
        full = self._record.held >= wanted
        hertz, self.waiting = self._record.shaft_hz() if full else (math.nan, '')
        stamped, said = self._record.stamped_rate(), self._record.sample_rate
        # An unknown rate (NaN) does not prevent a fit.
        if full and abs(stamped / said - 1.0) > REFUSED:
            self.waiting = off_rate(stamped, said)
        if not full or self.waiting:
            return None
        if now >= self._compared + self._values['window']:
            self._compared = now
            self._changed = self._compare(wanted, hertz)
        # After a failed fit ``_rested`` is infinite: the next fit comes at its regular time.
        if now < (min(self._rested, self._next) if self._contradicted(heard) else self._next):
            return None
        if self._reference and self._reference['machine']['unit'] != block.unit:
            self.forget()
        self._next, self._rested = now + self._values['period'], math.inf
        first = self._record.end - wanted
        return Task(
            samples=self._record.samples(wanted),
            sample_rate=said,
            bearing=self.bearing,
            shaft_hz=hertz,
            temperature=temperature,
            unit=block.unit,
            place=heard.place,
            load=self._load,
            candidates=self._values['candidates'],
            others=tuple(self._seen),
            reference=self._reference,
            healthy=heard.healthy,
            repairs=self._repairs,
            stamp=block.stamp + samples_ns(first - block.first_sample, block.sample_rate),
            frame_id=block.frame_id,
            first_sample=first,
        )

    def _heard(self) -> RecordVerdict:
        """Return the verdict of the diagnosis on the record."""
        record = self._record
        newest = record.newest
        return self._newest_verdict.on_record(newest.frame_id, record.end, record.sample_rate)

    def _follow_repair(self, heard: RecordVerdict, now: float) -> None:
        """Count a repair when a bearing with a defect has been healthy for ``REPAIRED_S``."""
        if heard.place is None:
            # A missing or uncertain verdict does not mean healthy.
            self._well_since = math.inf
            return
        if not heard.healthy:
            self._damaged, self._well_since = True, math.inf
            return
        self._well_since = min(self._well_since, now)
        if self._damaged and now - self._well_since >= REPAIRED_S:
            self._damaged = False
            self._repairs += 1
            self._seen.clear()

    def _contradicted(self, heard: RecordVerdict) -> bool:
        """Return whether the diagnosis names another place than the newest calibration."""
        old = self._latest
        return old is not None and heard.place not in (None, old.defect)

    def _compare(self, wanted: int, shaft_hz: float) -> str:
        """Return how the vibration has changed since the newest fit; '' if it has not."""
        old = self._latest
        if old is None or abs(shaft_hz / old.situation.shaft_hz - 1.0) > MOVED:
            return ''
        x, rate = decimated(self._record.samples(wanted), self._record.sample_rate)
        unit = self._record.newest.unit
        if not (unit == old.sensor_unit and same_rate(rate, old.situation.sample_rate)):
            return 'its sample rate or unit is another one'
        similarity = Similarity.of(x - x.mean(), rate, levels=old.spectrum, rms=old.rms)
        # The fit itself refuses values that are not finite.
        if not similarity.dissimilar or math.isnan(similarity.level):
            return ''
        return (
            f'the vibration is {signed(similarity.level)} dB over that of the record that was '
            f'fitted, at a log-spectral distance of {similarity.distance:.1f} dB'
        )

    def stale_reason(self, now: float) -> str:
        """Return why the newest calibration is stale; '' if it is not, or there is none."""
        old, heard = self._latest, self._heard()
        if old is None:
            return ''
        if self._contradicted(heard):
            has, says = (
                'no defect' if place == 'none' else f'a defect of the {place}'
                for place in (old.defect, heard.place)
            )
            return f'the diagnosis finds {says}, and the last calibration has {has}'
        if self._changed:
            return self._changed
        age = now - self._concluded
        if age > STALE_PERIODS * self._values['period']:
            return f'it is {age:.0f} s old'
        return ''

    def conclude(self, task: Task, done: Fit, now: float) -> Calibration:
        """Take the result of a fit; return its message. Delay the next fit after a costly one."""
        cost = float(done.found['cost_s'])
        self._rested = now + cost * (1.0 / SHARE - 1.0)
        self._next = max(self._next, self._rested)
        self._latest, self._concluded = FitResult.from_dict(done.found), now
        self._compared, self._changed = -math.inf, ''
        if self._latest.impacts is not None and task.repairs == self._repairs:
            self._seen.append(self._latest.impacts)
        heard = self._heard()
        # A fault that began during the record may be named only after it.
        healthy = task.healthy and heard.healthy
        decides = now - self._decided >= DECISION_S
        if self._reference is None:
            said = self._no_reference(heard.why, done.found['defect'], healthy=healthy)
            if not said:
                self._reference = done.found
                said = 'this calibration is the healthy twin: the next ones are compared with it'
            self.unexplained = ResidualDecision(math.nan, '', math.nan, said)
        elif decides:
            self._decided = now
            found = self._residuals.update(
                done.bands, done.measured - done.twin, task.shaft_hz, healthy=healthy
            )
            if found.alarm and self._repairs:
                found = replace(found, reason=f'{found.reason}; {REPAIRED}')
            self.unexplained = found
        return self._message(task, done)

    def _no_reference(self, why: str, defect: str, *, healthy: bool) -> str:
        """Return why a calibration cannot be the healthy twin; '' if it can."""
        why = why or ('' if healthy else 'the diagnosis is not ok')
        if not why and defect != 'none':
            why = f'this one has a defect ({defect})'
        return f'no calibration of the healthy machine yet: {why}' if why else ''

    def forget(self) -> str:
        """Discard the healthy twin, as after a repair; return the answer of the service."""
        self._residuals, self._reference, self._repairs = Residuals(), None, 0
        self._seen.clear()
        said = 'the healthy twin and its residual are learnt anew'
        self.unexplained = ResidualDecision(math.nan, '', math.nan, said)
        return said

    def _message(self, task: Task, done: Fit) -> Calibration:
        found, said = done.found, self.unexplained
        spectrum, quantities = found['spectrum'], found['quantities']
        bounded = self._latest is not None and self._latest.bounds_width
        width = quantities['defect_width_mm'] if bounded else {}
        before = spectrum['level_before_db']
        columns = {
            key: [value[key] for value in quantities.values()]
            for key in ('q05', 'median', 'q95', 'identifiable', 'why')
        }
        return Calibration(
            header=message_header(task.stamp, task.frame_id),
            first_sample=task.first_sample,
            sample_count=len(task.samples),
            sample_rate=task.sample_rate,
            bearing=task.bearing.name,
            shaft_hz=task.shaft_hz,
            temperature=task.temperature,
            defect=found['defect'],
            statement=found['statement'],
            quantity=list(quantities),
            quantity_unit=[value['unit'] for value in quantities.values()],
            **columns,
            **{f'width_{key}': width.get(key, math.nan) for key in ('q05', 'median', 'q95')},
            distance_before=spectrum['distance_before_db'],
            distance=spectrum['distance_after_db'],
            level_before=math.nan if before is None else before,
            level=spectrum['level_after_db'],
            residual=said.number,
            residual_alarm=said.alarm,
            residual_where=said.where,
            residual_over=said.over,
            residual_reason=said.reason,
            band=list(done.bands),
            measured_level=floats(done.measured),
            twin_level=floats(done.twin),
            unit=task.unit,
            spectrum_step=BAND_HZ,
            measured_spectrum=floats(np.array(spectrum['machine_db'])),
            twin_spectrum=floats(done.spectrum),
            turn_rate=found['machine']['sample_rate'],
            measured_turn=floats(done.turns[0]),
            twin_turn=floats(done.turns[1]),
            cost=float(found['cost_s']),
            json=json.dumps(found),
        )

    @property
    def _geometry(self) -> list[float]:
        return [getattr(self.bearing, name) for name in GEOMETRY]

    def save(self) -> bytes:
        """Return the state to keep over a restart: the healthy twin and its residual."""
        residuals, arrays = self._residuals.save()
        values = {
            'geometry': self._geometry,
            'reference': self._reference,
            'residuals': residuals,
            'repairs': self._repairs,
            'damaged': self._damaged,
        }
        return pack(_VERSION, values, arrays)

    def load(self, data: bytes) -> None:
        """
        Load a saved state.

        Raises
        ------
        BearingTwinError
            If the bytes are not such a state, or belong to another bearing. The present state is
            then unchanged.

        """
        values, arrays = unpack(data, _VERSION)
        if values.get('geometry') != self._geometry:
            raise BearingTwinError(
                f'the saved healthy twin is not of {self.bearing.name}; choose another state_name'
            )
        reference = values.get('reference')
        if reference is not None:
            FitResult.from_dict(reference)
        self._residuals = Residuals.of(values.get('residuals'), arrays)
        self._reference, self._repairs = reference, int(values.get('repairs', 0))
        self._damaged = bool(values.get('damaged', False))
