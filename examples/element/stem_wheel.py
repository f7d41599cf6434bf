"""A railway wheel on a short rail in STEM; the contact is the element of railspring, called while STEM runs.

Load case of S.H. Ju 2016, section 4.1. The rail is STEM's beams along z, held at both ends. They are on the line of its
shear centres, in the axes of its section. The wheel is a user-defined vehicle that stands: stem_uvec.py.

STEM's vehicles put forces on a line, but no moment, and its beams have their mass on their line. So there are ribs:
stiff beams upwards, one at each node. They have the mass of the rail, with the section's centroid and moment of inertia
about the track. The wheel acts on two places of the rib in the middle. With ARM = 0.0 there are no ribs, and the wheel
acts on the rail itself. The rail's torsion is then a flexibility in the vehicle.

Usage: python stem_wheel.py pair.rse [time steps per row of 0.5 ms, 16 [rows, 550]]
Writes forces.csv: time_s, and the forces of the wheel on the rail, p_n (vertical) and q_n (lateral).
Needs stem-vibrations (1.4.0), numpy, stem_uvec.py and contact_library.py beside this file, and the C library.
"""
import dataclasses
import pathlib
import sys
import tempfile
import numpy as np
from stem.boundary import DisplacementConstraint, RotationConstraint
from stem.load import UvecLoad
from stem.model import Model
from stem.model_part import BodyModelPart
from stem.solver import (AnalysisType, DisplacementConvergenceCriteria, Lu, NewtonRaphsonStrategy, Problem,
                         SolutionType, SolverSettings, StressInitialisationType, TimeIntegration)
from stem.stem import Stem
from stem.structural_material import EulerBeam, StructuralMaterial

ROW, ROWS, STEPS = 0.5e-3, 550, 16  # s between two rows of the history, their number, time steps in a row
LOADS = 10e3, 61.25e3, 10.0, 20e3  # N, N, Hz, N: mean and swing of the vertical force, its frequency, lateral force
# Rail, with the corrections of shear and torsion to the solid rail
RAIL_LENGTH = 0.555  # m
RAIL_ELEMENTS = 20  # an even number: the wheel is on the node in the middle
YOUNG = 210000000000.0  # Pa
SHEAR_MODULUS = 80769230770.0  # Pa
DENSITY = 7850.0  # kg/m^3
AREA = 0.007670000183  # m^2
INERTIA_LATERAL = 5.123048706e-6  # m^4, against bending along the section's y
INERTIA_VERTICAL = 3.038312683e-5  # m^4, against bending along the section's z
SHEAR_AREA_LATERAL = 0.004528794242  # m^2
SHEAR_AREA_VERTICAL = 0.003924294928  # m^2
TORSION_CONSTANT = 9.536930027e-6  # m^4, with the warping that the ends hold
CENTROID = [0.0, -0.03468374605]  # m, from the shear centre along the section's y and z
RAIL_DAMPING = 6.366197724e-6  # s, in proportion to stiffness
# Numerics
ARM = 0.12  # m, between the two places where the wheel acts on the rib; 0.0 for one place on the rail, without ribs
RIB_YOUNG = 2e15  # Pa
RIB_INERTIA = 3e-8  # m^4, of the area; so small that it adds no moment of inertia
WITHOUT_MASS = 1e-6  # share of the rail's mass in the beams
TOLERANCE = 1e-5  # change of the displacements in the last iteration, over the displacements


@dataclasses.dataclass
class ShearBeam(EulerBeam):
    """STEM's beam with the shear areas that the elements of Kratos take."""
    AREA_EFFECTIVE_Y: float = 0.0
    AREA_EFFECTIVE_Z: float = 0.0


def add_beams(model, name, lines, **changed):
    """Adds beams along polylines, with the constants of the rail where nothing is `changed`."""
    constants = {
        'YOUNG_MODULUS': YOUNG, 'POISSON_RATIO': 0.5 * YOUNG / SHEAR_MODULUS - 1.0, 'DENSITY': DENSITY,
        'CROSS_AREA': AREA, 'I33': INERTIA_VERTICAL, 'I22': INERTIA_LATERAL, 'TORSIONAL_INERTIA': TORSION_CONSTANT,
        'RAYLEIGH_M': 0.0, 'RAYLEIGH_K': RAIL_DAMPING, 'AREA_EFFECTIVE_Y': SHEAR_AREA_VERTICAL,
        'AREA_EFFECTIVE_Z': SHEAR_AREA_LATERAL}
    for line in lines:
        model.gmsh_io.generate_geometry({name: {'coordinates': line, 'ndim': 1, 'element_size': -1}}, '')
    body = BodyModelPart(name)
    body.material = StructuralMaterial(name, ShearBeam(ndim=3, **{**constants, **changed}))
    model.body_model_parts.append(body)


def rail():
    """The model of the rail, held at both ends, and the numbers of the lines on which the wheel stands."""
    model, middle = Model(3), 0.5 * RAIL_LENGTH
    nodes = [(0.0, 0.0, RAIL_LENGTH * i / RAIL_ELEMENTS) for i in range(RAIL_ELEMENTS + 1)]
    add_beams(model, 'rail', [nodes], DENSITY=DENSITY * (WITHOUT_MASS if ARM else 1.0))
    if ARM:
        # half the length of a rod with the section's moment of inertia
        half = np.sqrt(3.0 * (INERTIA_LATERAL + INERTIA_VERTICAL) / AREA)
        height = np.hypot(*CENTROID)
        lateral, up = CENTROID[0] / height, -CENTROID[1] / height  # along a rib
        ribs = [[(lateral * at, up * at, z) for at in (height - half, 0.0, height + half)] for _, _, z in nodes[1:-1]]
        add_beams(model, 'ribs', ribs, DENSITY=DENSITY * RAIL_LENGTH / RAIL_ELEMENTS / (2.0 * half), RAYLEIGH_K=0.0,
                  YOUNG_MODULUS=RIB_YOUNG, I33=RIB_INERTIA, I22=RIB_INERTIA, TORSIONAL_INERTIA=RIB_INERTIA)
    geometry = model.gmsh_io.geo_data
    for body in model.body_model_parts:
        body.get_geometry_from_geo_data(geometry, body.name)
    model.synchronise_geometry()

    def points_at(place):
        """Points at a place along the rail that are not below it."""
        return {number for number, (_, y, z) in geometry['points'].items() if y > -1e-6 and abs(z - place) < 1e-6}

    ends, held = [*points_at(0.0), *points_at(RAIL_LENGTH)], ([True] * 3, [0.0] * 3)
    model.add_boundary_condition_by_geometry_ids(0, ends, DisplacementConstraint(*held), 'displacements')
    model.add_boundary_condition_by_geometry_ids(0, ends, RotationConstraint(*held), 'rotations')
    model.set_mesh_size(RAIL_LENGTH)  # an element from point to point
    if ARM:
        return model, [number for number, line in geometry['lines'].items() if set(line) == points_at(middle)]
    return model, geometry['physical_groups']['rail']['geometry_ids']


def run(model, step, steps, tolerance=TOLERANCE):
    """Runs a model for so many time steps of a length (s)."""
    time = TimeIntegration(start_time=0.0, end_time=step * steps, delta_time=step, reduction_factor=1.0,
                           increase_factor=1.0)
    # STEM's strategy for linear systems shows a vehicle the displacements of the last step in all iterations
    settings = SolverSettings(
        analysis_type=AnalysisType.MECHANICAL, solution_type=SolutionType.DYNAMIC,
        stress_initialisation_type=StressInitialisationType.NONE, time_integration=time,
        is_stiffness_matrix_constant=True, are_mass_and_damping_constant=True,
        convergence_criteria=DisplacementConvergenceCriteria(tolerance, 1e-13),
        strategy_type=NewtonRaphsonStrategy(max_iterations=50, min_iterations=0), linear_solver_settings=Lu(),
        rayleigh_m=0.0, rayleigh_k=RAIL_DAMPING, echo_level=0)
    model.project_parameters = Problem('rail', 1, settings)
    with tempfile.TemporaryDirectory() as folder:  # Kratos's files
        stem = Stem(model, folder)
        stem.write_all_input_files()
        stem.run_calculation()


def main(element, steps_per_row=STEPS, rows=ROWS):
    """Runs the load case and writes forces.csv."""
    here, history = pathlib.Path(__file__).resolve().parent, pathlib.Path('forces.csv').resolve()
    history.write_text('time_s,p_n,q_n\n0,0,0\n')
    model, lines = rail()
    torsion = 0.25 * RAIL_LENGTH / (SHEAR_MODULUS * TORSION_CONSTANT)  # of both halves, at the wheel
    model.add_load_by_geometry_ids(lines, UvecLoad(
        direction_signs=[1, 1, 1], velocity=0.0, origin=[0.0, 0.0, 0.5 * RAIL_LENGTH],
        uvec_file=str(here / 'stem_uvec.py'), uvec_function_name='uvec', uvec_parameters={
            'element': str(pathlib.Path(element).resolve()), 'place': 0.5 * RAIL_LENGTH,
            'turn': 0.0 if ARM else torsion, 'loads': LOADS, 'history': str(history), 'row': ROW,
            'wheel_configuration': [0.0, ARM] if ARM else [0.0]}), 'wheel')
    # one more step: the wheel writes a row when the next step begins
    run(model, ROW / steps_per_row, rows * steps_per_row + 1)


if __name__ == '__main__':
    main(sys.argv[1], *map(int, sys.argv[2:]))
