# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
One MCAP file, read within bounds that hold whatever the file claims, sound or damaged.

Everything here raises a BrokenRecording where what it is to read is damaged or larger than stated.
"""
