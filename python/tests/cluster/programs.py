"""Small random programs, reproducible by their seed."""

from __future__ import annotations

import random

import iiwasim as iw

# Within the joint ranges.
REACH_DEG = (165, 115, 165, 115, 165, 115, 170)


def random_programs(count: int, seed: int = 1) -> list[str]:
    """JSON texts of programs with two to four motions."""
    chance = random.Random(seed)

    def joints() -> list[float]:
        return [round(chance.uniform(-reach, reach), 2) for reach in REACH_DEG]

    def program() -> iw.Program:
        motions = [
            iw.ptp(
                deg=joints(),
                velocity_rel=round(chance.uniform(0.2, 1.0), 2),
                blend_cart_mm=chance.choice([None, 50]),
            )
            for _ in range(chance.randint(2, 4))
        ]
        return iw.Program(motions, start_deg=joints())

    return [program().to_json() for _ in range(count)]
