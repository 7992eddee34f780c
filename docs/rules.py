# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Write tables into the pages on the diagnosis: that of the rules, or what a study prints.

A table replaces the text between its two markers::

    python docs/rules.py docs/diagnosis.md
    python -m bearing_twin.studies.noise_windows | python docs/rules.py docs/diagnosis_why.md noise
"""

from pathlib import Path
import re
import sys

from bearing_twin.diagnosis.rules.table import RULES


def with_block(text: str, name: str, content: str) -> str:
    """Return the document with other text between the markers of a name."""
    begin, end = f'<!-- {name} -->', f'<!-- end of {name} -->'
    if begin not in text or end not in text:
        msg = f'the document has no markers {begin} and {end}'
        raise ValueError(msg)
    block = '\n'.join((begin, content.strip(), end))
    return re.sub(f'{begin}.*?{end}', lambda _: block, text, flags=re.DOTALL)


def with_rules(text: str) -> str:
    """Return the document with the present rules in it."""
    rows = ['| rule | answer | why |', '|---|---|---|']
    rows += [f'| `{rule.name}` | *{rule.answer}* | {rule.why} |' for rule in RULES]
    steps = ['| rule | next step | confidence |', '|---|---|---|']
    steps += [
        f'| `{rule.name}` | {rule.tells} | '
        f'{f"at most {rule.at_most:g}" if rule.at_most < 1.0 else "that something strikes"} |'
        for rule in RULES
        if rule.tells and rule.answer in ('suspect', 'ambiguous')
    ]
    text = with_block(text, 'tells', '\n'.join(steps))
    return with_block(text, 'rules', '\n'.join(rows))


if __name__ == '__main__':
    document = Path(sys.argv[1])
    before = document.read_text('utf-8')
    after = (
        with_block(before, sys.argv[2], sys.stdin.read()) if sys.argv[2:] else with_rules(before)
    )
    document.write_text(after, 'utf-8')
