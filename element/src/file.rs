//! An element as a file in the safetensors format, which other languages read, too; `docs/element-file.md` has its fields.

use crate::curve::Curve;
use crate::element::{About, Element, RailMode, RailModes};
use crate::head::{Head, HeadAt, VALUES};
use crate::law::{StripPlace, StripStiffness};
use crate::modulus::StripModulus;
use crate::relief::Influence;
use crate::wheel::{ElasticWheel, RimMode};
use nalgebra::{Matrix3, Point2, Vector3};
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::input;
use railspring_profiles::placement::PlacedRail;
use railspring_profiles::profile::{CurveParts, ProfileCurve};
use safetensors::tensor::{Dtype, SafeTensors, TensorView, serialize};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::path::Path;

/// Layout of the file. A reader takes this one alone.
pub const FORMAT: &str = "railspring element 2";

/// Largest file that is read, bytes, and most rows of a tensor.
const LARGEST: u64 = 64 << 20;

/// Stands for the hash of the contents while that is computed.
const NO_HASH: &str = "0000000000000000000000000000000000000000000000000000000000000000";

/// What is not a tensor. Lengths are in m, angles in rad.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Plain {
    format: String,
    contents_blake3: String,
    about: About,
    rail_angle_rad: f64,
    rail_origin_m: [f64; 2],
    wheel_origin_m: [f64; 2],
    node_line_m: [f64; 2],
    hub_m: [f64; 2],
    wheel_damping_s: f64,
    relief_m2_per_n: f64,
    friction: f64,
    /// Length of a rail with held ends; none of one whose head is everywhere the same.
    rail_length_m: Option<f64>,
    /// Place and damping of the rail by its modes.
    rail_at_wheel: Option<RailHead>,
}

#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RailHead {
    place_m: f64,
    damping_s: f64,
}

fn refused(name: &str, found: String) -> InputError {
    let remedy = "write it again with `railspring element` of this version";
    InputError::new(name, found, format!("a contact element of the layout `{FORMAT}`"), remedy)
}

/// BLAKE3 of the text of the head, with zeros for its `hash`, and of the tensors in the bytes of a `file`, whose first eight are the length of what is
/// before the tensors.
fn contents(head: &str, hash: &str, file: &[u8]) -> String {
    let length = file.first_chunk().map_or(0, |bytes| u64::from_le_bytes(*bytes));
    let tensors = usize::try_from(length).ok().and_then(|length| file.get(length.checked_add(8)?..));
    let mut hasher = blake3::Hasher::new();
    hasher.update(head.replacen(hash, NO_HASH, 1).as_bytes()).update(tensors.unwrap_or_default());
    hasher.finalize().to_hex().to_string()
}

/// A file with the hash of what is in it, as one has who forges it; none of bytes that have no place for it.
#[cfg(test)]
pub(crate) fn with_own_hash(bytes: &[u8]) -> Option<Vec<u8>> {
    let (_, header) = SafeTensors::read_metadata(bytes).ok()?;
    let line = header.metadata().as_ref()?.get("railspring")?;
    let hash = serde_json::from_str::<serde_json::Value>(line).ok()?["contents_blake3"].as_str()?.to_owned();
    if hash.len() != NO_HASH.len() {
        return None;
    }
    let at = bytes.windows(hash.len()).position(|window| window == hash.as_bytes())?;
    let own = contents(line, &hash, bytes);
    let mut bytes = bytes.to_vec();
    bytes.splice(at..at + hash.len(), own.bytes());
    Some(bytes)
}

fn rows<const N: usize>(values: impl IntoIterator<Item = [f64; N]>) -> (Vec<usize>, Vec<f64>) {
    let values: Vec<f64> = values.into_iter().flatten().collect();
    (vec![values.len() / N, N], values)
}

fn by_rows(m: &Matrix3<f64>) -> [f64; 9] {
    std::array::from_fn(|i| m[(i / 3, i % 3)])
}

fn of_curve(name: &str, curve: &ProfileCurve, into: &mut Vec<(String, Vec<usize>, Vec<f64>)>) {
    let CurveParts { knots, cubics, breaks } = curve.parts();
    let breaks: Vec<f64> = breaks.iter().map(|&at| at as f64).collect();
    into.push((format!("{name}.knots"), vec![knots.len()], knots));
    let (shape, cubics) = rows(cubics);
    into.push((format!("{name}.cubics"), shape, cubics));
    into.push((format!("{name}.breaks"), vec![breaks.len()], breaks));
}

impl Element {
    /// The element as a file. The same element gives the same bytes.
    ///
    /// # Panics
    /// Never: the shapes are those of the data.
    pub fn write(&self) -> Vec<u8> {
        let mut tensors: Vec<(String, Vec<usize>, Vec<f64>)> = Vec::new();
        of_curve("rail", &self.rail.curve, &mut tensors);
        of_curve("wheel", &self.wheel_profile, &mut tensors);
        let mut put = |name: &str, (shape, values): (Vec<usize>, Vec<f64>)| {
            tensors.push((name.to_string(), shape, values));
        };
        let square = |m: &Matrix3<f64>| (vec![3, 3], by_rows(m).to_vec());
        put(
            "strips",
            rows(self.strips.places().iter().map(|StripPlace { rail_s, modulus }| {
                [*rail_s, modulus.normal, modulus.hardening, modulus.tangential, modulus.relief]
            })),
        );
        put("head.on_section", square(&self.head_on_section));
        put("wheel.mass", square(&self.wheel.mass));
        put("wheel.rest", square(&self.wheel.rest));
        put(
            "wheel.modes",
            rows(self.wheel.modes.iter().map(|RimMode { square, rim, coupling }| {
                [*square, rim.x, rim.y, rim.z, coupling.x, coupling.y, coupling.z]
            })),
        );
        let length = match &self.head {
            Head::Same(head) => {
                put("head", rows([head.values()]));
                None
            }
            Head::ByDistance(length, curve) => {
                put("head", rows(curve.places().iter().map(|(_, values)| *values)));
                let places: Vec<f64> = curve.places().iter().map(|(place, _)| *place).collect();
                put("head.distance", (vec![places.len()], places));
                Some(*length)
            }
        };
        if let Some(rail) = &self.rail_at_wheel {
            put(
                "rail.modes",
                rows(
                    rail.modes
                        .iter()
                        .map(|RailMode { square, section }| [*square, section.x, section.y, section.z]),
                ),
            );
            put("rail.rest", square(&rail.rest));
        }
        let bytes: Vec<(String, Vec<usize>, Vec<u8>)> = tensors
            .into_iter()
            .map(|(name, shape, values)| (name, shape, values.iter().flat_map(|v| v.to_le_bytes()).collect()))
            .collect();
        let views = bytes.iter().map(|(name, shape, bytes)| {
            let view = TensorView::new(Dtype::F64, shape.clone(), bytes);
            (name.as_str(), view.expect("as many bytes as the shape says"))
        });
        let head = Plain {
            format: FORMAT.into(),
            contents_blake3: NO_HASH.into(),
            about: self.about.clone(),
            rail_angle_rad: self.rail.angle,
            rail_origin_m: self.rail.origin.into(),
            wheel_origin_m: self.tape.into(),
            node_line_m: self.node_line.into(),
            hub_m: self.wheel.hub,
            wheel_damping_s: self.damping,
            relief_m2_per_n: self.strips.influence.flexibility,
            friction: self.friction,
            rail_length_m: length,
            rail_at_wheel: self
                .rail_at_wheel
                .as_ref()
                .map(|rail| RailHead { place_m: rail.place, damping_s: rail.damping }),
        };
        let line = serde_json::to_string(&head).expect("numbers and strings are plain JSON");
        let file = |line: &str| {
            let lines = HashMap::from([("railspring".to_string(), line.to_string())]);
            serialize(views.clone(), Some(lines)).expect("names and shapes are plain")
        };
        let hash = contents(&line, NO_HASH, &file(&line));
        file(&line.replacen(NO_HASH, &hash, 1))
    }

    /// Reads a file with what [`Element::write`] wrote.
    ///
    /// # Errors
    /// [`InputError`] with the file: one that cannot be read, and as [`Element::read`].
    pub fn open(path: &Path) -> Result<Self> {
        let name = path.display().to_string();
        let bytes = input::read(path, LARGEST).map_err(|cause| {
            InputError::new(&name, cause, "a file as `railspring element` writes it", "check the path")
        })?;
        Ok(Self::parsed(&bytes).map_err(|found| refused(&name, found))?)
    }

    /// Reads what [`Element::write`] wrote.
    ///
    /// # Errors
    /// [`InputError`] for bytes of another layout, and for values that no element has.
    pub fn read(bytes: &[u8]) -> Result<Self> {
        Ok(Self::parsed(bytes).map_err(|found| refused("element", found))?)
    }

    fn parsed(bytes: &[u8]) -> std::result::Result<Self, String> {
        let (_, header) = SafeTensors::read_metadata(bytes).map_err(|cause| cause.to_string())?;
        let line = header.metadata().as_ref().and_then(|lines| lines.get("railspring"));
        let line = line.ok_or("no metadata of a contact element")?;
        #[derive(Deserialize)]
        struct Layout {
            format: String,
        }
        let Layout { format } = serde_json::from_str(line).map_err(|cause| cause.to_string())?;
        if format != FORMAT {
            return Err(format!("the layout `{format}`"));
        }
        let head: Plain = serde_json::from_str(line).map_err(|cause| cause.to_string())?;
        if contents(line, &head.contents_blake3, bytes) != head.contents_blake3 {
            return Err("contents that are not those that were written (contents_blake3)".into());
        }
        let file = Tensors(SafeTensors::deserialize(bytes).map_err(|cause| cause.to_string())?);
        let strips = file.rows::<5>("strips")?;
        let wheel = ElasticWheel {
            mass: file.square("wheel.mass")?,
            hub: head.hub_m,
            modes: file
                .rows::<7>("wheel.modes")?
                .into_iter()
                .map(|[square, ry, rz, rr, cy, cz, cr]| RimMode {
                    square,
                    rim: Vector3::new(ry, rz, rr),
                    coupling: Vector3::new(cy, cz, cr),
                })
                .collect(),
            rest: file.square("wheel.rest")?,
        };
        let places = file.rows::<VALUES>("head")?;
        let of_head = match head.rail_length_m {
            None => Head::Same(HeadAt::of_values(places.first().copied().ok_or("no head")?)),
            Some(length) => {
                let distances = file.reals("head.distance", 1)?.1;
                let ascend = distances.is_sorted_by(|a, b| a < b);
                if distances.len() != places.len() || places.len() < 2 || !ascend || !(length > 0.0) {
                    return Err("places of the head that do not ascend along a rail".into());
                }
                Head::ByDistance(length, Curve::new(distances.into_iter().zip(places).collect()))
            }
        };
        let rail_at_wheel = match head.rail_at_wheel {
            None => None,
            Some(RailHead { place_m: place, damping_s: damping }) => {
                let modes = file.rows::<4>("rail.modes")?;
                let mode = |[square, y, z, r]: [f64; 4]| RailMode { square, section: Vector3::new(y, z, r) };
                let modes = modes.into_iter().map(mode).collect();
                Some(RailModes { place, damping, modes, rest: file.square("rail.rest")? })
            }
        };
        let strip = |[rail_s, normal, hardening, tangential, relief]: [f64; 5]| StripPlace {
            rail_s,
            modulus: StripModulus { normal, hardening, tangential, relief },
        };
        let element = Self {
            rail: PlacedRail {
                curve: file.curve("rail")?,
                angle: head.rail_angle_rad,
                origin: Point2::from(head.rail_origin_m),
            },
            wheel_profile: file.curve("wheel")?,
            tape: Point2::from(head.wheel_origin_m),
            node_line: Point2::from(head.node_line_m),
            wheel,
            damping: head.wheel_damping_s,
            head: of_head,
            head_on_section: file.square("head.on_section")?,
            strips: StripStiffness::new(
                strips.into_iter().map(strip).collect(),
                Influence { flexibility: head.relief_m2_per_n },
                head.about.strips_max_rel_error,
            ),
            friction: head.friction,
            rail_at_wheel,
            about: head.about,
        };
        element.check()?;
        Ok(element)
    }

    /// Whether an element can have such values.
    fn check(&self) -> std::result::Result<(), String> {
        let places = self.strips.places();
        let Some((first, last)) = places.first().zip(places.last()) else {
            return Err("no strips".into());
        };
        let apart = (last.rail_s - first.rail_s) / (places.len().max(2) - 1) as f64;
        let even = |(i, place): (usize, &StripPlace)| {
            (place.rail_s - first.rail_s - apart * i as f64).abs() <= 1e-6 * apart.abs().max(1e-6)
        };
        if !(places.len() == 1 || apart > 0.0) || !places.iter().enumerate().all(even) {
            return Err("strips that are not equally far apart".into());
        }
        let stiff = |StripPlace { modulus: m, .. }: &StripPlace| {
            m.normal > 0.0 && m.tangential > 0.0 && m.relief >= 0.0 && m.hardening > -1.0
        };
        if !places.iter().all(stiff) {
            return Err("a strip that does not resist".into());
        }
        let positive = |m: &Matrix3<f64>| {
            let symmetric = (m - m.transpose()).amax() <= 1e-9 * m.amax();
            symmetric && (0..3).all(|i| m[(i, i)] >= 0.0)
        };
        let heads: Vec<[f64; VALUES]> = match &self.head {
            Head::Same(head) => vec![head.values()],
            Head::ByDistance(_, curve) => curve.places().iter().map(|(_, values)| *values).collect(),
        };
        // shares and flexibilities on their own motions
        if !heads.iter().all(|values| [0, 2, 3, 4, 7, 9].iter().all(|i| values[*i] >= 0.0)) {
            return Err("a head that does not resist".into());
        }
        let mass = self.superelement().mass;
        if mass.clone().cholesky().is_none() {
            return Err("a wheel whose mass is not positive".into());
        }
        let moves = self.wheel.modes.iter().all(|mode| mode.square > 0.0);
        if !positive(&self.head_on_section) {
            return Err("a head that does not resist".into());
        }
        if !(positive(&self.wheel.rest) && moves && self.damping >= 0.0) {
            return Err("a wheel that does not resist".into());
        }
        if let Some(rail) = &self.rail_at_wheel
            && !(positive(&rail.rest)
                && rail.damping >= 0.0
                && rail.modes.iter().all(|mode| mode.square > 0.0))
        {
            return Err("a rail that does not resist".into());
        }
        let scalars = [
            self.rail.angle,
            self.rail.origin.x,
            self.rail.origin.y,
            self.tape.x,
            self.tape.y,
            self.node_line.x,
            self.node_line.y,
            self.wheel.hub[0],
            self.wheel.hub[1],
        ];
        if !scalars.iter().all(|value| value.is_finite() && value.abs() < 10.0) {
            return Err("places (m) or angles (rad) out of range".into());
        }
        if !(0.0..=10.0).contains(&self.friction) || !(self.strips.influence.flexibility >= 0.0) {
            return Err("a friction or relief out of range".into());
        }
        Ok(())
    }
}

/// Tensors of finite numbers.
struct Tensors<'b>(SafeTensors<'b>);

impl Tensors<'_> {
    fn reals(&self, name: &str, rank: usize) -> std::result::Result<(Vec<usize>, Vec<f64>), String> {
        let tensor = self.0.tensor(name).map_err(|cause| cause.to_string())?;
        if tensor.dtype() != Dtype::F64 || tensor.shape().len() != rank {
            return Err(format!("{name} of {:?} and shape {:?}", tensor.dtype(), tensor.shape()));
        }
        let (values, _) = tensor.data().as_chunks::<8>();
        let values: Vec<f64> = values.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
        match values.iter().find(|value| !value.is_finite()) {
            Some(value) => Err(format!("{name} with the value {value}")),
            None => Ok((tensor.shape().to_vec(), values)),
        }
    }

    fn rows<const N: usize>(&self, name: &str) -> std::result::Result<Vec<[f64; N]>, String> {
        let (shape, values) = self.reals(name, 2)?;
        if shape[1] != N {
            return Err(format!("{name} of shape {shape:?}"));
        }
        Ok(values.as_chunks::<N>().0.to_vec())
    }

    fn square(&self, name: &str) -> std::result::Result<Matrix3<f64>, String> {
        match &self.rows::<3>(name)?[..] {
            [a, b, c] => Ok(Matrix3::from_fn(|i, j| [a, b, c][i][j])),
            rows => Err(format!("{name} with {} rows", rows.len())),
        }
    }

    fn curve(&self, name: &str) -> std::result::Result<ProfileCurve, String> {
        let knots = self.reals(&format!("{name}.knots"), 1)?.1;
        let cubics = self.rows::<8>(&format!("{name}.cubics"))?;
        let breaks = self.reals(&format!("{name}.breaks"), 1)?.1;
        let breaks = breaks.iter().map(|at| *at as usize).collect();
        ProfileCurve::from_parts(&CurveParts { knots, cubics, breaks })
            .map_err(|error| format!("{name}: {error}"))
    }
}
