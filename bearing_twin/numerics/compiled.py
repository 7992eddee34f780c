# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Compilation of the kernels with numba, and the cache of the compiled code.

Numba's cache checks the source file of a function, but not the files of the functions that it
calls. Here a digest of all these sources is part of the cache folder's name, so code compiled from
other sources is never loaded.
"""

from __future__ import annotations

from collections.abc import Callable
import contextlib
import functools
import hashlib
import logging
import os
from pathlib import Path
import pickle
import shutil
import tempfile
import time
from typing import Any, cast, TypeVar

import numba as nb
from numba.core import event
from numba.core.caching import FunctionCache

FAST = frozenset({'contract', 'reassoc', 'nsz', 'arcp', 'nnan', 'ninf'})
"""Fast-math flags of the kernels; results on one machine remain the same to the bit."""

SHARED = (
    *('numerics/*.py', 'bearing/*.py', 'thermal/*.py', 'dynamics/**/*.py'),
    'diagnosis/signal/lines.py',
    'diagnosis/signal/stockham.py',
)
"""Files whose functions or constants are compiled into the code of other files."""

_numba: Any = nb.config

F = TypeVar('F', bound='Callable[..., Any]')


def compiled(
    *, inline: bool = False, fast: frozenset[str] = frozenset(), borrows: bool = False
) -> Callable[[F], F]:
    """
    Return a decorator that compiles a function on its first call and caches the code.

    Parameters
    ----------
    inline
        Copy the function into its callers.
    fast
        Fast-math flags, e.g. `FAST`.
    borrows
        The function makes no arrays. Numba then does not count references to the arrays it is
        given: atomic counting would cost as much as the arithmetic of a step.

    Notes
    -----
    Division by zero follows numpy: a check would put an exception, and with it reference
    counting, into every inner loop. Where no cache can be written, each process compiles the
    function again.

    Examples
    --------
    >>> from bearing_twin.thermal import network
    >>> change = compiled()(network.clearance_change)
    >>> round(1e6 * change(60.0, 40.0, 0.05735), 2)
    -6.88

    """

    def decorate(function: F) -> F:
        options: dict[str, Any] = {
            'inline': 'always' if inline else 'never',
            'fastmath': set(fast) or False,
            'error_model': 'numpy',
            # Other threads run meanwhile, e.g. the diagnosis of an offline run.
            'nogil': True,
        }
        if borrows:
            options['_nrt'] = False
        folder = cache_folder()
        if folder is None:
            plain: F = nb.njit(**options)(function)
            return plain
        # Numba reads this setting while it decorates; other users of numba keep their own.
        before = _numba.CACHE_DIR
        _numba.CACHE_DIR = str(folder)
        try:
            cached: Any = nb.njit(**options)(function)
            cached._cache = _Cache(function)  # type: ignore[no-untyped-call]
        finally:
            _numba.CACHE_DIR = before
        return cast('F', cached)

    return decorate


class _Cache(FunctionCache):
    """Cache of one function; a full disk or a damaged file costs time, but ends no command."""

    def load_overload(self, *key: Any) -> Any:
        try:
            return super().load_overload(*key)  # type: ignore[no-untyped-call]
        except Exception:
            # Damaged bytes raise errors of any type. An empty index takes the code again.
            with contextlib.suppress(OSError):
                self.flush()  # type: ignore[no-untyped-call]
            return None

    def save_overload(self, *entry: Any) -> None:
        try:
            super().save_overload(*entry)  # type: ignore[no-untyped-call]
        except OSError as error:
            if not _unkept:
                _unkept.append(
                    f'compiled code cannot be kept in {cache_folder()} ({error.strerror}): each '
                    'start compiles it again; make room, or set NUMBA_CACHE_DIR to another folder'
                )
                logging.getLogger(__name__).warning(_unkept[0])


_unkept: list[str] = []


def why_not_kept() -> str:
    """
    Return why compiled code of this process could not be written to the cache; '' if it could.

    >>> why_not_kept()
    ''

    """
    return ''.join(_unkept)


def has_compiled() -> bool:
    """
    Whether this process has compiled anything or begun to; loading from the cache does not count.

    >>> has_compiled() in (True, False)
    True

    """
    return _passes.seen


class _Passes(event.Listener):
    """Records that a pass of the compiler has begun."""

    seen = False

    def on_start(self, event: event.Event) -> None:
        self.seen = True

    def on_end(self, event: event.Event) -> None:
        """Nothing to do."""


_passes = _Passes()
event.register('numba:run_pass', _passes)  # type: ignore[no-untyped-call]


@functools.cache
def cache_folder() -> Path | None:
    """
    Return the cache folder for the present sources; None if no folder can be written.

    It lies in ``NUMBA_CACHE_DIR`` if that is set, otherwise beside the sources or, if they are
    read-only, in the user's cache folder (``XDG_CACHE_HOME``, by default ``~/.cache``).

    Examples
    --------
    >>> folder = cache_folder()
    >>> folder is None or folder.is_dir()
    True

    """
    bases = [Path(__file__).parent / '__pycache__']
    if _numba.CACHE_DIR:
        bases = [Path(_numba.CACHE_DIR)]
    elif os.environ.get('XDG_CACHE_HOME'):
        bases.append(Path(os.environ['XDG_CACHE_HOME']))
    else:
        with contextlib.suppress(RuntimeError):  # a user without a home
            bases.append(Path.home() / '.cache')
    name = f'bearing_twin-{_digest()}'
    for base in bases:
        folder = base / name
        with contextlib.suppress(OSError):
            folder.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=folder):
                os.utime(folder)
            _drop_old(base)
            return folder.resolve()
    return None


def processor() -> str:
    """
    Return the name of the processor that code is compiled for.

    Examples
    --------
    >>> processor() != ''
    True

    """
    return str(_target()[1])


@functools.cache
def other_processors() -> list[str]:
    """
    Return the processors that the cache has code for, if it has none for the present one.

    Numba stores code by processor name and features and never loads code of another processor: a
    copied or shared folder costs another compilation, but gives no wrong results. Only the first
    call reads the folder.

    Examples
    --------
    >>> processor() in other_processors()
    False

    """
    folder = cache_folder()
    found = set()
    for index in folder.rglob('*.nbi') if folder is not None else ():
        with contextlib.suppress(OSError, EOFError, pickle.UnpicklingError), index.open('rb') as f:
            pickle.load(f)  # version of numba
            _, overloads = pickle.loads(f.read())
            found |= {key[1] for key in overloads}
    return [] if _target() in found else sorted({str(target[1]) for target in found})


def _target() -> tuple[str, ...]:
    """Return numba's key of compiled code: architecture, processor and its features."""
    from numba.core.registry import cpu_target

    return tuple(cpu_target.target_context.codegen().magic_tuple())


def _digest() -> str:
    """Return the digest of numba's version and the sources in `SHARED`."""
    package = Path(__file__).parents[1]
    digest = hashlib.sha256(nb.__version__.encode())
    for pattern in SHARED:
        for source in sorted(package.glob(pattern)):
            digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


def _drop_old(base: Path) -> None:
    """Remove cache folders that have not been used for 30 days."""
    for folder in base.glob('bearing_twin-' + '?' * 16):
        if time.time() - folder.stat().st_mtime > 30 * 86400:
            shutil.rmtree(folder, ignore_errors=True)
