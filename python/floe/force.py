"""Forces in Python."""
import numpy as np
from numpy.typing import NDArray
from typing import Protocol


class ForceBodies(Protocol):
    """The bodies of this rank at the start of a step, one row each. The arrays are memory of the
    library: read them, and keep copies, since the next step overwrites them."""
    time: float  #: [s]
    index: NDArray[np.int32]  #: in the lattice, (n,)
    position: NDArray[np.float64]  #: of the centroids [m], (n, 3)
    orientation: NDArray[np.float64]  #: rotation since rest, w x y z, (n, 4)
    velocity: NDArray[np.float64]  #: half a step before `time` [m/s], (n, 3)
    spin: NDArray[np.float64]  #: likewise, world axes [rad/s], (n, 3)
    mass: NDArray[np.float64]  #: [kg], (n,)
    force: NDArray[np.float64]  #: to be added to, zeros before [N], (n, 3)
    moment: NDArray[np.float64]  #: about the centroids, likewise [N m], (n, 3)

    def __len__(self) -> int: ...


class Force:
    """A force on bodies, for explicit runs by leapfrog:

        class Wind(floe.Force):
            def add(self, bodies):
                bodies.force[:, 0] += 0.5 * 1.3 * area * (speed - bodies.velocity[:, 0]) ** 2

        floe.Simulation(scene, forces=[Wind()])

    It is asked once per step, on all ranks, with the bodies of each. Its work is in the column
    energy_external. The search for the stable step does not see it: a force that grows with places
    or velocities says how fast, by the attributes `stiffness`, an upper bound of M^-1 K [1/s^2]
    that is added to that of all else, and `damping`, of M^-1 C [1/s]: steps stay below 2/damping.
    With a force of Python the model is spatial.

    An exception pauses the run before the step on all ranks: the rank that has it gets it from
    step_to(), the others get CallbackError.
    """
    stiffness: float = 0.0
    damping: float = 0.0

    def add(self, bodies: ForceBodies) -> None:
        """Adds to bodies.force and bodies.moment."""
        raise NotImplementedError(f"{type(self).__name__} has no method add(self, bodies)")
