# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Fill in who publishes the packages: python docs/identity.py 'NAME <MAIL>' URL."""

from pathlib import Path
import re
import sys
from xml.sax.saxutils import escape, quoteattr

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = (ROOT / 'package.xml', ROOT / 'msg_defs' / 'package.xml')


def identified(text: str, maintainer: str, url: str) -> str:
    """Return a package.xml with this maintainer ('NAME <MAIL>') and repository."""
    found = re.fullmatch(r'([^<>]+?)\s*<([^<>@\s]+@[^<>@\s]+)>', maintainer)
    if not (found and re.fullmatch(r'https://[^\s/]+/\S+', url)):
        raise SystemExit("usage: make identity MAINTAINER='NAME <MAIL>' URL=https://HOST/PROJECT")
    name, mail = found.groups()
    fields = (
        f'  <maintainer email={quoteattr(mail)}>{escape(name)}</maintainer>\n',
        '  <license>Apache-2.0</license>\n',
        f'  <url type="website">{escape(url)}</url>\n',
        f'  <url type="repository">{escape(url)}</url>\n',
        f'  <url type="bugtracker">{escape(url)}/issues</url>\n',
    )
    text = re.sub(r'  <url .*</url>\n', '', text)
    return re.sub(
        r'  <maintainer .*</maintainer>\n  <license>.*</license>\n',
        lambda _: ''.join(fields),
        text,
    )


if __name__ == '__main__':
    if len(sys.argv) != 3:
        raise SystemExit(__doc__)
    for path in PACKAGES:
        path.write_text(identified(path.read_text(), *sys.argv[1:]))
