"""The time of a step of OpenSees' WheelRail element: a sprung wheel crosses a bridge.

Bridge and wheel are `bridge` and `crossing` of simulate/src/cases.rs, and the wheel's mass is that of
xtask/src/step_times.rs. The wheel starts in static balance above the first support. Then it crosses the bridge in
steps of average acceleration. The time is the CPU time of one `analyze` call for all steps, without recorders.

WheelRail is an element of OpenSees (Quan Gu, Yongdou Liu and others, WheelRail.cpp). What it does, by its source:
- It is plane, and joins the wheel's node with all nodes of the rail. It fills a dense matrix of all their motions.
- Contact is Hertz's law with a fixed coefficient: 4.57e-8 R^-0.149 m/N^(2/3). Only the wheel's radius R enters.
- It has no friction, no profiles and no lateral motion.
- It adds the deflection of the loaded beam element that cubic shapes leave out.

The model is made as quick as its results allow. Ratios are those of 20 to 80 elements:
- The rail's motion along the track is held. Nothing drives it, and the force stays the same to ten digits. With it a
  step takes 1.1 to 2.5 times as long.
- BandSPD solves the equations, and was the quickest. All nodes hang together, so that the band is full.
  FullGeneral took 1.0 to 1.2 times as long, BandGeneral 1.1 to 1.5, ProfileSPD 1.4 to 3.4. The sparse ones were
  slower: SuperLU 1.9 to 3.5, UmfPack 2.2 to 5.
- Newton's method ends at an increment of 1e-8 m (Euclidean norm). That takes two iterations. A smaller limit changes
  the force by less than 1e-6 N. ModifiedNewton takes 0.7 to 0.8 times as long, and its forces differ by up to 3 mN.

The bridge is undamped. In railspring's run it has the damping of the study's rail, 6.4e-6 s times its stiffness. In a
modal solution that changes the largest deflection by 1.4e-4 of it, and the force by up to 80 N.

Usage: python wheel_rail.py ELEMENTS [--history FILE]
ELEMENTS is even, so that a node is at midspan. The last line is the time: `230.1 us a step`.
With --history the case is run again. FILE is CSV with a row for the start and one for the end of each step:
- time_s,
- midspan_m, the deflection at midspan, down, from the bridge without the wheel,
- p_n, the contact force.

SI units.
Needs opensees (0.1.32, Linux on x86-64), numpy, and a Python with tkinter, for its Tcl. openseespy has no WheelRail.
"""
import argparse
import os
import time as clock

for threads in ('OPENBLAS_NUM_THREADS', 'OMP_NUM_THREADS'):
    os.environ.setdefault(threads, '1')  # CPU time counts every thread

import opensees.openseespy as ops

YOUNG, SECOND_MOMENT, MASS, LENGTH = 3.5e10, 1.3901, 18_358.0, 25.0  # Pa, m4, kg/m, m
AXIAL = 1e12  # N
WHEEL, SUSPENDED, SPRING, RADIUS = 283.0, 5750.0, 1.595e6, 0.429  # kg, kg, N/m, m
GRAVITY, SPEED, STEP, STEPS = 9.81, 300 / 3.6, 2.5e-4, 1200  # m/s2, m/s, s, number
LOAD_STEPS = 10  # for the balance at the start
SYSTEM, ALGORITHM, INCREMENT, ITERATIONS = 'BandSPD', 'Newton', 1e-8, 30


class Crossing:
    """The model with the wheel in balance above the first support."""

    def __init__(self, elements):
        model = self.model = ops.Model(ndm=2, ndf=3)
        self.midspan, self.contact = elements // 2 + 1, elements + 2
        rail, wheel, suspended = range(1, elements + 2), elements + 2, elements + 3
        for node in rail:
            end = int(node in (rail[0], rail[-1]))
            model.node(node, LENGTH * (node - 1) / elements, 0.0)
            model.fix(node, 1, end, 0)
        model.geomTransf('Linear', 1)
        area = AXIAL / YOUNG
        for node in rail[:-1]:
            section = area, YOUNG, SECOND_MOMENT
            model.element('elasticBeamColumn', node, node, node + 1, *section, 1, '-mass', MASS, '-cMass')
        model.timeSeries('Linear', 1)
        model.pattern('Plain', 1, 1)
        for node, mass in (wheel, WHEEL), (suspended, SUSPENDED):
            model.node(node, 0.0, 0.0)
            model.fix(node, 1, 0, 1)
            model.mass(node, mass, mass, 0.0)
            model.load(node, 0.0, -mass * GRAVITY, 0.0)
        model.uniaxialMaterial('Elastic', 1, SPRING)
        model.element('zeroLength', elements + 1, wheel, suspended, '-mat', 1, '-dir', 2)
        # the wheel rolls on after so many steps, the first of which are those of the load
        rolling = STEP, SPEED, 0.0, wheel, RADIUS, SECOND_MOMENT, YOUNG, area, 1, LOAD_STEPS
        even = '-DeltaYList', [0.0, 0.0], '-LocationList', [-1.0, 2 * LENGTH]
        model.element('WheelRail', self.contact, *rolling, '-NodeList', list(rail), *even)
        self.balance()

    def balance(self):
        """Adds the weight, and makes the steps ready."""
        model = self.model
        self.solver('Newton')
        model.integrator('LoadControl', 1 / LOAD_STEPS)
        model.analysis('Static')
        balanced = model.analyze(LOAD_STEPS) == 0
        weight = (WHEEL + SUSPENDED) * GRAVITY
        if not (balanced and abs(self.force() - weight) < 1e-6 * weight):
            raise SystemExit('no balance at the start: %s N of %s N' % (self.force(), weight))
        model.loadConst('-time', 0.0)
        model.wipeAnalysis()
        self.solver(ALGORITHM)
        model.integrator('Newmark', 0.5, 0.25)
        model.analysis('Transient')

    def solver(self, algorithm):
        """How equations are set up and solved."""
        self.model.constraints('Plain')
        self.model.numberer('Plain')
        self.model.system(SYSTEM)
        self.model.test('NormDispIncr', INCREMENT, ITERATIONS, 0)
        self.model.algorithm(algorithm)

    def force(self):
        """Contact force, N."""
        return self.model.eleResponse(self.contact, 'contactData')[2]

    def run(self, steps):
        """Takes so many steps."""
        if self.model.analyze(steps, STEP) != 0:
            raise SystemExit('no end of a step at %s s' % self.model.getTime())

    def row(self, steps):
        """Time, deflection and force after so many steps."""
        return steps * STEP, -self.model.nodeDisp(self.midspan, 2), self.force()


def history(elements, path):
    """Runs the case step by step, and writes every end of a step."""
    crossing = Crossing(elements)
    rows = [crossing.row(0)]
    for step in range(1, STEPS + 1):
        crossing.run(1)
        rows.append(crossing.row(step))
    with open(path, 'w', encoding='utf-8') as file:
        file.write('time_s,midspan_m,p_n\n')
        file.writelines('%.9g,%.9g,%.9g\n' % (time, deflection + 0.0, force) for time, deflection, force in rows)
    crossing.model.wipe()


def main():
    """Times the crossing."""
    parser = argparse.ArgumentParser(description='The time of a step of OpenSees\' WheelRail element on a bridge.')
    parser.add_argument('elements', type=int, help='beam elements of the bridge, an even number')
    parser.add_argument('--history', metavar='FILE', help='deflection at midspan and contact force of every step (CSV)')
    arguments = parser.parse_args()
    if arguments.elements < 2 or arguments.elements % 2:
        parser.error('give an even number of elements, 2 at least')
    crossing = Crossing(arguments.elements)
    begun = clock.process_time()
    crossing.run(STEPS)
    taken = clock.process_time() - begun
    crossing.model.wipe()
    if arguments.history:
        history(arguments.elements, arguments.history)
    print('%.1f us a step' % (1e6 * taken / STEPS))


if __name__ == '__main__':
    main()
