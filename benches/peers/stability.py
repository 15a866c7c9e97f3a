#!/usr/bin/env python3
"""Runs MuJoCo on the scenes of experiments/stability.toml, with the criteria that the study applies to its own methods.

The parts of the study with rapier are run with three settings of MuJoCo: the Euler and the implicitfast integrator with default contacts, and the
discrete integrator with hard contacts. Rows are written to results/stability/peers.csv, which the study reads. src/studies/stability/ defines the
scenes, the times of evaluation and the outcomes. README.md beside this file describes the settings.
"""

import argparse
import csv
import datetime
import itertools
import math
import time
import tomllib
from pathlib import Path

import mujoco
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
GRAVITY, SPEED, APPROACH, LEAST_HOLD, DECAY = 9.81, 0.5, 2e-3, 0.2, 10.0
LEAST_HOLD_STEPS, LEAST_TIME, LEAST_STEPS, TOLERANCE = 5.0, 0.5, 50.0, 0.01
# Numbers of stacked balls by scene; other scenes have one ball.
BALLS = dict(stack_of_two=2, stack_of_four=4)
SKIN_SIM = dict(mass=1e-3, stiffness=16.37, damping=0.13)

# Name, integrator, and whether contacts are hard.
INTEGRATOR = mujoco.mjtIntegrator
METHODS = [
    ("mujoco_euler", INTEGRATOR.mjINT_EULER, False),
    ("mujoco_implicitfast", INTEGRATOR.mjINT_IMPLICITFAST, False),
    ("mujoco_discrete", INTEGRATOR.mjINT_DISCRETE, True),
]

# Recovery time of hard contacts, in steps, and their minimum impedance.
HARD = (0.1, 0.999)

COLUMNS = [
    "part", "scene", "method", "solver_iterations", "taxels", "stiffness_n_per_m", "taxel_mass_kg", "object_mass_kg", "dt_s",
    "mass_ratio", "explicit_limit_s", "damping_n_s_per_m", "contact_stiffness_n_per_m", "outcome", "force_imbalance",
    "deflection_error", "n_steps", "simulated_s", "wall_s", "per_simulated_s", "pitch_mm", "stroke_mm", "program", "version", "date",
]


class Scene:
    """Scene of a cell: bed of taxels, balls, damping, times, and the exact deflections and force."""

    def __init__(self, cell, pitch_mm, stroke_mm):
        pitch, stroke = 1e-3 * pitch_mm, 1e-3 * stroke_mm
        self.cell, self.stroke, self.millimetres = cell, stroke, dict(pitch_mm=pitch_mm, stroke_mm=stroke_mm)
        side, k, m = cell["taxels"], cell["stiffness_n_per_m"], cell["taxel_mass_kg"]
        self.taxel_radius, self.ball = 0.5 * pitch, side * pitch
        xs = (np.arange(side) - 0.5 * (side - 1)) * pitch
        x, y = np.meshgrid(xs, xs)
        across = (x**2 + y**2).ravel()
        reach = self.ball + self.taxel_radius
        corner = across[0]
        sag = 0.25 * stroke * across / corner
        self.centers = np.column_stack([x.ravel(), y.ravel(), reach - np.sqrt(reach**2 - across) - sag])
        # Travel of the ball at which it touches each taxel, metres; the innermost taxels are touched first.
        self.starts = sag - sag.min()
        self.lift = reach - sag.min()
        mass = cell["object_mass_kg"]
        self.mass, self.is_free = mass, mass is not None
        self.n_balls = BALLS.get(cell["scene"], 1)
        if self.is_free:
            weight = self.n_balls * mass * GRAVITY
            self.deflection = self.at_rest(k, weight)
            share = self.n_balls * mass / (self.deflection > 0).sum() + m
            is_plunger = cell["scene"] == "plunger"
            self.damping = k * SKIN_SIM["damping"] / SKIN_SIM["stiffness"] if is_plunger else 2 * math.sqrt(k * share)
            end = max(LEAST_TIME, DECAY / slowest(k, self.damping, share), LEAST_STEPS * cell["dt_s"])
            self.judged = self.end = end
            self.force, self.energy_limit = weight, weight * stroke
        else:
            ratio = SKIN_SIM["damping"] / (2 * math.sqrt(SKIN_SIM["stiffness"] * SKIN_SIM["mass"]))
            self.damping = 2 * ratio * math.sqrt(k * m)
            depth = 0.5 * stroke
            self.way = (APPROACH + depth) / SPEED
            self.hold = max(LEAST_HOLD, DECAY / slowest(k, self.damping, m), LEAST_HOLD_STEPS * cell["dt_s"])
            self.judged, self.end = self.way + self.hold, 2 * (self.way + self.hold)
            self.deflection = np.maximum(depth - self.starts, 0)
            self.force = k * self.deflection.sum()
            self.energy_limit = 2 * len(self.starts) * (k * depth**2 + m * (2 * SPEED) ** 2)

    def at_rest(self, k, weight):
        """Returns the deflections at which the springs carry the weight, metres, (n_taxels,); at the stops, the stops carry the remaining weight."""
        floor = self.starts.min() + self.stroke
        low, high = 0.0, floor
        if k * np.maximum(floor - self.starts, 0).sum() > weight:
            for _ in range(200):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if k * np.maximum(middle - self.starts, 0).sum() < weight else (low, middle)
        return np.maximum(high - self.starts, 0)

    def travel_at(self, t):
        """Returns the travel of an imposed ball at time t, metres, from its start APPROACH above first contact."""
        down = SPEED * min(max(t, 0), self.way)
        return down - SPEED * min(max(t - self.way - self.hold, 0), self.way)

    def frames(self):
        dt = self.cell["dt_s"]
        end = math.ceil(self.end / dt)
        return (math.floor(self.judged / dt) if self.judged < self.end else end), end

    def model(self, integrator, is_hard):
        """Returns the MuJoCo model: taxels on slide joints with springs, dampers and stops, and balls on slide joints or one imposed ball."""
        cell = self.cell
        spec = mujoco.MjSpec()
        spec.option.timestep, spec.option.integrator = cell["dt_s"], integrator
        spec.option.gravity = [0, 0, -GRAVITY]
        # Without automatic resets, a diverging run is detected.
        spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
        contact = dict(friction=[0, 0, 0], condim=1)
        joint = {}
        if is_hard:
            spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_REFSAFE
            solref, solimp = [HARD[0] * cell["dt_s"], 1], [HARD[1], 0.9999, 1e-4, 0.5, 2]
            # The ball starts at first contact. Without a margin, it passes through the skin within one long step.
            contact |= dict(solref=solref, solimp=solimp, margin=1e-3 * self.deflection.max() if self.is_free else 0.0)
            joint = dict(solref_limit=solref, solimp_limit=solimp)
        above = self.lift + (0 if self.is_free else APPROACH)
        if self.is_free:
            # Taxels collide with the first ball (bits 1 and 2), balls with each other (bit 4).
            for number in range(self.n_balls):
                ball = spec.worldbody.add_body(pos=[0, 0, above + 2 * number * self.ball])
                ball.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[0, 0, -1])
                bits = dict(contype=1 if number == 0 else 0, conaffinity=2 if number == 0 else 0)
                if self.n_balls > 1:
                    bits = {key: value | 4 for key, value in bits.items()}
                ball.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[self.ball, 0, 0], mass=self.mass, **bits, **contact)
        else:
            ball = spec.worldbody.add_body(pos=[0, 0, above], mocap=True)
            ball.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[self.ball, 0, 0], contype=1, conaffinity=2, **contact)
        for center in self.centers:
            # Gravity does not act on taxels.
            taxel = spec.worldbody.add_body(pos=center, gravcomp=1)
            taxel.add_joint(
                type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[0, 0, -1], stiffness=[cell["stiffness_n_per_m"], 0, 0],
                damping=[self.damping, 0, 0], limited=mujoco.mjtLimited.mjLIMITED_TRUE, range=[-1.0, self.stroke], **joint,
            )
            taxel.add_geom(
                type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[self.taxel_radius, 0, 0], mass=cell["taxel_mass_kg"], contype=2, conaffinity=1,
                **contact,
            )
        return spec.compile()


def slowest(k, c, m):
    """Returns the decay rate of the slower mode of m x'' + c x' + k x = 0, 1/s."""
    half = 0.5 * c / m
    inside = half**2 - k / m
    return (k / m) / (half + math.sqrt(inside)) if inside > 0 else half


def energy(scene, data, first):
    cell, taxels = scene.cell, slice(first, None)
    skin = 0.5 * (cell["taxel_mass_kg"] * data.qvel[taxels] ** 2 + cell["stiffness_n_per_m"] * data.qpos[taxels] ** 2).sum()
    balls = scene.mass * (0.5 * data.qvel[:first] ** 2 - GRAVITY * data.qpos[:first]).sum() if scene.is_free else 0.0
    return skin + balls


def force_on_ball(data):
    """Returns the total contact force on the taxels along their axis, newtons: the sum of normal forces times the normals' z components."""
    total, wrench = 0.0, np.zeros(6)
    of_taxels = data.model.geom_contype == 2
    for number in range(data.ncon):
        contact = data.contact[number]
        if contact.efc_address >= 0 and of_taxels[contact.geom].any():
            mujoco.mj_contactForce(data.model, data, number, wrench)
            total += abs(wrench[0] * contact.frame[2])
    return total


def simulate(scene, integrator, is_hard):
    """Returns the outcome, the relative force imbalance, the relative deflection error, and the number of steps."""
    dt = scene.cell["dt_s"]
    judged, end = scene.frames()
    model = scene.model(integrator, is_hard)
    data = mujoco.MjData(model)
    first = scene.n_balls if scene.is_free else 0
    above = scene.lift + APPROACH
    looks = {1, 2, 5, 10, judged, end} | set(range(0, end, max(1, end // 20)))
    imbalance = felt = None
    for step in range(1, end + 1):
        if not scene.is_free:
            data.mocap_pos[0] = [0, 0, above - scene.travel_at(step * dt)]
        mujoco.mj_step(model, data)
        if step in looks:
            now = energy(scene, data, first)
            if not np.isfinite(now):
                return "not_finite", None, None, step
            if now > scene.energy_limit:
                return "energy_growth", None, None, step
        if step == judged:
            imbalance, felt = abs(force_on_ball(data) / scene.force - 1), data.qpos[first:].copy()
    left_over = 0.0 if scene.is_free else np.abs(data.qpos[first:]).sum()
    total = scene.deflection.sum()
    error = max(np.abs(felt - scene.deflection).sum() / total, left_over / total)
    in_all = felt[scene.deflection > 0].sum() / total
    worst = max(error, imbalance)
    if not np.isfinite(worst):
        return "not_finite", None, None, end
    if not 0.5 <= in_all <= 2.0:
        return "missed_contact", imbalance, error, end
    return ("inaccurate" if worst > TOLERANCE else "right"), imbalance, error, end


def cells(study):
    """Yields each cell of the study's parts with an engine, and its stroke in millimetres: one cell for each combination of the axes.

    The part of growing arrays (`object_mass_per_taxel_kg`) is left out, because its largest arrays would take MuJoCo hours.
    """
    for number, part in enumerate(study["parts"], start=1):
        if "rapier_tuned" not in part["methods"] or "object_mass_per_taxel_kg" in part:
            continue
        axes = [as_list(part[key]) for key in ["taxels", "stiffness_n_per_m"]]
        axes += [as_list(part.get("object_mass_kg")), as_list(part["taxel_mass_kg"]), as_list(part["dt_s"])]
        for taxels, k, mass, m, dt in itertools.product(*axes):
            cell = dict(part=number, scene=part["scene"], taxels=taxels, stiffness_n_per_m=k, taxel_mass_kg=m, object_mass_kg=mass, dt_s=dt)
            yield cell, part.get("stroke_mm", 2.0)


def as_list(value):
    return value if isinstance(value, list) else [value]


def row_of(cell, scene, method, found, wall_s):
    outcome, imbalance, error, n_steps = found
    simulated = n_steps * cell["dt_s"]
    mass = cell["object_mass_kg"]
    row = dict(cell, method=method, solver_iterations="", contact_stiffness_n_per_m="", outcome=outcome)
    row |= dict(mass_ratio="" if mass is None else mass / cell["taxel_mass_kg"], object_mass_kg="" if mass is None else mass)
    row |= dict(explicit_limit_s=2 * math.sqrt(cell["taxel_mass_kg"] / cell["stiffness_n_per_m"]), damping_n_s_per_m=scene.damping)
    row |= dict(force_imbalance="" if imbalance is None else imbalance, deflection_error="" if error is None else error)
    row |= dict(n_steps=n_steps, simulated_s=simulated, wall_s=wall_s, per_simulated_s=wall_s / simulated)
    row |= scene.millimetres
    return row | dict(program="MuJoCo", version=mujoco.__version__, date=datetime.date.today().isoformat())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--study", type=Path, default=ROOT / "experiments" / "stability.toml")
    parser.add_argument("--out", type=Path, default=ROOT / "results" / "stability" / "peers.csv")
    parser.add_argument("--only", type=int, help="only so many cells, to try the script")
    options = parser.parse_args()
    study = tomllib.loads(options.study.read_text())["stability"]
    pitch_mm = study.get("pitch_mm", 4.0)
    rows, counts = [], {}
    for cell, stroke_mm in itertools.islice(cells(study), options.only):
        scene = Scene(cell, pitch_mm, stroke_mm)
        for method, integrator, is_hard in METHODS:
            start = time.perf_counter()
            found = simulate(scene, integrator, is_hard)
            rows.append(row_of(cell, scene, method, found, time.perf_counter() - start))
            key = (cell["scene"], method, found[0])
            counts[key] = counts.get(key, 0) + 1
    part = options.out.with_suffix(".part")
    with open(part, "w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        writer.writerows(rows)
    part.replace(options.out)
    for (scene, method, outcome), count in sorted(counts.items()):
        print(f"{scene:13} {method:20} {outcome:15} {count}")


if __name__ == "__main__":
    main()
