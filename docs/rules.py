# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Write the table of rules in ``docs/diagnosis.md`` from the rules themselves.

It replaces the text between the two markers::

    python docs/rules.py docs/diagnosis.md
"""

from pathlib import Path
import re
import sys

from bearing_twin.diagnosis.rules import RULES

__all__ = ['with_rules']

BEGIN, END = '<!-- rules -->', '<!-- end of rules -->'


def with_rules(text: str) -> str:
    """Return the document with the present rules in it."""
    rows = ['| rule | answer | why |', '|---|---|---|']
    rows += [f'| `{rule.name}` | *{rule.answer}* | {rule.why} |' for rule in RULES]
    table = '\n'.join((BEGIN, *rows, END))
    return re.sub(f'{BEGIN}.*?{END}', lambda _: table, text, flags=re.DOTALL)


if __name__ == '__main__':
    document = Path(sys.argv[1])
    document.write_text(with_rules(document.read_text('utf-8')), 'utf-8')
