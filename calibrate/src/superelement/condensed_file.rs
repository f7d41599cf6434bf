//! A condensed body as a file in the safetensors format, which other languages read, too.

use super::condensed::CondensedBody;
use super::modes::Modes;
use super::section_motion::SectionMotion;
use crate::mesh::SurfaceGrid;
use crate::solid::Material;
use faer::Mat;
use nalgebra::{DMatrix, Matrix3, Matrix6, Point2, Point3};
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::input;
use safetensors::tensor::{Dtype, SafeTensors, TensorView, serialize};
use std::collections::{BTreeMap, HashMap};
use std::path::Path;
use std::sync::Arc;

/// Layout of the file.
const FORMAT: &str = "railspring condensed body 5";

/// Largest file that is read, bytes.
const LARGEST: u64 = 4 << 30;

fn refused(name: &str, found: String) -> InputError {
    InputError::new(name, found, "a file as `CondensedBody::write` writes it", "condense the body again")
}

/// Number of values of the upper triangle of a matrix of a size, and of those before the column of that number.
fn triangle(size: usize) -> usize {
    size * (size + 1) / 2
}

impl CondensedBody {
    /// The body as a file of tensors, with the rest as metadata. `compliance` is symmetric: the file has its
    /// upper triangle, column by column. `nodes`, `along_profile`, `along_track` and `node_numbers` describe
    /// the contact nodes. The motion of a section is `section_moved` (a row for y, z and the rotation),
    /// `section_flexibility` and `shear_centre`. Modes are `mode_shapes` (a row for each), `mode_stiffness`,
    /// `mode_coupling` (a row for each rigid motion), `rigid_mass` and `master`.
    ///
    /// # Panics
    /// Never: the shapes are those of the data.
    pub fn write(&self) -> Vec<u8> {
        let size = self.compliance.nrows();
        let compliance: Vec<f64> = (0..size)
            .flat_map(|column| self.compliance.col_as_slice(column)[..=column].iter().copied())
            .collect();
        let nodes: Vec<f64> = self.nodes.iter().flat_map(|p| [p.x, p.y, p.z]).collect();
        let mut reals = vec![
            ("compliance", compliance, vec![triangle(size)]),
            ("nodes", nodes, vec![self.nodes.len(), 3]),
            ("along_profile", self.grid.along_profile.clone(), vec![self.grid.along_profile.len()]),
            ("along_track", self.grid.along_track.clone(), vec![self.grid.along_track.len()]),
        ];
        if let Some(section) = &self.section {
            reals.extend([
                ("section_moved", section.moved.concat(), vec![3, section.moved[0].len()]),
                ("section_flexibility", section.flexibility.as_slice().to_vec(), vec![3, 3]),
                ("shear_centre", vec![section.shear_centre.x, section.shear_centre.y], vec![2]),
            ]);
        }
        if let Some(modes) = &self.modes {
            let count = modes.count();
            let shapes = (0..count).flat_map(|mode| modes.contact(mode).iter().copied()).collect();
            reals.extend([
                ("mode_shapes", shapes, vec![count, modes.contact.nrows()]),
                ("mode_stiffness", modes.stiffness.as_slice().to_vec(), vec![count, count]),
                ("mode_coupling", modes.coupling.transpose().as_slice().to_vec(), vec![6, count]),
                ("rigid_mass", modes.rigid.as_slice().to_vec(), vec![6, 6]),
                ("master", modes.master.coords.as_slice().to_vec(), vec![3]),
            ]);
        }
        let numbers = self.grid.nodes.iter().flat_map(|&n| (n as u64).to_le_bytes()).collect();
        let numbers = ("node_numbers", Dtype::U64, vec![self.grid.nodes.len()], numbers);
        let tensors: Vec<(&str, Dtype, Vec<usize>, Vec<u8>)> = reals
            .into_iter()
            .map(|(name, values, shape)| {
                (name, Dtype::F64, shape, values.iter().flat_map(|v| v.to_le_bytes()).collect())
            })
            .chain([numbers])
            .collect();
        let tensors = tensors.iter().map(|(name, kind, shape, bytes)| {
            (*name, TensorView::new(*kind, shape.clone(), bytes).expect("as many bytes as the shape says"))
        });
        let metadata: HashMap<String, String> = [
            ("format", FORMAT.to_string()),
            ("key", self.key.clone()),
            ("of", self.of.clone()),
            ("equations", self.equations.to_string()),
            ("mass_kg", format!("{:e}", self.mass)),
            ("young_pa", format!("{:e}", self.surface.young)),
            ("poisson", format!("{:e}", self.surface.poisson)),
            ("density_kg_per_m3", format!("{:e}", self.surface.density)),
        ]
        .map(|(name, value)| (name.to_string(), value))
        .into();
        // one line of metadata, in the order of its names, so that the same body gives the same bytes
        let whole = serde_json::to_string(&metadata.into_iter().collect::<BTreeMap<_, _>>());
        let line = HashMap::from([("railspring".to_string(), whole.expect("strings are plain JSON"))]);
        serialize(tensors, Some(line)).expect("names and shapes are plain")
    }

    /// Reads a file with what [`CondensedBody::write`] wrote; what refuses the body later names the file.
    ///
    /// # Errors
    /// [`InputError`] with the file: one that cannot be read, and as [`CondensedBody::read`].
    pub fn open(path: &Path) -> Result<Self> {
        let name = path.display().to_string();
        let bytes = input::read(path, LARGEST).map_err(|cause| {
            InputError::new(&name, cause, "a file as `CondensedBody::write` writes it", "check the path")
        })?;
        let body = Self::parsed(&bytes).map_err(|found| refused(&name, found))?;
        Ok(Self { file: Some(path.to_path_buf()), ..body })
    }

    /// Reads what [`CondensedBody::write`] wrote.
    ///
    /// # Errors
    /// [`InputError`] for bytes of another layout, a matrix that is not square or does not suit its grid, and values that
    /// are not finite.
    pub fn read(bytes: &[u8]) -> Result<Self> {
        Self::parsed(bytes).map_err(|found| refused("condensed body", found).into())
    }

    fn parsed(bytes: &[u8]) -> std::result::Result<Self, String> {
        let (_, header) = SafeTensors::read_metadata(bytes).map_err(|cause| cause.to_string())?;
        let line = header.metadata().as_ref().and_then(|lines| lines.get("railspring"));
        let line = line.ok_or("no metadata of a condensed body")?;
        let metadata: HashMap<String, String> =
            serde_json::from_str(line).map_err(|cause| cause.to_string())?;
        let entry = |name: &str| metadata.get(name).ok_or_else(|| format!("no {name}"));
        if entry("format")? != FORMAT {
            return Err(format!("the layout `{}`", entry("format")?));
        }
        let tensors = SafeTensors::deserialize(bytes).map_err(|cause| cause.to_string())?;
        let values = |name: &str, kind: Dtype| -> std::result::Result<(Vec<usize>, Vec<[u8; 8]>), String> {
            let tensor = tensors.tensor(name).map_err(|cause| cause.to_string())?;
            if tensor.dtype() != kind {
                return Err(format!("{name} of {:?}", tensor.dtype()));
            }
            let (values, _) = tensor.data().as_chunks::<8>();
            Ok((tensor.shape().to_vec(), values.to_vec()))
        };
        let reals = |name: &str| -> std::result::Result<(Vec<usize>, Vec<f64>), String> {
            let (shape, values) = values(name, Dtype::F64)?;
            let values: Vec<f64> = values.into_iter().map(f64::from_le_bytes).collect();
            match values.iter().find(|v| !v.is_finite()) {
                Some(value) => Err(format!("{name} with the value {value}")),
                None => Ok((shape, values)),
            }
        };
        let (_, compliance) = reals("compliance")?;
        let (_, nodes) = reals("nodes")?;
        let (along_profile, along_track) = (reals("along_profile")?.1, reals("along_track")?.1);
        let (_, numbers) = values("node_numbers", Dtype::U64)?;
        let numbers: Vec<usize> = numbers.into_iter().map(|n| u64::from_le_bytes(n) as usize).collect();
        let count = along_profile.len() * along_track.len();
        let size = (0..).find(|size| triangle(*size) >= compliance.len()).unwrap_or_default();
        let is_triangle = compliance.len() == triangle(size) && size >= 3 * count;
        if !is_triangle || nodes.len() != 3 * count || numbers.len() != count {
            return Err(format!("a compliance of {} values for {count} contact nodes", compliance.len()));
        }
        let nodes: Vec<Point3<f64>> = nodes.chunks_exact(3).map(|p| Point3::new(p[0], p[1], p[2])).collect();
        let section = if tensors.tensor("section_moved").is_ok() {
            let (shape, moved) = reals("section_moved")?;
            let (flexibility, centre) = (reals("section_flexibility")?.1, reals("shear_centre")?.1);
            if shape != [3, 3 * count] || flexibility.len() != 9 || centre.len() != 2 {
                return Err(format!("a motion of the section of shape {shape:?} for {count} contact nodes"));
            }
            Some(SectionMotion {
                shear_centre: Point2::new(centre[0], centre[1]),
                flexibility: Matrix3::from_column_slice(&flexibility),
                nodes: nodes.iter().map(|p| Point2::new(p.y, p.z)).collect(),
                moved: [0, 1, 2].map(|k| moved[3 * count * k..3 * count * (k + 1)].to_vec()),
            })
        } else {
            None
        };
        let modes = if tensors.tensor("mode_shapes").is_ok() {
            let (shapes, stiffness) = (reals("mode_shapes")?, reals("mode_stiffness")?);
            let (coupling, rigid) = (reals("mode_coupling")?, reals("rigid_mass")?);
            let master = reals("master")?.1;
            let n = shapes.0.first().copied().unwrap_or(0);
            let suit = shapes.0 == [n, 3 * count]
                && stiffness.0 == [n, n]
                && coupling.0 == [6, n]
                && rigid.0 == [6, 6]
                && master.len() == 3;
            if !suit {
                return Err(format!("modes of shape {:?} for {count} contact nodes", shapes.0));
            }
            Some(Modes {
                contact: Mat::from_fn(3 * count, n, |row, mode| shapes.1[mode * 3 * count + row]),
                stiffness: DMatrix::from_column_slice(n, n, &stiffness.1),
                coupling: DMatrix::from_row_slice(6, n, &coupling.1),
                rigid: Matrix6::from_column_slice(&rigid.1),
                master: Point3::new(master[0], master[1], master[2]),
            })
        } else {
            None
        };
        let number = |name: &str| {
            let text = entry(name)?;
            let number: Option<f64> = text.parse().ok().filter(|value: &f64| value.is_finite());
            number.ok_or_else(|| format!("{name} = {text}"))
        };
        Ok(Self {
            key: entry("key")?.clone(),
            compliance: Arc::new(Mat::from_fn(size, size, |row, column| {
                compliance[triangle(row.max(column)) + row.min(column)]
            })),
            grid: SurfaceGrid { along_profile, along_track, nodes: numbers },
            nodes,
            equations: entry("equations")?.parse().map_err(|_| "equations that are no number".to_string())?,
            mass: number("mass_kg")?,
            surface: Material {
                young: number("young_pa")?,
                poisson: number("poisson")?,
                density: number("density_kg_per_m3")?,
                damping: 0.0,
            },
            section,
            modes,
            of: entry("of")?.clone(),
            file: None,
        })
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use railspring_testing::fuzz::{Corpus, Effort, Fate};

    use super::*;

    /// A body of two by two contact nodes with made-up numbers.
    fn body() -> CondensedBody {
        let value = |row: usize, column: usize| 1e-9 / (1.0 + row.abs_diff(column) as f64);
        let nodes: Vec<Point3<f64>> =
            [[0.0, 0.0], [0.0, 6e-3], [8e-3, 0.0], [8e-3, 6e-3]].map(|[x, y]| Point3::new(x, y, 1e-3)).into();
        CondensedBody {
            key: "a key".into(),
            compliance: Arc::new(Mat::from_fn(12, 12, value)),
            grid: SurfaceGrid {
                along_profile: vec![0.0, 6e-3],
                along_track: vec![0.0, 8e-3],
                nodes: vec![3, 7, 11, 15],
            },
            section: Some(SectionMotion {
                shear_centre: Point2::new(0.0, 0.1),
                flexibility: Matrix3::identity() * 1e-9,
                nodes: nodes.iter().map(|p| Point2::new(p.y, p.z)).collect(),
                moved: [0, 1, 2].map(|k| (0..12).map(|row| value(row, k)).collect()),
            }),
            modes: Some(Modes {
                contact: Mat::from_fn(12, 2, |row, mode| value(row, 5 * mode)),
                stiffness: DMatrix::identity(2, 2) * 1e6,
                coupling: DMatrix::from_element(6, 2, 0.5),
                rigid: Matrix6::identity() * 300.0,
                master: Point3::new(0.0, 0.0, -0.4),
            }),
            nodes,
            equations: 96,
            mass: 300.0,
            surface: Material { damping: 0.0, ..Material::STEEL },
            of: "numbers".into(),
            file: None,
        }
    }

    /// Goal: mutated files are read or refused, without a panic and in time; all numbers of what is read are finite, and it is read again as it is written.
    fn fuzzed(effort: Effort) {
        let whole = body();
        assert_eq!(CondensedBody::read(&whole.write()).unwrap(), whole);
        Corpus::of(vec![("body".into(), whole.write())]).fuzz("condensed bodies", effort, |_, bytes| {
            let read = match CondensedBody::read(bytes) {
                Ok(read) => read,
                Err(error) => return Fate::Refused(error.to_string()),
            };
            let Material { young, poisson, density, .. } = read.surface;
            if ![read.mass, young, poisson, density].iter().all(|value| value.is_finite()) {
                return Fate::Silent("a number that is not finite".into());
            }
            match CondensedBody::read(&read.write()) {
                Ok(again) if again == read => Fate::Read,
                Ok(_) => Fate::Silent("another body when it is read again".into()),
                Err(error) => Fate::Silent(format!("refused when it is read again: {error}")),
            }
        });
    }

    #[test]
    fn mutated_files_are_read_or_refused() {
        fuzzed(Effort::Time(Duration::from_secs(5)));
    }

    /// Goal: no file of a condensed body makes a panic or a hang in ten minutes of mutated bytes.
    #[test]
    #[ignore = "ten minutes: cargo long fuzz"]
    fn ten_minutes_of_fuzzed_bodies() {
        fuzzed(Effort::Time(Duration::from_secs(600)));
    }
}
