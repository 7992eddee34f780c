# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Means over temperature, and whether vibration is simulated or measured."""

import math

from bearing_twin.assets.parameters.twin import SPECS
from bearing_twin.streams.vibration_input import SOURCE_MEASURED, SOURCE_SIMULATED
from bearing_twin.view.over_temperature import OverTemperature
from bearing_twin.view.source import Source, twin_in_words
from drawn import header, message
import numpy as np
import pytest


def test_means_are_of_their_class_and_ratios_refer_to_20_degrees():
    over = OverTemperature()
    for temperature, scale in ((19.0, 1.0), (21.0, 3.0), (64.0, 4.0), (108.0, 1.0)):
        over.vibration(scale * np.array([1.0, -2.0, 0.0, 1.0]), 'm/s^2', 4.0, temperature)
    over.vibration(np.ones(4), 'm/s^2', 4.0, math.nan)
    amplitude, level = over.curves
    assert list(amplitude.temperatures) == [20.0, 65.0, 110.0]
    assert list(amplitude.values) == [4.0, 8.0, 2.0]
    assert (amplitude.base, amplitude.reference) == (4.0, 20.0)
    # Mean squares are averaged, not roots: 1.5 (1 + 9) / 2 in the first class.
    assert level.values == pytest.approx(np.sqrt([7.5, 24.0, 1.5]))
    assert level.title == 'Level, rms [m/s²]'


def test_the_amplitude_is_that_of_a_second_however_short_the_blocks():
    # Impacts at 5 Hz, and every second of a beat the weaker ones: most blocks have none.
    rate, blocks = 1000.0, 25
    whole = np.random.default_rng(1).normal(0.0, 0.1, 8 * round(rate))
    whole[100::200] += 10.0 + 4.0 * np.cos(0.5 * np.pi * np.arange(100, whole.size, 200) / rate)
    over = OverTemperature()
    for k, block in enumerate(np.split(whole, 8 * blocks)):
        over.vibration(block, 'g', rate, 20.0 if k < 4 * blocks else 100.0)
    amplitude = over.curves[0]
    seconds = whole.reshape(8, -1).max(axis=1)
    assert amplitude.values == pytest.approx([seconds[:4].mean(), seconds[4:].mean()], rel=0.03)
    assert amplitude.values[1] / amplitude.base == pytest.approx(1.0, abs=0.03)


def test_a_sensor_that_tells_a_stop_has_no_quiet_class_of_temperature():
    over = OverTemperature()
    for temperature, scale, hertz in ((20.0, 4.0, 25.0), (45.0, 5.0, 25.1), (70.0, 0.01, 0.0)):
        over.vibration(scale * np.array([1.0, -1.0]), 'm/s^2', 2.0, temperature, hertz)
    amplitude, _ = over.curves
    assert list(amplitude.temperatures) == [20.0, 45.0]


def test_the_frequency_found_is_of_one_place():
    over = OverTemperature()
    for place, hertz in (('inner', 126.0), ('ambiguous', 77.0), ('outer', 76.0), ('inner', 127.0)):
        over.diagnosis(message('Diagnosis', result_name=place, temperature=20.0, fault_hz=hertz))
    (found,) = over.curves
    assert list(found.values) == [126.5]


def test_another_defect_of_the_twin_is_no_effect_of_temperature():
    over = OverTemperature()

    def hear(defect, temperature, scale):
        over.state(message('TwinState', temperature_used=temperature, defect=defect, slip=0.01))
        over.vibration(scale * np.array([1.0, -1.0]), 'm/s^2', 2.0, temperature)
        over.take_strip(np.ones(2000), 0, 12000.0, temperature)

    hear('inner:width=0.002', 20.0, 4.0)
    hear('inner:width=0.003', 80.0, 3.0)
    assert list(over.curves[0].temperatures) == [20.0, 80.0] and len(over.strips) == 2
    for defect in ('ball', 'ball+inner'):
        hear(defect, 80.0, 1.0)
        assert list(over.curves[0].values) == [1.0] and len(over.strips) == 1


@pytest.mark.parametrize('other', [0.0, 30.0])
def test_another_speed_is_no_effect_of_temperature(other):
    over = OverTemperature()
    for temperature, speed, scale in ((20, 25, 4), (50, 25.1, 3), (80, other, 1), (110, 25, 2)):
        state = {'temperature_used': temperature, 'shaft_hz': speed, 'bpfi': 5.0 * speed}
        over.state(message('TwinState', defect='inner', slip=0.01, **state))
        over.vibration(scale * np.array([1.0, -1.0]), 'm/s^2', 2.0, temperature)
        over.take_strip(np.ones(2000), 0, 12000.0, temperature)
    curves = {curve.key: curve for curve in over.curves}
    assert list(curves['amplitude'].values) == [4.0, 3.0, 2.0]
    assert list(curves['frequency'].values) == [125.0, 125.5, 125.0]
    assert all(list(c.temperatures) == [20.0, 50.0, 110.0] for c in curves.values())
    assert sorted(over.strips) == [4, 10, 22]


def test_what_is_heard_before_the_speed_is_known_is_of_the_first_speed():
    over = OverTemperature()
    over.vibration(np.array([1.0, -1.0]), 'm/s^2', 2.0, 20.0)
    for temperature in (50.0, 80.0):
        state = {'temperature_used': temperature, 'shaft_hz': 25.0, 'bpfi': 125.0}
        over.state(message('TwinState', defect='', slip=0.01, **state))
        over.vibration(np.array([1.0, -1.0]), 'm/s^2', 2.0, temperature)
    assert list(over.curves[0].temperatures) == [20.0, 50.0, 80.0]


def test_the_frequency_of_the_twin_is_that_of_the_defect_found():
    over = OverTemperature()
    over.state(
        message('TwinState', temperature_used=20.0, defect='inner+outer', bpfi=124.0, bpfo=76.0)
    )
    assert [list(c.values) for c in over.curves] == [[124.0]]
    over.diagnosis(message('Diagnosis', result_name='outer', temperature=20.0, fault_hz=75.0))
    assert [list(c.values) for c in over.curves] == [[75.0], [76.0]]


def test_vibration_says_itself_whether_it_is_simulated():
    source, block = Source(), message('Vibration', header=header(frame_id='bearing_housing'))
    assert source.text == ''
    source.vibration(block)
    assert source.text == 'source not stated, bearing_housing'
    block.source = SOURCE_MEASURED
    source.vibration(block)
    assert source.text == 'measured, bearing_housing'
    block.source = SOURCE_SIMULATED
    source.vibration(block)
    assert source.text == 'simulated by a twin'
    values = {'preset': 'incipient', 'bearing': '6307', 'defect': 'inner:width=0.0024+ball'}
    source.parameters('/twin', 'twin', values)
    assert source.text.startswith('simulated by /twin, ')


def test_the_width_of_a_defect_is_that_of_the_preset():
    values = {spec.name: spec.default for spec in SPECS} | {'defect': 'inner'}
    assert twin_in_words(values) == 'preset paper, inner race 2.45 mm'
