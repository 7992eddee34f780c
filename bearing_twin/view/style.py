# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Colours and names that all views share: a fault family has one colour everywhere."""

from __future__ import annotations

from typing import NamedTuple

from bearing_twin.bearing.vocabulary import RESULTS, TITLES
from bearing_twin.recording import topics

PAGES = {
    'Verdict': {topics.DIAGNOSIS, topics.SPECTRUM, topics.TWIN_STATE},
    'Vibration': {topics.VIBRATION, topics.SPECTRUM},
    'Evidence': {topics.DIAGNOSIS, topics.SPECTRUM},
    'Temperature': {topics.TEMPERATURE, topics.TWIN_STATE, topics.DIAGNOSIS},
    'Twin': {topics.TWIN_STATE},
    'Calibration': {topics.CALIBRATION},
    'Nodes': {topics.CHECKPOINT, topics.DIAGNOSTICS, topics.LOG, topics.TEXT},
}
"""Pages of a bearing, with the message types without which there is nothing to show on them. Each
page fits the screen of a laptop."""

APPLICATION = 'bearing_twin'
"""Rerun keeps a blueprint per application."""

Colour = tuple[int, int, int]


class Family(NamedTuple):
    """Names and colour of a fault family."""

    key: str
    """Name of its entities."""
    label: str
    colour: Colour


class State(NamedTuple):
    """A state of a coloured lane."""

    key: str
    label: str
    colour: Colour


# All colours have medium lightness, to be distinct on dark and on light backgrounds.
FAMILIES = (
    Family('inner', 'BPFI', (229, 57, 53)),
    Family('outer', 'BPFO', (30, 136, 229)),
    Family('ball', '2 x BSF', (251, 140, 0)),
    Family('cage', 'FTF', (171, 71, 188)),
)
"""Families in the order of the per-family arrays of a Diagnosis."""

_VERDICT_COLOURS: dict[str, Colour] = {
    'healthy': (56, 142, 60),
    'suspect': (255, 193, 7),
    'ambiguous': (121, 85, 72),
    'insufficient': (117, 117, 117),
    **{family.key: family.colour for family in FAMILIES},
}
VERDICTS = tuple(State(key, TITLES[key], _VERDICT_COLOURS[key]) for key in RESULTS)
"""
States by the constants of Diagnosis.result. A fault has the colour of its lines.

Green is healthy, grey is no verdict, all others need attention.
"""


def verdict_state(result: str) -> State:
    """
    Return the state of a result; that of no statement for one that is not known.

    Examples
    --------
    >>> verdict_state('outer').label, verdict_state('').label
    ('Outer race fault', 'Insufficient')

    """
    return next((v for v in VERDICTS if v.key == result), VERDICTS[-1])


def ink(ground: Colour) -> str:
    """
    Return a colour in which letters can be read on a background.

    Examples
    --------
    >>> ink((255, 193, 7)), ink((229, 57, 53))
    ('black', 'white')

    """
    luminance = sum(w * c for w, c in zip((0.2126, 0.7152, 0.0722), ground, strict=True))
    return 'black' if luminance > 140.0 else 'white'


TEMPERATURE_STATES = (
    State('ok', 'temperature ok', (56, 142, 60)),
    State('waiting', 'waiting for a temperature', (117, 117, 117)),
    State('stale', 'temperature stale', (249, 168, 37)),
    State('invalid', 'temperature invalid', (211, 47, 47)),
    State('clamped', 'temperature outside 20..110 °C', (230, 81, 0)),
    State('backwards', 'temperature stamps run backwards', (211, 47, 47)),
)
"""States by the constants of TwinState.temperature_status."""

LANE_LEVELS = (
    State('ok', 'ok', (56, 142, 60)),
    State('warn', 'warning', (249, 168, 37)),
    State('error', 'error', (211, 47, 47)),
    State('stale', 'stale', (117, 117, 117)),
)
"""States by the level of a DiagnosticStatus."""

LINE: dict[str, Colour] = {
    'blue': (66, 165, 245),
    'green': (102, 187, 106),
    'olive': (158, 157, 36),
    'orange': (255, 167, 38),
    'red': (239, 83, 80),
    'violet': (171, 71, 188),
    'spectrum': (100, 181, 246),
    'limit': (255, 241, 118),
    'remark': (150, 142, 84),
    'threshold': (96, 100, 104),
    'ground': (128, 128, 128),
    'grid': (40, 40, 40),
    'back': (13, 13, 13),
}
"""Colours of lines by their name in titles or by their purpose."""
