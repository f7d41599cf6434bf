"""A wheelset on two flexible rails in Exudyn, pushed across the track; both contacts are elements of railspring.

A force pushes the axle to the right and lets go again. At first friction holds the wheels. Then they slide until the
flange of the right wheel meets its rail. Friction holds the axle there when the force has gone.

The wheelset moves in the plane across the track: y (to the right), z (down) and turn about x. It is an axle with two
elastic wheels, each a superelement of the same file. A mass on spring and damper is above it. Each wheel stands in the
middle of its own short rail, which is that of the study. The left side is the mirror image of the right one. In its
element y and the turn have the other sign. There is no rolling: friction is that of a wheel that stands.

SI units. Usage: python exudyn_wheelset.py pair.rse
Writes forces.csv, a row each millisecond: time_s, then p_n (vertical), q_n (lateral, to the field side) of the wheel on
the rail and the number of contacts, first of the right side; push_n, y_m and turn_rad of the axle.
Needs exudyn (1.13.6), numpy, contact_library.py and exudyn_live.py beside this file, and the C library (see there).
"""
import sys
import time as clock
import exudyn as exu
import numpy as np
from exudyn.itemInterface import (CoordinateSpringDamper, LoadCoordinate, MarkerNodeCoordinate, MassPoint,
                                  NodeGenericODE2, NodePoint, ObjectGenericODE2)
from contact_library import Element
from exudyn_live import AVERAGE_ACCELERATION, ContactInExudyn, add_modes, settings_for, write_rows

HALF_GAUGE = 0.75  # m, from the middle of the track to the origins of the wheels' profiles
AXLE_MASS, AXLE_TURN = 500.0, 120.0  # kg, kg m^2, besides the wheels
SUSPENDED_MASS, SPRING, DAMPER = 12500.0, 2.4e6, 8e4  # kg, N/m, N s/m
GRAVITY = 9.81  # m/s^2
FRICTION = 0.3
PUSH, BEGIN, UP, DOWN = 80e3, 0.5, 0.4, 0.2  # N; s: until it begins, while it grows, while it goes
END, STEP = 1.2, 62.5e-6  # s


def push(time):
    """Lateral force on the axle."""
    return PUSH * np.interp(time, [BEGIN, BEGIN + UP, BEGIN + UP + DOWN], [0.0, 1.0, 0.0])


def weight(time):
    """Share of the weight, which comes in a period of mass on spring: the wheels just touch at the beginning."""
    return np.interp(time, [0.0, 0.45], [0.0, 1.0])


def build(mbs, element):
    """Adds all bodies and loads; the contact of each side with the places of its coordinates in the system's."""
    modes, rail_modes = len(element.mass) - 3, len(element.rail_squares)
    axle = mbs.AddNode(NodeGenericODE2(numberOfODE2Coordinates=3, referenceCoordinates=[0.0] * 3,
                                       initialCoordinates=[0.0] * 3, initialCoordinates_t=[0.0] * 3))
    mbs.AddObject(ObjectGenericODE2(nodeNumbers=[axle], massMatrix=np.diag([AXLE_MASS, AXLE_MASS, AXLE_TURN])))
    squares = np.diag(element.rail_squares)
    contacts, first, own = [], 3, slice(3, 3 + modes)
    for side in (1.0, -1.0):
        # motions of the wheel (hub and modes), as its element has them, by axle and modes
        of_wheel = np.eye(3 + modes)
        of_wheel[:3, :3] = [[side, 0.0, 0.0], [0.0, 1.0, side * HALF_GAUGE], [0.0, 0.0, side]]
        # wheel: the modes' own parts stand at their node, those with the axle here
        wheel = add_modes(mbs, *(m[own, own] for m in (element.mass, element.damping, element.stiffness)))
        beside = of_wheel.T @ element.mass @ of_wheel
        beside[own, own] = 0.0
        mbs.AddObject(ObjectGenericODE2(nodeNumbers=[axle, wheel], massMatrix=beside))
        rail = add_modes(mbs, np.eye(rail_modes), element.about.damping[1] * squares, squares)
        # contact
        size = 3 + modes + rail_modes
        carried = np.zeros((6, size))
        carried[:3, :3 + modes] = element.rim @ of_wheel
        carried[3:, 3 + modes:] = element.rail_sections.T
        contact = ContactInExudyn(element, carried, FRICTION)
        mbs.AddObject(ObjectGenericODE2(nodeNumbers=[axle, wheel, rail], massMatrix=np.zeros((size, size)),
                                        forceUserFunction=contact.force, jacobianUserFunction=contact.jacobian))
        contacts.append((contact, np.r_[:3, first:first + modes + rail_modes]))
        first += modes + rail_modes
    # suspended mass and loads
    suspended = mbs.AddNode(NodePoint())
    mbs.AddObject(MassPoint(mass=SUSPENDED_MASS, nodeNumber=suspended))
    axle_y, axle_z = [mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=axle, coordinate=i)) for i in (0, 1)]
    above = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=suspended, coordinate=2))
    mbs.AddObject(CoordinateSpringDamper(markerNumbers=[axle_z, above], stiffness=SPRING, damping=DAMPER))
    mbs.AddLoad(LoadCoordinate(markerNumber=axle_y, loadUserFunction=lambda mbs, time, load: push(time)))
    for marker, mass in (axle_z, AXLE_MASS + 2.0 * element.mass[1, 1]), (above, SUSPENDED_MASS):
        mbs.AddLoad(LoadCoordinate(markerNumber=marker, load=GRAVITY * mass,
                                   loadUserFunction=lambda mbs, time, load: weight(time) * load))
    return contacts


def main(path):
    """Pushes the wheelset, and writes forces.csv."""
    system = exu.SystemContainer()
    mbs = system.AddSystem()
    contacts = build(mbs, Element(path))
    ends = []

    def after_step(mbs, time):  # after each step, and once at the start
        data = mbs.systemData
        coordinates, velocities = np.array(data.GetODE2Coordinates()), np.array(data.GetODE2Coordinates_t())
        end = [time]
        for contact, own in contacts:
            end += *contact.end_step(time, coordinates[own], velocities[own]), len(contact.stepped.places())
        ends.append((*end, push(time), coordinates[0], coordinates[2]))
        return True

    mbs.SetPostStepUserFunction(after_step)
    mbs.Assemble()
    begun = clock.process_time()
    mbs.SolveDynamic(settings_for(round(END / STEP), END), solverType=AVERAGE_ACCELERATION)
    taken = clock.process_time() - begun
    print('%d steps, %.1f us a step' % (len(ends) - 1, 1e6 * taken / (len(ends) - 1)))
    names = 'time_s,p_n,q_n,contacts,left_p_n,left_q_n,left_contacts,push_n,y_m,turn_rad'
    rows = write_rows('forces.csv', names, ends, np.arange(0.0, END, 1e-3))
    print('time  force    y    right P     Q      left P     Q    contacts')
    print('   s     kN     mm      kN    kN          kN    kN')
    for time, p, q, count, left_p, left_q, left_count, force, y, _ in rows[::50]:
        print('%4.2f %6.1f %6.2f %7.1f %6.1f %10.1f %6.1f %6d %d' % (
            time, 1e-3 * force, 1e3 * y, 1e-3 * p, 1e-3 * q, 1e-3 * left_p, 1e-3 * left_q, count, left_count))


if __name__ == '__main__':
    main(*sys.argv[1:])
