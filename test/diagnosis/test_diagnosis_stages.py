# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Each stage of the chain alone, against closed forms and independent implementations."""

from dataclasses import replace
import math
import time

from bearing_twin.bearing import fault_orders, find_bearing
from bearing_twin.diagnosis.chain import Excerpt
from bearing_twin.diagnosis.combs.comb import accumulate, comb_scores, order_spectra
from bearing_twin.diagnosis.record import diagnose_record
from bearing_twin.diagnosis.settings import DiagnosisSettings
from bearing_twin.diagnosis.signal.bands import band_tree, BandTree, squared_envelopes
from bearing_twin.diagnosis.signal.demodulation import choose_layout
from bearing_twin.diagnosis.signal.gate import check_record, Extent
from bearing_twin.diagnosis.signal.lines import NEUTRAL
from bearing_twin.diagnosis.signal.periodogram import OverlappingParts
from bearing_twin.diagnosis.signal.ranks import column_ranks
from bearing_twin.diagnosis.signal.severity import iso_zone, Levels, measure_severity
from bearing_twin.diagnosis.signal.shaft import refine_shaft_hz, resample, SpeedProfile
from bearing_twin.diagnosis.signal.spectra import envelope_spectra, local_floor, whiten
from bearing_twin.diagnosis.window import coarse_spectrum
from bearing_twin.errors import BearingTwinError
import numpy as np
import pytest
from scipy import signal, stats

RATE = 12800.0


def _envelope_spectra(whitened, tree, *, max_hz, floor_width):
    """Spectra of a whole record that is one segment: at each of its samples, nothing left out."""
    points = 2 * (tree.levels[0][0])
    return envelope_spectra(
        map(OverlappingParts, zip(squared_envelopes(whitened, tree, points))),
        points * tree.bin_hz,
        bands=len(tree.bands),
        max_hz=max_hz,
        floor_width=floor_width,
    )


def test_floor_of_exponential_noise_is_its_mean(rng):
    power = rng.exponential(2.5, 40_000).astype(np.float32)
    power[::50] *= 1e4  # lines must not lift it
    floor = local_floor(power, 200)
    assert floor.mean() == pytest.approx(2.5 * math.log(2 * 50 / 49) / math.log(2), rel=0.03)
    assert floor.std() / floor.mean() < 0.15


def test_whitening_flattens_caps_and_keeps_phase(rng):
    x = signal.lfilter([1.0], [1.0, -1.6, 0.9], rng.standard_normal(1 << 15))
    x += 5.0 * np.sin(2 * np.pi * 0.21 * np.arange(len(x)))
    spectrum = np.fft.rfft(x).astype(np.complex64)
    capped, cepstral = whiten(spectrum, 128)
    quarters = np.array_split(np.abs(capped[50:-50]) ** 2, 4)
    assert [np.median(q) for q in quarters] == pytest.approx([math.log(2)] * 4, rel=0.1)
    assert np.abs(capped).max() <= 2.0 + 1e-3
    assert np.abs(cepstral) == pytest.approx(1.0, abs=1e-4)
    assert np.angle(capped[100] / spectrum[100]) == pytest.approx(0.0, abs=1e-4)


def test_band_tree_covers_the_range_with_half_overlap():
    tree = band_tree(6400, 1.0, depth=3, narrowest_hz=700.0)
    assert [len(firsts) for _, firsts in tree.levels] == [1, 3, 7, 15]
    assert tree.bands[0] == (0.0, 6400.0)
    for width, firsts in tree.levels:
        assert firsts[0] == 0
        assert firsts[-1] + width == 6400
    assert len(band_tree(6400, 1.0, depth=3, narrowest_hz=2000.0).levels) == 2


def test_bands_of_a_faster_sampled_machine_are_those_of_the_slower_one_and_wider_ones_above():
    """Faster sampling adds noise to a wider band, and no ringing."""
    bearing = find_bearing('6205')
    slow, *faster = (
        {tuple(np.round(b)) for b in choose_layout(rate, rate, 8, bearing, 25.0).tree.bands}
        for rate in (25_600, 51_200, 102_400, 204_800)
    )
    assert len(slow) == 26
    for number, bands in enumerate(faster, start=1):
        assert slow < bands
        assert len(bands) <= 26 + 25 * number
        # Half-overlapping bands as wide as a ringing of 4 % damping, or one halving wider.
        for ringing in np.arange(1600.0, 0.5 * 25_600 * 2.0**number, 700.0):
            inside = [b for b in bands if b[0] <= ringing <= b[1]]
            assert min(b[1] - b[0] for b in inside) <= max(1600.0, 0.16 * ringing)


@pytest.mark.parametrize('depth', [0.1, 0.5])
def test_modulation_index_of_a_modulated_carrier(depth):
    """(1 + a cos)^2 has the relative lines 2a / (1 + a^2/2) and (a^2/2) / (1 + a^2/2)."""
    t = np.arange(int(4 * RATE)) / RATE
    x = (1.0 + depth * np.cos(2 * np.pi * 75.0 * t)) * np.cos(2 * np.pi * 3000.0 * t)
    spectrum = (np.fft.rfft(x) / len(x)).astype(np.complex64)[None]
    tree = band_tree(spectrum.shape[1] - 1, 0.25, depth=2, narrowest_hz=500.0)
    found = _envelope_spectra(np.repeat(spectrum, 2, axis=0), tree, max_hz=400.0, floor_width=64)
    band = next(i for i, (low, high) in enumerate(tree.bands) if low < 2500 and high > 3500)
    index = 2.0 * np.sqrt(found.power[band])
    mean = 1.0 + depth**2 / 2
    assert index[int(75 / 0.25) - 1] == pytest.approx(2 * depth / mean, rel=1e-3)
    assert index[int(150 / 0.25) - 1] == pytest.approx(depth**2 / 2 / mean, rel=1e-3)


def test_envelope_spectrum_agrees_with_hilbert(rng):
    x = rng.standard_normal(1 << 14) * (
        1.0 + 0.8 * np.sin(2 * np.pi * 40 * np.arange(1 << 14) / RATE)
    )
    spectrum = (np.fft.rfft(x) / len(x)).astype(np.complex64)[None]
    tree = band_tree(spectrum.shape[1] - 1, RATE / len(x), depth=0, narrowest_hz=1.0)
    found = _envelope_spectra(np.repeat(spectrum, 2, axis=0), tree, max_hz=500.0, floor_width=64)
    squared = np.abs(signal.hilbert(x)) ** 2
    window = signal.windows.hann(len(x), sym=False) * 2.0
    lines = np.fft.rfft((squared - squared.mean()) * window) / len(x) / squared.mean()
    reference = np.abs(lines[1 : found.power.shape[-1] + 1]) ** 2
    strong = reference > np.median(reference)
    assert found.power[0][strong] == pytest.approx(reference[strong], rel=0.05)


@pytest.mark.parametrize('carrier', [0.0, 30.0])
@pytest.mark.parametrize(
    ('samples', 'depth', 'reach'),
    [
        *((n, 3, 9.0) for n in (1 << 15, 32_760, 3 * 5**4 * 32, 20_000, 44_800, 67_200)),
        *((n, 4, 4.5) for n in (1 << 15, 32_760)),
        # Few wide bands, whose lags reach into seven tiles; tiles of 819 = 9 x 7 x 13 bins.
        *((n, depth, 9.0) for n, depth in ((1 << 15, 2), (13_440, 2), (3360, 1), (104_832, 5))),
    ],
)
def test_band_of_a_tree_is_the_band_alone_and_the_autocorrelation(
    rng, samples, depth, reach, carrier
):
    """Bands of a tree share transforms where they can; ends, lags and levels must not mix."""
    n = np.arange(samples)
    x = rng.standard_normal(samples) * (1.0 + 0.5 * np.sin(0.01 * n)) + carrier * np.cos(0.7 * n)
    spectra = whiten((np.fft.rfft(x) / samples).astype(np.complex64), 128, cap=30.0)
    tree = band_tree(samples // 2, 1.0, depth=depth, narrowest_hz=700.0, reach=reach)

    # Points for 700 lags and no more, as the window has them.
    def lines_of(spectra, tree):
        envelopes = np.concatenate(squared_envelopes(spectra, tree, 1400), axis=1).T
        assert not envelopes[2 * len(tree.bands) :].any()
        return np.fft.rfft(envelopes[: 2 * len(tree.bands)].reshape(2, -1, 1400), axis=-1)

    found = lines_of(spectra, tree)
    bands = [(width, first) for width, firsts in tree.levels for first in firsts]
    assert found.shape == (2, len(bands), 701)
    for i, (width, first) in enumerate(bands):
        part = spectra[:, first : first + width]
        alone = BandTree(1.0, ((width, (0,)),))
        same = lines_of(part, alone)[:, 0]
        exact = np.stack(
            [signal.correlate(row, row)[width - 1 : width + 699] for row in part.astype(complex)]
        )
        scale = 1400.0 * np.sqrt(np.mean(np.abs(exact[:, 1:]) ** 2, axis=-1, keepdims=True))
        for lines in (found[:, i, :700], same[:, :700]):
            assert np.abs(lines / scale - 1400.0 * exact / scale)[:, 1:].max() < 1e-3
            assert lines[:, 0] == pytest.approx(1400.0 * exact[:, 0], rel=1e-5)


@pytest.mark.parametrize('kind', ['noise', 'lines', 'ties', 'decades', 'signs'])
@pytest.mark.parametrize(('count', 'columns'), [(1, 16), (2, 17), (31, 52), (200, 40)])
def test_ranks_of_columns_are_those_of_sorting(rng, kind, count, columns):
    values = rng.exponential(size=(2 * count, columns))
    if kind == 'lines':
        values[:: max(count // 5, 1)] *= 1e8
    elif kind == 'ties':
        values = np.round(2.0 * values)
    elif kind == 'decades':
        values = 10.0 ** rng.uniform(-15.0, 15.0, values.shape)
    elif kind == 'signs':
        values -= 1.0
    values = values.astype(np.float32)
    found = np.empty(columns, np.float32)
    for first, step, away in ((0, 1, 0.0), (1, 2, 0.0), (1, 2, 1.0)):
        rows = np.sort(values[first::step][:count], axis=0)
        for rank in {0, count // 2, int(0.84 * count), count - 1}:
            column_ranks(values, first, step, count, rank, away, found[None])
            assert (found == rows[rank]).all()


@pytest.mark.parametrize('bands', [1, 3, 8])
def test_logarithms_of_an_envelope_spectrum_are_those_of_power_over_floor(rng, bands):
    part = OverlappingParts([rng.exponential(size=(1280, 2 * bands)).astype(np.float32)])
    # Logarithms are taken sixteen at a time, and 499 lines are no multiple of it.
    found = envelope_spectra([part], 1280.0, bands=bands, max_hz=499.0, floor_width=64)
    for band in range(bands):
        ratio = found.power[band] / found.floor(band).astype(np.float64)
        assert found.logs[:, band] == pytest.approx(np.log1p(ratio), rel=1e-5, abs=1e-6)


@pytest.mark.parametrize('points', [1280, 12_800])
def test_points_of_an_envelope_do_not_change_its_spectrum(rng, points):
    x = rng.standard_normal(25_600)
    white = whiten((np.fft.rfft(x) / len(x)).astype(np.complex64), 128)
    tree = band_tree(12_800, 1.0, depth=3, narrowest_hz=700.0)
    few, many = (
        envelope_spectra(
            map(OverlappingParts, zip(squared_envelopes(white, tree, count))),
            float(count),
            bands=len(tree.bands),
            max_hz=500.0,
            floor_width=64,
        )
        for count in (points, 25_600)
    )
    assert few.power == pytest.approx(many.power, rel=1e-2, abs=1e-3 * float(many.power.mean()))


def test_envelope_spectrum_of_noise_over_its_floor_is_exponential(rng):
    x = rng.standard_normal(1 << 16)
    spectrum = (np.fft.rfft(x) / len(x)).astype(np.complex64)[None]
    tree = band_tree(spectrum.shape[1] - 1, RATE / len(x), depth=2, narrowest_hz=500.0)
    found = _envelope_spectra(np.repeat(spectrum, 2, axis=0), tree, max_hz=300.0, floor_width=200)
    ratio = found.power[2] / found.floor(2)
    # Every third bin: the window joins neighbours.
    assert stats.kstest(ratio[5::3], 'expon').pvalue > 0.01
    assert found.logs[:, 2] == pytest.approx(np.log1p(ratio), rel=1e-3)
    assert found.excess[:, 2] == pytest.approx(
        np.maximum(found.power[2] - found.floor(2), 0.0),
        rel=1e-3,
        abs=1e-3 * float(found.power.mean()),
    )
    assert found.logs.mean() == pytest.approx(NEUTRAL, abs=0.03)


def _orders(x, shaft_hz):
    spectrum = (np.fft.rfft(x) / len(x)).astype(np.complex64)
    bin_hz = RATE / len(x)
    tree = band_tree(len(spectrum) - 1, bin_hz, depth=2, narrowest_hz=500.0)
    envelopes = _envelope_spectra(
        whiten(spectrum, 256), tree, max_hz=25.0 * shaft_hz, floor_width=200
    )
    power = np.abs(spectrum).astype(np.float32) ** 2
    return order_spectra(envelopes, tree.bands, shaft_hz, shaft_hz), envelopes, power, bin_hz


def _train(rng, order, shaft_hz, seconds, noise=1.0):
    n = int(seconds * RATE)
    x = np.zeros(n)
    x[(np.arange(0.0, seconds, 1.0 / (order * shaft_hz)) * RATE).astype(int)] = 12.0
    ring = np.exp(-500 * np.arange(200) / RATE) * np.sin(2 * np.pi * 4000 * np.arange(200) / RATE)
    return signal.fftconvolve(x, ring)[:n] + noise * rng.standard_normal(n)


def test_comb_peaks_at_the_planted_order(rng):
    orders, *_ = _orders(_train(rng, 3.61, 25.0, 4.0), 25.0)
    scores = comb_scores(orders, 6.0, 3)
    assert scores.grid[np.argmax(scores.z)] == pytest.approx(3.61, abs=0.01)
    assert scores.z.max() > 8.0
    # Silenced lines leave nothing behind.
    silent = orders.silenced(3.61 * np.arange(1, 8), 0.03)
    z = scores.score(silent, scores.grid[np.abs(scores.grid - 3.61) < 0.005])
    assert z.max() < 4.0


def test_mean_of_windows_raises_a_weak_comb(rng):
    x = _train(rng, 3.61, 25.0, 32.0, noise=5.0)
    parts = [_orders(part, 25.0)[0] for part in np.split(x, 8)]
    single = [comb_scores(part, 6.0, 3) for part in parts]
    near = np.abs(single[0].grid - 3.61) < 0.01
    alone = np.mean([scores.z[near].max() for scores in single])
    together = comb_scores(accumulate(parts), 6.0, 3).z[near].max()
    assert together > 1.5 * alone


def test_shaft_speed_is_found_and_fault_lines_do_not_lead_it_astray(rng):
    t = np.arange(int(4 * RATE)) / RATE
    noise = rng.standard_normal(len(t))
    shaft = sum(np.cos(2 * np.pi * k * 24.7 * t) for k in range(1, 6))
    _, envelopes, power, bin_hz = _orders(noise + 0.3 * shaft, 25.0)
    found = refine_shaft_hz(power, bin_hz, envelopes, 25.0, 0.02)
    assert found.shaft_hz == pytest.approx(24.7, abs=0.03)
    # A fault comb at 4.95 orders is no shaft at 0.99 of the speed.
    _, envelopes, power, bin_hz = _orders(_train(rng, 4.95, 25.0, 4.0), 25.0)
    assert refine_shaft_hz(power, bin_hz, envelopes, 25.0, 0.02).shaft_hz == 25.0


@pytest.mark.parametrize('order', [4.0, 4.95, 5.0])
def test_at_an_exact_speed_the_answer_does_not_depend_on_the_lines_of_the_shaft(rng, order):
    known = RATE, find_bearing('6205'), DiagnosisSettings(speed_tolerance=0.0)
    analysis = Excerpt.of(_train(rng, order, 25.0, 8.0), 25.0, *known).analyse()
    window = analysis.window
    assert window.speed.shaft_hz == 25.0
    clear = replace(window, speed=window.speed._replace(score=20.0, spread=0.0))
    one, other = (replace(analysis, window=each).conclude(()) for each in (window, clear))
    assert (one.result, one.score, one.trust) == (other.result, other.score, other.trust)
    assert (one.reasons, one.confidence) == (other.reasons, other.confidence)


def test_angular_resampling_turns_a_sweep_into_a_line():
    n = int(4 * RATE)
    shaft = np.linspace(20.0, 30.0, n)
    phase = 2 * np.pi * np.cumsum(shaft) / RATE
    profile = SpeedProfile(shaft, np.ones(n, np.intp))
    even, mean_hz = resample(np.cos(7.3 * phase), profile.equal_angles(n)), profile.mean_hz
    assert mean_hz == pytest.approx(25.0, rel=1e-3)
    assert profile.varies
    spectrum = np.abs(np.fft.rfft(even * np.hanning(n)))
    peak = np.argmax(spectrum) * RATE / n
    assert peak == pytest.approx(7.3 * mean_hz, abs=0.3)
    assert (spectrum > 0.3 * spectrum.max()).sum() <= 4


def test_the_speeds_of_each_sample_of_an_hour_are_cut_into_seconds_without_delay():
    """Not by a sum of all of them for each second."""
    n = 3600 * 1000
    profile = SpeedProfile(np.linspace(20.0, 30.0, n), np.ones(n, np.intp))
    begin = time.process_time()
    parts = profile.parts(range(0, n + 1, 1000))
    assert time.process_time() - begin < 5.0
    assert len(parts) == 3600
    assert np.concatenate([part.shaft_hz for part in parts]).tolist() == profile.shaft_hz.tolist()


@pytest.mark.parametrize('count', [0, 1, 3])
def test_fewer_values_than_interpolation_takes_are_not_resampled(count):
    with pytest.raises(BearingTwinError, match='give at least 4'):
        resample(np.ones(count), np.zeros(1))


@pytest.mark.parametrize(
    ('x', 'rate', 'hz', 'words'),
    [
        (np.zeros(0), RATE, 25.0, 'empty'),
        (np.full(50_000, 3.0), RATE, 25.0, 'constant'),
        (np.r_[np.nan, np.sin(np.arange(50_000.0))], RATE, 25.0, 'NaN'),
        (np.sin(np.arange(50_000.0)), math.nan, 25.0, 'sample rate'),
        (np.sin(np.arange(50_000.0)), RATE, math.nan, 'speed is unknown'),
        (np.sin(np.arange(5_000.0)), RATE, 25.0, 'shaft turns'),
        (np.sin(np.arange(50_000.0)), 600.0, 25.0, 'sample rate'),
        (np.clip(3 * np.sin(np.arange(50_000.0)), -1, 1), RATE, 25.0, 'clipped'),
        (np.r_[np.sin(np.arange(50_000.0)), np.zeros(50_000)], RATE, 25.0, 'repeat one value'),
    ],
)
def test_gate_says_what_is_missing(x, rate, hz, words):
    (reason,) = check_record([Extent.of(x)], rate, hz, 5.4)[:1]
    assert words in reason


def test_gate_lets_good_records_pass(rng):
    assert check_record([Extent.of(rng.standard_normal(50_000))], RATE, 25.0, 5.4) == []
    # A sine of 32 steps of a converter is at its ends for a ninth of the time.
    steps = np.rint(32.0 * np.sin(0.9 * np.arange(50_000.0)))
    assert check_record([Extent.of(steps)], RATE, 25.0, 5.4) == []
    # Impacts may stand in noise that is less than a step, however loud they are; a short drop-out
    # spoils little.
    impacts = np.zeros(50_000)
    impacts[::700] = rng.integers(-400, 401, len(impacts[::700]))
    assert check_record([Extent.of(impacts)], RATE, 25.0, 5.4) == []
    x = rng.standard_normal(100_000)
    x[1000:1400] = x[1000]
    assert check_record([Extent.of(x)], RATE, 25.0, 5.4) == []


@pytest.mark.parametrize('steps', [1e9, 100.0, 6.0, 2.0])
def test_gate_tells_drop_outs_of_signals_of_few_and_of_many_steps(rng, steps):
    x = np.rint(steps * rng.standard_normal(100_000))
    for start in (10_000, 50_000):
        x[start : start + 4_000] = x[start]
    (reason,) = check_record([Extent.of(x)], RATE, 25.0, 5.4)
    assert '8.0 % of the samples repeat one value' in reason


def test_a_signal_that_is_clipped_at_each_swing_is_found(rng):
    """Noise up to half of the sample rate stays at an end for one or two samples at a time."""
    x = rng.standard_normal(50_000)
    x[1::2] *= -1.0
    (reason,) = check_record([Extent.of(np.clip(np.diff(x), -1.0, 1.0))], RATE, 25.0, 5.4)
    assert 'clipped' in reason


@pytest.mark.parametrize(('steps', 'advice'), [(0.15, 'raise the gain'), (40.0, 'lower the gain')])
def test_the_end_of_few_steps_is_no_clipping(rng, steps, advice):
    """Hum below a step of the converter, as of a dead sensor, and hum that is clipped."""
    x = signal.lfilter(*signal.butter(2, 0.02), rng.standard_normal(50_000))
    x = np.rint(np.clip(steps * x / x.std(), -1.5 * steps - 1.0, 1.5 * steps + 1.0))
    (reason,) = check_record([Extent.of(x)], RATE, 25.0, 5.4)
    assert reason.endswith(advice)


def test_severity_of_a_sine():
    """1 m/s^2 peak at 160 Hz: rms 0.707, crest sqrt 2, kurtosis 1.5, velocity a / (2 pi f)."""
    t = np.arange(int(2 * RATE)) / RATE
    x = np.sin(2 * np.pi * 160.0 * t)
    spectrum = (np.fft.rfft(x) / len(x)).astype(np.complex64)
    levels = Levels.of(x, spectrum, RATE)
    found = measure_severity(levels, unit='m/s^2', power_group=2, mounting='rigid')
    assert found.rms == pytest.approx(math.sqrt(0.5), rel=1e-6)
    assert found.crest_factor == pytest.approx(math.sqrt(2), rel=1e-3)
    assert found.kurtosis == pytest.approx(1.5, rel=1e-3)
    assert found.velocity_rms == pytest.approx(1e3 / (2 * math.pi * 160 * math.sqrt(2)), rel=1e-3)
    assert found.band_rms == pytest.approx((math.sqrt(0.5), 0.0, 0.0), abs=1e-5)
    assert found.iso_zone == 'A'
    in_g = measure_severity(Levels.of(x / 9.80665, spectrum / 9.80665, RATE), unit='g')
    assert in_g.velocity_rms == pytest.approx(found.velocity_rms, rel=1e-6)
    assert math.isnan(measure_severity(levels, unit='V').velocity_rms)


def test_iso_zones_of_group_1_flexible():
    assert [iso_zone(v, 1, 'flexible') for v in (3.5, 3.6, 7.2, 11.5)] == list('ABCD')
    assert [iso_zone(v, 0, 'flexible') for v in (5.0, 7.2, 11.5)] == ['', 'C', 'D']
    assert [iso_zone(v, 0, '') for v in (5.0, 7.2, 11.5)] == ['', '', '']
    assert fault_orders(find_bearing('6205')).bpfi == pytest.approx(5.4152, abs=1e-3)


def test_coarse_spectrum_keeps_the_height_and_place_of_lines():
    amplitude = np.full(1 + 80_000, 0.01, dtype=np.float32)
    amplitude[[0, 1003, 80_000]] = (3.0, 7.0, 5.0)
    values, start_hz, bin_hz = coarse_spectrum(amplitude, 0.125)
    assert bin_hz == pytest.approx(1.0)
    at = start_hz + bin_hz * np.flatnonzero(values > 1.0)
    assert values[values > 1.0].tolist() == [3.0, 7.0, 5.0]
    assert at == pytest.approx([0.0, 1003 * 0.125, 10_000.0], abs=0.5)
    same, start_hz, bin_hz = coarse_spectrum(amplitude, 1.0)
    assert np.array_equal(same, amplitude)
    assert (start_hz, bin_hz) == (0.0, 1.0)


@pytest.mark.parametrize('speed', [12800.0, 1e20, 3.4e38, np.inf, -np.inf])
def test_a_speed_that_no_sample_shows_is_no_reason_to_divide_a_record(speed):
    verdict = diagnose_record(np.ones(3), 25600.0, find_bearing('6307'), speed)
    assert verdict.result == 'insufficient'


@pytest.mark.parametrize('rate', [5e-324, 1e-307, 1e-9, 1.0])
def test_a_low_rate_divides_no_record_into_more_pieces_than_can_be_measured(rate):
    known = find_bearing('6307'), DiagnosisSettings()
    excerpt = Excerpt.of(np.ones(640), 0.0, rate, *known)
    assert 1 <= len(excerpt.stretches) <= 10
    for shaft_hz in (0.0, -1.0, 25.0):
        found = diagnose_record(np.sin(np.arange(640.0)), rate, known[0], shaft_hz)
        assert found.result == 'insufficient'
