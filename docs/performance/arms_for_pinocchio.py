"""Writes arms of tests/vectors/robots for pinocchio.cpp, as Pinocchio's own URDF reader sees them.

python arms_for_pinocchio.py URDF > TEXT

One line a joint: axis (0 to 2), placement (rotation by columns, translation), mass, centre of mass, inertia about it.
"""

import sys

import pinocchio

model = pinocchio.buildModelFromUrdf(sys.argv[1])
for joint, placement, inertia in list(zip(model.joints, model.jointPlacements, model.inertias))[1:]:
    axis = {"JointModelRX": 0, "JointModelRY": 1, "JointModelRZ": 2}[joint.shortname()]
    numbers = [
        *placement.rotation.T.flatten(),
        *placement.translation,
        inertia.mass,
        *inertia.lever,
        *inertia.inertia.flatten(),
    ]
    print(axis, *(repr(float(number)) for number in numbers))
