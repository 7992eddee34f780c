# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The report as a browser shows it: on a desk, on a phone, on paper."""

import html
import json
import re
import shutil

from bearing_twin import cli
from bearing_twin.recording.reader import read_messages
from bearing_twin.recording.writer import RecordingWriter
from bearing_twin.view.report.page import report_page
from bearing_twin.view.report.pdf import browse, BROWSERS, pdf_of
from cases import in_proofs
from copies import put
import pytest

pytestmark = pytest.mark.skipif(
    not any(map(shutil.which, BROWSERS)), reason='there is no Chromium'
)

# The page runs no script: it is measured from outside, in a frame as wide as the screen.
MEASURE = """
<iframe id="page" style="border:0;width:%(width)dpx;height:4000px" srcdoc="%(page)s"></iframe>
<script>
document.getElementById('page').onload = (event) => {
  const page = event.target.contentDocument, root = page.documentElement;
  const found = {width: root.scrollWidth, smallest: 99, overlaps: [], outside: [], texts: 0,
    broken: []};
  for (const cell of page.querySelectorAll('.wide th')) {
    const range = page.createRange();
    for (const word of cell.textContent.matchAll(/[A-Za-z]+/g)) {
      const text = page.createTreeWalker(cell, NodeFilter.SHOW_TEXT).nextNode();
      if (text.length < cell.textContent.length) continue;
      range.setStart(text, word.index);
      range.setEnd(text, word.index + word[0].length);
      if (range.getClientRects().length > 1) found.broken.push(word[0]);
    }
  }
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


@pytest.fixture(scope='module', params=['inner', *in_proofs('none')])
def recording(request, scheduled):
    """Return a recording with a defect, and one without."""
    return scheduled(defect=request.param)


@pytest.fixture(scope='module')
def page(recording):
    """Return the report on it."""
    return report_page(recording)


def measured(page, width):
    """Return what a browser makes of a page on a screen of that width."""
    wrapper = MEASURE % {'width': width, 'page': html.escape(page)}
    shown = browse(wrapper, '--virtual-time-budget=5000', '--dump-dom')
    return json.loads(html.unescape(re.search(r'<pre>(.*?)</pre>', shown, re.DOTALL)[1]))


@pytest.mark.parametrize('width', [1366, 794, 390])
def test_nothing_overflows_overlaps_or_is_too_small(page, width):
    found = measured(page, width)
    assert found['texts'] > 100
    assert 'mathdefault' not in page
    assert found['width'] <= width
    assert found['smallest'] >= 9.0
    assert found['overlaps'] == []
    assert found['outside'] == []


def test_the_report_prints_on_two_sheets_and_an_appendix(page, recording, tmp_path):
    main = re.sub(r'<section class="appendix">.*</section>', '', page, flags=re.DOTALL)
    target = tmp_path / 'page.pdf'
    assert cli.main(['report', str(recording), '-o', str(target)]) == 0
    assert sheets(pdf_of(main)) == 2
    assert sheets(target.read_bytes()) == 4


def sheets(pdf):
    return len(re.findall(rb'/Type\s*/Page\b', pdf))


@pytest.mark.parametrize(('sound', 'damaged'), [('a', 'ef'), *in_proofs(('abcd', 'efgh'))])
def test_a_fleet_prints_all_machines_on_a_sheet_and_the_two_most_urgent(
    scheduled, tmp_path, sound, damaged
):
    fleet = {sound: scheduled(defect='none'), damaged: scheduled(defect='inner')}
    with RecordingWriter(tmp_path / 'fleet') as writer:
        for names, recording in fleet.items():
            begin = next(read_messages(recording)).log_time
            for message in read_messages(recording, end=begin + 12_000_000_000):
                for name in names:
                    put(writer, message, f'/line1/{name}{message.topic}')
    page = report_page(tmp_path / 'fleet')
    main = re.sub(r'<section class="appendix">.*</section>', '', page, flags=re.DOTALL)
    assert sheets(pdf_of(main)) == 1 + 2 * 2
    overview = re.search(r'<section class="overview">.*?</section>', page, re.DOTALL)[0]
    assert re.findall(r'<a href="#m\d">(.*?)</a>', overview) == [
        f'/line1/{name}' for name in damaged + sound
    ]
    for width in (390, 794):
        found = measured(page, width)
        assert found['width'] <= width
        assert found['broken'] == []
