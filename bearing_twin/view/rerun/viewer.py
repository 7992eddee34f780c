# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The Rerun viewer: in a window, in the browser, or without a display for pictures."""

from __future__ import annotations

from collections.abc import Callable, Sequence
import contextlib
import math
import os
from pathlib import Path
import re
import socket
import subprocess
import tempfile
import time
from typing import Any
from urllib.parse import quote, urlsplit

from bearing_twin.errors import BearingTwinError
from bearing_twin.stamps import NANO
from bearing_twin.view.rerun.ports import bracketed, free_port
import numpy as np
import psutil
import rerun_cli

LOOPBACK = '127.0.0.1'
START_TIMEOUT = 30.0
LOAD_TIMEOUT = 120.0
POLL = 0.7
SETTLE = 2.5
"""Time for the layout of the views after data have arrived, s."""


def listening(pid: int) -> list[int]:
    """
    Return the TCP ports at which a process listens.

    Examples
    --------
    >>> with socket.create_server((LOOPBACK, 0)) as server:
    ...     server.getsockname()[1] in listening(os.getpid())
    True

    """
    # The query for a single process has another name in the psutil of Ubuntu 24.04.
    found = (c for c in psutil.net_connections('tcp') if c.pid == pid)
    return [c.laddr.port for c in found if c.laddr and c.status == psutil.CONN_LISTEN]


def live_url(text: str) -> str:
    """Return the URL of a Rerun server from a URL, ADDRESS:PORT or PORT."""
    if text.startswith(('rerun://', 'rerun+http://', 'rerun+https://')):
        with contextlib.suppress(ValueError):
            # Reading ``port`` raises if it is not a number.
            if urlsplit(text).port != 0:
                return text
    found = re.fullmatch(r'(?:(?P<host>[^:/\s]+|\[[0-9a-fA-F:]+\]):)?(?P<port>\d{1,5})', text)
    if not found or not 0 < int(found['port']) < 65536:
        msg = f'{text!r} is no Rerun server; give a port (9876), ADDRESS:PORT or rerun+http://...'
        raise BearingTwinError(msg)
    return f'rerun+http://{found["host"] or LOOPBACK}:{found["port"]}/proxy'


def show(sources: Sequence[str]) -> int:
    """Open files or servers in a window; return the viewer's exit status when it is closed."""
    if not {'DISPLAY', 'WAYLAND_DISPLAY'} & set(os.environ):
        msg = 'there is no display; use --web for the browser or --screenshot for a picture'
        raise BearingTwinError(msg)
    return subprocess.call([_binary(), '--bind', LOOPBACK, '--port', '0', *sources])


def show_in_browser(
    sources: Sequence[str], *, address: str, web_port: int, announce: Callable[[str], None]
) -> int:
    """Serve files, or one server, to browsers until interrupted."""
    try:
        port = free_port(address, web_port)
    except (OSError, OverflowError, TypeError, ValueError) as error:
        # Besides OSError: a port above 65535, an address that is not text or too long.
        reason = getattr(error, 'strerror', None) or error
        raise BearingTwinError(
            f'{address}:{web_port} cannot be served ({reason}); choose another --web-port or '
            '--address'
        ) from None
    servers = [source for source in sources if '://' in source]
    shown = socket.gethostname() if address in ('0.0.0.0', '::') else bracketed(address)
    command = [_binary(), '--serve-web', '--bind', address, '--port', '0']
    command += ['--web-viewer-port', str(port), '--server-memory-limit', '75%', *sources]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as server:
        try:
            ports = _served(server, 1 if servers else 2) - {port}
            data = servers[0] if servers else f'rerun+http://{shown}:{ports.pop()}/proxy'
            announce(f'http://{shown}:{port}/?url={quote(data, safe="")}')
            return server.wait()
        except KeyboardInterrupt:
            return 0
        finally:
            server.terminate()


def _served(server: subprocess.Popen[bytes], count: int) -> set[int]:
    """Return the ports of a server once it has ``count``; it chooses the data port itself."""
    deadline = time.monotonic() + START_TIMEOUT
    while server.poll() is None and time.monotonic() < deadline:
        if len(ports := {*listening(server.pid)}) >= count:
            return ports
        time.sleep(POLL)
    raise BearingTwinError('the viewer serves no page; choose another --web-port or --address')


class HeadlessViewer:
    """
    A viewer without a display, controlled by this process.

    Raises
    ------
    BearingTwinError
        If there is no Vulkan device, or the viewer does not come up.

    """

    def __init__(self, sources: Sequence[str], *, size: tuple[int, int]) -> None:
        from rerun.experimental import ViewerClient

        self._live = any('://' in source for source in sources)
        self._folder = tempfile.TemporaryDirectory(prefix='bearing_twin_view_')
        # A terminated viewer leaves a folder behind.
        environment = os.environ | {
            'XDG_RUNTIME_DIR': self._folder.name,
            'TMPDIR': self._folder.name,
        }
        command = [_binary(), '--headless', '--bind', LOOPBACK, '--port', '0']
        command += ['--window-size', f'{size[0]}x{size[1]}', '--hide-welcome-screen', *sources]
        self._errors = Path(self._folder.name) / 'stderr'
        with self._errors.open('wb') as errors:
            self._process = subprocess.Popen(
                command, env=environment, stdout=subprocess.DEVNULL, stderr=errors
            )
        try:
            self.client: Any = self._connect(ViewerClient)
        except BaseException:
            self.close()
            raise

    @property
    def pid(self) -> int:
        """Process id of the viewer."""
        return self._process.pid

    def wait(self, seconds: float | None = None) -> None:
        """
        Wait until files are loaded or the past of a server is read, and show one moment.

        ``seconds`` count from the beginning of the blueprint's timeline; None: follow the end.
        """
        deadline = time.monotonic() + LOAD_TIMEOUT
        before, then = -math.inf, time.monotonic()
        while True:
            time.sleep(POLL)
            state = self._state()
            ends = [t.end for r in state.recordings for t in r.timelines if t.end is not None]
            now, end = time.monotonic(), max(ends, default=-math.inf)
            # A server sends on: its past is read when time passes as fast there as here.
            grown = 1e-9 * (end - before)
            there = grown < 2.0 * (now - then) if self._live else end == before
            if state.views and ends and there and (self._live or not state.loading):
                break
            before, then = end, now
            if now > deadline:
                raise BearingTwinError(f'the viewer has loaded nothing within {LOAD_TIMEOUT:g} s')
        if seconds is None:
            self.client.set_time(play_state='following')
        else:
            self._pause(state, seconds)
        time.sleep(SETTLE)

    def _pause(self, state: Any, seconds: float) -> None:
        recordings = [r for r in state.recordings if r.store_id == state.active_recording]
        for recording in recordings or state.recordings:
            for found in recording.timelines:
                if found.name != recording.current_timeline or found.start is None:
                    continue
                length = 1e-9 * (found.end - found.start)
                if not 0.0 <= seconds <= length:
                    msg = f'{seconds:g} s is outside of the {length:.1f} s that are shown'
                    raise BearingTwinError(msg)
                at = found.start + round(NANO * seconds)
                if found.time_type.lower().startswith('duration'):
                    self.client.set_time(duration=np.timedelta64(at, 'ns'), play_state='paused')
                else:
                    self.client.set_time(timestamp=np.datetime64(at, 'ns'), play_state='paused')
                return
        raise BearingTwinError('what is shown has no time')

    def screenshot(self, path: Path) -> None:
        """Write what the window shows as PNG."""
        self.client.save_screenshot(str(path))

    def close(self) -> None:
        """End the viewer."""
        if self._process.poll() is None:
            self._process.terminate()
            try:
                self._process.wait(5.0)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        self._folder.cleanup()

    def __enter__(self) -> HeadlessViewer:
        """Return itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """End the viewer."""
        self.close()

    def _connect(self, client_class: Any) -> Any:
        deadline = time.monotonic() + START_TIMEOUT
        while True:
            self._check()
            try:
                port = max(listening(self.pid), default=0)
                client = client_class.connect(f'rerun+http://{LOOPBACK}:{port}/proxy')
                client.get_state()
            except Exception as error:
                # The bindings raise bare exceptions while the viewer does not answer yet.
                if time.monotonic() > deadline:
                    msg = f'the viewer did not answer within {START_TIMEOUT:g} s ({error})'
                    raise BearingTwinError(msg) from None
                time.sleep(0.3)
            else:
                return client

    def _state(self) -> Any:
        self._check()
        try:
            return self.client.get_state()
        except ConnectionError:
            # The viewer is about to end; its reason is known only afterwards.
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(5.0)
            self._check()
            raise

    def _check(self) -> None:
        if self._process.poll() is None:
            return
        text = self._errors.read_text(errors='replace')
        # With OpenGL only, even in software, the viewer panics instead of naming the adapter.
        if 'adapter' in text or 'render context' in text:
            raise BearingTwinError(
                'no Vulkan device for pictures without a display; on Debian or Ubuntu install '
                'mesa-vulkan-drivers and libvulkan1'
            )
        last = text.strip().splitlines()[-1:] or ['no message']
        msg = f'the viewer ended with status {self._process.returncode}: {last[0]}'
        raise BearingTwinError(msg)


def _binary() -> str:
    """Return the path of the viewer; the `rerun` script is a wrapper that outlives its child."""
    binary = Path(rerun_cli.__file__).with_name('rerun')
    if not binary.exists():
        raise BearingTwinError(f'the Rerun viewer is not in {binary.parent}; reinstall rerun-sdk')
    return str(binary)
