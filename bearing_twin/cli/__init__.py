# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
# PYTHON_ARGCOMPLETE_OK
"""
The ``bearing-twin`` command, with a module or a package for each sub-command.

The sub-command NAME is in ``bearing_twin/cli/NAME.py``, or in a package of that name. Its
``configure(parser)`` adds the arguments; its ``run(args) -> int`` does the work and returns the
exit status.
Only the module of the called command is imported, which keeps the start short.

Shells that have run ``eval "$(register-python-argcomplete bearing-twin)"`` complete words.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
import errno
import gc
import importlib
import os
import sys
import threading

from bearing_twin import __version__
from bearing_twin.cli.arguments import refuse_command, refuse_unknown, take_as_meant
from bearing_twin.cli.terminal import mend_streams, report_compiling
from bearing_twin.errors import BearingTwinError, REFUSED, shown, UsageError
from bearing_twin.process import (
    begin_collection,
    end_as_interrupted,
    keep_freed_memory,
    Terminated,
)

__all__ = ['COMMANDS', 'main']

COMMANDS = {
    'bearings': 'look up a bearing: fault orders, geometry, source',
    'bench': 'measure speed and load on this machine, with their targets',
    'benchmark': 'score the diagnosis on a folder of labelled records',
    'compile': 'compile the kernels now, which their first use does otherwise',
    'demo': 'run twin, diagnosis and recorder on a temperature recording and show the result',
    'diagnose': 'say what is wrong with the bearing in vibration files',
    'fit': 'fit the twin to vibration files: width of a defect, sensor path, with intervals',
    'info': 'show what is inside a recording and how sound it is',
    'paper': 'recompute every figure and claim of the seed paper and judge it',
    'play': 'publish a vibration file as a sensor would, in real time',
    'recover': 'save the complete messages of a damaged recording',
    'replay': 'publish a recording again, or run it offline through twin and diagnosis',
    'report': 'show a recording on one HTML page, to be mailed and printed',
    'run': 'run a node, as ros2 run does, with the same arguments',
    'schedule': 'write a measured temperature, or that of the paper, as a recording',
    'verify': 're-run a recording of twin and diagnosis and compare it byte by byte',
    'view': 'show recordings, or what is running, in Rerun',
    'whatif': 'say what a fitted machine would show at another speed, load, temperature or width',
}
"""Name and one-line help of every sub-command."""

_UNWRITTEN = (errno.EBADF, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.ENOSPC)
"""Errors of writing."""

SLOW = 5.0
"""Time after which a command reports that it compiles, s."""


class _Help(argparse.HelpFormatter):
    """Help with a column for the longest sub-command: argparse does not count their indent."""

    def add_argument(self, action: argparse.Action) -> None:
        self._indent()
        super().add_argument(action)
        self._dedent()


def main(argv: Sequence[str] | None = None) -> int:
    """
    Run ``bearing-twin``; return the exit status.

    It is 0 only if it did what was asked, 2 (:data:`~bearing_twin.errors.REFUSED`) if the call is
    refused, 1 if anything else fails, such as a file, 130 after an interrupt, 143 after SIGTERM.

    Parameters
    ----------
    argv
        Arguments after ``bearing-twin``; None: those of this process.

    """
    arguments = list(sys.argv[1:] if argv is None else argv)
    completing = '_ARGCOMPLETE' in os.environ
    if completing:
        # A shell asks for completions: the line so far is in the environment.
        arguments = os.environ.get('COMP_LINE', '').split()[1:]
    parser, commands = _parsers()
    chosen = next((word for word in arguments if not word.startswith('-')), '')
    if chosen in commands:
        try:
            module = importlib.import_module(f'bearing_twin.cli.{chosen}')
        except ImportError as error:
            missing = "a library is missing or too old: 'pip install -r requirements.txt'"
            print(f'bearing-twin {chosen}: {error}; {missing}', file=sys.stderr)
            return 1
        module.configure(commands[chosen])
        commands[chosen].set_defaults(run=module.run, parser=commands[chosen])
    if completing:
        import argcomplete

        argcomplete.autocomplete(parser)
    elif chosen and chosen not in commands:
        refuse_command(parser, chosen, commands)
    args, unknown = parser.parse_known_args(arguments)
    if unknown:
        refuse_unknown(getattr(args, 'parser', parser), unknown)
    if args.command is None:
        parser.print_help()
        return 0
    keep_freed_memory()
    mend_streams()
    if args.command not in {'play', 'replay', 'run'}:
        # rclpy takes SIGTERM in these three.
        end_as_interrupted()
    if args.command != 'run':
        # Nearly all objects of a command live to its end. If there are many, repeated searches for
        # garbage take half of the time.
        gc.set_threshold(20_000, 20, 20)
        begin_collection()
    return _status(args)


def _parsers() -> tuple[argparse.ArgumentParser, dict[str, argparse.ArgumentParser]]:
    """Return the parser of the command, and that of each sub-command, still without arguments."""
    parser = argparse.ArgumentParser(
        prog='bearing-twin',
        description='Temperature-aware bearing twin and diagnosis.',
        formatter_class=_Help,
    )
    parser.add_argument('--version', action='version', version=f'%(prog)s {__version__}')
    subparsers = parser.add_subparsers(dest='command', metavar='COMMAND')
    commands = {
        name: subparsers.add_parser(name, help=text, description=text[0].upper() + text[1:] + '.')
        for name, text in COMMANDS.items()
    }
    for command in commands.values():
        take_as_meant(command)
    return parser, commands


def _status(args: argparse.Namespace) -> int:
    """Run a sub-command; return its exit status, after an error with the reason on stderr."""
    slow = threading.Timer(SLOW, report_compiling, [args.command])
    slow.daemon = True
    if args.command not in {'compile', 'demo', 'run'}:
        # These three report it themselves.
        slow.start()
    try:
        status: int = args.run(args)
        sys.stdout.flush()
    except BearingTwinError as error:
        text = shown(error, keep='\n')
        print(f'bearing-twin {args.command}: {text}', file=sys.stderr)
        return REFUSED if isinstance(error, UsageError) else 1
    except Terminated:
        return 143
    except KeyboardInterrupt:
        return 130
    except BrokenPipeError:
        return 141
    except OSError as error:
        said = error.strerror or error
        # Files that a command writes name themselves; the other output is the standard one.
        printed = 'standard output' if error.errno in _UNWRITTEN else ''
        where = f'{name}: ' if (name := error.filename or printed) else ''
        print(f'bearing-twin {args.command}: {shown(f"{where}{said}")}', file=sys.stderr)
        return 1
    finally:
        slow.cancel()
    return status
