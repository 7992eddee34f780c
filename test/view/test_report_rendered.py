# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The report as a browser shows it: on a desk, on a phone, on paper."""

import html
import json
from pathlib import Path
import re
import shutil
import subprocess

from bearing_twin.view.report.page import report_page
import pytest

SCHEDULE = Path(__file__).resolve().parents[2] / 'recordings' / 'paper_schedule.mcap'
CHROMIUM = shutil.which('chromium') or shutil.which('chromium-browser')
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason='there is no Chromium')

# The page runs no script: it is measured from outside, in a frame as wide as the screen.
MEASURE = """
<iframe id="page" style="border:0;width:%(width)dpx;height:4000px" srcdoc="%(page)s"></iframe>
<script>
document.getElementById('page').onload = (event) => {
  const page = event.target.contentDocument, root = page.documentElement;
  const found = {width: root.scrollWidth, smallest: 99, overlaps: [], outside: [], texts: 0};
  for (const svg of page.querySelectorAll('svg')) {
    const scale = svg.getBoundingClientRect().width / svg.viewBox.baseVal.width;
    const whole = svg.getBoundingClientRect(), boxes = [];
    for (const text of svg.querySelectorAll('text')) {
      const size = parseFloat(page.defaultView.getComputedStyle(text).fontSize) * scale;
      found.smallest = Math.min(found.smallest, size);
      found.texts += 1;
      const box = text.getBoundingClientRect(), words = text.textContent.trim();
      if (!words) continue;
      if (box.left < whole.left - 1 || box.right > whole.right + 1) found.outside.push(words);
      for (const [other, b] of boxes) {
        const wide = Math.min(box.right, b.right) - Math.max(box.left, b.left);
        const high = Math.min(box.bottom, b.bottom) - Math.max(box.top, b.top);
        if (wide > 2 && high > 0.4 * size) found.overlaps.push(other + ' / ' + words);
      }
      boxes.push([words, box]);
    }
  }
  document.body.innerHTML = '<pre>' + JSON.stringify(found) + '</pre>';
};
</script>
"""


def chromium(tmp_path, *arguments):
    """Run Chromium; return what it prints."""
    command = [CHROMIUM, '--headless', '--no-sandbox', '--disable-gpu', '--disable-dev-shm-usage']
    command += ['--disable-background-networking', f'--user-data-dir={tmp_path / "profile"}']
    done = subprocess.run([*command, *arguments], capture_output=True, timeout=120, check=True)
    return done.stdout.decode()


@pytest.fixture(scope='module', params=['inner', 'none'])
def page(request, tmp_path_factory):
    """Return the report on a recording with a defect, and on one without."""
    pytest.importorskip('bearing_twin_msgs', reason='the message package is not built')
    from bearing_twin.offline.run import run_offline

    target = tmp_path_factory.mktemp('rendered') / request.param
    run_offline(SCHEDULE, target, twin={'defect': request.param})
    return report_page(target)


@pytest.mark.parametrize('width', [1366, 794, 390])
def test_nothing_overflows_overlaps_or_is_too_small(page, tmp_path, width):
    wrapper = tmp_path / 'wrapper.html'
    wrapper.write_text(MEASURE % {'width': width, 'page': html.escape(page)}, encoding='utf-8')
    shown = chromium(tmp_path, '--virtual-time-budget=5000', '--dump-dom', wrapper.as_uri())
    found = json.loads(html.unescape(re.search(r'<pre>(.*?)</pre>', shown, re.DOTALL)[1]))
    assert found['texts'] > 100
    assert 'mathdefault' not in page
    assert found['width'] <= width
    assert found['smallest'] >= 9.0
    assert found['overlaps'] == []
    assert found['outside'] == []


def test_the_report_prints_on_two_sheets_and_an_appendix(page, tmp_path):
    main = re.sub(r'<section class="appendix">.*</section>', '', page, flags=re.DOTALL)
    for text, sheets in ((main, 2), (page, 4)):
        source, target = tmp_path / 'page.html', tmp_path / 'page.pdf'
        source.write_text(text, encoding='utf-8')
        chromium(tmp_path, '--no-pdf-header-footer', f'--print-to-pdf={target}', source.as_uri())
        assert len(re.findall(rb'/Type\s*/Page\b', target.read_bytes())) == sheets
