# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Diagnosis of a stream: takes blocks, gives one diagnosis per update interval, without clocks."""

from __future__ import annotations

from collections import deque
from dataclasses import replace
import functools
import itertools
import math
from typing import Any, NamedTuple, TYPE_CHECKING

from bearing_twin.bearing import check_geometry
from bearing_twin.diagnosis.chain import Excerpt, is_simulated, Stretch
from bearing_twin.diagnosis.combs.comb import OrderSpectra
from bearing_twin.diagnosis.machine.held import Pace
from bearing_twin.diagnosis.machine.trend import Source, Trend
from bearing_twin.diagnosis.record import at_other_speeds, WINDOW_TURNS
from bearing_twin.diagnosis.settings import DiagnosisSettings
from bearing_twin.diagnosis.signal.shaft import SpeedProfile
from bearing_twin.errors import BearingTwinError
from bearing_twin.given import one_axis, real_number
from bearing_twin.packed import pack, restored, unpack
from bearing_twin.quantity import check_range, check_whole
import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing
    from bearing_twin.diagnosis.chain import Analysis
    from bearing_twin.diagnosis.result import Diagnosis


_VERSION = 23
_MOST_PARTS = 64
_ROUNDED = 5e-4
"""Largest relative rounding of the time between updates."""
_FEWEST_POINTS, _LARGEST_STEP = 256, 512
"""Least envelope points in an interval, those of a shaft of 5 Hz, and most samples per point."""
PATIENCE = 3.0
"""Update intervals, or cycles of a series, without a verdict after which one is overdue."""
_STEADY = 1e-4
"""Largest relative change of the sample rate within a window: a line at 1 kHz moves by less than
its width in 8 s."""
LOOK_EVERY, LOOK_SELDOM = 10, 80
"""Least and largest number of windows from one look at other speeds to the next: a look takes
three to six times as long as a verdict, so fruitless ones take 4 to 8 % of the time in the end."""
_FARTHEST = 2**63 - 1
"""Largest index of a sample, in either direction."""


LOWEST_RATE, HIGHEST_RATE = 1.0, 1e9
"""Range of sample rates of a stream, Hz: an update has at least one sample, and a window ends."""


def checked_block(
    first_sample: int, x: ArrayLike, sample_rate: float, shaft_hz: float, temperature: float
) -> tuple[int, NDArray[np.float64], float, float, float]:
    """
    Return the index, samples, rate, shaft speed and temperature of a block as plain numbers.

    Raises
    ------
    BearingTwinError
        If x is not one-dimensional, a value is no number, the sample rate is outside 1 Hz to
        1 GHz, or the index is no whole number of 64 bits.

    >>> checked_block(0, [1, 2], 25600, 25, math.nan)
    (0, array([1., 2.]), 25600.0, 25.0, nan)

    """
    check_whole('first_sample', first_sample)
    check_range('first_sample', first_sample, -_FARTHEST, _FARTHEST, 'samples')
    rate = real_number('sample_rate', sample_rate)
    check_range('sample_rate', rate, LOWEST_RATE, HIGHEST_RATE, 'Hz')
    hertz = real_number('shaft_hz', shaft_hz)
    return int(first_sample), one_axis(x), rate, hertz, real_number('temperature', temperature)


def same_rate(first: float, other: float) -> bool:
    """
    Return whether samples of both rates, Hz, can be in one window.

    >>> same_rate(25600.0, 25600.4), same_rate(25600.0, 25610.0), same_rate(math.nan, 25600.0)
    (True, False, False)

    """
    return abs(other - first) <= _STEADY * first


def _divisible(wanted: int) -> int:
    """
    Return a number with many divisors near a wanted number of samples; that one if none is near.

    The distance of envelope points is a divisor of the interval. There are enough divisors if each
    is at most about twice the previous one. With a prime number each sample is a point, which
    takes fifty times as long.

    >>> _divisible(25600), _divisible(25601), _divisible(48828)
    (25600, 25600, 48828)

    """
    for away in range(int(_ROUNDED * wanted) + 1):
        for count in (wanted - away, wanted + away):
            most = min(count // _FEWEST_POINTS, _LARGEST_STEP)
            divisors = [step for step in range(1, most + 1) if count % step == 0]
            if all(b <= 2 * a + 1 for a, b in itertools.pairwise((*divisors, most))):
                return count
    return wanted


class Cut(NamedTuple):
    """
    Division of a stream into stretches; windows and updates are whole numbers of stretches.

    >>> Cut.of(DiagnosisSettings(window=2.5), 25600.0)
    Cut(stretch=12800, window=5, update=2)

    """

    stretch: int
    """Samples of a stretch."""
    window: int
    """Stretches of a window."""
    update: int
    """Stretches from one update to the next."""

    @classmethod
    def of(cls, settings: DiagnosisSettings, sample_rate: float) -> Cut:
        """Return the division into the longest stretches; the window may be rounded to them."""
        return cls._of(settings.update_interval, settings.window, sample_rate)

    @classmethod
    @functools.lru_cache(maxsize=64)
    def _of(cls, update_interval: float, window: float, sample_rate: float) -> Cut:
        interval = _divisible(max(round(update_interval * sample_rate), 1))
        wanted = window * sample_rate
        cuts = (
            cls(interval // parts, max(round(wanted * parts / interval), 1), parts)
            for parts in range(1, _MOST_PARTS + 1)
            if interval % parts == 0
        )
        # Differences of the window below one in a thousand do not matter.
        return min(cuts, key=lambda c: (round(abs(c.samples / wanted - 1.0), 3), c.update))

    @property
    def samples(self) -> int:
        """Return the samples of a window."""
        return self.stretch * self.window

    @property
    def interval(self) -> int:
        """Return the samples from one update to the next."""
        return self.stretch * self.update


class StreamingDiagnoser:
    """
    Sliding-window diagnosis of one axis of one sensor.

    The result depends on the pushed blocks alone, not on clocks: the same blocks give the same
    diagnoses to the bit. An update is due after each ``settings.update_interval`` of samples. A
    new window begins after a gap in ``first_sample``, after an index that runs backwards (a
    restarted source), and at another sample rate, sensor or unit; the next diagnosis gives the
    reason. Rates that differ by less than 0.01 % count as the rate of the first block. The
    ``level`` of the diagnoses is held: it rises after ``settings.hold_updates`` verdicts, and
    falls when the machine has changed
    (:class:`bearing_twin.diagnosis.machine.held.HeldLevel`).

    Baseline and trend belong to one source: sensor, bearing, unit and sample rate. Windows of
    another source have a separate baseline and say so. The first baseline is kept until its source
    comes back.

    Parameters
    ----------
    bearing
        Geometry.
    settings
        See :class:`DiagnosisSettings`.

    >>> import numpy as np
    >>> from bearing_twin.bearing import find_bearing
    >>> diagnoser = StreamingDiagnoser(find_bearing('6307'))
    >>> noise = np.random.default_rng(0).standard_normal(3 * 25600)
    >>> [verdict.result for verdict in diagnoser.push(0, noise, 25600.0, 25.0)]
    ['insufficient', 'healthy', 'healthy']

    """

    def __init__(self, bearing: Bearing, settings: DiagnosisSettings | None = None) -> None:
        check_geometry(bearing)
        self._bearing = bearing
        self._settings = settings or DiagnosisSettings()
        self._earlier: deque[tuple[int, OrderSpectra]] = deque()
        self._judged = self._run = 0
        self.other_source = ''
        """Why the last window is of another source than baseline and trend; '' if it is not."""
        self._trend, self._guest = Trend(), Trend()
        # The newest restart, its sample, and how many there were since the last update.
        self._note, self._noted, self._restarts = '', 0, 0
        self._waited = 0.0
        # Windows from one look at other speeds to the next, and windows since the last one.
        self._pause, self._unseen = LOOK_EVERY, 0
        # Whether the newest window asked for a level that was not held.
        self._asked = False
        self._rate = math.nan
        self._named: tuple[str, str] | None = None
        self._clear(0)

    @property
    def bearing(self) -> Bearing:
        """Geometry in use."""
        return self._bearing

    @property
    def settings(self) -> DiagnosisSettings:
        """Return the settings in use."""
        return self._settings

    def reconfigure(
        self, bearing: Bearing | None = None, settings: DiagnosisSettings | None = None
    ) -> None:
        """Change geometry or settings; the window starts anew, the baseline remains."""
        if bearing is not None:
            check_geometry(bearing)
        self._bearing = bearing or self._bearing
        self._settings = settings or self._settings
        self._restart(self._next, 'window restarted: bearing or settings were changed')

    def push(
        self, first_sample: int, x: ArrayLike, sample_rate: float, shaft_hz: float, **known: Any
    ) -> list[Diagnosis]:
        """
        Take a block and return the diagnoses that are due within it, oldest first.

        It calls :meth:`take`, which describes the parameters, :meth:`Excerpt.analyse` and
        :meth:`judge`.
        """
        due = self.take(first_sample, x, sample_rate, shaft_hz, **known)
        return [self.judge(excerpt.analyse()) for excerpt in due]

    def take(
        self,
        first_sample: int,
        x: ArrayLike,
        sample_rate: float,
        shaft_hz: float,
        *,
        speed_measured: bool = False,
        temperature: float = math.nan,
        unit: str = '',
        sensor: str = '',
    ) -> list[Excerpt]:
        """
        Take a block and return the windows that are due within it, oldest first.

        Windows may be analysed in any order and thread while further blocks are taken. They must
        be judged in their own order. Save the state, and change bearing or settings, only when all
        windows have been judged.

        Parameters
        ----------
        first_sample
            Running index of the first sample of the block.
        x
            Samples, shape (n,).
        sample_rate
            Hz.
        shaft_hz
            Shaft speed during the block, Hz; NaN if unknown.
        speed_measured
            Whether the speed was measured with the samples; its tolerance is then
            ``measured_speed_tolerance``, or 0 if a twin is the sensor.
        temperature
            Bearing temperature, degC; NaN if unknown.
        unit
            Unit of x.
        sensor
            Name of the sensor, e.g. frame and axis.

        Raises
        ------
        BearingTwinError
            If x is not one-dimensional, a value is no number, or the sample rate is outside 1 Hz
            to 1 GHz. The state is unchanged then.

        """
        first_sample, block, sample_rate, shaft_hz, temperature = checked_block(
            first_sample, x, sample_rate, shaft_hz, temperature
        )
        if not same_rate(self._rate, sample_rate):
            before, self._rate = self._rate, sample_rate
            if math.isnan(before):
                self._clear(first_sample)
            else:
                text = (
                    f'window restarted: sample rate went from {before:.7g} to {sample_rate:.7g} Hz'
                )
                self._restart(first_sample, text)
        elif first_sample != self._next:
            if first_sample > self._next:
                missing = (first_sample - self._next) / sample_rate
                self._waited += min(missing, self._settings.update_interval)
                text = f'window restarted: {first_sample - self._next} samples are missing'
            else:
                text = f'window restarted: index went back from {self._next} to {first_sample}'
            self._restart(first_sample, f'{text} before sample {first_sample}')
        elif self._named not in (None, (sensor, unit)):
            self._restart(first_sample, 'window restarted: sensor or unit changed')
        self._named = sensor, unit
        due_now, cut = [], self._cut
        self._waited += len(block) / self._rate
        while len(block):
            room = cut.stretch - self._filled
            self._hold(block[:room], shaft_hz, cut)
            block = block[room:]
            if not self._filled and (self._next - self._start) % cut.interval == 0:
                due_now.append(self._excerpt(speed_measured, temperature, unit, sensor))
                self._waited = len(block) / self._rate
        return due_now

    may_pause = False
    """Whether blocks may be left out now: none of a stream."""

    def has_gap(self, first_sample: int, sample_rate: float) -> bool:
        """Return whether a block does not follow on the newest one."""
        return first_sample != self._next

    @property
    def next_sample(self) -> int:
        """Index of the sample after the newest block."""
        return self._next

    @property
    def overdue(self) -> str:
        """Why no window is due although samples arrive; '' if none is overdue."""
        if self._waited <= PATIENCE * self._settings.update_interval:
            return ''
        return f'no verdict in {self._waited:.0f} s of vibration: {self._restarted}'

    @property
    def _restarted(self) -> str:
        """Newest restart of the window since the last one was due; '' if there was none."""
        more = f' ({self._restarts} restarts since the last verdict)' if self._restarts > 1 else ''
        return f'{self._note}{more}'

    def judge(self, analysis: Analysis) -> Diagnosis:
        """Return the diagnosis of a window together with earlier windows and verdicts."""
        excerpt, window = analysis.excerpt, analysis.window
        settings = excerpt.settings
        wanted = Cut.of(settings, excerpt.sample_rate).samples
        full = excerpt.sample_count == wanted
        if excerpt.run != self._judged:
            self._judged = excerpt.run
            self._earlier.clear()
        source = Source(excerpt.sensor, excerpt.bearing.name, excerpt.unit, excerpt.sample_rate)
        self.other_source = ''
        if not self._trend.takes(source):
            self.other_source = f'baseline and trend are of {self._trend.source}, this is {source}'
        earlier: list[OrderSpectra] = []
        if window is not None:
            # Windows at another speed may have other bands.
            bands = window.orders.carrier.shape
            earlier = [w for w in self._before(excerpt, wanted) if w.carrier.shape == bands]
            if full and settings.averages:
                self._earlier.append((excerpt.end, window.orders))
        found = analysis.conclude(earlier) if earlier else analysis.alone
        trend = self._trend
        if self.other_source:
            found = replace(found, reasons=(*found.reasons, self.other_source))
            if not self._guest.takes(source):
                self._guest = Trend()
            trend = self._guest
        if full and self._looks(found, analysis):
            found = _looked_at(found, analysis)
            rises = trend.held.would_rise(found.level)
            self._pause = LOOK_EVERY if rises else min(2 * self._pause, LOOK_SELDOM)
        span = settings.memory if settings.averages else settings.window
        shown = trend.update(
            found,
            source,
            wanted=settings.baseline_windows,
            pace=Pace(
                updates=settings.hold_updates,
                interval=settings.update_interval,
                span=max(span, settings.update_interval),
                longest=settings.longest_hold,
                simulated=excerpt.simulated,
                window=settings.window,
            ),
            full=full,
            speed_known=not settings.nominal or (window is not None and window.speed.shows),
        )
        self._asked = trend.held.would_rise(shown.window[1] if shown.window else shown.level)
        return shown

    def save(self) -> bytes:
        """Return the state to keep over a restart: baseline, held level and averaged windows."""
        arrays = {}
        earlier = self._earlier if self._judged == self._run else ()
        for number, (_, orders) in enumerate(earlier):
            arrays[f'logs{number}'] = orders.logs
            arrays[f'excess{number}'] = orders.excess
            arrays[f'carrier{number}'] = orders.carrier
        values = {
            'trend': self._trend.values(),
            'guest': self._guest.values(),
            'sample_rate': self._rate if math.isfinite(self._rate) else None,
            'start': self._start,
            'next': self._next,
            'note': [self._note, self._noted, self._restarts],
            'look': [self._pause, self._unseen, self._asked],
            'earlier': [(end, orders.step, orders.given) for end, orders in earlier],
        }
        return pack(_VERSION, values, arrays)

    def load(self, data: bytes) -> None:
        """
        Restore a saved state.

        A state does not contain the window, so the window starts anew. But if the samples before
        the state have just been taken, they are the window, and updates are due as without a
        restart.

        Raises
        ------
        BearingTwinError
            If the bytes are no such state. The present state is unchanged then.

        """
        values, arrays = unpack(data, _VERSION)
        try:
            rate = math.nan if values['sample_rate'] is None else float(values['sample_rate'])
            earlier = deque(
                (
                    int(end),
                    OrderSpectra(
                        float(step),
                        arrays[f'logs{n}'],
                        arrays[f'excess{n}'],
                        arrays[f'carrier{n}'],
                        float(given),
                    ),
                )
                for n, (end, step, given) in enumerate(values['earlier'])
            )
            start, following = int(values['start']), int(values['next'])
            note, noted, restarts = values['note']
            pause, unseen, asked = map(int, values['look'])
            trend, guest = (restored(Trend, values[name]) for name in ('trend', 'guest'))
            if not (0.0 < rate < math.inf or math.isnan(rate)):
                raise ValueError(f'sample rate {rate}')
        except (KeyError, TypeError, ValueError) as error:
            msg = f'saved state lacks {error}; use what save() returned'
            raise BearingTwinError(msg) from error
        before, self._rate = self._rate, rate
        if same_rate(rate, before) and following == self._next:
            self._cut_again(start)
        else:
            self._clear(following)
            # Windows start anew here; the saved ones began earlier.
            self._began = start
        self._judged, self._earlier = self._run, earlier
        self._note, self._noted, self._restarts = str(note), int(noted), int(restarts)
        self._trend, self._guest = trend, guest
        self._pause, self._unseen, self._asked = pause, unseen, bool(asked)

    def first_needed_sample(self, following: int) -> int:
        """
        Return the index of the first sample that windows depend on if ``following`` comes next.

        These are the samples of the next window and, since its first segment overlaps it, of the
        stretch before it, if the run has one; at least those of the newest stretch, which decide
        when updates are due. Before the first update they are all of the run, whose begin that
        update explains.
        """
        held = following - self._began
        if following != self._next or not held or not math.isfinite(self._rate):
            return following
        cut = self._cut
        if held < cut.interval:
            return self._began
        due = self._began + (held // cut.interval + 1) * cut.interval
        newest = self._began + (held - 1) // cut.stretch * cut.stretch
        return max(min(due - cut.samples - cut.stretch, newest), self._began)

    @property
    def _cut(self) -> Cut:
        return Cut.of(self._settings, self._rate)

    def _restart(self, first_sample: int, note: str) -> None:
        # Several settings changed one after another, before any sample, are one restart.
        self._restarts += self._next != self._noted or not self._restarts
        self._note, self._noted = note, first_sample
        self._clear(first_sample)

    def _clear(self, first_sample: int) -> None:
        self._run += 1
        self._start = self._next = first_sample
        self._began = first_sample
        self._stretches: deque[Stretch] = deque()
        self._parts: list[tuple[NDArray[np.float64], float]] = []
        self._filled = 0

    def _hold(self, part: NDArray[np.float64], shaft_hz: float, cut: Cut) -> None:
        """Add samples to the present stretch."""
        self._parts.append((part, shaft_hz))
        self._next += len(part)
        self._filled += len(part)
        if self._filled < cut.stretch:
            return
        # Parts of one speed are joined, so that the division into blocks does not matter.
        speeds = [
            (hz, sum(len(x) for x, _ in parts))
            for hz, parts in itertools.groupby(self._parts, key=lambda part: part[1])
        ]
        hertz, lengths = zip(*speeds, strict=True)
        samples = np.concatenate([x for x, _ in self._parts])
        self._stretches.append(Stretch(samples, SpeedProfile(np.array(hertz), np.array(lengths))))
        self._parts, self._filled = [], 0
        # Two more than a window: the stretch before it, and one for another start in _cut_again.
        while len(self._stretches) > cut.window + 2:
            self._stretches.popleft()

    def _cut_again(self, start: int) -> None:
        """Divide the present samples again as if the run had begun at the sample ``start``."""
        held = [
            (part, float(hz))
            for stretch in self._stretches
            for part, hz in zip(
                np.split(stretch.samples, np.cumsum(stretch.speed_profile.lengths)[:-1]),
                stretch.speed_profile.shaft_hz,
                strict=True,
            )
        ] + self._parts
        following, cut = self._next, self._cut
        first = following - sum(len(part) for part, _ in held)
        skipped = max(start - first, (start - first) % cut.stretch)
        self._clear(start)
        self._next = first + skipped
        for part, hz in held:
            rest, skipped = part[skipped:], max(skipped - len(part), 0)
            while len(rest):
                room = cut.stretch - self._filled
                self._hold(rest[:room], hz, cut)
                rest = rest[room:]
        self._next = following

    def _excerpt(
        self, speed_measured: bool, temperature: float, unit: str, sensor: str
    ) -> Excerpt:
        simulated = is_simulated(sensor)
        settings = self._settings.for_speed(measured=speed_measured, simulated=simulated)
        stretches, count = tuple(self._stretches), self._cut.window
        note, self._note, self._restarts = self._restarted, '', 0
        return Excerpt(
            stretches=stretches[-count:],
            before=stretches[-count - 1] if len(stretches) > count else None,
            sample_rate=self._rate,
            bearing=self._bearing,
            settings=settings,
            first_sample=self._next - sum(len(s.samples) for s in stretches[-count:]),
            temperature=temperature,
            unit=unit,
            sensor=sensor,
            notes=(note,) if note else (),
            run=self._run,
        )

    def _looks(self, found: Diagnosis, analysis: Analysis) -> bool:
        """
        Count a full window; return whether it is looked at for another speed than the given one.

        It is if it is no alarm, its speed is only nominal, and the lines of the shaft do not show
        at it, or not at one speed. One in ten is, and fewer while looks ask for no level that is
        not held yet; so are those after a window that asks for one.
        """
        window = analysis.window
        if window is None or not analysis.excerpt.settings.nominal:
            return False
        self._unseen += 1
        due = self._unseen >= self._pause or self._asked
        if found.level == 'fault' or window.speed.steady or not due:
            return False
        self._unseen = 0
        return True

    def _before(self, excerpt: Excerpt, wanted: int) -> list[OrderSpectra]:
        """Return the windows to average with an excerpt, oldest first; drop those too old."""
        oldest = excerpt.end - round(excerpt.settings.memory * excerpt.sample_rate)
        while self._earlier and self._earlier[0][0] - wanted < oldest:
            self._earlier.popleft()
        # Only windows that overlap neither this one nor each other add evidence.
        windows, limit = [], excerpt.first_sample
        for end, orders in reversed(self._earlier):
            if end <= limit:
                windows.append(orders)
                limit = end - wanted
        return windows[::-1]


def _looked_at(found: Diagnosis, analysis: Analysis) -> Diagnosis:
    """Return the answer on a window after looks at other speeds, as those of a record."""
    excerpt = analysis.excerpt
    cut = functools.partial(
        Excerpt.of, sample_rate=excerpt.sample_rate, bearing=excerpt.bearing,
        settings=excerpt.settings, longest=WINDOW_TURNS, first_sample=excerpt.first_sample,
        temperature=excerpt.temperature, unit=excerpt.unit, sensor=excerpt.sensor,
        notes=excerpt.notes,
    )  # fmt: skip
    return at_other_speeds(found, analysis, excerpt.samples, cut)
