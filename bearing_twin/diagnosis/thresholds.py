# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Thresholds of the decision; docs/diagnosis_why.md derives them."""

from __future__ import annotations

HARMONICS = 4
"""Harmonics of a comb. Fault lines fade after a few, and each empty harmonic costs power."""

Z_FAULT = 5.5
"""Score from which a comb is not chance."""

Z_CAGE = 8.0
"""The same for the cage: its low orders have a wider null."""

Z_SECOND_LOOK = 4.0
"""Score from which a strong comb gets a second look, against a null without its own lines. In 1.5
% of windows of noise such a comb then reaches ``Z_FAULT``, but never ``INDEX_FAULT``
(studies.noise_windows)."""

Z_ELSEWHERE = 8.0
"""Score from which a comb at any order is not chance: it is the best of some thousand orders, not
of a few. Noise reaches it in 22 of a thousand windows (studies.noise_windows)."""

IMPACTS = 1.0
"""Mean log score over noise of the second to fourth harmonic, above which a comb is made by
impacts and not by a smooth modulation: four times 0.24, the scatter of the mean of three lines of
noise in one window."""

Z_PASSAGES = 4.0
"""Significance from which groups of impacts, one group each cage turn, belong to a ball."""

INDEX_FAULT = 0.6
"""Modulation index from which a significant comb is a fault."""

INDEX_SUSPECT = 0.3
"""Modulation index from which a significant comb is reported."""

INDEX_NOISE = 0.13
"""Modulation index below which 95 % of windows of noise of 4 s are."""

INDEX_SOUND = 2.0 * 0.16 / (1.0 + 0.5 * 0.16**2)
"""Modulation index of 1 + 0.16 cos, the largest modulation of the noise of a healthy bearing by
passing balls and waviness (studies.impact_machines)."""

SLIP = (-0.015, 0.06)
"""Range of cage slip that is searched. Negative: a contact angle that the geometry lacks."""

INDEX_NOISE_TURNS = 100.0
"""Shaft turns of ``INDEX_NOISE``: 4 s at 25 Hz. At 1 s noise has twice the index."""

KURTOSIS = 3.0 * 35.0 / 18.0
"""Kurtosis of noise whose force varies as 1 + cos, the largest variation by a rotating load: mean
(1 + cos)^4 over the square of mean (1 + cos)^2 is 35/18. Impacts and bursts have more."""

INDEX_SMOOTH = 17.0**0.5 / 3.0
"""Modulation index of 1 + cos, the largest modulation by a load: squared, it has lines of 4/3 and
1/3 of its mean. No healthy part modulates more."""

INDEX_STRIKE = 2.0
"""Modulation index of a comb from which its impacts are sharp: half of 4, the index of sharp
impacts with four harmonics."""

RIPPLE = 0.2
"""Power of the fifth to eighth harmonic of the cage's comb over that of the first four, below
which the comb is a ripple. A ball strikes while it passes the load zone. The squared envelope of a
narrow load zone, of spread 0.1 (37 degrees to either side), has 0.2; a strike has 1
(studies.load_sidebands)."""

JOINT_SLIP = 0.008
"""Largest difference between the slips of two faults of one bearing: they share the cage."""

MAINS_HZ = (50.0, 60.0)
"""Frequencies of the mains, Hz; rectifiers pulse twice a period."""

CARRIER = 12.0
"""Multiple of the outer race's frequency from which carrier bands count for its comb."""

LOW_LINES = 1.0 / 3.0
"""Share of the power at low multiples of the outer race's frequency that is in its lines: from
here on more bearings with an otherwise healthy answer are damaged than healthy
(studies.low_ringing)."""

RIVAL = 1.4
"""Ratio of evidence from which two faults that explain each other's lines are told apart."""

BLURRED = 0.9
"""Ratio of sidebands to harmonics from which a comb may be a sideband of another fault."""

LOAD_ZONE = 0.5
"""Ratio of sidebands to harmonics above which a load zone modulates the impacts. A force that
varies as 1 + cos, the largest variation by a rotating load at a fixed place, makes shaft sidebands
of 0.49 in the squared envelope. A damaged outer race stands still; an inner race passes through
the load zone."""

SWAY = 0.2
"""Ratio of sidebands to harmonics from which a part moves through the load. It is the ratio of a
bearing with so much preload that its least loaded ball is deflected by half as much as the most
loaded, 1 + 0.3 cos (studies.load_sidebands)."""

UNLIKELY_SLIP = 0.025
"""Slip above which a named place needs an explanation, such as a bearing without load."""

SLIP_COST = 0.02
"""Slip that costs one standard deviation of score; twice the slip costs four."""

SLOW_CAGE = 0.12
"""Largest slip of a cage whose harmonics may be mistaken for other faults."""

STEADY = 0.004
"""Relative uncertainty of the shaft speed up to which slips are compared."""
