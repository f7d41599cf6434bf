"""A railway wheel on its rail in Exudyn, with the lumped contact element of railspring.

The wheel is a hub with oscillators that move its rim. The rail is the modes of its beam. A bushing joins the
beam's section under the wheel to the head of the rail. Between head and rim lies a Winkler foundation: strips
across the track with Coulomb friction. Rim and head have no mass.

With the hub's motion u, the oscillators' displacements q, the rail modes' s, and the contact force f on the rim:

    rim = u + sum r q                       r = (r_y, offset r_phi, r_phi)
    M u'' + sum c q'' = loads + f           q'' + c u'' + beta w^2 q' + w^2 q = r f
    head = sum d s - C T'f                  s'' + beta w^2 s' + w^2 s = -d T'f

T takes motions of the head at the shear centre to the wheel's origin, C is the flexibility of the bushing.

Axes: x along the track, y to the field side, z down, rotation phi about x, from y to z. All units are SI.
Profiles and strips stand in the JSON file of the same name.

Usage: python wheel_rail_exudyn.py [time steps per row of the history]
Writes history.csv (time_s, p_kn, q_kn): vertical and lateral force of the wheel on the rail.
Needs exudyn (1.13.6) and numpy.
"""
import csv
import json
import pathlib
import sys
import exudyn as exu
import numpy as np
from exudyn.itemInterface import (CoordinateSpringDamper, LoadCoordinate, MarkerNodeCoordinate, MassPoint,
                                  NodeGenericODE2, NodePoint, ObjectGenericODE2)

# CONSTANTS
FORCE_TOLERANCE = 0.1  # N, balance of the head
# STRIPS


class Contact:
    """The strips with the bushing: forces on hub, oscillators and rail modes by their displacements.

    The head has no mass: its balance is solved by Newton's method wherever the forces are evaluated.
    """

    def __init__(self, strips, of_rim, of_head):
        """`of_rim` and `of_head` have the motions of rim and section by the coordinates as rows."""
        self.strips, self.of_rim, self.of_head = strips, of_rim, of_head
        arm = np.array([-BUSHING_HEIGHT, 0.0, 1.0])
        self.flexibility = np.diag([1.0 / BUSHING_LATERAL, 1.0 / BUSHING_VERTICAL, 0.0]) + np.outer(arm, arm) / BUSHING_TURN
        self.stiffness = np.linalg.inv(self.flexibility)
        self.head = np.zeros(3)  # where the iteration begins
        strips.begin_step(np.zeros(3), self.head, [], [])

    def at(self, rim, section, head):
        """The head in a pose: that, force on the rim with its derivative, friction taken up, T, and what is off."""
        force, stiffness, taken_up = self.strips.forces(rim, head)
        to_rim = transport(self.strips.arm + rim[:2] - head[:2])
        off = head - section + self.flexibility @ to_rim.T @ force
        return head, force, stiffness, taken_up, to_rim, off, np.abs(self.stiffness @ off).max()

    def balance(self, coordinates):
        """Poses of rim and head, force on the rim with its derivative, friction taken up, and T."""
        rim, section = self.of_rim @ coordinates, self.of_head @ coordinates
        found = self.at(rim, section, self.head)
        for _ in range(60):
            head, force, stiffness, taken_up, to_rim, off, size = found
            if size < FORCE_TOLERANCE:
                self.head = head
                return rim, head, force, stiffness, taken_up, to_rim
            step = np.linalg.solve(np.eye(3) + self.flexibility @ to_rim.T @ stiffness @ to_rim, off)
            # between sticking and sliding a whole step may lead to and fro; a part of it leads down
            for length in 0.5 ** np.arange(8):
                found = self.at(rim, section, head - length * step)
                if found[-1] < (1.0 - 0.1 * length) * size:
                    break
        raise RuntimeError('the head of the rail is %.3g N off balance; take shorter time steps' % size)

    def force(self, mbs, time, item, coordinates, velocities):
        """Forces on the coordinates."""
        _, _, force, _, _, to_rim = self.balance(coordinates)
        return (self.of_rim - to_rim @ self.of_head).T @ force

    def jacobian(self, mbs, time, item, coordinates, velocities, factor, factor_t):
        """Minus their derivative by the coordinates."""
        _, _, _, stiffness, _, to_rim = self.balance(coordinates)
        bushing = to_rim @ self.flexibility @ to_rim.T
        rows = self.of_rim - to_rim @ self.of_head
        return factor * rows.T @ np.linalg.solve(np.eye(3) + stiffness @ bushing, stiffness) @ rows

    def end_step(self, coordinates):
        """Ends a time step; the force on the rail (y, z; N)."""
        rim, head, force, _, taken_up, _ = self.balance(coordinates)
        self.strips.begin_step(rim, head, self.strips.window, taken_up)
        return -force[:2]


def build(mbs, data):
    """Adds all bodies and loads to the system; returns the contact, whose coordinates are the system's first."""
    def add_oscillators(frequencies, damping):
        count = len(frequencies)
        node = mbs.AddNode(NodeGenericODE2(
            referenceCoordinates=[0.0] * count, initialCoordinates=[0.0] * count,
            initialCoordinates_t=[0.0] * count, numberOfODE2Coordinates=count))
        stiffness = np.diag((2.0 * np.pi * np.array(frequencies))**2)
        mbs.AddObject(ObjectGenericODE2(nodeNumbers=[node], massMatrix=np.eye(count), stiffnessMatrix=stiffness,
                                        dampingMatrix=damping * stiffness))
        return node

    hub = mbs.AddNode(NodePoint())
    wheel = add_oscillators(OSCILLATOR_FREQUENCY, WHEEL_DAMPING)
    rail = add_oscillators(RAIL_FREQUENCY, RAIL_DAMPING)
    mbs.AddObject(MassPoint(mass=HUB_MASS, nodeNumber=hub))
    # mass that couples the oscillators with the hub
    on_wheel = slice(3, 3 + len(OSCILLATOR_FREQUENCY))
    coupling = np.zeros((on_wheel.stop, on_wheel.stop))
    coupling[1, on_wheel] = coupling[on_wheel, 1] = COUPLING_LATERAL
    coupling[2, on_wheel] = coupling[on_wheel, 2] = COUPLING_VERTICAL
    mbs.AddObject(ObjectGenericODE2(nodeNumbers=[hub, wheel], massMatrix=coupling))
    # contact
    size = on_wheel.stop + len(RAIL_FREQUENCY)
    of_rim, of_head = np.zeros((3, size)), np.zeros((3, size))
    of_rim[0, 1] = of_rim[1, 2] = 1.0
    of_rim[:, on_wheel] = RIM_LATERAL, RIM_OFFSET * np.array(RIM_TURN), RIM_TURN
    of_head[:, on_wheel.stop:] = HEAD_LATERAL, HEAD_VERTICAL, HEAD_TURN
    contact = Contact(CONTACT(data), of_rim, of_head)
    mbs.AddObject(ObjectGenericODE2(nodeNumbers=[hub, wheel, rail], massMatrix=np.zeros((size, size)),
                                    forceUserFunction=contact.force, jacobianUserFunction=contact.jacobian))
    # suspension and loads; without a suspended mass the suspension passes the force on to the hub
    hub_y, hub_z = [mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=hub, coordinate=axis)) for axis in (1, 2)]
    loaded = hub_z
    if SUSPENDED_MASS > 0.0:
        suspended = mbs.AddNode(NodePoint())
        mbs.AddObject(MassPoint(mass=SUSPENDED_MASS, nodeNumber=suspended))
        loaded = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=suspended, coordinate=2))
        mbs.AddObject(CoordinateSpringDamper(markerNumbers=[hub_z, loaded], stiffness=SUSPENSION_STIFFNESS,
                                             damping=SUSPENSION_DAMPING))
    mbs.AddLoad(LoadCoordinate(markerNumber=hub_z, load=GRAVITY * HUB_MASS))

    def vertical_force(mbs, time, load):
        sine = np.sin(2.0 * np.pi * VERTICAL_FREQUENCY * time + VERTICAL_PHASE)
        return GRAVITY * SUSPENDED_MASS + VERTICAL_MEAN + VERTICAL_AMPLITUDE * sine

    def lateral_force(mbs, time, load):
        return LATERAL_MEAN + LATERAL_AMPLITUDE * np.sin(2.0 * np.pi * LATERAL_FREQUENCY * time + LATERAL_PHASE)

    mbs.AddLoad(LoadCoordinate(markerNumber=loaded, loadUserFunction=vertical_force))
    mbs.AddLoad(LoadCoordinate(markerNumber=hub_y, loadUserFunction=lateral_force))
    return contact


def main(steps_per_row):
    """Runs the load case and writes history.csv."""
    data = json.loads(pathlib.Path(__file__).with_suffix('.json').read_text())
    system = exu.SystemContainer()
    mbs = system.AddSystem()
    contact = build(mbs, data)
    size, rows = contact.of_rim.shape[1], []

    def post_step(mbs, time):  # after each completed step, and once at the start
        lateral, vertical = contact.end_step(mbs.systemData.GetODE2Coordinates()[:size])
        if round(time / ROW * steps_per_row) % steps_per_row == 0:
            rows.append(['%.6g' % time, '%.9g' % (vertical * 1e-3), '%.9g' % (lateral * 1e-3)])
        return True

    mbs.SetPostStepUserFunction(post_step)
    mbs.Assemble()
    settings = exu.SimulationSettings()
    settings.solution.file.write = False  # Exudyn's own file
    integration = settings.timeIntegration
    integration.numberOfSteps = ROWS * steps_per_row
    integration.endTime = ROWS * ROW
    integration.adaptiveStep = False
    integration.verboseMode = 1
    integration.newton.useModifiedNewton = False  # the contact's stiffness changes from step to step
    integration.newton.relativeTolerance = 1e-6
    integration.newton.absoluteTolerance = 1e-4
    mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.TrapezoidalIndex2)  # average acceleration
    with open('history.csv', 'w', newline='') as file:
        csv.writer(file).writerows([['time_s', 'p_kn', 'q_kn']] + rows)


if __name__ == '__main__':
    main(int(sys.argv[1]) if len(sys.argv) > 1 else STEPS)
