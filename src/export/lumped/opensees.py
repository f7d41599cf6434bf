"""A wheel on its rail in OpenSees: the lumped contact element under a load case.

Bodies. The rail is a Timoshenko beam that is fixed at both ends, with its mass at the centroids of its sections. The
rail's head is a rigid body without mass on a bushing. The wheel is a hub, which does not turn, and three links on
elastic hinges, one after another; the last one is the rim. Each oscillator of the element is a hinge: it turns the rim
about a pole of its own.

Contact. Strips across the track carry normal forces in proportion to their penetration, and friction: tangential
springs that Coulomb's law limits. The wheel slides over the strips by millimetres, which no contact element of OpenSees
takes with friction. So this script finds the forces at the start of each time step and puts them into the model, with a
spring between head and rim that has the stiffness of the strips: in the step, the forces follow the motion with it.

Axes: x along the track, y to the field side, z down; rotations about x, from y to z. The origin of y and z is the line
of the rail's shear centres. Units: m, kg, s, N, rad.

    python wheel_rail_opensees.py [time steps in a row of the history]

reads strips and profiles from wheel_rail_opensees.json and writes history.csv: time_s, p_kn, q_kn, the vertical and the
lateral force of the wheel on the rail. Needs openseespy (3.7.1) and numpy.
"""

import csv
import json
import sys
import time
from pathlib import Path

import numpy as np
import openseespy.opensees as ops

# CONSTANTS
# ---- the model's own -------------------------------------------------------------------------------------------------
RIGID = 1e13  # N/m and N m/rad, of what a hinge holds
LEAST_COSINE = 0.3  # of the angle between profiles that face each other
SETTLED = 1e-5  # m, the last step to the wheel's point opposite to a strip
DEEPEST = 1e-3  # m, what is deeper is not a contact
MIDDLE = 1 + RAIL_ELEMENTS // 2  # nodes from here on; 1 to RAIL_ELEMENTS + 1 are those of the beam
CENTROIDS, SECTION, HEAD, HEAD_AT_RIM, HUB, SUSPENDED, LINKS, RIM = 100, 201, 202, 203, 300, 301, 310, 400
BUSHING, SUSPENSION, HINGES, INERTERS, CONTACT = 101, 102, 110, 120, 130  # elements after those of the beam
ALL = (2, 3, 4, 1, 5, 6)  # directions of a bushing or hinge: those in the plane of y and z first


class Strips:
    """Strips on the rail's head against the wheel's profile, with what friction has displaced them by."""

    def __init__(self, data):
        point = np.array([data["strip_y_m"], data["strip_z_m"]])
        angle = np.array(data["strip_angle_rad"])
        self.point = point + np.array([[0.0], [BUSHING_HEIGHT]])  # from the elastic centre
        self.normal = np.array([np.sin(angle), -np.cos(angle)])  # out of the rail
        self.stiffness = np.array(data["strip_normal_pa"]) * data["strip_width_m"]
        self.tangential = np.array(data["strip_tangential_pa"]) * data["strip_width_m"]
        self.spacing = data["wheel_spacing_m"]
        self.wheel = np.array([data["wheel_y_m"], data["wheel_z_m"]])
        self.wheel_angle = np.array(data["wheel_angle_rad"])
        self.origin = np.array(WHEEL_ORIGIN) + np.array([0.0, BUSHING_HEIGHT])
        along = self.spacing * np.arange(len(self.wheel_angle))
        self.foot = np.interp(point[0] - WHEEL_ORIGIN[0], self.wheel[0], along)  # arc length on the wheel opposite
        self.held = np.zeros(len(angle))  # tangential displacement of the springs
        self.place = None  # the strips in the wheel's frame at the last step

    # ON_WHEEL
    def look(self, head, rim):
        """The contact at the motions (y, z, rotation) of head and rim, and what friction does since the last look.

        Returns the force on the rim with its moment about the profile's origin where that is now, and minus its
        derivative by the rim's motion.
        """
        place = turned(-rim[2], turned(head[2], self.point) + (head[:2] - rim[:2] - self.origin)[:, None])
        normal = turned(head[2] - rim[2], self.normal)
        along = np.array([-normal[1], normal[0]])
        for _ in range(3):  # Newton's method for the wheel's point on the strip's normal
            point, angle = self.on_wheel(self.foot)
            cosine = np.maximum((along * np.array([np.cos(angle), np.sin(angle)])).sum(0), LEAST_COSINE)
            step = np.clip((along * (place - point)).sum(0) / cosine, -5e-3, 5e-3)
            self.foot = np.clip(self.foot + step, 0.0, self.spacing * (len(self.wheel_angle) - 1))
        point, angle = self.on_wheel(self.foot)
        depth = ((place - point) * normal).sum(0)
        faces = (cosine > LEAST_COSINE) & (np.abs(step) < SETTLED)
        now = np.flatnonzero(faces & (depth > 0.0) & (depth < DEEPEST))
        before = place if self.place is None else self.place
        held, self.held, self.place = self.held[now], np.zeros(len(depth)), place
        if len(now) == 0:
            return np.zeros(3), np.zeros((3, 3))
        depth, arm, stiffness, tangential = depth[now], place[:, now], self.stiffness[now], self.tangential[now]
        tangent = np.array([np.cos(angle[now]), np.sin(angle[now])])
        # penetration and tangential displacement of each strip per motion of the rim
        deeper = with_moment(arm, np.array([-tangent[1], tangent[0]]) / cosine[now])
        aside = with_moment(arm, tangent)
        limit = FRICTION * stiffness * depth / (cosine[now] * tangential)
        wanted = held - (tangent * (arm - before[:, now])).sum(0)
        held = np.clip(wanted, -limit, limit)
        self.held[now] = held
        sticks = np.abs(wanted) < limit
        force = -deeper @ (stiffness * depth) - aside @ (tangential * held)
        matrix = (deeper * stiffness) @ deeper.T + (aside * tangential * sticks) @ aside.T
        matrix += (aside * (tangential * held / depth * ~sticks)) @ deeper.T  # the limit goes with the normal force
        return np.append(turned(rim[2], force[:2]), force[2]), matrix


def turned(angle, vectors):
    """Vectors (y, z) turned by an angle."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * vectors[0] - s * vectors[1], s * vectors[0] + c * vectors[1]])


def with_moment(arm, direction):
    """Directions (y, z) with the moment of a unit force along them."""
    return np.vstack([direction, arm[0] * direction[1] - arm[1] * direction[0]])


def rail():
    """The beam with its mass at the centroids, and the head on its bushing."""
    c, s, pitch = np.cos(RAIL_ANGLE), np.sin(RAIL_ANGLE), RAIL_LENGTH / RAIL_ELEMENTS
    ops.geomTransf("Linear", 1, 0.0, -s, c)
    polar = INERTIA_LATERAL + INERTIA_VERTICAL
    rotary = [DENSITY * pitch * inertia for inertia in (polar, INERTIA_VERTICAL, INERTIA_LATERAL)]
    for i in range(RAIL_ELEMENTS + 1):
        ops.node(1 + i, i * pitch, 0.0, 0.0)
        if i in (0, RAIL_ELEMENTS):
            ops.fix(1 + i, 1, 1, 1, 1, 1, 1)
            continue
        ops.node(CENTROIDS + i, i * pitch, *turned(RAIL_ANGLE, CENTROID))
        ops.rigidLink("beam", 1 + i, CENTROIDS + i)
        ops.mass(CENTROIDS + i, *3 * [DENSITY * AREA * pitch], *rotary)
    for i in range(1, RAIL_ELEMENTS + 1):
        ops.element("ElasticTimoshenkoBeam", i, i, i + 1, YOUNG, SHEAR_MODULUS, AREA, TORSION_CONSTANT,
                    INERTIA_VERTICAL, INERTIA_LATERAL, SHEAR_AREA_LATERAL, SHEAR_AREA_VERTICAL, 1)
    ops.rayleigh(0.0, 0.0, RAIL_DAMPING, 0.0)  # of the beam: the other elements do not take part
    x = 0.5 * RAIL_LENGTH
    ops.node(SECTION, x, 0.0, -BUSHING_HEIGHT)
    ops.rigidLink("beam", MIDDLE, SECTION)
    ops.node(HEAD, x, 0.0, -BUSHING_HEIGHT)
    for tag, stiffness in ((1, BUSHING_LATERAL), (2, BUSHING_VERTICAL), (3, BUSHING_TURN), (4, RIGID)):
        ops.uniaxialMaterial("Elastic", tag, stiffness)
    ops.element("zeroLength", BUSHING, SECTION, HEAD, "-mat", 1, 2, 3, 4, 4, 4, "-dir", *ALL)
    ops.node(HEAD_AT_RIM, x, *WHEEL_ORIGIN)  # of the head, where the wheel's profile has its origin
    ops.rigidLink("beam", HEAD, HEAD_AT_RIM)


def wheel():
    """The hub, the suspended mass, and the links to the rim.

    An oscillator of 1 kg is a hinge with the inertia 1/turn^2 against its rotation. The one with the largest coupling
    with the hub's motion along y comes first; it has the inertia as a body of coupling^2 kg that moves along y below
    its hinge, and the hub has so much less. Other couplings are small: their oscillators move against the centre of
    mass of both, which moves the pole of the hinge.
    """
    x, last = 0.5 * RAIL_LENGTH, None
    coupled = max(range(len(COUPLING_LATERAL)), key=lambda i: abs(COUPLING_LATERAL[i]))
    body = COUPLING_LATERAL[coupled] ** 2
    ops.uniaxialMaterial("Elastic", 5, SUSPENSION_STIFFNESS, SUSPENSION_DAMPING)
    for i in sorted(range(len(RIM_TURN)), key=lambda i: i != coupled):
        turn, inertia = RIM_TURN[i], 1.0 / RIM_TURN[i] ** 2
        stiffness = (2.0 * np.pi * OSCILLATOR_FREQUENCY[i]) ** 2 * inertia
        aside, rise = RIM_LATERAL[i], RIM_OFFSET * turn - COUPLING_VERTICAL[i] / HUB_MASS
        if i != coupled:
            aside -= COUPLING_LATERAL[i] / HUB_MASS
            inertia *= 1.0 - (COUPLING_LATERAL[i] ** 2 + COUPLING_VERTICAL[i] ** 2) / HUB_MASS
        pole = WHEEL_ORIGIN[0] - rise / turn, WHEEL_ORIGIN[1] + aside / turn
        link, mass, before = (LINKS + 10 * i + k for k in range(3))
        if last is None:  # the first hinge is at the hub, whose place does not count, as it does not turn
            before = HUB
            for node in (HUB, SUSPENDED):
                ops.node(node, x, *pole)
            ops.fix(HUB, 1, 0, 0, 1, 1, 1)
            ops.fix(SUSPENDED, 1, 1, 0, 1, 1, 1)
            ops.mass(HUB, 0.0, HUB_MASS - body, HUB_MASS, 0.0, 0.0, 0.0)
            ops.mass(SUSPENDED, 0.0, 0.0, SUSPENDED_MASS, 0.0, 0.0, 0.0)
            ops.element("zeroLength", SUSPENSION, HUB, SUSPENDED, "-mat", 5, "-dir", 3)
        else:
            ops.node(before, x, *pole)
            ops.rigidLink("beam", last, before)
        ops.node(link, x, *pole)
        ops.uniaxialMaterial("Elastic", 6 + i, stiffness, WHEEL_DAMPING * stiffness)
        ops.element("zeroLength", HINGES + i, before, link, "-mat", 4, 4, 6 + i, 4, 4, 4, "-dir", *ALL)
        if i != coupled or body == 0.0:
            ops.element("inerter", INERTERS + i, before, link, "-dir", 4, "-inertance", inertia)
        else:
            ops.node(mass, x, pole[0], pole[1] - 1.0 / (COUPLING_LATERAL[i] * turn))
            ops.rigidLink("beam", link, mass)
            ops.mass(mass, 0.0, body, 0.0, 0.0, 0.0, 0.0)
        last = link
    ops.node(RIM, x, *WHEEL_ORIGIN)
    ops.rigidLink("beam", last, RIM)


def loads():
    """The forces on hub and suspended mass; without a mass its suspension passes the force on to the hub."""
    of_vertical = SUSPENDED if SUSPENDED_MASS > 0.0 else HUB
    end = 2.0 * ROWS * ROW
    ops.timeSeries("Constant", 1)
    ops.pattern("Plain", 1, 1)
    ops.load(HUB, 0.0, LATERAL_MEAN, GRAVITY * HUB_MASS, 0.0, 0.0, 0.0)
    ops.load(of_vertical, 0.0, 0.0, VERTICAL_MEAN + GRAVITY * SUSPENDED_MASS, 0.0, 0.0, 0.0)
    ops.timeSeries("Trig", 2, 0.0, end, 1.0 / VERTICAL_FREQUENCY, "-shift", VERTICAL_PHASE)
    ops.pattern("Plain", 2, 2)
    ops.load(of_vertical, 0.0, 0.0, VERTICAL_AMPLITUDE, 0.0, 0.0, 0.0)
    ops.timeSeries("Trig", 3, 0.0, end, 1.0 / LATERAL_FREQUENCY, "-shift", LATERAL_PHASE)
    ops.pattern("Plain", 3, 3)
    ops.load(HUB, 0.0, LATERAL_AMPLITUDE, 0.0, 0.0, 0.0, 0.0)


def place_contact(strips, first):
    """Puts the contact into the model, as it is at the start of a time step; the force on the rim (y, z, moment).

    The spring is there without contact, too: with its stiffness of zero the model keeps its form.
    """
    head, rim, carried = (np.array(ops.nodeDisp(node)[1:4]) for node in (HEAD, RIM, HEAD_AT_RIM))
    force, matrix = strips.look(head, rim)
    if not first:
        ops.remove("element", CONTACT)
        ops.remove("loadPattern", CONTACT)
    ops.element("linearElasticSpring", CONTACT, HEAD_AT_RIM, RIM, "-dir", 2, 3, 4, "-stif", *matrix.ravel().tolist())
    apart = rim - carried
    y, z, moment = (force + matrix @ apart).tolist()
    lever = float(apart[0] * force[1] - apart[1] * force[0])  # the rim has slid over the head by so much
    ops.pattern("Plain", CONTACT, 1)
    ops.load(RIM, 0.0, y, z, moment, 0.0, 0.0)
    ops.load(HEAD_AT_RIM, 0.0, -y, -z, -moment - lever, 0.0, 0.0)
    return force


def run(steps, strips):
    """Runs the load case; rows of time (s), and vertical and lateral force of the wheel on the rail (N)."""
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    rail()
    wheel()
    loads()
    ops.constraints("Transformation")  # in 3.7.1 right only where no node with a rigid link has a `fix`
    ops.numberer("RCM")
    ops.system("BandGeneral")
    ops.algorithm("Linear")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    rows = []
    for step in range(ROWS * steps + 1):
        force = place_contact(strips, step == 0)
        if step % steps == 0:
            rows.append((step // steps * ROW, -force[1], -force[0]))
        if ops.analyze(1, ROW / steps) != 0:
            raise RuntimeError(f"no solution at {step * ROW / steps:.6f} s")
    return rows


def main():
    steps = int(sys.argv[1]) if len(sys.argv) > 1 else STEPS
    strips = Strips(json.loads(Path(__file__).with_suffix(".json").read_text()))
    begin = time.process_time()
    rows = run(steps, strips)
    with open("history.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(("time_s", "p_kn", "q_kn"))
        writer.writerows((f"{t:.7g}", f"{p / 1e3:.8g}", f"{q / 1e3:.8g}") for t, p, q in rows)
    print(f"{len(rows)} rows with {steps} time steps in each: {time.process_time() - begin:.1f} s of CPU")


if __name__ == "__main__":
    main()
