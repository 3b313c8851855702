"""Small scenes that several tests run."""

# A small sheet on water, a hundred thousand steps long; at end 1 it takes no time.
AFLOAT = """integrator: explicit
forces: [beam, gravity, buoyancy]
sheet: {length: 6, thickness: 0.5, element_size: 2, iterations: 5}
beam: {damping_ratio: 1}
time: {end: 100000}
output: {history: 0.002}
"""
# As many load steps as anybody has time for.
LOADED = """forces: [beam]
sheet: {length: 6, thickness: 0.5, element_size: 2, iterations: 5}
boundary: {names: [a], a: {set: left, fix: x y z rx ry rz}}
load: {names: [b], b: {set: right, force: [0, 0, 1e4], ramp: 1}}
time: {end: 1, dt: 1e-7}
"""
# A sheet that is pulled from the first step on.
PULL = """integrator: explicit
forces: [beam]
sheet: {length: 10, thickness: 0.5, element_size: 1.5, iterations: 10}
boundary:
  names: [left, right]
  left: {set: left, fix: x}
  right: {set: right, fix: x, velocity: [0.1, 0, 0]}
time: {end: 0.01}
"""
