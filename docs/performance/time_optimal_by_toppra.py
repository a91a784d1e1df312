"""The time-optimal reference of checker/examples/worth_it.rs against toppra (0.6.10, from PyPI).

    pip install toppra==0.6.10
    cargo run --release --package takt-checker --example worth_it -- 100 --dump paths.json
    python docs/performance/time_optimal_by_toppra.py paths.json

Both get the same torque terms along the same path; the search is toppra's own (Pham and Pham 2018, with its default
solver and the constraints held at both ends of every interval). Viscous torque f*sqrt(x) is not linear in x: toppra gets its
tangent at its own last solution, until that changes nothing.
"""

import json
import sys

import numpy as np
import toppra
import toppra.algorithm
import toppra.constraint
from toppra.constraint import DiscretizationType, LinearConstraint
from toppra.constraint.linear_constraint import canlinear_colloc_to_interpolate

ROUNDS = 8


class Terms(LinearConstraint):
    """The torques of a dumped path, linear in x and u."""

    def __init__(self, path):
        super().__init__()
        self.dof = 1
        self.path = path
        self.identical = True
        self.discretization_type = DiscretizationType.Interpolation
        count = len(path["mass"])
        self.x = np.full(count, path["square_speed_max"])

    def compute_constraint_params(self, _, gridpoints):
        path = self.path
        mass, velocity, still = (np.array(path[key]) for key in ("mass", "velocity", "still"))
        viscous = np.array(path["viscous"])[None, :]
        root = np.sqrt(np.maximum(self.x, 1e-6 * path["square_speed_max"]))[:, None]
        velocity = velocity + viscous / (2 * root)
        still = still + viscous * root / 2
        limit = np.array(path["torque_limit"])
        joints = mass.shape[1]
        signs = np.vstack([np.eye(joints), -np.eye(joints)])
        room = np.concatenate([limit, limit])
        return canlinear_colloc_to_interpolate(
            mass, velocity, still, signs, room, None, None, gridpoints, identical=True
        )


class Rates(LinearConstraint):
    """The speed and acceleration limits along a dumped path."""

    def __init__(self, path):
        super().__init__()
        self.dof = 1
        self.path = path
        self.identical = True
        self.discretization_type = DiscretizationType.Collocation

    def compute_constraint_params(self, _, gridpoints):
        count = len(gridpoints)
        xbound = np.tile([0.0, self.path["square_speed_max"]], (count, 1))
        most, least = self.path["acceleration_max"], self.path["deceleration_max"]
        ubound = np.tile([-least if least else -1e9, most if most else 1e9], (count, 1))
        return None, None, None, None, None, ubound, xbound


def duration(x):
    speed = np.sqrt(np.maximum(x, 0.0))
    return np.sum(2.0 / (len(x) - 1) / (speed[1:] + speed[:-1]))


def optimum(path):
    count = len(path["mass"])
    gridpoints = np.linspace(0, 1, count)
    line = toppra.SplineInterpolator([0, 1], [[0.0], [1.0]], bc_type="natural")
    torque = Terms(path)
    found = None
    for _ in range(ROUNDS):
        solver = toppra.algorithm.TOPPRA([torque, Rates(path)], line, gridpoints=gridpoints, solver_wrapper="seidel")
        _, speed, _ = solver.compute_parameterization(0, 0)
        if speed is None:
            return None
        x = np.asarray(speed) ** 2
        before, found = found, duration(x)
        if before is not None and abs(found / before - 1) < 1e-7 or not np.any(path["viscous"]):
            break
        torque.x = x
    return found


def main():
    toppra.setup_logging("ERROR")
    rows = {}
    for path in json.load(open(sys.argv[1])):
        found = optimum(path)
        rows.setdefault(path["arm"], []).append(np.nan if found is None else path["optimal_duration_s"] / found - 1)
    for arm, differences in rows.items():
        differences = np.array(differences)
        print(
            f"{arm}: {len(differences)} paths, {np.isnan(differences).sum()} that toppra fails on; ours / toppra's - 1: "
            f"median {np.nanmedian(differences):+.1e}, from {np.nanmin(differences):+.1e} to {np.nanmax(differences):+.1e}"
        )


main()
