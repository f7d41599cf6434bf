"""A railway wheel rolls along a track in STEM; the contact is the element of railspring, called while STEM runs.

A user-defined vehicle takes the place of STEM's own and of its power law: stem_uvec.py. It is a wheel with its modes,
and a mass on spring and damper above it. A vertical force on that mass has all weights. At first the wheel just touches
the rail; mass, spring and damper bring the force to it. The hub moves vertically and laterally, but does not turn.
STEM's vehicles put no moment on a rail, so that STEM's rail does not roll.

There are two tracks, both of 60E1 along STEM's z:
- "sleepers" is STEM's straight track, with its own rail, pads and sleepers, and springs and dampers as ground. STEM
  holds such a rail laterally. Its beams have no shear. What that adds under the wheel is a flexibility of the section.
  The rail's height has the irregularity of STEM's vehicles, with a tenth of its usual power.
- "held" is the rail of a study between held ends, for a comparison. Its beams have shear and move laterally as well.
  Torsion is a flexibility of the section, its mean along the rail. The force has a sine.

A moving load of Kratos acts on the nodes as on beams without shear. A wheel on beams with shear feels each of them, so
they are short here: with 150 mm instead of 12.5 mm the vertical force is 2 % off.

For the element both rails are other ones than the study's. Its head gives way as far from any end.

Pads and sleepers are those of STEM's fourth tutorial, the ground is of the size in STEM's examples. Suspended mass and
spring are those of STEM's heavy passenger train, whose weight is about the force. The damper is that of load case 4.1
of S.H. Ju 2016. The rail between held ends has the beam of the study.

Usage: python stem_track.py pair.rse [sleepers or held, sleepers [time steps per row of 0.5 ms, 16 [rows]]]
Writes forces.csv: time_s, and the forces of the wheel on the rail, p_n (vertical) and q_n (lateral).
Needs stem-vibrations (1.4.0), stem_uvec.py, stem_wheel.py and contact_library.py beside this file with what they need,
and the C library.
"""
import pathlib
import sys
from stem.boundary import DisplacementConstraint, RotationConstraint
from stem.default_materials import DefaultMaterial
from stem.load import UvecLoad
from stem.model import Model
from stem.structural_material import ElasticSpringDamper, NodalConcentrated
from contact_library import OTHER_RAIL
from stem_wheel import INERTIA_VERTICAL, RAIL_DAMPING, ROW, SHEAR_MODULUS, STEPS, YOUNG, add_beams, run

# Vehicle
SPEED = 30.0  # m/s
VEHICLE = 775.0, 1.2e6, 4e4  # kg, N/m, N s/m: suspended mass, its spring and damper
FORCE = 60e3  # N, vertical, on the suspended mass
# Rail with the corrections of shear and torsion to the solid rail of 3 m
SHEAR_AREA_LATERAL = 0.004218924103  # m^2
SHEAR_AREA_VERTICAL = 0.003357989  # m^2
TORSION_CONSTANT = 2.715885e-6  # m^4
# Track on sleepers
SLEEPERS, SPACING = 13, 0.6  # their number, m
SLEEPER = 140.0  # kg, a rail's share of one
PAD, PAD_THICKNESS = (750e6, 750e3), 0.025  # N/m and N s/m, m
GROUND = 71e6, 71e3  # N/m and N s/m, below a sleeper
IRREGULARITY = {'Av': 2.095e-6, 'seed': 14}  # m^2 rad/m: power of the waves, of random phases
# Rail between held ends
HELD_LENGTH = 3.0  # m
SWING = 60e3, 60.0  # N, Hz: the force's sine
# Numerics
TOLERANCE = 1e-6  # change of the displacements in the last iteration, over the displacements


def on_sleepers():
    """The model of the track on sleepers, and what the vehicle has to know of it."""
    model, nothing = Model(3), [0.0, 0.0, 0.0]
    rail = DefaultMaterial.Rail_60E1_3D.value.material_parameters
    pad, ground = [ElasticSpringDamper([0.0, stiffness, 0.0], nothing, [0.0, damping, 0.0], nothing)
                   for stiffness, damping in (PAD, GROUND)]
    model.generate_extended_straight_track(
        SPACING, SLEEPERS, rail, NodalConcentrated(nothing, SLEEPER, nothing), pad, PAD_THICKNESS, nothing, ground,
        1.0, [0, 0, 1], 'rail')
    model.synchronise_geometry()
    model.set_mesh_size(SPACING / 6)
    # what shear adds under a force on a long beam on a foundation, whose deflection falls as exp(-rate * z)
    foundation = 1.0 / (1.0 / PAD[0] + 1.0 / GROUND[0]) / SPACING
    rate = (0.25 * foundation / (YOUNG * INERTIA_VERTICAL))**0.25
    start = 2.5 * SPACING
    return model, [0.0, PAD_THICKNESS, start], {
        'loads': [FORCE, 0.0, 0.0, 0.0], 'turn': 0.0,
        'shear': 3.0 / (16.0 * rate * SHEAR_MODULUS * SHEAR_AREA_VERTICAL),
        'irregularity': {'start': start, 'speed': SPEED, **IRREGULARITY}}


def between_held_ends():
    """The model of the rail between held ends, and what the vehicle has to know of it."""
    model, ends = Model(3), [(0.0, 0.0, 0.0), (0.0, 0.0, HELD_LENGTH)]
    add_beams(model, 'rail', [ends], AREA_EFFECTIVE_Y=SHEAR_AREA_VERTICAL, AREA_EFFECTIVE_Z=SHEAR_AREA_LATERAL)
    geometry, held = model.gmsh_io.geo_data, ([True] * 3, [0.0] * 3)
    model.body_model_parts[0].get_geometry_from_geo_data(geometry, 'rail')
    model.synchronise_geometry()
    model.add_boundary_condition_by_geometry_ids(0, geometry['points'], DisplacementConstraint(*held), 'displacements')
    model.add_boundary_condition_by_geometry_ids(0, geometry['points'], RotationConstraint(*held), 'rotations')
    model.set_mesh_size(HELD_LENGTH / 240)
    return model, [0.0, 0.0, 0.1 * HELD_LENGTH], {
        'loads': [FORCE, *SWING, 0.0], 'turn': HELD_LENGTH / (6.0 * SHEAR_MODULUS * TORSION_CONSTANT)}


TRACKS = {'sleepers': (on_sleepers, 300), 'held': (between_held_ends, 160)}  # with the rows of a run


def main(element, track='sleepers', steps_per_row=STEPS, rows=None):
    """Runs the wheel along a track and writes forces.csv."""
    here, history = pathlib.Path(__file__).resolve().parent, pathlib.Path('forces.csv').resolve()
    history.write_text('time_s,p_n,q_n\n0,0,0\n')
    made, usual_rows = TRACKS[track]
    step = ROW / int(steps_per_row)
    model, (across, up, along), of_track = made()
    # Kratos moves the wheel at the end of a step: in the first one it is where it begins
    model.add_load_on_line_model_part('rail', UvecLoad(
        direction_signs=[1, 1, 1], velocity=SPEED, origin=[across, up, along + SPEED * step],
        uvec_file=str(here / 'stem_uvec.py'), uvec_function_name='uvec', uvec_parameters={
            'element': str(pathlib.Path(element).resolve()), 'place': OTHER_RAIL, 'vehicle': VEHICLE,
            'history': str(history), 'row': ROW, 'wheel_configuration': [0.0], **of_track}), 'wheel')
    # one more step: the wheel writes a row when the next step begins
    run(model, step, int(rows or usual_rows) * int(steps_per_row) + 1, TOLERANCE)


if __name__ == '__main__':
    main(*sys.argv[1:])
