//! The contact element for Python: motions in, forces and tangent out, one state at a time or thousands at once from the same end of a step.

use nalgebra::{Matrix3, Vector3};
use numpy::ndarray::{Array1, Array2, Array3, ArrayView1, ArrayView2};
use numpy::{AllowTypeChange, IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayLike1, PyArrayLike2};
use pyo3::exceptions::{PyArithmeticError, PyValueError};
use pyo3::prelude::*;
use railspring_element::contact::{ContactAt, Forces, Motions, StaticContact};
use railspring_element::element::OTHER_RAIL;
use railspring_element::unit::{Host, HostForces, Motion, Unit as Inner};
use railspring_profiles::error::Error;
use std::path::PathBuf;
use std::sync::Arc;

/// Three numbers, or a list of threes.
type Three<'py> = PyArrayLike1<'py, f64, AllowTypeChange>;
type Threes<'py> = PyArrayLike2<'py, f64, AllowTypeChange>;

fn refused(error: Error) -> PyErr {
    match error {
        Error::Numerics(_) => PyArithmeticError::new_err(error.to_string()),
        _ => PyValueError::new_err(error.to_string()),
    }
}

fn vector(name: &str, of: ArrayView1<'_, f64>) -> PyResult<Vector3<f64>> {
    match of.as_slice() {
        Some(&[y, z, roll]) => Ok(Vector3::new(y, z, roll)),
        _ if of.len() == 3 => Ok(Vector3::new(of[0], of[1], of[2])),
        _ => Err(PyValueError::new_err(format!(
            "{name}: {} numbers: expected y, z and the rotation about x",
            of.len()
        ))),
    }
}

fn three(of: &Vector3<f64>) -> Array1<f64> {
    Array1::from_iter(of.iter().copied())
}

fn square(of: &Matrix3<f64>) -> Array2<f64> {
    Array2::from_shape_fn((3, 3), |(i, j)| of[(i, j)])
}

/// A contact element, as `railspring element` writes it. It does not change; contacts and units share it.
#[pyclass(frozen, module = "railspring")]
pub(super) struct Element {
    element: Arc<railspring_element::element::Element>,
}

#[pymethods]
impl Element {
    #[new]
    fn new(path: PathBuf) -> PyResult<Self> {
        let element = railspring_element::element::Element::open(&path).map_err(refused)?;
        Ok(Self { element: Arc::new(element) })
    }

    #[getter]
    fn pair(&self) -> &str {
        &self.element.about.pair
    }

    #[getter]
    fn kind(&self) -> &str {
        &self.element.about.element
    }

    #[getter]
    fn friction(&self) -> f64 {
        self.element.friction
    }

    #[getter]
    fn largest_force(&self) -> f64 {
        self.element.about.largest_force_n
    }

    #[getter]
    fn hub_mass<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        square(&self.element.wheel.mass_beside_modes()).into_pyarray(py)
    }

    #[getter]
    fn place(&self) -> Option<f64> {
        self.element.rail_at_wheel.as_ref().map(|rail| rail.place)
    }

    fn superelement<'py>(&self, py: Python<'py>) -> [Bound<'py, PyArray2<f64>>; 4] {
        let wheel = self.element.superelement();
        [wheel.mass, wheel.damping, wheel.stiffness, wheel.rim].map(|matrix| {
            Array2::from_shape_fn((matrix.nrows(), matrix.ncols()), |(i, j)| matrix[(i, j)]).into_pyarray(py)
        })
    }

    #[expect(clippy::type_complexity, reason = "what Python takes apart")]
    fn rail<'py>(
        &self,
        py: Python<'py>,
    ) -> Option<(Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>, f64)> {
        let rail = self.element.rail_at_wheel.as_ref()?;
        let squares = Array1::from_iter(rail.modes.iter().map(|mode| mode.square));
        let sections = Array2::from_shape_fn((rail.modes.len(), 3), |(i, j)| rail.modes[i].section[j]);
        Some((
            squares.into_pyarray(py),
            sections.into_pyarray(py),
            square(&rail.rest).into_pyarray(py),
            rail.damping,
        ))
    }

    #[pyo3(signature = (friction=None))]
    fn contact(&self, friction: Option<f64>) -> PyResult<Contact> {
        let friction = friction.unwrap_or(self.element.friction);
        Ok(Contact { contact: StaticContact::new(self.element.clone(), friction).map_err(refused)? })
    }

    #[pyo3(signature = (friction=None, gravity=0.0))]
    fn unit(&self, friction: Option<f64>, gravity: f64) -> PyResult<Unit> {
        let friction = friction.unwrap_or(self.element.friction);
        Ok(Unit { unit: Inner::new(self.element.clone(), friction, gravity).map_err(refused)? })
    }

    fn __repr__(&self) -> String {
        format!("Element({}, {})", self.element.about.element, self.element.about.pair)
    }
}

/// Forces on rim and section, and their tangent.
type OfContact<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>);
/// The same of many states.
type OfMany<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray3<f64>>);
/// A contact: rail (y, z), wheel (y, z), normal and tangential force, width, whether it slides.
type Place = ((f64, f64), (f64, f64), f64, f64, f64, bool);

fn place_of(at: ContactAt) -> Place {
    let ContactAt { rail, wheel, normal_force, tangential_force, slides, width } = at;
    ((rail.x, rail.y), (wheel.x, wheel.y), normal_force, tangential_force, width, slides)
}

fn of_contact<'py>(py: Python<'py>, forces: &Forces) -> OfContact<'py> {
    let tangent = Array2::from_shape_fn((6, 6), |(i, j)| forces.tangent[(i, j)]);
    (three(&forces.rim).into_pyarray(py), three(&forces.section).into_pyarray(py), tangent.into_pyarray(py))
}

/// The contact of an element as statics, with its state.
#[pyclass(module = "railspring")]
pub(super) struct Contact {
    contact: StaticContact,
}

fn motions(rim: &Three<'_>, section: Option<&Three<'_>>, place: Option<f64>) -> PyResult<Motions> {
    let section = section.map(|section| vector("section", section.as_array())).transpose()?;
    Ok(Motions {
        rim: vector("rim", rim.as_array())?,
        section: section.unwrap_or_default(),
        place: place.unwrap_or(OTHER_RAIL),
    })
}

#[pymethods]
impl Contact {
    #[pyo3(signature = (rim, section=None, place=None))]
    fn start<'py>(
        &mut self,
        py: Python<'py>,
        rim: Three<'py>,
        section: Option<Three<'py>>,
        place: Option<f64>,
    ) -> PyResult<OfContact<'py>> {
        let forces = self.contact.start(&motions(&rim, section.as_ref(), place)?).map_err(refused)?;
        Ok(of_contact(py, &forces))
    }

    #[pyo3(signature = (rim, section=None, place=None))]
    fn evaluate<'py>(
        &mut self,
        py: Python<'py>,
        rim: Three<'py>,
        section: Option<Three<'py>>,
        place: Option<f64>,
    ) -> PyResult<OfContact<'py>> {
        let forces = self.contact.evaluate(&motions(&rim, section.as_ref(), place)?).map_err(refused)?;
        Ok(of_contact(py, &forces))
    }

    #[pyo3(signature = (rim, section=None, place=None))]
    fn evaluate_many<'py>(
        &mut self,
        py: Python<'py>,
        rim: Threes<'py>,
        section: Option<Threes<'py>>,
        place: Option<Three<'py>>,
    ) -> PyResult<OfMany<'py>> {
        let rim: ArrayView2<'_, f64> = rim.as_array();
        let count = rim.nrows();
        let section = section.as_ref().map(|section| section.as_array());
        let place = place.as_ref().map(|place| place.as_array());
        for (name, rows) in [("section", section.map(|of| of.nrows())), ("place", place.map(|of| of.len()))] {
            if let Some(rows) = rows.filter(|rows| *rows != count) {
                let message = format!("{name}: {rows} rows: expected {count}, one for each rim");
                return Err(PyValueError::new_err(message));
            }
        }
        let (mut rims, mut sections) = (Array2::zeros((count, 3)), Array2::zeros((count, 3)));
        let mut tangents = Array3::zeros((count, 6, 6));
        for n in 0..count {
            let motions = Motions {
                rim: vector("rim", rim.row(n))?,
                section: section.map_or(Ok(Vector3::zeros()), |of| vector("section", of.row(n)))?,
                place: place.map_or(OTHER_RAIL, |of| of[n]),
            };
            // a state without a balance leaves the others as they are
            match self.contact.evaluate(&motions) {
                Ok(forces) => {
                    (0..3)
                        .for_each(|i| (rims[(n, i)], sections[(n, i)]) = (forces.rim[i], forces.section[i]));
                    (0..36).for_each(|i| tangents[(n, i / 6, i % 6)] = forces.tangent[(i / 6, i % 6)]);
                }
                Err(Error::Numerics(_)) => {
                    rims.row_mut(n).fill(f64::NAN);
                    sections.row_mut(n).fill(f64::NAN);
                    tangents.outer_iter_mut().nth(n).into_iter().for_each(|mut of| of.fill(f64::NAN));
                }
                Err(error) => return Err(PyValueError::new_err(format!("row {n}: {error}"))),
            }
            py.check_signals()?;
        }
        Ok((rims.into_pyarray(py), sections.into_pyarray(py), tangents.into_pyarray(py)))
    }

    fn commit(&mut self) {
        self.contact.commit();
    }

    fn copy(&self) -> Self {
        Self { contact: self.contact.clone() }
    }

    fn restore(&mut self, other: &Self) -> PyResult<()> {
        same(self.contact.element(), other.contact.element())?;
        self.contact.restore(&other.contact);
        Ok(())
    }

    fn set_section_rest(&mut self, rest: Threes<'_>) -> PyResult<()> {
        self.contact.set_section_rest(matrix(&rest)?).map_err(refused)
    }

    fn contacts(&self) -> Vec<Place> {
        self.contact.contacts().map(place_of).collect()
    }
}

fn same(
    one: &Arc<railspring_element::element::Element>,
    other: &Arc<railspring_element::element::Element>,
) -> PyResult<()> {
    if Arc::ptr_eq(one, other) {
        return Ok(());
    }
    Err(PyValueError::new_err("other: of another element: expected one of the same; take a copy of this one"))
}

fn matrix(rest: &Threes<'_>) -> PyResult<Matrix3<f64>> {
    let rest = rest.as_array();
    if rest.shape() != [3, 3] {
        return Err(PyValueError::new_err(format!(
            "rest: shape {:?}: expected three rows of three",
            rest.shape()
        )));
    }
    Ok(Matrix3::from_fn(|i, j| rest[(i, j)]))
}

/// Forces on hub, section and rim.
type OfUnit<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

fn of_unit<'py>(py: Python<'py>, forces: &HostForces) -> OfUnit<'py> {
    let HostForces { hub, section, rim } = forces;
    (three(hub).into_pyarray(py), three(section).into_pyarray(py), three(rim).into_pyarray(py))
}

/// An element with the modes of its wheel inside, with its state.
#[pyclass(module = "railspring")]
pub(super) struct Unit {
    unit: Inner,
}

/// A host's motions from Python: displacements and velocities of hub and section, place.
fn host(
    hub: &Three<'_>,
    hub_velocity: &Three<'_>,
    section: Option<&Three<'_>>,
    section_velocity: Option<&Three<'_>>,
    place: Option<f64>,
) -> PyResult<Host> {
    let or_rest = |name: &str, of: Option<&Three<'_>>| -> PyResult<Vector3<f64>> {
        Ok(of.map(|of| vector(name, of.as_array())).transpose()?.unwrap_or_default())
    };
    Ok(Host {
        hub: Motion {
            displacement: vector("hub", hub.as_array())?,
            velocity: vector("hub_velocity", hub_velocity.as_array())?,
        },
        section: Motion {
            displacement: or_rest("section", section)?,
            velocity: or_rest("section_velocity", section_velocity)?,
        },
        place: place.unwrap_or(OTHER_RAIL),
    })
}

#[pymethods]
impl Unit {
    #[pyo3(signature = (hub, hub_velocity, section=None, section_velocity=None, place=None, bent=false))]
    #[expect(clippy::too_many_arguments, reason = "by name in Python")]
    fn start<'py>(
        &mut self,
        py: Python<'py>,
        hub: Three<'py>,
        hub_velocity: Three<'py>,
        section: Option<Three<'py>>,
        section_velocity: Option<Three<'py>>,
        place: Option<f64>,
        bent: bool,
    ) -> PyResult<OfUnit<'py>> {
        let host = host(&hub, &hub_velocity, section.as_ref(), section_velocity.as_ref(), place)?;
        Ok(of_unit(py, &self.unit.start(&host, bent).map_err(refused)?))
    }

    #[pyo3(signature = (length, hub, hub_velocity, section=None, section_velocity=None, place=None))]
    #[expect(clippy::too_many_arguments, reason = "by name in Python")]
    fn advance<'py>(
        &mut self,
        py: Python<'py>,
        length: f64,
        hub: Three<'py>,
        hub_velocity: Three<'py>,
        section: Option<Three<'py>>,
        section_velocity: Option<Three<'py>>,
        place: Option<f64>,
    ) -> PyResult<OfUnit<'py>> {
        let host = host(&hub, &hub_velocity, section.as_ref(), section_velocity.as_ref(), place)?;
        Ok(of_unit(py, &self.unit.advance(length, &host).map_err(refused)?))
    }

    fn tangent<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let tangent = self.unit.tangent();
        Array2::from_shape_fn((6, 6), |(i, j)| tangent[(i, j)]).into_pyarray(py)
    }

    fn commit(&mut self) {
        self.unit.commit();
    }

    fn copy(&self) -> Self {
        Self { unit: self.unit.clone() }
    }

    fn restore(&mut self, other: &Self) -> PyResult<()> {
        same(self.unit.element(), other.unit.element())?;
        self.unit.restore(&other.unit);
        Ok(())
    }

    fn set_section_rest(&mut self, rest: Threes<'_>) -> PyResult<()> {
        self.unit.set_section_rest(matrix(&rest)?).map_err(refused)
    }

    fn contacts(&self) -> Vec<Place> {
        self.unit.contacts().map(place_of).collect()
    }
}
