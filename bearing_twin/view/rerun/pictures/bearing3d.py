# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The bearing in three dimensions, from its geometry and the poses of the twin."""

from __future__ import annotations

from dataclasses import dataclass
import math
from typing import Any, NamedTuple, TYPE_CHECKING

from bearing_twin.dynamics.defect_text import read_defects
from bearing_twin.dynamics.equations.load_zone import contact_forces
from bearing_twin.errors import BearingTwinError
from bearing_twin.view.rerun.pictures import shapes
from bearing_twin.view.style import LINE
import numpy as np
from numpy.typing import NDArray
import rerun as rr

if TYPE_CHECKING:
    from bearing_twin.bearing.geometry import Bearing
    from bearing_twin.dynamics.parameters import Defect
    from bearing_twin.view.rerun.canvas import Canvas


SLOWED = 40.0
"""The drawn bearing turns this many times slower than the real one."""
MAGNIFIED = 100.0
"""Factor by which the displacement of the inner ring is magnified."""
FRAME = 0.04
"""Longest time between two poses, s."""
LONGEST = 1.0
"""Poses further apart than this are not interpolated, s."""
STEEL, BRIGHT, BRASS = (150, 156, 164), (176, 182, 190), (176, 141, 66)
DEFECT = (255, 23, 68)
AROUND = np.linspace(0.0, 2.0 * np.pi, 180, endpoint=False)
"""Angles of the load zone's spikes, rad."""


def greatest_force(state: Any) -> float:
    """Return the greatest force around the rings in a TwinState, N."""
    pose = state.inner_x, state.inner_y, state.radial_clearance, state.k_b
    return float(contact_forces(AROUND, *pose).max())


@dataclass
class _Turning:
    """
    Angle in slow motion, from wrapped readings and a speed.

    It begins at the first reading, so that shaft, cage and balls have the same relative angles as
    in the twin, and grows by the true angle divided by `SLOWED`.
    """

    shown: float = math.nan
    last: float = math.nan

    def follow(self, angle: float, hertz: float, seconds: float) -> float:
        """Return the angle shown after a reading in rad, ``seconds`` after the one before."""
        if not math.isfinite(self.shown):
            self.shown = angle
        elif 0.0 < seconds < LONGEST:
            expected = 2.0 * math.pi * hertz * seconds
            off = angle - self.last - expected
            self.shown += (expected + math.remainder(off, 2.0 * math.pi)) / SLOWED
        self.last = angle
        return self.shown


class _Pose(NamedTuple):
    time: int
    shaft: float
    cage: float
    spin: float
    x: float
    y: float
    clearance: float
    stiffness: float


class Bearing3D:
    """
    Draw the bearing in its successive poses.

    Poses are held and sent together, at a fifth of the cost of sending each alone.
    Only the rotation is slowed down, by `SLOWED`; the timeline is not. Forces are those at the
    drawn positions of the balls, with the current displacement, clearance and stiffness, so that
    colours and load zone agree. They are relative to the greatest so far, at least ``greatest`` in
    N.
    """

    def __init__(self, canvas: Canvas, name: str, bearing: Bearing, greatest: float) -> None:
        self.bearing = bearing
        self._canvas = canvas
        self._name = name
        self._shaft, self._cage, self._spin = _Turning(), _Turning(), _Turning()
        self._pose: _Pose | None = None
        self._held: list[_Pose] = []
        self._greatest = greatest
        self._text = 'none'
        self._defects: tuple[Defect, ...] = ()
        self._marks: set[str] = set()
        self._bodies()

    def draw(self, state: Any, time: int) -> None:
        """Hold the pose of a TwinState at ``time`` in ns for the next flush."""
        before = self._pose
        seconds = (time - before.time) * 1e-9 if before else 0.0
        pose = _Pose(
            time,
            self._shaft.follow(state.shaft_angle, state.shaft_hz, seconds),
            self._cage.follow(state.cage_angle, state.ftf, seconds),
            self._spin.follow(state.ball_angle, state.bsf, seconds),
            float(state.inner_x),
            float(state.inner_y),
            float(state.radial_clearance),
            float(state.k_b),
        )
        self._pose = pose
        if state.defect != self._text:
            self.flush()
            self._text = str(state.defect)
            self._defects = _defects(self._text)
            self._mark(time)
        if before and 0.0 < seconds < LONGEST:
            steps = max(1, math.ceil(seconds / FRAME - 0.5))
            for k in range(1, steps):
                self._held.append(_between(before, pose, k / steps))
        self._held.append(pose)

    def flush(self) -> None:
        """Log the poses that are held."""
        held, self._held = self._held, []
        if not held:
            return
        canvas, bearing, name = self._canvas, self.bearing, self._name
        times = np.array([pose.time for pose in held], dtype=np.int64)
        shaft, cage, spin, x, y, clearance, stiffness = np.array([pose[1:] for pose in held]).T
        pose = (x[:, None], y[:, None], clearance[:, None], stiffness[:, None])
        zone = contact_forces(AROUND, *pose)
        scale = np.maximum.accumulate(np.append(self._greatest, zone.max(axis=1)))[1:]
        self._greatest = float(scale[-1])
        scale = np.where(scale > 0.0, scale, 1.0)[:, None]
        shift = 1e3 * MAGNIFIED * np.stack([x, y, np.zeros_like(x)], axis=1)
        canvas.columns(
            f'{name}/inner',
            times,
            rr.Transform3D.columns(translation=shift, quaternion=_about_z(shaft)),
        )
        canvas.columns(f'{name}/cage', times, rr.Transform3D.columns(quaternion=_about_z(cage)))
        angles = cage[:, None] + np.arange(bearing.n_balls) * (2.0 * np.pi / bearing.n_balls)
        colours = force_colours(contact_forces(angles, *pose) / scale)
        canvas.columns(
            f'{name}/balls',
            times,
            rr.Points3D.columns(
                positions=_on_circle(500.0 * bearing.d_pitch, angles).reshape(-1, 3),
                colors=colours.reshape(-1, 3),
            ).partition(np.full(len(held), bearing.n_balls)),
        )
        self._load_zone(times, zone, scale)
        for k, defect in enumerate(self._defects):
            if defect.place == 'ball':
                # At this spin angle the defect meets the inner race: it points to the shaft.
                at = angles[:, defect.ball % bearing.n_balls]
                spot = _on_circle(400.0 * bearing.d_ball, at + np.pi - spin + defect.angle)
                spot[:, 2] = 300.0 * bearing.d_ball
                centre = _on_circle(500.0 * bearing.d_pitch, at)
                canvas.columns(
                    f'{name}/defects/ball_{k}', times, rr.Points3D.columns(positions=centre + spot)
                )

    def _load_zone(
        self, times: NDArray[np.int64], zone: NDArray[np.float64], scale: NDArray[np.float64]
    ) -> None:
        """Draw the forces as spikes around the outer ring, the greatest with its value."""
        foot = shapes.outer_radius(self.bearing) * 1.02
        tip = foot + zone / scale * 600.0 * self.bearing.d_ball
        front = [0.0, 0.0, shapes.face(self.bearing)]
        outer = _on_circle(tip, np.broadcast_to(AROUND, zone.shape)) + front
        inner = np.broadcast_to(_on_circle(foot, AROUND) + front, outer.shape)
        loaded = zone > 0.0
        self._canvas.columns(
            f'{self._name}/load_zone',
            times,
            rr.LineStrips3D.columns(
                strips=np.stack([inner[loaded], outer[loaded]], axis=1)
            ).partition(loaded.sum(axis=1)),
        )
        rows, peak = np.arange(len(zone)), zone.argmax(axis=1)
        self._canvas.columns(
            f'{self._name}/load_zone/greatest',
            times,
            rr.Points3D.columns(
                positions=1.06 * outer[rows, peak],
                labels=[f'{force:.0f} N' for force in zone[rows, peak]],
            ),
        )

    def _bodies(self) -> None:
        bearing, canvas, name = self.bearing, self._canvas, self._name
        canvas.once(name, rr.ViewCoordinates.RIGHT_HAND_Y_UP)
        canvas.once(f'{name}/outer/body', shapes.outer_ring(bearing, STEEL))
        canvas.once(f'{name}/inner/body', shapes.inner_ring(bearing, BRIGHT))
        for side, rim in zip('ab', shapes.cage(bearing, BRASS), strict=True):
            canvas.once(f'{name}/cage/{side}', rim)
        ball = 500.0 * bearing.d_ball
        canvas.once(f'{name}/balls', rr.Points3D.from_fields(radii=ball))
        hair = rr.Radius.ui_points(1.0)
        canvas.once(
            f'{name}/load_zone', rr.LineStrips3D.from_fields(radii=hair, colors=LINE['orange'])
        )
        canvas.once(
            f'{name}/load_zone/greatest',
            rr.Points3D.from_fields(
                radii=rr.Radius.ui_points(0.5), colors=LINE['orange'], show_labels=True
            ),
        )
        front, bore = 1.02 * shapes.face(bearing), shapes.inner_radius(bearing)
        edge = bore + 90.0 * bearing.d_ball
        canvas.once(
            f'{name}/inner/mark',
            rr.LineStrips3D(
                [[[0.0, -bore, front], [0.0, -edge, front]]],
                colors=LINE['ground'],
                radii=60.0 * bearing.d_ball * 0.5,
            ),
        )

    def _mark(self, time: int) -> None:
        """Mark where the defects are, on the body that carries them."""
        bearing = self.bearing
        marks: dict[str, rr.Points3D | rr.LineStrips3D] = {}
        back, front = -0.5 * shapes.width(bearing), 1.02 * shapes.face(bearing)
        pitch, ball = 500.0 * bearing.d_pitch, 1e3 * bearing.d_ball
        # Radii of the mark on the face, in diameters of a ball from the pitch circle.
        faces = {'inner': (-0.52, -0.25), 'outer': (0.25, 0.52), 'cage': (-0.12, 0.12)}
        for k, defect in enumerate(self._defects):
            if defect.place == 'ball':
                spot = rr.Points3D.from_fields(radii=0.09 * ball, colors=DEFECT)
                marks[f'defects/ball_{k}'] = spot
                continue
            low, high = (pitch + part * ball for part in faces[defect.place])
            angle, depth = defect.angle, front
            if defect.place == 'cage':
                # The worn pocket turns with the cage.
                angle, depth = 2.0 * math.pi * defect.ball / bearing.n_balls, 0.57 * ball
            cos, sin = math.cos(angle), math.sin(angle)
            bottom = low if defect.place == 'inner' else high
            across = [[bottom * cos, bottom * sin, back], [bottom * cos, bottom * sin, depth]]
            face = [[low * cos, low * sin, depth], [high * cos, high * sin, depth]]
            marks[f'{defect.place}/defect_{k}'] = rr.LineStrips3D(
                [across, face], colors=DEFECT, radii=0.07 * ball
            )
        for name in self._marks - marks.keys():
            self._canvas.put(f'{self._name}/{name}', time, rr.Clear(recursive=False))
        for name, mark in marks.items():
            self._canvas.put(f'{self._name}/{name}', time, mark)
        self._marks = set(marks)


def _defects(text: str) -> tuple[Defect, ...]:
    """Return the defects of a state; empty if the text cannot be read."""
    try:
        return read_defects(text, width=1e-3, depth=1e-4, profile='ball')
    except BearingTwinError:
        return ()


def force_colours(parts: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Return colours from grey to orange, shape (..., 3), for relative forces 0..1."""
    grey, orange = np.array([[96, 125, 139], LINE['orange']], dtype=np.float64)
    colours = grey + np.clip(parts, 0.0, 1.0)[..., None] * (orange - grey)
    return np.asarray(colours, dtype=np.uint8)


def _on_circle(
    radius: float | NDArray[np.float64], angles: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return points at angles in the plane z = 0, shape (..., 3)."""
    x, y = radius * np.cos(angles), radius * np.sin(angles)
    return np.stack([x, y, np.zeros_like(x)], axis=-1)


def _about_z(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return rotations about z as quaternions xyzw, shape (n, 4)."""
    half, none = 0.5 * angles, np.zeros_like(angles)
    return np.stack([none, none, np.sin(half), np.cos(half)], axis=1)


def _between(a: _Pose, b: _Pose, part: float) -> _Pose:
    time = a.time + round(part * (b.time - a.time))
    return _Pose(time, *(p + part * (q - p) for p, q in zip(a[1:], b[1:], strict=True)))
