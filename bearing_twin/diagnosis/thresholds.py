# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Thresholds of the decision; docs/diagnosis_why.md derives them."""

from __future__ import annotations

HARMONICS = 4
"""Harmonics of a comb. Fault lines fade after a few, and each empty harmonic costs power."""

Z_FAULT = 5.5
"""Score above which a comb is not chance."""

Z_CAGE = 8.0
"""The same for the cage, whose low orders have a wider null."""

Z_SECOND_LOOK = 4.0
"""Score from which a strong comb gets a second look, without its own lines in the null. In 1.5 %
of windows of noise such a comb then reaches ``Z_FAULT``, never with the index (noise_windows)."""

Z_ELSEWHERE = 8.0
"""Score above which a comb at any order is not chance: the best of some thousand orders and not of
a few. Noise passes it in 22 of a thousand windows (studies.noise_windows)."""

IMPACTS = 1.0
"""Mean log score over noise of the second to fourth harmonic above which a comb is of impacts and
not of a smooth modulation: four times the 0.24 by which the mean of three lines of noise scatters
in one window."""

Z_PASSAGES = 4.0
"""Significance from which impacts in groups, once a turn of the cage, are those of a ball."""

INDEX_FAULT = 0.6
"""Modulation index above which a significant comb is a fault."""

INDEX_SUSPECT = 0.3
"""Modulation index above which a significant comb is worth a remark."""

INDEX_NOISE = 0.13
"""Modulation index that noise alone reaches in 4 s (95 %)."""

INDEX_SOUND = 2.0 * 0.16 / (1.0 + 0.5 * 0.16**2)
"""Modulation index of 1 + 0.16 cos, the most by which the passing balls and the waves of its
surfaces modulate the noise of a sound bearing (studies.impact_machines)."""

SLIP = (-0.015, 0.06)
"""Cage slip looked for. Below zero: a contact angle that the geometry does not know of."""

INDEX_NOISE_TURNS = 100.0
"""Shaft turns to which ``INDEX_NOISE`` belongs: 4 s at 25 Hz. At 1 s it is twice as much."""

KURTOSIS = 3.0 * 35.0 / 18.0
"""Most that noise has whose force varies as 1 + cos, the most that a rotating load does:
mean (1 + cos)^4 over the square of mean (1 + cos)^2 is 35/18. Impacts and bursts have more."""

INDEX_SMOOTH = 17.0**0.5 / 3.0
"""Modulation index of 1 + cos, the most that a load does: squared, it has lines of 4/3 and 1/3 of
its mean. Above it no sound part modulates."""

INDEX_STRIKE = 2.0
"""Modulation index of the cage's comb above which the envelope is more strike than ripple: half of
the 4 that sharp impacts reach with four harmonics."""

RIPPLE = 0.2
"""Power of the fifth to eighth harmonic of the cage's comb over that of the first four below which
it is a ripple. A ball strikes while it passes the load zone: squared, the envelope of a narrow
one, of spread 0.1 (37 degrees to either side), has 0.2; a strike has 1 (load_sidebands)."""

JOINT_SLIP = 0.008
"""Two faults of one bearing share one cage: their slips agree to this much."""

MAINS_HZ = (50.0, 60.0)
"""Frequencies of the mains, whose rectifiers strike twice a period."""

CARRIER = 12.0
"""Multiples of the outer race's frequency above which its carriers count."""

LOW_LINES = 1.0 / 3.0
"""Share of the power at low multiples of the outer race in its lines there: the least from which
more bearings are damaged than sound, of those that are else healthy (studies.low_ringing)."""

RIVAL = 1.4
"""Two faults that explain each other away are told apart from this ratio of evidence on."""

BLURRED = 0.9
"""Sidebands over harmonics above which a comb may itself be a sideband of another fault."""

LOAD_ZONE = 0.5
"""Sidebands over harmonics above which impacts pass through a load zone. A force that varies as
1 + cos, the most that a rotating load does to a fixed place, makes shaft sidebands of 0.49 in the
squared envelope. A damaged outer race stands still; an inner race passes through the load zone."""

SWAY = 0.2
"""Sidebands over harmonics from which a part is seen to move through the load: those of a bearing
with so much preload that its least loaded ball is deflected by half as much as the most loaded,
1 + 0.3 cos (studies.load_sidebands)."""

UNLIKELY_SLIP = 0.025
"""Slip above which a name needs a reason, such as a bearing without load."""

SLIP_COST = 0.02
"""Slip that costs one standard deviation of score; twice as much costs four."""

SLOW_CAGE = 0.12
"""Slip up to which a cage is searched for where its harmonics pass for other faults."""

STEADY = 0.004
"""Relative uncertainty of the shaft speed up to which slips are compared."""
