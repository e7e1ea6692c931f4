# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Texture: what a scene says of it, what of it a device can render.

Source of the whole room: V. Hayward, Physically-Based Haptic Synthesis (2008), section 5 and table 1, after
G. Campion and V. Hayward, Fundamental limits in the rendering of virtual haptic textures, World Haptics 2005.
"""
