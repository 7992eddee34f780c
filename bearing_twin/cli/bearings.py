# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin bearings``: look up a bearing of the catalogue."""

from __future__ import annotations

import argparse
from dataclasses import asdict
import json
import math
from typing import TYPE_CHECKING

from bearing_twin.bearing import catalogue, fault_orders, find_bearing
from bearing_twin.cli.terminal import lined_up
from bearing_twin.diagnosis.rules.fits import striking_parts
from bearing_twin.errors import BearingTwinError

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing


ORDER_WIDTH = 0.01
"""Half-width of the search around an order: two lines of a window of 8 s at 25 Hz."""


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        'query',
        nargs='?',
        metavar='QUERY',
        help="designation, e.g. 6205 or 'SKF 6205-2RS'; its beginning or a part of its kind lists "
        'all that match (default: all)',
    )
    parser.add_argument(
        '--order',
        type=float,
        help='only bearings with a race or a ball that strikes as often as this a turn, and which '
        f'part it is (within {ORDER_WIDTH:g}, with 1.5 %% for slip and contact angle)',
    )
    parser.add_argument('--json', action='store_true', help='one JSON object a line')


def run(args: argparse.Namespace) -> int:
    """Print one bearing in full, or one line for each of several; raise if none matches."""
    found = _matching(args.query or '')
    parts: dict[str, str] = {}
    if args.order is not None:
        parts = _striking(args.order)
        if not (found := [bearing for bearing in found if bearing.name in parts]):
            raise BearingTwinError(
                f'no race or ball of these bearings strikes {args.order:g} times a turn (within '
                f'{ORDER_WIDTH:g}); an order is a frequency over that of the shaft'
            )
    if args.json:
        for bearing in found:
            row = asdict(bearing) | {'orders': fault_orders(bearing)._asdict()}
            print(json.dumps(row | ({'strikes': parts[bearing.name]} if parts else {})))
    elif len(found) == 1 and not parts:
        print(_whole(found[0]))
    else:
        columns = f'{"name":<15}{"balls":>9} mm{"pitch mm":>10}  BPFO    BPFI    2xBSF   FTF   '
        print(columns, 'strikes' if parts else 'basis')
        for bearing in found:
            print(_line(bearing), parts[bearing.name] if parts else bearing.basis)
    return 0


def _striking(order: float) -> dict[str, str]:
    """Return the parts that strike at an order, by the name of their bearing."""
    parts: dict[str, str] = {}
    for bearing, place in striking_parts(order, ORDER_WIDTH):
        parts[bearing.name] = f'{parts[bearing.name]}, {place}' if bearing.name in parts else place
    return parts


def _matching(query: str) -> list[Bearing]:
    """Return the bearing of this name, or all with this start of the name or part of the kind."""
    folded = query.strip().casefold()
    known = catalogue().values()
    if not folded:
        return list(known)
    exact = [bearing for bearing in known if bearing.name.casefold() == folded]
    part = [
        bearing
        for bearing in known
        if bearing.name.casefold().startswith(folded) or folded in bearing.kind.casefold()
    ]
    return exact or part or [find_bearing(query)]


def _line(bearing: Bearing) -> str:
    orders = fault_orders(bearing)
    numbers = (orders.bpfo, orders.bpfi, 2.0 * orders.bsf, orders.ftf)
    balls = f'{bearing.n_balls} x {bearing.d_ball * 1e3:.5g}'
    text = '  '.join(f'{number:6.3f}' for number in numbers)
    return f'{bearing.name:<15}{balls:>12}{bearing.d_pitch * 1e3:10.5g} {text} '


def _whole(bearing: Bearing) -> str:
    def mm(value: float | None) -> str:
        return 'not published' if value is None else f'{value * 1e3:g} mm'

    def kn(value: float | None) -> str:
        return 'not published' if value is None else f'{value / 1e3:g} kN'

    orders = fault_orders(bearing)
    rows = {
        'bearing': f'{bearing.name}, {bearing.kind}',
        'elements': f'{bearing.n_balls} {bearing.element}s of {bearing.d_ball * 1e3:g} mm'
        + (f' in each of {bearing.rows} rows' if bearing.rows > 1 else ''),
        'pitch diameter': mm(bearing.d_pitch),
        'contact angle': f'{math.degrees(bearing.contact_angle):g} deg',
        'bore, outside, width': ', '.join(map(mm, (bearing.bore, bearing.outside, bearing.width))),
        'C_r, C_0r': f'{kn(bearing.dynamic_rating)}, {kn(bearing.static_rating)}',
        'outer race, BPFO': f'{orders.bpfo:.4f} times the shaft speed',
        'inner race, BPFI': f'{orders.bpfi:.4f}',
        'ball, 2 x BSF': f'{2.0 * orders.bsf:.4f} (strikes; BSF {orders.bsf:.4f})',
        'cage, FTF': f'{orders.ftf:.4f}',
        'geometry': bearing.basis,
        'source': bearing.source,
    }
    return '\n'.join(lined_up(rows.items()))
