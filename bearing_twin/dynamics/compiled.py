# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Compilation of the kernels: cached where that is possible, and never stale."""

from __future__ import annotations

import contextlib
import hashlib
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numba as nb

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ['FAST', 'compiled']

FAST = frozenset({'contract', 'reassoc', 'nsz', 'arcp', 'nnan', 'ninf'})
"""Floating point freedom of the kernels; the same machine still gives the same bits."""

F = TypeVar('F', bound='Callable[..., Any]')


def compiled(*, inline: bool = False, fast: frozenset[str] = frozenset()) -> Callable[[F], F]:
    """Return a decorator that compiles a function on its first call and caches the code.

    Parameters
    ----------
    inline
        Copy the function into its callers.
    fast
        Flags of floating point freedom, e.g. `FAST`.

    Notes
    -----
    Division follows numpy: a check for zero would put an exception, and with it reference
    counting, into every inner loop. Where no cache can be written the function is compiled anew
    in each process.
    """

    def decorate(function: F) -> F:
        options: dict[str, Any] = {
            'inline': 'always' if inline else 'never',
            'fastmath': set(fast) or False,
            'error_model': 'numpy',
        }
        try:
            dispatcher: F = nb.njit(cache=True, **options)(function)
        except RuntimeError:  # no writable folder for the cache
            dispatcher = nb.njit(**options)(function)
        return dispatcher

    return decorate


def _drop_stale() -> None:
    """Remove cached code that was compiled from other sources.

    The cache looks at the file of a function only, not at those of the functions that it calls.
    """
    here = Path(__file__).parent
    digest = hashlib.sha256(nb.__version__.encode())
    for folder in (here, here.parent / 'thermal'):
        for source in sorted(folder.glob('*.py')):
            digest.update(source.read_bytes())
    stamp = here / '__pycache__' / 'kernels.sha256'
    with contextlib.suppress(OSError):
        if stamp.is_file() and stamp.read_text() == digest.hexdigest():
            return
        for folder in (here, here.parent / 'thermal'):
            for index in (folder / '__pycache__').glob('*.nb[ic]'):
                index.unlink()
        stamp.parent.mkdir(exist_ok=True)
        stamp.write_text(digest.hexdigest())


_drop_stale()
