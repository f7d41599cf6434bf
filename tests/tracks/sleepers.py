"""A sprung wheel on a rail on sleepers, by OpenSees with its WheelRail element.

Rail and wheel are those of `a_rail_on_sleepers_is_that_of_opensees` in tests/track.rs: Euler beams of 0.15 m over 12 m, free at both ends; every
0.6 m a pad, a sleeper and ballast. The wheel starts in static balance at 3 m and goes 6 m at 50 m/s, in steps of average acceleration. The law is Hertz's with
the fixed coefficient of WheelRail, 4.57e-8 R^-0.149 m/N^(2/3).

Usage: python sleepers.py FILE
FILE is CSV with a row for the start and one for the end of each step:
- time_s,
- middle_m, the deflection of the rail at 6 m, down,
- p_n, the contact force.

SI units. Needs opensees (0.1.32, Linux on x86-64), numpy, and a Python with tkinter, for its Tcl.
"""
import sys

import opensees.openseespy as ops

YOUNG, SECOND_MOMENT, MASS, PITCH, ELEMENTS = 2.1e11, 3.04e-5, 60.2, 0.15, 80  # Pa, m4, kg/m, m, number
PAD, PAD_DAMPER, SLEEPER, BALLAST, BALLAST_DAMPER, EVERY = 1e8, 3e4, 150.0, 5e7, 5e4, 4  # N/m, N s/m, kg, N/m, N s/m, nodes
WHEEL, SUSPENDED, SPRING, DAMPER, RADIUS = 900.0, 5000.0, 1.2e6, 4e4, 0.46  # kg, kg, N/m, N s/m, m
GRAVITY, START, SPEED, STEP, STEPS, LOAD_STEPS = 9.81, 3.0, 50.0, 1e-4, 1200, 10  # m/s2, m, m/s, s


def build():
    """The model with the wheel in balance; its contact element."""
    model = ops.Model(ndm=2, ndf=3)
    rail = list(range(1, ELEMENTS + 2))
    for node in rail:
        model.node(node, PITCH * (node - 1), 0.0)
        model.fix(node, 1, 0, 0)
    model.geomTransf('Linear', 1)
    area = 7.67e-3
    for node in rail[:-1]:
        section = area, YOUNG, SECOND_MOMENT
        model.element('elasticBeamColumn', node, node, node + 1, *section, 1, '-mass', MASS, '-cMass')
    model.uniaxialMaterial('Elastic', 1, SPRING, DAMPER)
    model.uniaxialMaterial('Elastic', 2, PAD, PAD_DAMPER)
    model.uniaxialMaterial('Elastic', 3, BALLAST, BALLAST_DAMPER)
    element = 1000
    for node in rail[::EVERY]:
        sleeper, ground = 1000 + node, 2000 + node
        for at in sleeper, ground:
            model.node(at, PITCH * (node - 1), 0.0)
        model.fix(sleeper, 1, 0, 1)
        model.fix(ground, 1, 1, 1)
        model.mass(sleeper, SLEEPER, SLEEPER, 0.0)
        for material, ends in (2, (sleeper, node)), (3, (ground, sleeper)):
            element += 1
            model.element('zeroLength', element, *ends, '-mat', material, '-dir', 2)
    wheel, suspended = ELEMENTS + 2, ELEMENTS + 3
    model.timeSeries('Linear', 1)
    model.pattern('Plain', 1, 1)
    for node, mass in (wheel, WHEEL), (suspended, SUSPENDED):
        model.node(node, 0.0, 0.0)
        model.fix(node, 1, 0, 1)
        model.mass(node, mass, mass, 0.0)
        model.load(node, 0.0, -mass * GRAVITY, 0.0)
    model.element('zeroLength', 999, wheel, suspended, '-mat', 1, '-dir', 2)
    contact = 998
    rolling = STEP, SPEED, START, wheel, RADIUS, SECOND_MOMENT, YOUNG, area, 1, LOAD_STEPS
    even = '-DeltaYList', [0.0, 0.0], '-LocationList', [-1.0, 2 * PITCH * ELEMENTS]
    model.element('WheelRail', contact, *rolling, '-NodeList', rail, *even)
    solver(model)
    model.integrator('LoadControl', 1 / LOAD_STEPS)
    model.analysis('Static')
    if model.analyze(LOAD_STEPS) != 0:
        raise SystemExit('no balance at the start')
    model.loadConst('-time', 0.0)
    model.wipeAnalysis()
    solver(model)
    model.integrator('Newmark', 0.5, 0.25)
    model.analysis('Transient')
    return model, contact


def solver(model):
    """How equations are set up and solved."""
    model.constraints('Plain')
    model.numberer('RCM')
    model.system('UmfPack')
    model.test('NormDispIncr', 1e-10, 50, 0)
    model.algorithm('Newton')


def main():
    """Writes the history."""
    model, contact = build()
    middle = ELEMENTS // 2 + 1

    def row(step):
        return step * STEP, -model.nodeDisp(middle, 2), model.eleResponse(contact, 'contactData')[2]

    rows = [row(0)]
    for step in range(1, STEPS + 1):
        if model.analyze(1, STEP) != 0:
            raise SystemExit('no end of step %s' % step)
        rows.append(row(step))
    with open(sys.argv[1], 'w', encoding='utf-8') as file:
        file.write('time_s,middle_m,p_n\n')
        file.writelines('%.9g,%.9g,%.9g\n' % each for each in rows)


if __name__ == '__main__':
    main()
