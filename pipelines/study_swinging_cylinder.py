"""Coefficients of Morison's equation from the force on the swinging cylinder.

    valsalva-cycle pipelines/cases/fluid-swinging-cylinder.toml --out FOLDER
    python3 pipelines/study_swinging_cylinder.py FOLDER

Fitted over the periods after the second:  F = -rho D cd |U| U / 2 - pi rho D^2 ci A / 4  a length, U and A: velocity and
acceleration of the cylinder. Prints cd, ci, the largest force, what the fit leaves and the trembling from row to row (both as root
mean squares).
"""

import sys
from pathlib import Path

import numpy as np

from flow_runs import columns

PERIOD, THICKNESS, MICRO = 5.0, 0.05, 1e6


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    table = columns(Path(sys.argv[1]) / "history.csv")
    late = table["time_s"] > 2 * PERIOD + 1e-9
    if not late.any():
        sys.exit(f"error: {sys.argv[1]}/history.csv has no row after {2 * PERIOD:g} s; the run is to reach beyond the second period")
    time, force = table["time_s"][late], table["cylinder_x_N"][late] * MICRO / THICKNESS
    omega = 2 * np.pi / PERIOD
    velocity, acceleration = -np.cos(omega * time), omega * np.sin(omega * time)
    parts = np.column_stack([-0.5 * velocity * np.abs(velocity), -0.25 * np.pi * acceleration])
    (cd, ci), *_ = np.linalg.lstsq(parts, force, rcond=None)
    left = np.sqrt(np.mean((parts @ [cd, ci] - force) ** 2))
    trembling = np.sqrt(np.mean(np.diff(force, 2) ** 2))
    print(f"drag coefficient {cd:.3f}, inertia coefficient {ci:.3f}; largest force {np.abs(force).max():.3f}, left by the fit {left:.3f}, "
          f"trembling {trembling:.3f}")


if __name__ == "__main__":
    main()
