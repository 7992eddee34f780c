# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""From combs to an answer: evidence, ordered table of rules, and confidence of an answer."""
