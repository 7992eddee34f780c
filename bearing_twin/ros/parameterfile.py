# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Mistakes in parameter files about which rcl says nothing, or no reason. Imports no rclpy."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from contextlib import suppress
from difflib import get_close_matches
from itertools import pairwise
from pathlib import Path
import re
from typing import Any

from bearing_twin.errors import FileError
import yaml

PARAMETERS = 'ros__parameters'
WILDCARDS = {'*': r'/\w+', '**': r'(/\w+)*'}
ALIKE = 0.7
"""Least similarity of a name that is taken for a mistyped one."""


def doubts(words: Sequence[str], node: str) -> list[str]:
    """
    Return a sentence on each likely mistake for a node in parameter files.

    rcl ignores a section that misses the node by name or namespace, and the node would run with
    its defaults. Of a parameter that a section gives twice, rcl keeps the last value.

    Parameters
    ----------
    words
        Arguments of the process.
    node
        Full name of the node.

    """
    sentences = []
    for file in _files(words):
        # rcl has read the file already, or says itself why it cannot.
        with suppress(OSError, ValueError, yaml.YAMLError):
            content = yaml.compose(Path(file).read_text(encoding='utf-8'), yaml.SafeLoader)
            sections = list(_sections(content))
            if wrong := near_misses([name for name, _ in sections], node):
                sentences.append(
                    f'{file} sets parameters of {" and ".join(wrong)}, but this node is {node} '
                    f"and does not take them: write '/**/{node.rpartition('/')[2]}'"
                )
            sentences += _given_twice(file, sections, node)
    return sentences


def _given_twice(file: str, sections: Sequence[tuple[str, Any]], node: str) -> list[str]:
    """Return a sentence on each parameter of a node that a section of a file gives twice."""
    given = defaultdict(list)
    for section, parameters in sections:
        if re.fullmatch(_pattern(section), node):
            for name, line in _lines(parameters):
                given[section, name].append(line)
    return [
        f'{file} gives {name} of {section} in lines {" and ".join(map(str, lines))}: the last '
        'value is taken; delete the others'
        for (section, name), lines in given.items()
        if len(lines) > 1
    ]


def near_misses(sections: Sequence[str], node: str) -> list[str]:
    """
    Return the sections that seem to be meant for a node, if none of them is for it by name.

    Examples
    --------
    >>> near_misses(['/diagnosis', '/adaptor', '/recorder'], '/fan_7/diagnosis')
    ['/diagnosis']
    >>> near_misses(['/adaptor', '/**'], '/adapter')
    ['/adaptor']
    >>> near_misses(['/**/diagnosis', '/pump/diagnosis'], '/fan_7/diagnosis')
    []

    """
    names = {section: section.rpartition('/')[2] for section in sections}
    named = [section for section, name in names.items() if name not in WILDCARDS]
    if any(re.fullmatch(_pattern(section), node) for section in named):
        return []
    meant = get_close_matches(node.rpartition('/')[2], names.values(), cutoff=ALIKE)
    return [section for section in named if names[section] in meant]


def reason(words: Sequence[str]) -> str:
    """
    Return why parameter files are refused, with the line; '' if none is.

    Raises
    ------
    FileError
        If one cannot be read.

    """
    return '; '.join(filter(None, map(_unreadable, _files(words))))


def _unreadable(file: str) -> str:
    try:
        yaml.safe_load(Path(file).read_text(encoding='utf-8'))
    except OSError as error:
        raise FileError(f'{file} cannot be read: {error.strerror}') from None
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 0
        return f'{file}, line {line}: {error.problem}'
    except (ValueError, yaml.YAMLError) as error:
        return f'{file}: {error}'
    return ''


def _files(words: Sequence[str]) -> list[str]:
    return [file for option, file in pairwise(words) if option == '--params-file']


def _sections(content: Any, path: str = '') -> Iterator[tuple[str, Any]]:
    """Yield the name pattern and parameters of each section, which namespaces may nest."""
    if not isinstance(content, yaml.MappingNode):
        return
    for key, value in content.value:
        if key.value == PARAMETERS:
            yield path, value
        else:
            yield from _sections(value, f'{path}/{str(key.value).strip("/")}')


def _lines(parameters: Any, prefix: str = '') -> Iterator[tuple[str, int]]:
    """Yield the name and line of each parameter of a section, which tables may nest."""
    if not isinstance(parameters, yaml.MappingNode):
        return
    for key, value in parameters.value:
        name = f'{prefix}{key.value}'
        if isinstance(value, yaml.MappingNode):
            yield from _lines(value, f'{name}.')
        else:
            yield name, key.start_mark.line + 1


def _pattern(section: str) -> str:
    """Return the regular expression of a section, as ``rcl_yaml_param_parser`` matches it."""
    parts = section.strip('/').split('/')
    return ''.join(WILDCARDS.get(part, f'/{re.escape(part)}') for part in parts)
