"""A stock environment of Gymnasium whose observations contain the forces on the soles of its feet."""

import gymnasium

import bubbletouch as bt
from bubbletouch.mujoco import SkinObservation

cheetah = gymnasium.make("HalfCheetah-v5")
# Radii and lengths of the capsules of the feet, metres.
shapes = {"geom:bfoot": (0.046, 0.188), "geom:ffoot": (0.046, 0.14)}
feet = {name: bt.Patch.draped(bt.Mesh.capsule(*shape), pitch=0.02, stroke=0.02) for name, shape in shapes.items()}
env = SkinObservation(cheetah, feet, match="normal_force")

observation = env.reset(seed=0)[0]
env.action_space.seed(0)
forces = []
for _ in range(100):
    observation = env.step(env.action_space.sample())[0]
    forces.append([env.skin.frame(name, observation[17:]).sum() for name in feet])
for name, force in zip(feet, zip(*forces, strict=True), strict=True):
    print(f"{name} touches the floor in {sum(f > 0 for f in force)} of 100 steps, with up to {max(force):.0f} N")
print(f"{env.skin.n_taxels} of {len(observation)} numbers of an observation come from the skin")
