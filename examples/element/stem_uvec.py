"""A railway wheel as a user-defined vehicle (UVEC) of STEM; its contact is the element of railspring, called live.

STEM's own vehicles have a power law between wheel and rail. This one has the hub (y and z), the wheel's modes, and
a mass on spring and damper above. The hub does not turn. The average acceleration integrates them at STEM's times, and
Newton's method finds the contact with them. STEM has the rail, and gives its displacements.

STEM repeats a step with other displacements until they settle. Each time the wheel begins at the end of the last
finished step. A step is finished when STEM asks for a later time: what was evaluated last is its end. STEM keeps the
state of a vehicle as JSON, but the element's state is in this process alone. So the stages of an analysis must follow
each other without a new start of the program.

STEM takes forces, but no moment. There are two ways to put the wheel on a rail:
- "wheel_configuration": [0.0, 0.12] has two places on a stiff arm across the rail. The first is at the rail, the second
  so much (m) above it. A pair of lateral forces is the moment. Such a wheel stands still.
- "wheel_configuration": [0.0] has one place on the line of the rail. The rail's torsion is then a flexibility of its
  section in the element, "turn" (rad/(N m)). Such a wheel may roll.

Axes of the element: x along the track, y to the field side, z down. STEM's x is y of the rail's section, and its y is
-z of it. The line of STEM's beam is that of the shear centres.

Parameters: element (file), place (m along the rail, -1 on a rail that is not the study's), turn, loads (mean and swing
of the vertical force, N, its frequency, Hz, lateral force, N), history (file that gets time_s, p_n, q_n when a step is
finished), row (s, between two of its rows), wheel_configuration. These may be left out:
- shear (m/N): vertical flexibility of the section that STEM's beams lack;
- vehicle: suspended mass (kg), its spring (N/m) and damper (N s/m);
- irregularity: how the rail's height changes along the track, by the function of STEM's own vehicles. It has start and
  speed of the wheel along the track (m, m/s), and parameters of that function.

Needs numpy, contact_library.py beside this file, and the C library (see there).
"""
import json
import pathlib
import sys
import numpy as np
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))  # STEM loads this file alone
from contact_library import Contact, Element

VEHICLE = 6250.0, 1.2e6, 4e4  # kg, N/m, N s/m: suspended mass, its spring and damper
SETTLED = 1e-8  # m, the last step of Newton's method


class Wheel:
    """Hub (y, z), modes of the wheel, and suspended mass (z), on a contact."""

    def __init__(self, element, place, turn, loads, shear=0.0, vehicle=VEHICLE, **_):
        element, (suspended_mass, spring, damper) = Element(element), vehicle
        kept = np.r_[0, 1, 3:len(element.mass)]  # all of the wheel but the turn of its hub
        size, above = len(kept) + 1, len(kept)
        self.mass, self.damping, self.stiffness = np.zeros((3, size, size))
        for own, of_wheel in ((self.mass, element.mass), (self.damping, element.damping),
                              (self.stiffness, element.stiffness)):
            own[:above, :above] = of_wheel[np.ix_(kept, kept)]
        self.mass[above, above] = suspended_mass
        for own, value in (self.stiffness, spring), (self.damping, damper):
            own[np.ix_([1, above], [1, above])] += value * np.array([[1.0, -1.0], [-1.0, 1.0]])
        self.rim = np.zeros((3, size))
        self.rim[:, :above] = element.rim[:, kept]
        self.place, self.load, self.angle = place, loads, element.about.rail[0]
        self.contact = Contact(element)
        self.contact.set_section_rest(np.diag([0.0, shear, turn]))
        self.contact.start(np.zeros(6), place)
        self.finished = 0.0, np.zeros(size), np.zeros(size), np.linalg.solve(self.mass, self.loads(0.0))
        self.running = self.finished
        self.forces = np.zeros(6)  # on rim and section

    def loads(self, time):
        """Forces on the coordinates besides those of the contact."""
        mean, swing, frequency, lateral = self.load
        loads = np.zeros(len(self.mass))
        loads[0], loads[-1] = lateral, mean + swing * np.sin(2.0 * np.pi * frequency * time)
        return loads

    def step(self, time, section):
        """Goes from the last finished step to a time, where the section has these motions; the force on it."""
        begin, x, v, a = self.finished
        length = time - begin
        free_x, free_v = x + length * v + 0.25 * length**2 * a, v + 0.5 * length * a
        matrix = 4.0 / length**2 * self.mass + 2.0 / length * self.damping + self.stiffness
        end = x + length * v + 0.5 * length**2 * a
        for _ in range(60):
            forces, tangent = self.contact.evaluate(np.append(self.rim @ end, section), self.place)
            after = 4.0 / length**2 * (end - free_x)
            velocity = free_v + 0.5 * length * after
            off = (self.loads(time) + self.rim.T @ forces[:3] - self.mass @ after - self.damping @ velocity
                   - self.stiffness @ end)
            change = np.linalg.solve(matrix - self.rim.T @ tangent[:3, :3] @ self.rim, off)
            end = end + change
            if np.abs(change).max() < SETTLED:
                break
        else:
            raise RuntimeError('no balance at %g s: take shorter steps' % time)
        after = 4.0 / length**2 * (end - free_x)
        self.running = time, end, free_v + 0.5 * length * after, after
        self.forces = forces
        return forces[3:]

    def finish(self):
        """Takes what was found last as the end of a step."""
        self.contact.commit()
        self.finished = self.running


def turned(angle, vector):
    """A vector (y, z) turned from y to z."""
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]) @ vector


def irregularity(time, start, speed, **parameters):
    """How much higher the rail is where the wheel is than where it began, m."""
    from UVEC.uvec_ten_dof_vehicle_2D.irregularities import calculate_rail_irregularity
    begin, here = [calculate_rail_irregularity(start + speed * after, **parameters) for after in (0.0, time)]
    return here - begin


WHEELS = []  # none before the first call, then one


def uvec(json_string):
    """Called by STEM in each iteration of a time step: from displacements of the rail to forces on it."""
    data = json.loads(json_string)
    time, step, parameters = data['t'], data['dt'], data['parameters']
    places, arm = sorted(data['u'], key=int), np.ptp(parameters['wheel_configuration'])
    if not WHEELS:
        WHEELS.append(Wheel(**parameters))
    wheel, = WHEELS
    running = wheel.running[0]
    if wheel.finished[0] < running < time - 0.5 * step:
        wheel.finish()
        if abs(running - round(running / parameters['row']) * parameters['row']) < 0.5 * step:
            with open(parameters['history'], 'a') as file:
                file.write('%.6g,%.9g,%.9g\n' % (running, -wheel.forces[1], -wheel.forces[0]))
    # the section by its places
    lateral, up, _ = data['u'][places[0]]
    if 'irregularity' in parameters:
        up += irregularity(time, **parameters['irregularity'])
    turn = (data['u'][places[1]][0] - lateral) / arm if arm else 0.0
    force = wheel.step(time, np.append(turned(wheel.angle, [lateral, -up]), turn))
    lateral, down = turned(-wheel.angle, force[:2])
    above = force[2] / arm if arm else 0.0
    data['loads'] = dict(zip(places, [[lateral - above, -down, 0.0], [above, 0.0, 0.0]]))
    return json.dumps(data)
