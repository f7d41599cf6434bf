"""A railway wheel on a short rail in Exudyn; the contact is the element of railspring, called while the solver runs.

Load case of S.H. Ju 2016, section 4.1. All but the contact are Exudyn's objects: hub (y and z), mass on spring and
damper above it, and the rail by its modes. The hub does not turn. The contact is an object without mass whose force is
a user function. It has a tangent, so that Newton's method is quick. There are two kinds:
- "contact": the wheel's modes are Exudyn's coordinates, and the contact is statics with friction.
- "unit": the element has the wheel's modes inside.

Forces depend on the motions and on the end of the last step alone. So Newton's method may call the element at will.
After each step a user function says that the step has ended.

Axes: x along the track, y to the field side, z down. SI units.
Usage: python exudyn_live.py pair.rse [contact|unit [steps per row of 0.5 ms, 16]]
Writes forces.csv: time_s, and the forces of the wheel on the rail, p_n (vertical) and q_n (lateral).
Needs exudyn (1.13.6), numpy, contact_library.py beside this file, and the C library (see there).
"""
import sys
import time as clock
import exudyn as exu
import numpy as np
from exudyn.itemInterface import (CoordinateSpringDamper, LoadCoordinate, MarkerNodeCoordinate, MassPoint,
                                  NodeGenericODE2, NodePoint, ObjectGenericODE2)
from contact_library import Contact, Element, Unit

ROW, ROWS = 0.5e-3, 550  # s, number
SUSPENDED_MASS, SPRING, DAMPER = 6250.0, 1.2e6, 4e4  # kg, N/m, N s/m
AVERAGE_ACCELERATION = exu.DynamicSolverType.TrapezoidalIndex2
LATERAL, VERTICAL, SWING, FREQUENCY = 20e3, 10e3, 61.25e3, 10.0  # N, N, N, Hz


class InExudyn:
    """A contact behind Exudyn's user functions. `carried` has the motions of two bodies by the coordinates as rows."""

    def __init__(self, element, stepped, carried):
        self.carried, self.place, self.stepped, self.time = carried, element.about.place, stepped, 0.0
        stepped.set_section_rest(element.rail_rest)
        self.start()
        self.evaluated_at = (0.0,) * (1 + 2 * carried.shape[1])  # time, coordinates, velocities

    def evaluate(self, time, coordinates, velocities):
        """Finds `forces` and `tangent`, unless they are those of the last call."""
        now = time, *coordinates, *velocities
        if now != self.evaluated_at:
            self.advance(time - self.time, self.carried @ np.array(coordinates), self.carried @ np.array(velocities))
            self.evaluated_at = now

    def force(self, mbs, time, item, coordinates, velocities):
        """Forces on the coordinates."""
        self.evaluate(time, coordinates, velocities)
        return self.carried.T @ self.forces

    def jacobian(self, mbs, time, item, coordinates, velocities, factor, factor_t):
        """Minus their derivative by the coordinates."""
        self.evaluate(time, coordinates, velocities)
        return -factor * self.carried.T @ self.tangent @ self.carried

    def end_step(self, time, coordinates, velocities):
        """Ends a step here. The forces of the wheel on the rail, P and Q."""
        self.evaluate(time, coordinates, velocities)
        self.stepped.commit()
        self.time = time
        return -self.rim[1], -self.rim[0]


class ContactInExudyn(InExudyn):
    """The contact as statics, between rim and rail section."""

    def __init__(self, element, carried, friction=float('nan')):
        super().__init__(element, Contact(element, friction), carried)

    def start(self):
        self.forces, self.tangent = self.stepped.start(np.zeros(6), self.place)
        self.rim = self.forces[:3]

    def advance(self, length, motions, speeds):
        self.forces, self.tangent = self.stepped.evaluate(motions, self.place)
        self.rim = self.forces[:3]


class UnitInExudyn(InExudyn):
    """The contact with the wheel's modes inside, between hub and rail section."""

    def __init__(self, element, carried):
        super().__init__(element, Unit(element), carried)

    def start(self):
        self.forces, self.rim = np.split(self.stepped.start(np.zeros(6), np.zeros(6), self.place), [6])

    def advance(self, length, motions, speeds):
        self.forces, self.rim = np.split(self.stepped.advance(length, motions, speeds, self.place), [6])
        self.tangent = self.stepped.tangent()


def add_modes(mbs, mass, damping, stiffness):
    """Adds coordinates for modes."""
    zeros = [0.0] * len(mass)
    node = mbs.AddNode(NodeGenericODE2(numberOfODE2Coordinates=len(mass), referenceCoordinates=zeros,
                                       initialCoordinates=zeros, initialCoordinates_t=zeros))
    mbs.AddObject(ObjectGenericODE2(nodeNumbers=[node], massMatrix=mass, dampingMatrix=damping,
                                    stiffnessMatrix=stiffness))
    return node


def build(mbs, element, kind):
    """Adds all bodies, the contact and the loads; the contact's coordinates are the system's first."""
    hub = mbs.AddNode(NodePoint())  # x does not move
    nodes, on_hub = [hub], slice(1, 3)
    if kind == 'contact':
        modes = slice(3, len(element.mass))
        hub_mass = element.mass[:2, :2]
        nodes.append(add_modes(mbs, *(m[modes, modes] for m in (element.mass, element.damping, element.stiffness))))
    else:
        modes = slice(3, 3)  # none
        hub_mass = element.hub_mass[:2, :2]
    # mass of the hub, and that between hub and modes; any along x
    mass = np.zeros((modes.stop, modes.stop))
    mass[0, 0], mass[on_hub, on_hub] = hub_mass[1, 1], hub_mass
    mass[on_hub, modes] = element.mass[:2, modes]
    mass[modes, on_hub] = mass[on_hub, modes].T
    mbs.AddObject(ObjectGenericODE2(nodeNumbers=nodes, massMatrix=mass))
    # rail
    stiffness = np.diag(element.rail_squares)
    nodes = [*nodes, add_modes(mbs, np.eye(len(stiffness)), element.about.damping[1] * stiffness, stiffness)]
    # contact
    size = modes.stop + len(stiffness)
    carried = np.zeros((6, size))
    carried[:3, on_hub] = element.rim[:, :2] if kind == 'contact' else np.eye(3)[:, :2]
    carried[:3, modes] = element.rim[:, modes]
    carried[3:, modes.stop:] = element.rail_sections.T
    contact = (ContactInExudyn if kind == 'contact' else UnitInExudyn)(element, carried)
    mbs.AddObject(ObjectGenericODE2(nodeNumbers=nodes, massMatrix=np.zeros((size, size)),
                                    forceUserFunction=contact.force, jacobianUserFunction=contact.jacobian))
    # suspended mass and loads
    suspended = mbs.AddNode(NodePoint())
    mbs.AddObject(MassPoint(mass=SUSPENDED_MASS, nodeNumber=suspended))
    hub_y, hub_z, above = [mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=node, coordinate=axis))
                           for node, axis in ((hub, 1), (hub, 2), (suspended, 2))]
    mbs.AddObject(CoordinateSpringDamper(markerNumbers=[hub_z, above], stiffness=SPRING, damping=DAMPER))
    mbs.AddLoad(LoadCoordinate(markerNumber=hub_y, load=LATERAL))
    mbs.AddLoad(LoadCoordinate(markerNumber=above, loadUserFunction=lambda mbs, time, load: (
        VERTICAL + SWING * np.sin(2.0 * np.pi * FREQUENCY * time))))
    return contact, size


def settings_for(steps, end):
    """Newton's whole method in a number of steps, shorter ones where no motions balance."""
    settings = exu.SimulationSettings()
    settings.solution.file.write = False  # Exudyn's own file
    integration = settings.timeIntegration
    integration.numberOfSteps, integration.endTime = steps, end
    integration.adaptiveStep = True  # the element's forces jump by up to 40 N in some places
    integration.newton.useModifiedNewton = False  # the contact's stiffness changes from step to step
    integration.newton.relativeTolerance, integration.newton.absoluteTolerance = 1e-3, 0.1
    return settings


def write_rows(path, names, ends, times):
    """Writes a row for each of some times. `ends` has a row for each step, with its time first."""
    ends = np.array(ends)
    rows = np.column_stack([times, *(np.interp(times, ends[:, 0], values) for values in ends.T[1:])]) + 0.0  # no -0
    np.savetxt(path, rows, '%.9g', ',', header=names, comments='')
    return rows


def main(path, kind='contact', steps=16):
    """Runs the load case, and writes forces.csv."""
    system = exu.SystemContainer()
    mbs = system.AddSystem()
    contact, size = build(mbs, Element(path), kind)
    ends = []

    def after_step(mbs, time):  # after each step, and once at the start
        now = mbs.systemData.GetODE2Coordinates()[:size], mbs.systemData.GetODE2Coordinates_t()[:size]
        ends.append((time, *contact.end_step(time, *now)))
        return True

    mbs.SetPostStepUserFunction(after_step)
    mbs.Assemble()
    begun = clock.process_time()
    mbs.SolveDynamic(settings_for(ROWS * steps, ROWS * ROW), solverType=AVERAGE_ACCELERATION)
    taken = clock.process_time() - begun
    write_rows('forces.csv', 'time_s,p_n,q_n', ends, ROW * np.arange(ROWS + 1))
    print('%d steps, %.1f us a step' % (len(ends) - 1, 1e6 * taken / (len(ends) - 1)))


if __name__ == '__main__':
    main(*sys.argv[1:3], *map(int, sys.argv[3:4]))
