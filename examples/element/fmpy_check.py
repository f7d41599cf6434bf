"""What a master may rely on where the contact element is a functional mock-up unit (FMI 3.0); the master is FMPy.

- Co-simulation: a step after fmi3SetFMUState gives the same bytes as the step before it.
- Co-simulation: directional derivatives of the forces by the motions at the end of a step agree with differences.
- Model exchange: so do those of forces and accelerations of the modes, by inputs and by states.

The wheel is pressed on the rail and pushed to the side. Differences are central, so that curvature has little effect.
They mean nothing across a jump or a bend of the forces. So half of all steps must agree, not each one.

Usage: python fmpy_check.py pair.rse pair.fmu
Needs numpy, fmpy (0.3.32), and fmpy_master.py beside this file.
"""
import sys
import fmpy
import numpy as np
from fmpy.fmi3 import FMU3Model
from fmpy_master import MockUpUnit, read_element

LENGTH, STEPS = 2e-5, 200  # s, number
PRESSED, PUSHED = 1e-4, 1e-4  # m, at the end
DIFFERENCE = np.array([1e-9, 1e-9, 1e-8])  # m, m, rad
AGREE = 0.02  # of the largest derivative


def at(share):
    """Motions of hub and section (6), and their velocities."""
    motions = np.array([PUSHED * share, PRESSED * share, 0.0, 0.0, 0.0, 0.0])
    return motions, np.array([PUSHED, PRESSED, 0.0, 0.0, 0.0, 0.0]) / (STEPS * LENGTH)


def off(derivatives, differences):
    """Largest error of derivatives, in shares of the largest of each kind: forces (N/m) before moments."""
    return max(np.abs(derivatives[rows] - differences[rows]).max() / max(np.abs(differences[rows]).max(), 1e-300)
               for rows in (slice(0, 2), slice(3, 5)))


def co_simulation(element_path, unit_path):
    """Steps that return to their beginning."""
    tensors, notes = read_element(element_path)
    place, unit = notes['rail_at_wheel']['place_m'], MockUpUnit(unit_path)
    unit.start(tensors['rail.rest'], *at(0.0), place)
    instance, same, errors = unit.instance, 0, []
    for step in range(STEPS):
        time, (motions, velocities) = step * LENGTH, at((step + 1) / STEPS)
        state = instance.getFMUState()

        def again(moved):
            """The forces after a step that begins here."""
            instance.setFMUState(state)
            return unit.step(time, LENGTH, motions + moved, velocities, place, goes_back=True)

        first = unit.step(time, LENGTH, motions, velocities, place, goes_back=True)
        differences = np.zeros((6, 6))
        for i, moved in enumerate(np.diag(np.tile(DIFFERENCE, 2))):
            differences[:, i] = ((again(moved) - again(-moved)) / (2.0 * moved[i]))[:6]
        same += again(np.zeros(6)).tobytes() == first.tobytes()
        derivatives = np.transpose([instance.getDirectionalDerivative(unit.outputs[:6], [known], [1.0])
                                    for known in unit.inputs[:6]])
        errors.append(off(derivatives, differences))
        instance.freeFMUState(state)
    unit.end()
    print('co-simulation: %d of %d steps repeat to the byte; P is %.0f N at the end' % (same, STEPS, -first[7]))
    print('  derivatives are off by %.2g in half of the steps, by %.2g in one of ten, by %.2g in one' % (
        np.median(errors), np.quantile(errors, 0.9), max(errors)))
    return same == STEPS and np.median(errors) < AGREE


def model_exchange(unit_path):
    """Derivatives by inputs and states, at motions and at modes that do not swing."""
    description = fmpy.read_model_description(unit_path)
    references = {variable.name: variable.valueReference for variable in description.modelVariables}
    modes = sum(name.endswith('.p') and name.startswith('mode[') for name in references)
    inputs = [references[body + axis] for body in ('hub.', 'section.') for axis in ('y', 'z', 'roll')]
    states = [references['mode[%d].%s' % (mode, kind)] for mode in range(1, modes + 1) for kind in 'pv']
    forces = [references[body + force] for body in ('hub.', 'section.') for force in ('fy', 'fz', 'mx')]
    rates = [references['der(mode[%d].v)' % mode] for mode in range(1, modes + 1)]
    model = FMU3Model(guid=description.guid, unzipDirectory=fmpy.extract(unit_path), instanceName='pair',
                      modelIdentifier=description.modelExchange.modelIdentifier)
    model.instantiate()
    model.enterInitializationMode(startTime=0.0)
    model.exitInitializationMode()
    model.updateDiscreteStates()
    model.enterContinuousTimeMode()
    knowns, unknowns, steps = inputs + states, forces + rates, np.array([*np.tile(DIFFERENCE, 2), *[1e-8] * 2 * modes])
    errors = []
    for share in np.arange(1, STEPS + 1) / STEPS:
        values = np.array([*at(share)[0], *np.zeros(2 * modes)])

        def found(values):
            """Forces and accelerations of modes."""
            model.setFloat64(knowns, values)
            return np.array(model.getFloat64(unknowns))

        model.setTime(share * STEPS * LENGTH)
        differences = np.transpose([(found(values + moved) - found(values - moved)) / (2.0 * moved.sum())
                                    for moved in np.diag(steps)])
        found(values)
        derivatives = np.transpose([model.getDirectionalDerivative(unknowns, [known], [1.0]) for known in knowns])
        errors.append(max(off(derivatives, differences), np.abs(derivatives[6:] - differences[6:]).max()
                          / np.abs(differences[6:]).max()))
        model.completedIntegratorStep()
    model.terminate()
    model.freeInstance()
    print('model exchange: derivatives are off by %.2g in half of the steps, by %.2g in one of ten, by %.2g in one' % (
        np.median(errors), np.quantile(errors, 0.9), max(errors)))
    return np.median(errors) < AGREE


if __name__ == '__main__':
    good = co_simulation(*sys.argv[1:]), model_exchange(sys.argv[2])
    sys.exit(0 if all(good) else 'the unit does not keep to this')
