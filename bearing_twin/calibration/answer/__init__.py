# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What a fit tells: each quantity with its interval, and what the vibration does not tell."""
