# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin compile``: compile the kernels before their first use."""

from __future__ import annotations

import json
import time
from typing import TYPE_CHECKING

from bearing_twin.diagnosis import compilation as diagnosis
from bearing_twin.dynamics import compilation as dynamics
from bearing_twin.errors import BearingTwinError
from bearing_twin.numerics.compiled import (
    cache_folder,
    has_compiled,
    other_processors,
    processor,
    why_not_kept,
)

if TYPE_CHECKING:
    import argparse


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('--json', action='store_true', help='print the answer as JSON')


def run(args: argparse.Namespace) -> int:
    """Compile what is not in the cache."""
    folder = cache_folder()
    if folder is None:
        msg = (
            'compiled code can be kept nowhere: set NUMBA_CACHE_DIR to a folder that you can '
            'write and the nodes can read'
        )
        raise BearingTwinError(msg)
    others, began = ', '.join(other_processors()), time.perf_counter()
    if others and not args.json:
        print(f'the code in {folder} is for another processor ({others})', flush=True)
    dynamics.warm_up(fleet=True)
    diagnosis.warm_up()
    if why := why_not_kept():
        raise BearingTwinError(why)
    took = time.perf_counter() - began
    answer = {'processor': processor(), 'folder': str(folder), 'seconds': took}
    if args.json:
        print(json.dumps({**answer, 'compiled': has_compiled()}))
    elif has_compiled():
        print(f'kernels compiled for {processor()} in {took:.0f} s; kept in {folder}')
    else:
        print(f'kernels are compiled for {processor()}; kept in {folder}')
    return 0
