# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin diagnose --series``: many short files of one machine, judged together."""

from __future__ import annotations

import argparse
import json
import math
from pathlib import Path
import sys
from typing import Any, TYPE_CHECKING

from bearing_twin.bearing import fault_orders, named_bearing, next_step, PLACES
from bearing_twin.cli.signal_arguments import given_bearing
from bearing_twin.cli.terminal import by_level, clear_progress, lined_up, plain, progress, wrapped
from bearing_twin.diagnosis.rules.table import TELLS
from bearing_twin.diagnosis.series.monitor import SeriesMonitor
from bearing_twin.diagnosis.settings import DiagnosisSettings
from bearing_twin.errors import BearingTwinError, refused, shown, UsageError
from bearing_twin.quantity import quantities
from bearing_twin.recording.signals.snapshots import read_snapshots, series_files
from bearing_twin.view.verdict import LOUDER

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing
    from bearing_twin.diagnosis.series.result import SeriesReport

LONGEST_CYCLE = quantities(DiagnosisSettings)['series_cycle'][1].high or math.inf
"""Longest time between two snapshots, s."""


def run_series(args: argparse.Namespace, shaft_hz: float) -> int:
    """Judge the files as one series; return 0 if every file could be read."""
    files = series_files([Path(name) for name in args.files])
    settings = _settings(args)
    monitor = None
    bearing: Bearing | None = None
    said = ''
    unread: list[BearingTwinError] = []
    speeds: list[float] = []
    snapshots = read_snapshots(
        files,
        channel=args.channel,
        sample_rate=args.sample_rate,
        cycle=args.cycle,
        unread=unread.append,
    )
    for count, snapshot in enumerate(snapshots, start=1):
        signal = snapshot.signal
        if monitor is None:
            said = signal.source
            bearing = _bearing(args, signal.bearing or signal.bearing_name)
            monitor = SeriesMonitor(bearing, settings)
        hertz = signal.shaft_hz if math.isnan(shaft_hz) else shaft_hz
        speeds.append(hertz)
        point = monitor.add(
            snapshot.time,
            signal.x,
            signal.sample_rate,
            hertz,
            temperature=signal.temperature,
            unit=args.unit or signal.unit,
        )
        if args.json and point is not None:
            print(json.dumps(plain(vars(point))), flush=True)
        if count % 100 == 0 and not args.json:
            progress(count, count + 1, 'snapshots')
    if monitor is None:
        msg = f'{files[0]}: no snapshot in it; is x the name of the samples?'
        raise unread[-1] if unread else BearingTwinError(msg)
    clear_progress(count)
    for error in unread:
        print(f'bearing-twin diagnose: left out: {shown(str(error))}', file=sys.stderr)
    report = monitor.report()
    summary = _summary(report, bearing)
    if args.json:
        print(json.dumps({'series': said, **summary}))
    else:
        print(_page(said, report, summary, _looked_for(bearing, speeds)))
    return 1 if unread else 0


def _settings(args: argparse.Namespace) -> DiagnosisSettings:
    if args.cycle is not None and not 0.0 < args.cycle <= LONGEST_CYCLE:
        msg = f'--cycle {args.cycle:g}: give a time above 0 s and up to {LONGEST_CYCLE:g} s'
        raise UsageError(msg)
    with refused():
        return DiagnosisSettings(
            baseline_windows=args.baseline,
            longest_hold=args.hold,
            power_group=args.power_group,
            mounting=args.mounting,
        )


def _bearing(args: argparse.Namespace, said: Bearing | str) -> Bearing | None:
    given = given_bearing(args)
    if given is not None:
        return given
    if not isinstance(said, str):
        return said
    try:
        return named_bearing(said)
    except BearingTwinError as error:
        print(f'bearing-twin diagnose: alarms without a place: {error}', file=sys.stderr)
        return None


def _summary(report: SeriesReport, bearing: Bearing | None) -> dict[str, Any]:
    found: dict[str, Any] = plain(
        {
            'level': report.level,
            'snapshots': len(report.points),
            'bearing': bearing.name if bearing else None,
            'baseline_s': list(report.baseline) if report.baseline else None,
            'scatter_dB': report.scatter,
            'change_s': report.change,
            'alarm_s': report.alarm,
            'first_alarm_s': report.first_alarm,
            'first_fault_s': report.first_fault,
            'level_changes': report.changes,
            'trend_dB_per_h': report.trend,
            'warmer_K': report.warmer,
            'temperature_dB_per_K': report.law.temperature.mean,
            'temperature_dB_per_K_sd': report.law.temperature.deviation,
            'temperature_learnt': report.law.temperature.known,
            'place': report.place or None,
            'doubt': report.doubt or None,
            'reasons': list(report.reasons),
        }
    )
    return found


def _looked_for(bearing: Bearing | None, speeds: list[float]) -> list[tuple[str, str]]:
    """Return rows of the speed, and of orders and frequencies of the bearing."""
    known = [hertz for hertz in speeds if hertz > 0.0]
    if not known:
        return [('speed', 'unknown: give --rpm')]
    low, high = min(known), max(known)
    same = high - low < 1e-3 * high
    speed = f'{high:.4g}' if same else f'{low:.4g} to {high:.4g}'
    rows = [('speed', f'{speed} Hz')]
    if bearing is not None:
        orders = fault_orders(bearing)
        each = ((place, orders.impacts(place)) for place in PLACES)
        rows += [
            ('' if number else 'looked for', f'{place:<5} {order:.3f} orders'
             + (f', {order * high:.4g} Hz' if same else ''))
            for number, (place, order) in enumerate(each)
        ]  # fmt: skip
    return rows


def _to_do(report: SeriesReport) -> str:
    """Return the next step."""
    alarm = report.level == 'fault'
    risen = report.level == 'suspect' and math.isfinite(report.change)
    step = next_step(
        report.result,
        int(alarm),
        urgent=alarm and not report.place and not report.doubt,
        tells=LOUDER if risen else TELLS.get(report.doubt, ''),
    )
    return step[0].upper() + step[1:]


def _page(
    said: str, report: SeriesReport, summary: dict[str, Any], looked_for: list[tuple[str, str]]
) -> str:
    def when(seconds: float) -> str:
        return 'never' if math.isnan(seconds) else _clock(seconds - start)

    points = report.points
    start = points[0].time if points else 0.0
    base = 'not learnt'
    if report.baseline:
        first, last = (_clock(time - start) for time in report.baseline)
        base = f'{first} to {last}, scatter {report.scatter:.2g} dB'
    length = _clock(points[-1].time - start) if points else '0 s'
    rows = [
        ('level', by_level(report.level, report.level)
         + (f', place {report.place}' if report.place else '')),
        ('bearing', summary['bearing'] or 'unknown'),
        *looked_for,
        ('baseline', base),
        ('change', when(report.change)),
        ('alarm', f'{when(report.first_alarm)}; fault {when(report.first_fault)}; '
         + (f'last {when(report.alarm)}; ' if report.alarm > report.first_alarm else '')
         + _changes(report.changes)),
        ('trend', 'unknown' if math.isnan(report.trend) else f'{report.trend + 0.0:+.2g} dB/h'),
        *(('why' if not index else '', text) for index, text in enumerate(report.reasons)),
        ('next step', _to_do(report)),
    ]  # fmt: skip
    head = wrapped('', f'from {said} on: {len(points)} snapshots in {length}')
    return '\n'.join([by_level('\n'.join(head), 'bold'), *lined_up(rows)])


def _changes(count: int) -> str:
    """Say how often the held level changed; its first one is no change."""
    if not count:
        return 'the first level that was known still holds'
    return f'the level changed {count} time{"s" if count > 1 else ""} since it was first known'


def _clock(seconds: float) -> str:
    """Return a time as days, hours, minutes and seconds, the two largest that are not zero."""
    left = round(seconds)
    parts: list[str] = []
    for size, name in ((86400, 'd'), (3600, 'h'), (60, 'min'), (1, 's')):
        count, left = divmod(left, size)
        if count or (name == 's' and not parts):
            parts.append(f'{count} {name}')
    return ' '.join(parts[:2])
