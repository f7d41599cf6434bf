"""A railway wheel as a user-defined vehicle of STEM, with the lumped contact element of railspring.

The wheel is a hub with oscillators that move its rim. A bushing joins the section of STEM's rail under the wheel to the
head of the rail. Between head and rim lies a Winkler foundation: strips across the track with Coulomb friction. Rim and
head have no mass.

With the hub's motion u, the oscillators' displacements q, and the contact force f on the rim:

    rim = u + sum r q                       r = (r_y, offset r_phi, r_phi)
    M u'' + sum c q'' = loads + f           q'' + c u'' + beta w^2 q' + w^2 q = r f
    head = section - C T'f

T takes motions of the head at the shear centre to the wheel's origin, C is the flexibility of the bushing.

Axes: x along the track, y to the field side, z down, rotation phi about x, from y to z. In STEM, x is y and y is -z, of
the rail's section: a beam along z has its lateral axis along x. All units are SI. Profiles and strips stand in the JSON
file of the same name.

STEM takes forces, but no moment. There are two ways to put the wheel on a rail:
- one place on the line of the rail ("wheel_configuration": [0.0]): the rail's torsion is a spring in C;
- two places on a stiff arm across the rail ("wheel_configuration": [0.0, 0.12]), of which the first is at the rail and
  the second so much (m) above it: a pair of lateral forces is the moment. Such a wheel stands still.

Each step is integrated with the average acceleration, at STEM's times. STEM repeats a step with other displacements
until they settle; each repetition begins at the end of the last finished step, which stands in the state.

With the parameters "history" (a CSV file) and "row" (s), time_s, p_kn and q_kn are appended to that file at multiples
of row: vertical and lateral force of the wheel on the rail. A step's row is written when the next step begins.
"""
import json
import pathlib
import numpy as np

# CONSTANTS
FORCE_TOLERANCE = 0.1  # N, balance of the head
# STRIPS


class Wheel:
    """The wheel on the head of the rail: hub (y, z), oscillators, and suspended mass (z) if there is one."""

    def __init__(self, data, torsion):
        """`torsion` is the flexibility (rad/(N m)) of the rail that the bushing has besides its own."""
        self.strips = CONTACT(data)
        count = len(OSCILLATOR_FREQUENCY)
        size = 2 + count + (SUSPENDED_MASS > 0.0)
        on_wheel = slice(2, 2 + count)
        self.mass, self.damping, self.stiffness = np.zeros((3, size, size))
        self.mass[:2, :2] = HUB_MASS * np.eye(2)
        self.mass[on_wheel, on_wheel] = np.eye(count)
        self.mass[0, on_wheel] = self.mass[on_wheel, 0] = COUPLING_LATERAL
        self.mass[1, on_wheel] = self.mass[on_wheel, 1] = COUPLING_VERTICAL
        self.stiffness[on_wheel, on_wheel] = np.diag((2.0 * np.pi * np.array(OSCILLATOR_FREQUENCY))**2)
        self.damping[on_wheel, on_wheel] = WHEEL_DAMPING * self.stiffness[on_wheel, on_wheel]
        # without a suspended mass the suspension passes the force on to the hub
        self.loaded = 1
        if SUSPENDED_MASS > 0.0:
            self.loaded = size - 1
            self.mass[-1, -1] = SUSPENDED_MASS
            both = np.ix_([1, self.loaded], [1, self.loaded])
            spring = np.array([[1.0, -1.0], [-1.0, 1.0]])
            self.stiffness[both] += SUSPENSION_STIFFNESS * spring
            self.damping[both] += SUSPENSION_DAMPING * spring
        self.of_rim = np.zeros((3, size))
        self.of_rim[0, 0] = self.of_rim[1, 1] = 1.0
        self.of_rim[:, on_wheel] = RIM_LATERAL, RIM_OFFSET * np.array(RIM_TURN), RIM_TURN
        arm = np.array([-BUSHING_HEIGHT, 0.0, 1.0])
        self.of_head = np.diag([1.0 / BUSHING_LATERAL, 1.0 / BUSHING_VERTICAL, torsion])
        self.of_head += np.outer(arm, arm) / BUSHING_TURN

    def loads(self, time):
        """Forces on the coordinates besides those of the contact."""
        def sine(mean, amplitude, frequency, phase):
            return mean + amplitude * np.sin(2.0 * np.pi * frequency * time + phase)

        loads = np.zeros(len(self.mass))
        loads[0] = sine(LATERAL_MEAN, LATERAL_AMPLITUDE, LATERAL_FREQUENCY, LATERAL_PHASE)
        loads[1] = GRAVITY * HUB_MASS
        loads[self.loaded] += GRAVITY * SUSPENDED_MASS
        loads[self.loaded] += sine(VERTICAL_MEAN, VERTICAL_AMPLITUDE, VERTICAL_FREQUENCY, VERTICAL_PHASE)
        return loads

    def at_rest(self):
        """The state at the beginning, where the wheel just touches the rail."""
        rest = np.zeros(len(self.mass))
        return {'time': 0.0, 'displacement': rest.tolist(), 'velocity': rest.tolist(),
                'acceleration': np.linalg.solve(self.mass, self.loads(0.0)).tolist(),
                'rim': [0.0] * 3, 'head': [0.0] * 3, 'strips': [], 'taken_up': [], 'force': [0.0] * 3}

    def step(self, before, time, section, guess):
        """The state at the end of a time step with the section in this pose; `guess` has poses to begin with."""
        self.strips.begin_step(before['rim'], before['head'], before['strips'], before['taken_up'])
        displacement, velocity, acceleration = (np.array(before[key]) for key in
                                                ('displacement', 'velocity', 'acceleration'))
        step = time - before['time']
        by_mass = 4.0 / step**2 * displacement + 4.0 / step * velocity + acceleration
        by_damping = 2.0 / step * displacement + velocity
        matrix = 4.0 / step**2 * self.mass + 2.0 / step * self.damping + self.stiffness
        free = np.linalg.solve(matrix, self.loads(time) + self.mass @ by_mass + self.damping @ by_damping)
        by_contact = np.linalg.solve(matrix, self.of_rim.T)
        rim, head, force, taken_up = self.balance(self.of_rim @ free, self.of_rim @ by_contact, section, guess)
        moved = free + by_contact @ force - displacement
        on_head = -transport(self.strips.arm + rim[:2] - head[:2]).T @ force
        return {'time': time, 'displacement': (displacement + moved).tolist(),
                'velocity': (2.0 / step * moved - velocity).tolist(),
                'acceleration': (4.0 / step**2 * moved - 4.0 / step * velocity - acceleration).tolist(),
                'rim': rim.tolist(), 'head': head.tolist(), 'strips': self.strips.window.tolist(),
                'taken_up': taken_up.tolist(), 'force': on_head.tolist()}

    def balance(self, free, flexibility, section, guess):
        """Poses of rim and head, force on the rim, and friction taken up, by Newton's method.

        Without contact the rim would be at `free`; it moves by `flexibility` times the force.
        """
        stiffnesses = np.linalg.inv(flexibility), np.linalg.inv(self.of_head)

        def at(poses):
            rim, head = poses[:3], poses[3:]
            force, stiffness, taken_up = self.strips.forces(rim, head)
            to_rim = transport(self.strips.arm + rim[:2] - head[:2])
            on_rim, on_head = flexibility, -self.of_head @ to_rim.T
            off = np.concatenate([rim - free - on_rim @ force, head - section - on_head @ force])
            size = max(np.abs(stiffnesses[0] @ off[:3]).max(), np.abs(stiffnesses[1] @ off[3:]).max())
            slope = np.eye(6) + np.vstack([on_rim, on_head]) @ stiffness @ np.hstack([np.eye(3), -to_rim])
            return poses, force, taken_up, off, slope, size

        found = at(np.array(guess['rim'] + guess['head']))
        for _ in range(60):
            poses, force, taken_up, off, slope, size = found
            if size < FORCE_TOLERANCE:
                return poses[:3], poses[3:], force, taken_up
            step = np.linalg.solve(slope, off)
            # between sticking and sliding a whole step may lead to and fro; a part of it leads down
            for length in 0.5 ** np.arange(8):
                found = at(poses - length * step)
                if found[-1] < (1.0 - 0.1 * length) * size:
                    break
        raise RuntimeError('the contact is %.3g N off balance; take shorter time steps' % size)


DATA = json.loads(pathlib.Path(__file__).with_suffix('.json').read_text())
WHEELS = {1: Wheel(DATA, 1.0 / RAIL_TURN), 2: Wheel(DATA, 0.0)}  # by the number of places that STEM has


def section_at(displacements, arm):
    """Pose of the rail's section by STEM's displacements of its places."""
    lateral, up, _ = displacements[0]
    turn = (displacements[1][0] - lateral) / arm if arm else 0.0
    return np.append(rotation(RAIL_ANGLE) @ [lateral, -up], turn)


def loads_at(force, arm):
    """STEM's forces on the places of the rail by force and moment on its section."""
    lateral, down = rotation(-RAIL_ANGLE) @ force[:2]
    above = force[2] / arm if arm else 0.0
    return [[lateral - above, -down, 0.0], [above, 0.0, 0.0]]


def record(state, step, history=None, row=None, **_):
    """Appends the forces of a finished step to the history, if a row is due."""
    if history and abs(state['time'] - round(state['time'] / row) * row) < 0.5 * step:
        lateral, vertical, _ = state['force']
        with open(history, 'a') as file:
            file.write('%.6g,%.9g,%.9g\n' % (state['time'], vertical * 1e-3, lateral * 1e-3))


def uvec(json_string):
    """Called by STEM in each iteration of a time step: from displacements of the rail to forces on it."""
    data = json.loads(json_string)
    time, step, state, parameters = data['t'], data['dt'], data['state'], data['parameters']
    places = sorted(data['u'])
    wheel, arm = WHEELS[len(places)], np.ptp(parameters['wheel_configuration'])
    if not state:
        state['finished'] = state['running'] = wheel.at_rest()
    if state['finished']['time'] < state['running']['time'] < time - 0.5 * step:
        state['finished'] = state['running']
        record(state['finished'], step, **parameters)
    section = section_at([data['u'][place] for place in places], arm)
    state['running'] = wheel.step(state['finished'], time, section, state['running'])
    data['loads'] = dict(zip(places, loads_at(state['running']['force'], arm)))
    return json.dumps(data)
