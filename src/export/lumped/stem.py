"""A clamped rail in STEM with a railway wheel in its middle, the lumped contact element of railspring.

The rail is STEM's beams along z, on the line of its shear centres, in the axes of its section. The wheel with its
contact is a user-defined vehicle of zero speed, wheel_uvec.py.

STEM's vehicles put forces on a line, but no moment, and its beams have their mass on their line. So there are ribs:
stiff beams upwards, one at each node, which have the mass of the rail with the section's centroid and moment of inertia
about the track. The wheel acts on two places of the rib in the middle. With ARM = 0.0 there are no ribs; the wheel acts
on the rail itself, whose torsion is then a spring of wheel_uvec.py.

Usage: python wheel_rail_stem.py [time steps per row of the history [rows]]
Writes history.csv (time_s, p_kn, q_kn): vertical and lateral force of the wheel on the rail.
Needs stem-vibrations (1.4.0), numpy, and wheel_uvec.py and wheel_uvec.json beside this file.
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

# CONSTANTS
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
        half = np.sqrt(3.0 * (INERTIA_LATERAL + INERTIA_VERTICAL) / AREA)  # of a rod with the moment of inertia of the section
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


def main(steps_per_row, rows):
    """Runs the load case and writes history.csv."""
    here, history = pathlib.Path(__file__).resolve().parent, pathlib.Path('history.csv').resolve()
    history.write_text('time_s,p_kn,q_kn\n0,0,0\n')
    model, lines = rail()
    model.add_load_by_geometry_ids(lines, UvecLoad(
        direction_signs=[1, 1, 1], velocity=0.0, origin=[0.0, 0.0, 0.5 * RAIL_LENGTH],
        uvec_file=str(here / 'wheel_uvec.py'), uvec_function_name='uvec', uvec_parameters={
            'wheel_configuration': [0.0, ARM] if ARM else [0.0], 'history': str(history), 'row': ROW}), 'wheel')
    # one more step: the wheel writes a row when the next step begins
    step = ROW / steps_per_row
    time = TimeIntegration(start_time=0.0, end_time=step * (rows * steps_per_row + 1), delta_time=step,
                           reduction_factor=1.0, increase_factor=1.0)
    # STEM's strategy for linear systems shows a vehicle the displacements of the last step in all iterations
    settings = SolverSettings(
        analysis_type=AnalysisType.MECHANICAL, solution_type=SolutionType.DYNAMIC,
        stress_initialisation_type=StressInitialisationType.NONE, time_integration=time,
        is_stiffness_matrix_constant=True, are_mass_and_damping_constant=True,
        convergence_criteria=DisplacementConvergenceCriteria(TOLERANCE, 1e-13),
        strategy_type=NewtonRaphsonStrategy(max_iterations=50, min_iterations=0), linear_solver_settings=Lu(),
        rayleigh_m=0.0, rayleigh_k=RAIL_DAMPING, echo_level=0)
    model.project_parameters = Problem('rail', 1, settings)
    with tempfile.TemporaryDirectory() as folder:  # Kratos's files
        stem = Stem(model, folder)
        stem.write_all_input_files()
        stem.run_calculation()


if __name__ == '__main__':
    main(*(int(argument) for argument in sys.argv[1:]), *[STEPS, ROWS][len(sys.argv) - 1:])
