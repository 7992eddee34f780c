# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Result of a fit: quantities with intervals, and reasons why a width is not identifiable."""
