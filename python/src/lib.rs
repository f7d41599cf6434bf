//! `railspring._native`: the laws of the library for Python, in N, m and N/m, for numbers and for arrays of any shape, its contact element, and the program.

mod element;

use std::ffi::OsString;
use std::path::PathBuf;

use numpy::ndarray::ArrayD;
use numpy::{AllowTypeChange, IntoPyArray, PyArrayLikeDyn, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyFloat;
use railspring::export::SpringsFile;
use railspring::table::earlier::Earlier;
use railspring_calibrate::law::{REFERENCE_FORCE, StiffnessLaw, TableLaw as Knots, fit_law as fitted};
use railspring_profiles::error::Error;
use railspring_profiles::units::{KILONEWTON, KILONEWTON_PER_METRE};

/// Numbers that Python gives: one, a list, or an array.
type Given<'py> = PyArrayLikeDyn<'py, f64, AllowTypeChange>;

fn refused(error: Error) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// A value for each number, a number for a number; what is not a number stays so.
fn each<'py>(py: Python<'py>, given: &Given<'py>, value: impl Fn(f64) -> f64) -> Bound<'py, PyAny> {
    let of = |x: &f64| if x.is_nan() { f64::NAN } else { value(*x) };
    let made: ArrayD<f64> = given.as_array().map(of);
    match (made.ndim(), made.first()) {
        (0, Some(number)) => PyFloat::new(py, *number).into_any(),
        _ => made.into_pyarray(py).into_any(),
    }
}

/// The law `k(F) = a + b·(F/f0)^c` with f0 = 1 kN.
#[pyclass(frozen, eq, module = "railspring", from_py_object)]
#[derive(Debug, Clone, PartialEq)]
struct Law {
    law: StiffnessLaw,
}

#[pymethods]
impl Law {
    #[new]
    fn new(a: f64, b: f64, c: f64) -> PyResult<Self> {
        StiffnessLaw::new(a, b, c).map(|law| Self { law }).map_err(refused)
    }

    #[staticmethod]
    fn from_constants(a_kn_per_m: f64, b_kn_per_m: f64, c: f64, f0_kn: f64) -> PyResult<Self> {
        if !(f0_kn > 0.0 && f0_kn.is_finite()) {
            let message = format!("f0_kn = {f0_kn}: expected a force above 0 kN; give that of the file");
            return Err(PyValueError::new_err(message));
        }
        // b·(f/f0)^c = b·(r/f0)^c·(f/r)^c with the reference force r of the library
        let factor = (REFERENCE_FORCE / (f0_kn * KILONEWTON)).powf(c);
        Self::new(a_kn_per_m * KILONEWTON_PER_METRE, b_kn_per_m * KILONEWTON_PER_METRE * factor, c)
    }

    #[staticmethod]
    fn published() -> Self {
        Self { law: StiffnessLaw::published() }
    }

    #[getter]
    fn a(&self) -> f64 {
        self.law.a
    }

    #[getter]
    fn b(&self) -> f64 {
        self.law.b
    }

    #[getter]
    fn c(&self) -> f64 {
        self.law.c
    }

    fn tangent<'py>(&self, py: Python<'py>, force: Given<'py>) -> Bound<'py, PyAny> {
        each(py, &force, |force| self.law.tangent(force))
    }

    fn displacement<'py>(&self, py: Python<'py>, force: Given<'py>) -> Bound<'py, PyAny> {
        each(py, &force, |force| self.law.displacement(force))
    }

    fn force<'py>(&self, py: Python<'py>, displacement: Given<'py>) -> Bound<'py, PyAny> {
        each(py, &displacement, |displacement| self.law.force(displacement))
    }

    fn energy<'py>(&self, py: Python<'py>, displacement: Given<'py>) -> Bound<'py, PyAny> {
        each(py, &displacement, |displacement| self.law.energy(displacement))
    }

    fn __repr__(&self) -> String {
        let StiffnessLaw { a, b, c } = self.law;
        format!("Law(a={a:?}, b={b:?}, c={c:?})")
    }

    fn __getnewargs__(&self) -> (f64, f64, f64) {
        (self.law.a, self.law.b, self.law.c)
    }
}

/// The law through points of tangent stiffness, the alternative to [`Law`] where one power does not follow the contact.
#[pyclass(frozen, eq, module = "railspring", from_py_object)]
#[derive(Debug, Clone, PartialEq)]
struct TableLaw {
    forces: Vec<f64>,
    tangents: Vec<f64>,
    law: Knots,
}

#[pymethods]
impl TableLaw {
    #[new]
    fn new(forces: Vec<f64>, tangents: Vec<f64>) -> PyResult<Self> {
        let law = Knots::new(&forces, &tangents).map_err(refused)?;
        Ok(Self { forces, tangents, law })
    }

    fn tangent<'py>(&self, py: Python<'py>, force: Given<'py>) -> Bound<'py, PyAny> {
        each(py, &force, |force| self.law.tangent(force))
    }

    fn displacement<'py>(&self, py: Python<'py>, force: Given<'py>) -> Bound<'py, PyAny> {
        each(py, &force, |force| self.law.displacement(force))
    }

    fn force<'py>(&self, py: Python<'py>, displacement: Given<'py>) -> Bound<'py, PyAny> {
        each(py, &displacement, |displacement| self.law.force(displacement))
    }

    fn __repr__(&self) -> String {
        format!("TableLaw({} points)", self.forces.len())
    }

    fn __getnewargs__(&self) -> (Vec<f64>, Vec<f64>) {
        (self.forces.clone(), self.tangents.clone())
    }
}

/// A law with the errors of its fit.
#[pyclass(frozen, get_all, module = "railspring")]
struct LawFit {
    law: Law,
    standard_error: [f64; 3],
    at_bound: [bool; 3],
    rms_relative_error: f64,
    max_relative_error: f64,
    range: (f64, f64),
}

/// Fits a [`Law`] to tangent stiffness (N/m) at forces (N).
#[pyfunction]
fn fit_law(forces: PyReadonlyArray1<'_, f64>, tangents: PyReadonlyArray1<'_, f64>) -> PyResult<LawFit> {
    let [forces, tangents] = [forces, tangents].map(|list| list.as_array().to_vec());
    let fit = fitted(&forces, &tangents).map_err(refused)?;
    Ok(LawFit {
        law: Law { law: fit.law },
        standard_error: fit.standard_error,
        at_bound: fit.at_bound,
        rms_relative_error: fit.rms_relative_error,
        max_relative_error: fit.max_relative_error,
        range: fit.range,
    })
}

/// Runs the program with `arguments`, the first of them its name; its exit code. `file` is this module, `command` what starts the program.
#[pyfunction]
fn run_program(py: Python<'_>, arguments: Vec<OsString>, file: PathBuf, command: Option<PathBuf>) -> u8 {
    railspring::program::is_part_of(file, command);
    py.detach(|| railspring::cli::run(arguments))
}

/// Refuses a `stiffness.json`, a `table.json`, or a `table.csv` beside one, that is not as the program wrote it.
#[pyfunction]
fn check_as_written(py: Python<'_>, path: PathBuf) -> PyResult<()> {
    let is_rows = path.extension().is_some_and(|ending| ending == "csv");
    py.detach(|| match is_rows {
        true => Earlier::read(&path).map(drop),
        false => SpringsFile::read(&path).map(drop),
    })
    .map_err(refused)
}

#[pymodule]
mod _native {
    #[pymodule_export]
    use super::element::{Contact, Element, Unit};
    #[pymodule_export]
    use super::{Law, LawFit, TableLaw, check_as_written, fit_law, run_program};
}
