# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin compile``: compile the kernels before their first use."""

from __future__ import annotations

import argparse
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
import json
import time

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
from bearing_twin.process import end_with_parent


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('--json', action='store_true', help='print the answer as JSON')


def run(args: argparse.Namespace) -> int:
    """Compile what is not in the cache."""
    folder = cache_folder()
    if folder is None:
        raise BearingTwinError(
            'compiled code can be kept nowhere: set NUMBA_CACHE_DIR to a folder that you can '
            'write and the nodes can read'
        )
    others, began = ', '.join(other_processors()), time.perf_counter()
    if others and not args.json:
        print(f'the code in {folder} is for another processor ({others})', flush=True)
    # Beside each other, as nothing of the diagnosis calls the dynamics.
    with ProcessPoolExecutor(1, initializer=end_with_parent) as pool:
        beside = pool.submit(_compile_diagnosis)
        dynamics.warm_up(fleet=True)
        try:
            anything, why = beside.result()
        except BrokenProcessPool as error:
            msg = 'the process that compiled the diagnosis was killed; leave it more memory'
            raise BearingTwinError(msg) from error
    if why := why_not_kept() or why:
        raise BearingTwinError(why)
    anything |= has_compiled()
    took = time.perf_counter() - began
    answer = {'processor': processor(), 'folder': str(folder), 'seconds': took}
    if args.json:
        print(json.dumps({**answer, 'compiled': anything}))
    elif anything:
        print(f'kernels compiled for {processor()} in {took:.0f} s; kept in {folder}')
    else:
        print(f'kernels are compiled for {processor()}; kept in {folder}')
    return 0


def _compile_diagnosis() -> tuple[bool, str]:
    """Return whether anything was compiled, and why it could not be kept; '' if it could."""
    diagnosis.warm_up()
    return has_compiled(), why_not_kept()
