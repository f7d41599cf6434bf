"""A load case with the contact element as a functional mock-up unit (FMI 3.0, co-simulation); FMPy is the master.

A railway wheel stands on a short rail (S.H. Ju 2016, section 4.1). This program has the hub (y and z), a mass on
spring and damper above it, and the rail by its modes. The hub does not turn. The unit has the wheel's modes and the
contact. It takes the motions of hub and rail section at the end of a step, and gives the forces there (parameter
inputs_at_end).

    hub M a = loads + force of the unit on the hub        rail mode q: q'' + b w^2 q' + w^2 q = shape . force on section

All is explicit (central differences). A step must be shorter than 2 / w of the rail's last mode: 55 microseconds.

The element file (safetensors), from which the unit was made, has the numbers of hub and rail:
- wheel.mass (3, 3) is the whole wheel about the hub's centre (y, z, turn).
- wheel.modes has a row for each mode: square of the angular frequency, motion of the rim (3), coupling with the hub
  (3). The hub beside the modes is the mass minus the sum of coupling coupling^T.
- rail.modes has a row for each mode of 1 kg: square of the angular frequency (1/s^2), motion of the section (y, z,
  turn). Their damping is damping_s times the square.
- rail.rest (3, 3) is the section's flexibility beyond the modes.

Usage: python fmpy_master.py pair.rse pair.fmu [steps per row of 0.5 ms, 16]
Writes forces.csv: time_s, and the forces of the wheel on the rail, p_n (vertical) and q_n (lateral).
Needs numpy and fmpy (0.3.32). With "-" for the unit, the C library through contact_library.py stands in for it.
"""
import json
import pathlib
import sys
import time as clock
import numpy as np

ROW, ROWS = 0.5e-3, 550  # s, number
SUSPENDED_MASS, SPRING, DAMPER = 6250.0, 1.2e6, 4e4  # kg, N/m, N s/m
AXES = 'y', 'z', 'roll'
FORCES = 'fy', 'fz', 'mx'
REST = 'rest.yy', 'rest.yz', 'rest.yr', 'rest.zz', 'rest.zr', 'rest.rr'


def read_element(path):
    """Tensors and notes of an element file: safetensors, a header in JSON after its length, then the numbers."""
    content = pathlib.Path(path).read_bytes()
    begin = 8 + int.from_bytes(content[:8], 'little')
    header = json.loads(content[8:begin])
    notes = json.loads(header.pop('__metadata__')['railspring'])
    return {name: np.frombuffer(content[begin:][slice(*entry['data_offsets'])], '<f8').reshape(entry['shape'])
            for name, entry in header.items()}, notes


class MockUpUnit:
    """An instance of the functional mock-up unit."""

    def __init__(self, path):
        import fmpy
        from fmpy.fmi3 import FMU3Slave
        description = fmpy.read_model_description(path)
        references = {variable.name: variable.valueReference for variable in description.modelVariables}
        self.parameters = [references[name] for name in ('gravity', *REST)]
        self.at_end = references['inputs_at_end']
        bodies = 'hub.', 'section.'
        self.inputs = [references[body + kind + axis] for kind in ('', 'v') for body in bodies for axis in AXES]
        self.inputs.append(references['place'])
        self.outputs = [references[body + force] for body in (*bodies, 'rim.') for force in FORCES]
        self.instance = FMU3Slave(guid=description.guid, unzipDirectory=fmpy.extract(path), instanceName='pair',
                                  modelIdentifier=description.coSimulation.modelIdentifier)

    def start(self, rest, motions, velocities, place):
        """Begins at these motions. The forces on hub, section and rim."""
        self.instance.instantiate()
        self.instance.enterInitializationMode(startTime=0.0, stopTime=ROW * ROWS)
        self.instance.setFloat64(self.parameters, [0.0, *rest[np.triu_indices(3)]])
        self.instance.setBoolean([self.at_end], [True])
        self.instance.setFloat64(self.inputs, [*motions, *velocities, place])
        self.instance.exitInitializationMode()
        return np.array(self.instance.getFloat64(self.outputs))

    def step(self, time, length, motions, velocities, place, goes_back=False):
        """A step from a time. The motions are those at its end, and so are the forces."""
        self.instance.setFloat64(self.inputs, [*motions, *velocities, place])
        self.instance.doStep(time, length, not goes_back)  # False where a state may be set again
        return np.array(self.instance.getFloat64(self.outputs))

    def end(self):
        """Lets the instance go."""
        self.instance.terminate()
        self.instance.freeInstance()


class StandIn:
    """The same by the C library."""

    def __init__(self, path):
        import contact_library
        self.unit = contact_library.Unit(contact_library.Element(path))

    def start(self, rest, motions, velocities, place):
        self.unit.set_section_rest(rest)
        return self.unit.start(motions, velocities, place)

    def step(self, _, length, motions, velocities, place):
        forces = self.unit.advance(length, motions, velocities, place)
        self.unit.commit()
        return forces

    def end(self):
        pass


def loads(time):
    """Lateral force on the hub, and vertical one on the suspended mass, N."""
    return 20e3, 10e3 + 61.25e3 * np.sin(2.0 * np.pi * 10.0 * time)


def main(element_path, unit_path, steps=16):
    """Runs the load case, and writes forces.csv."""
    tensors, notes = read_element(element_path)
    place, damping = notes['rail_at_wheel']['place_m'], notes['rail_at_wheel']['damping_s']
    couplings, squares = tensors['wheel.modes'][:, 4:], tensors['rail.modes'][:, 0]
    hub_mass = (tensors['wheel.mass'] - couplings.T @ couplings)[:2, :2]
    # coordinates: hub y and z, suspended mass, modes of the rail
    size = 3 + len(squares)
    carried = np.zeros((6, size))  # motions of hub and section by the coordinates
    carried[0, 0] = carried[1, 1] = 1.0
    carried[3:, 3:] = tensors['rail.modes'][:, 1:].T
    inverse_mass = np.eye(size)
    inverse_mass[:2, :2], inverse_mass[2, 2] = np.linalg.inv(hub_mass), 1.0 / SUSPENDED_MASS
    stiffness, damper = np.diag([0.0, 0.0, 0.0, *squares]), np.diag([0.0, 0.0, 0.0, *(damping * squares)])
    for matrix, value in (stiffness, SPRING), (damper, DAMPER):
        matrix[1:3, 1:3] += value * np.array([[1.0, -1.0], [-1.0, 1.0]])

    def accelerations(time, x, v, forces):
        outside = np.zeros(size)
        outside[[0, 2]] = loads(time)
        return inverse_mass @ (outside + carried.T @ forces[:6] - stiffness @ x - damper @ v)

    length = ROW / steps
    x, v = np.zeros(size), np.zeros(size)
    unit = StandIn(element_path) if unit_path == '-' else MockUpUnit(unit_path)
    forces = unit.start(tensors['rail.rest'], carried @ x, carried @ v, place)
    a = accelerations(0.0, x, v, forces)
    rows = [(0.0, -forces[7], -forces[6])]
    begun = clock.process_time()
    for step in range(1, ROWS * steps + 1):
        x = x + length * v + 0.5 * length**2 * a
        expected = v + length * a
        forces = unit.step((step - 1) * length, length, carried @ x, carried @ expected, place)
        after = accelerations(step * length, x, expected, forces)
        v = v + 0.5 * length * (a + after)
        a = after
        if step % steps == 0:
            rows.append((step * length, -forces[7], -forces[6]))
    taken = (clock.process_time() - begun) / (ROWS * steps)
    unit.end()
    with open('forces.csv', 'w') as file:
        file.write('time_s,p_n,q_n\n')
        file.writelines('%.6g,%.9g,%.9g\n' % row for row in rows)
    print('%.1f us a step' % (1e6 * taken))


if __name__ == '__main__':
    main(*sys.argv[1:3], *map(int, sys.argv[3:4]))
