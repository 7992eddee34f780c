# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The bearing in three dimensions, from its geometry and the poses of the twin."""

from __future__ import annotations

from dataclasses import dataclass
import math
from typing import Any, TYPE_CHECKING

from bearing_twin.view import shapes
from bearing_twin.view.style import LINE
import numpy as np
import rerun as rr

if TYPE_CHECKING:
    from bearing_twin.bearing.geometry import Bearing
    from bearing_twin.view.canvas import Canvas
    from numpy.typing import NDArray

__all__ = ['MAGNIFIED', 'SLOWED', 'Bearing3D', 'contact_forces']

SLOWED = 40.0
"""The bearing is drawn turning this many times slower than it does."""
MAGNIFIED = 100.0
"""The displacement of the inner ring is drawn this many times larger than it is."""
FRAME = 0.04
"""Longest time between two poses, s."""
LONGEST = 1.0
"""Poses further apart than this are not joined, s."""
STEEL, BRIGHT, BRASS = (150, 156, 164), (176, 182, 190), (176, 141, 66)
DEFECT = (255, 23, 68)
OUTER_DEFECT_ANGLE = -0.5 * math.pi
"""Where the twin puts a defect of the outer ring: in the direction of the load."""


def contact_forces(
    angles: NDArray[np.floating[Any]], x: float, y: float, clearance: float, stiffness: float
) -> NDArray[np.float64]:
    """
    Return the Hertz contact force in N of balls at some angles, shape (n,).

    Parameters
    ----------
    angles
        Positions from +x, rad.
    x, y
        Displacement of the inner ring against the outer ring, m.
    clearance
        Half the radial internal clearance, m.
    stiffness
        Hertz coefficient, N/m^1.5.

    Notes
    -----
    Zhang et al., Symmetry 2023, 15, 2166, equations of the contact deformation and force, without
    the defect's depth.

    """
    deformation = x * np.cos(angles) + y * np.sin(angles) - clearance
    return np.asarray(stiffness * np.maximum(deformation, 0.0) ** 1.5)


@dataclass
class _Turning:
    """Angle that grows without wrapping, followed from wrapped readings and a speed."""

    total: float = 0.0
    last: float = math.nan

    def follow(self, angle: float, hertz: float, seconds: float) -> float:
        """Return the total after a reading in rad, ``seconds`` after the one before."""
        if math.isfinite(self.last) and 0.0 < seconds < LONGEST:
            expected = 2.0 * math.pi * hertz * seconds
            off = angle - self.last - expected
            self.total += expected + math.remainder(off, 2.0 * math.pi)
        elif not math.isfinite(self.last):
            self.total = 0.0
        self.last = angle
        return self.total


@dataclass(frozen=True)
class _Pose:
    time: int
    shaft: float
    cage: float
    spin: float
    x: float
    y: float


class Bearing3D:
    """
    Draw the bearing pose after pose.

    It turns slowed down, while the clock of the timeline runs on: angles are the true ones,
    divided by `SLOWED`. Forces are those of balls at the places where they are drawn, at the
    displacement, clearance and stiffness of the moment, so that colours and load zone agree.
    """

    def __init__(self, canvas: Canvas, name: str, bearing: Bearing) -> None:
        self.bearing = bearing
        self._canvas = canvas
        self._name = name
        self._shaft, self._cage, self._spin = _Turning(), _Turning(), _Turning()
        self._pose: _Pose | None = None
        self._greatest = 0.0
        self._defects: tuple[str, ...] = ()
        self._bodies()

    def draw(self, state: Any, time: int) -> None:
        """Draw the pose of a TwinState at ``time`` in ns."""
        before = self._pose
        seconds = (time - before.time) * 1e-9 if before else 0.0
        pose = _Pose(
            time,
            self._shaft.follow(state.shaft_angle, state.shaft_hz, seconds) / SLOWED,
            self._cage.follow(state.cage_angle, state.ftf, seconds) / SLOWED,
            self._spin.follow(state.ball_angle, state.bsf, seconds) / SLOWED,
            float(state.inner_x),
            float(state.inner_y),
        )
        self._pose = pose
        defects = tuple(part for part in str(state.defect).split('+') if part not in ('', 'none'))
        if defects != self._defects:
            self._defects = defects
            self._mark(defects, time)
        clearance, stiffness = float(state.radial_clearance), float(state.k_b)
        if before and 0.0 < seconds < LONGEST:
            steps = max(1, math.ceil(seconds / FRAME - 0.5))
            for k in range(1, steps):
                self._frame(_between(before, pose, k / steps), clearance, stiffness)
        self._frame(pose, clearance, stiffness)

    def _frame(self, pose: _Pose, clearance: float, stiffness: float) -> None:
        canvas, bearing = self._canvas, self.bearing
        angles = pose.cage + np.arange(bearing.n_balls) * (2.0 * np.pi / bearing.n_balls)
        forces = contact_forces(angles, pose.x, pose.y, clearance, stiffness)
        around = np.linspace(0.0, 2.0 * np.pi, 180, endpoint=False)
        zone = contact_forces(around, pose.x, pose.y, clearance, stiffness)
        self._greatest = max(self._greatest, float(zone.max()))
        scale = self._greatest or 1.0
        canvas.put(
            f'{self._name}/inner',
            pose.time,
            rr.Transform3D(
                translation=[1e3 * MAGNIFIED * pose.x, 1e3 * MAGNIFIED * pose.y, 0.0],
                rotation=rr.RotationAxisAngle([0, 0, 1], radians=pose.shaft),
            ),
        )
        canvas.put(
            f'{self._name}/cage',
            pose.time,
            rr.Transform3D(rotation=rr.RotationAxisAngle([0, 0, 1], radians=pose.cage)),
        )
        pitch = 500.0 * bearing.d_pitch
        centres = np.column_stack(
            [pitch * np.cos(angles), pitch * np.sin(angles), np.zeros_like(angles)]
        )
        canvas.put(
            f'{self._name}/balls',
            pose.time,
            rr.Points3D(
                centres, radii=500.0 * bearing.d_ball, colors=force_colours(forces / scale)
            ),
        )
        self._load_zone(pose.time, around, zone, scale)
        if 'ball' in self._defects:
            where = angles[0] + pose.spin
            spot = centres[0] + 500.0 * bearing.d_ball * 0.8 * np.array(
                [math.cos(where), math.sin(where), 0.75]
            )
            canvas.put(
                f'{self._name}/defects/ball',
                pose.time,
                rr.Points3D([spot], radii=90.0 * bearing.d_ball, colors=DEFECT),
            )

    def _load_zone(
        self, time: int, around: NDArray[np.float64], zone: NDArray[np.float64], scale: float
    ) -> None:
        """Draw the forces as spikes around the outer ring, the greatest with its value."""
        foot = shapes.outer_radius(self.bearing) * 1.02
        tip = foot + zone / scale * 600.0 * self.bearing.d_ball
        rays = np.stack([np.cos(around), np.sin(around)], axis=1)
        front = np.full((len(around), 1), shapes.face(self.bearing))
        inner = np.hstack([foot * rays, front])
        outer = np.hstack([tip[:, None] * rays, front])
        spikes = np.stack([inner, outer], axis=1)[zone > 0.0]
        self._canvas.put(
            f'{self._name}/load_zone',
            time,
            rr.LineStrips3D(spikes, colors=LINE['used'], radii=rr.Radius.ui_points(1.0)),
        )
        peak = int(zone.argmax())
        self._canvas.put(
            f'{self._name}/load_zone/greatest',
            time,
            rr.Points3D(
                [1.06 * outer[peak]],
                labels=[f'{zone[peak]:.0f} N'],
                colors=LINE['used'],
                radii=rr.Radius.ui_points(0.5),
                show_labels=True,
            ),
        )

    def _bodies(self) -> None:
        bearing, canvas, name = self.bearing, self._canvas, self._name
        canvas.once(name, rr.ViewCoordinates.RIGHT_HAND_Y_UP)
        canvas.once(f'{name}/outer/body', shapes.outer_ring(bearing, STEEL))
        canvas.once(f'{name}/inner/body', shapes.inner_ring(bearing, BRIGHT))
        for side, rim in zip('ab', shapes.cage(bearing, BRASS), strict=True):
            canvas.once(f'{name}/cage/{side}', rim)
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

    def _mark(self, defects: tuple[str, ...], time: int) -> None:
        """Mark where the defects are."""
        bearing = self.bearing
        back, front = -0.5 * shapes.width(bearing), 1.02 * shapes.face(bearing)
        pitch, ball = 500.0 * bearing.d_pitch, 1e3 * bearing.d_ball
        places = {
            'inner': ('inner/defect', 0.0, pitch - 0.52 * ball, pitch - 0.25 * ball),
            'outer': (
                'outer/defect',
                OUTER_DEFECT_ANGLE,
                pitch + 0.25 * ball,
                pitch + 0.52 * ball,
            ),
            'cage': ('cage/defect', 0.0, pitch - 0.12 * ball, pitch + 0.12 * ball),
        }
        for key, (name, angle, low, high) in places.items():
            entity = f'{self._name}/{name}'
            if key not in defects:
                self._canvas.put(entity, time, rr.Clear(recursive=False))
                continue
            cos, sin = math.cos(angle), math.sin(angle)
            depth = 0.57 * ball if key == 'cage' else front
            bottom = low if key == 'inner' else high
            across = [[bottom * cos, bottom * sin, back], [bottom * cos, bottom * sin, depth]]
            face = [[low * cos, low * sin, depth], [high * cos, high * sin, depth]]
            self._canvas.put(
                entity,
                time,
                rr.LineStrips3D([across, face], colors=DEFECT, radii=0.07 * ball),
            )
        if 'ball' not in defects:
            self._canvas.put(f'{self._name}/defects/ball', time, rr.Clear(recursive=False))


def force_colours(parts: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Return steel, yellow or red, shape (n, 3), for forces as parts 0..1 of the greatest."""
    stops = np.array([[96, 125, 139], [255, 193, 7], [229, 57, 53]], dtype=np.float64)
    at = np.clip(parts, 0.0, 1.0)
    channels = [np.interp(at, [0.0, 0.5, 1.0], stops[:, k]) for k in range(3)]
    return np.stack(channels, axis=1).astype(np.uint8)


def _between(a: _Pose, b: _Pose, part: float) -> _Pose:
    def mix(p: float, q: float) -> float:
        return p + part * (q - p)

    return _Pose(
        a.time + round(part * (b.time - a.time)),
        mix(a.shaft, b.shaft),
        mix(a.cage, b.cage),
        mix(a.spin, b.spin),
        mix(a.x, b.x),
        mix(a.y, b.y),
    )
