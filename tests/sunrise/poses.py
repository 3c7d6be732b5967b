"""Poses in mm and rad as in Sunrise, and the turn of joint positions."""

from __future__ import annotations

import math
from dataclasses import dataclass

# Lengths of the LBR iiwa 7 R800 from shoulder to elbow, elbow to wrist, foot to shoulder, wrist to
# flange, in mm.
UPPER, FORE, FOOT, FLANGE = 400.0, 400.0, 340.0, 152.0
LIMITS_DEG = [170, 120, 170, 120, 170, 120, 175]


def product(left: list[list[float]], right: list[list[float]]) -> list[list[float]]:
    return [[sum(row[k] * right[k][j] for k in range(3)) for j in range(3)] for row in left]


def applied(rotation: list[list[float]], vector: list[float]) -> list[float]:
    return [sum(r * v for r, v in zip(row, vector)) for row in rotation]


def transposed(rotation: list[list[float]]) -> list[list[float]]:
    return [list(column) for column in zip(*rotation)]


def about(axis: str, angle: float) -> list[list[float]]:
    c, s = math.cos(angle), math.sin(angle)
    return {
        "x": [[1, 0, 0], [0, c, -s], [0, s, c]],
        "y": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
        "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]],
    }[axis]


@dataclass(frozen=True)
class Pose:
    """x, y, z in mm and a, b, c in rad: R = Rz(a) Ry(b) Rx(c)."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    a: float = 0.0
    b: float = 0.0
    c: float = 0.0

    @property
    def rotation(self) -> list[list[float]]:
        return product(product(about("z", self.a), about("y", self.b)), about("x", self.c))

    @classmethod
    def of(cls, rotation: list[list[float]], origin: list[float]) -> Pose:
        r = rotation
        a = math.atan2(r[1][0], r[0][0])
        b = math.atan2(-r[2][0], math.hypot(r[0][0], r[1][0]))
        c = math.atan2(r[2][1], r[2][2])
        return cls(*origin, a, b, c)

    def then(self, carried: Pose) -> Pose:
        """The composition of this pose with a pose in its frame."""
        moved = applied(self.rotation, [carried.x, carried.y, carried.z])
        origin = [own + by for own, by in zip([self.x, self.y, self.z], moved)]
        return Pose.of(product(self.rotation, carried.rotation), origin)

    def inverse(self) -> Pose:
        back = transposed(self.rotation)
        return Pose.of(back, [-v for v in applied(back, [self.x, self.y, self.z])])

    def keys(self) -> dict[str, float]:
        """The keys of the pose in programs."""
        values = [self.x, self.y, self.z, self.a, self.b, self.c]
        return dict(zip(["x_mm", "y_mm", "z_mm", "a_rad", "b_rad", "c_rad"], values))


def deg(x: float, y: float, z: float, a: float, b: float, c: float) -> Pose:
    """A pose with angles in deg."""
    return Pose(x, y, z, *map(math.radians, [a, b, c]))


def joints(flange: Pose, e1: float, status: int) -> list[float]:
    """Joint positions for a flange pose, with A3 at `e1`, in closed form: see docs/cartesian.md."""
    s0, s4, s6 = (-1 if status & bit else 1 for bit in [1, 2, 4])
    r = flange.rotation
    wx, wy, wz = (
        p - FLANGE * row[2] - foot
        for p, row, foot in zip([flange.x, flange.y, flange.z], r, [0, 0, FOOT])
    )
    a4 = s4 * math.acos((wx * wx + wy * wy + wz * wz - UPPER**2 - FORE**2) / (2 * UPPER * FORE))
    v = [
        -FORE * math.sin(a4) * math.cos(e1),
        -FORE * math.sin(a4) * math.sin(e1),
        UPPER + FORE * math.cos(a4),
    ]
    ahead = s0 * math.sqrt(wx * wx + wy * wy - v[1] ** 2)
    a1 = math.atan2(wy * ahead - wx * v[1], wx * ahead + wy * v[1])
    a2 = math.atan2(ahead * v[2] - wz * v[0], wz * v[2] + ahead * v[0])
    arm = product(product(about("z", a1), about("y", a2)), product(about("z", e1), about("y", -a4)))
    m = product(transposed(arm), r)
    a6 = math.atan2(s6 * math.hypot(m[0][2], m[1][2]), m[2][2])
    a5 = math.atan2(s6 * m[1][2], s6 * m[0][2])
    a7 = math.atan2(s6 * m[2][1], -s6 * m[2][0])
    found = [a1, a2, e1, a4, a5, a6, a7]
    for number, (angle, limit) in enumerate(zip(found, LIMITS_DEG), 1):
        assert abs(math.degrees(angle)) < limit, (
            f"A{number} would be at {math.degrees(angle):.1f} deg"
        )
    return found


def turn(found: list[float]) -> int:
    """The turn: one bit for each negative joint."""
    return sum(1 << i for i, angle in enumerate(found) if angle < 0)
