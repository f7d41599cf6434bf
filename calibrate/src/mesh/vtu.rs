//! VTK XML files of unstructured grids, read by ParaView and meshio, and collections of them.

use std::fmt::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use nalgebra::{Point3, Vector3};

use railspring_profiles::error::{InputError, Result};

/// Cells of a grid.
#[derive(Debug, Clone, Copy)]
pub enum Cells<'a> {
    /// 8-node hexahedra in the order of VTK.
    Hexes(&'a [[usize; 8]]),
    /// 4-node quadrilaterals, and points that are a corner of none: a grid without a cell is no grid to most readers.
    Surface {
        /// The quadrilaterals.
        quads: &'a [[usize; 4]],
        /// The single points.
        points: &'a [usize],
    },
}

impl Cells<'_> {
    fn len(&self) -> usize {
        match self {
            Self::Hexes(cells) => cells.len(),
            Self::Surface { quads, points } => quads.len() + points.len(),
        }
    }
}

/// Values at every point or cell, with the name under which they are shown.
#[derive(Debug, Clone, Copy)]
pub enum Field<'a> {
    /// One value each.
    Scalar(&'a str, &'a [f64]),
    /// A vector each.
    Vector(&'a str, &'a [Vector3<f64>]),
    /// A symmetric tensor each: xx, yy, zz, xy, yz, xz.
    SymmetricTensor(&'a str, &'a [[f64; 6]]),
}

impl Field<'_> {
    fn name(&self) -> &str {
        match self {
            Self::Scalar(name, _) | Self::Vector(name, _) | Self::SymmetricTensor(name, _) => name,
        }
    }

    fn len(&self) -> usize {
        match self {
            Self::Scalar(_, values) => values.len(),
            Self::Vector(_, values) => values.len(),
            Self::SymmetricTensor(_, values) => values.len(),
        }
    }

    fn write(&self, out: &mut String) {
        let name = escape(self.name());
        match self {
            Self::Scalar(_, values) => array(out, &format!("Name=\"{name}\""), values.iter().copied()),
            Self::Vector(_, values) => array(
                out,
                &format!("Name=\"{name}\" NumberOfComponents=\"3\""),
                values.iter().flat_map(|v| [v.x, v.y, v.z]),
            ),
            Self::SymmetricTensor(_, values) => {
                let components: String = ["XX", "YY", "ZZ", "XY", "YZ", "XZ"]
                    .iter()
                    .enumerate()
                    .map(|(k, c)| format!(" ComponentName{k}=\"{c}\""))
                    .collect();
                array(
                    out,
                    &format!("Name=\"{name}\" NumberOfComponents=\"6\"{components}"),
                    values.iter().flatten().copied(),
                );
            }
        }
    }
}

/// A grid with its data, as the text of a VTU file.
///
/// # Errors
/// When a field has not one value for every point or cell.
pub fn vtu(
    points: &[Point3<f64>],
    cells: Cells,
    point_data: &[Field],
    cell_data: &[Field],
) -> Result<String> {
    for (fields, count, what) in [(point_data, points.len(), "point"), (cell_data, cells.len(), "cell")] {
        for field in fields {
            if field.len() != count {
                return InputError::refuse(
                    format!("{what} data {}", field.name()),
                    format!("{} values", field.len()),
                    format!("{count} values, one for every {what}"),
                    "give the field of this mesh",
                );
            }
        }
    }
    Ok(document(points, cells, point_data, cell_data))
}

/// A collection of files over a parameter, as the text of a PVD file, which ParaView plays as an animation: the parameter of each file, which
/// it calls time, and its path from the collection.
pub fn pvd(entries: &[(f64, String)]) -> String {
    let mut out = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n",
    );
    for (parameter, file) in entries {
        let file = escape(file);
        let _ = writeln!(out, "<DataSet timestep=\"{parameter}\" group=\"\" part=\"0\" file=\"{file}\"/>");
    }
    out.push_str("</Collection>\n</VTKFile>\n");
    out
}

/// The whole file.
fn document(points: &[Point3<f64>], cells: Cells, point_data: &[Field], cell_data: &[Field]) -> String {
    let mut out = String::new();
    out.push_str("<?xml version=\"1.0\"?>\n");
    out.push_str("<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n");
    let _ = writeln!(
        out,
        "<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">",
        points.len(),
        cells.len()
    );
    out.push_str("<Points>\n");
    array(&mut out, "Name=\"Points\" NumberOfComponents=\"3\"", points.iter().flat_map(|p| [p.x, p.y, p.z]));
    out.push_str("</Points>\n<Cells>\n");
    // corners and kind of every cell
    const HEXAHEDRON: (usize, u8) = (8, 12);
    const QUAD: (usize, u8) = (4, 9);
    const VERTEX: (usize, u8) = (1, 1);
    let (connectivity, kinds): (Vec<usize>, Vec<(usize, u8)>) = match cells {
        Cells::Hexes(hexes) => (hexes.iter().flatten().copied().collect(), vec![HEXAHEDRON; hexes.len()]),
        Cells::Surface { quads, points } => {
            let kinds = std::iter::repeat_n(QUAD, quads.len()).chain(points.iter().map(|_| VERTEX));
            (quads.iter().flatten().chain(points).copied().collect(), kinds.collect())
        }
    };
    let ends = kinds.iter().scan(0, |end, (corners, _)| {
        *end += corners;
        Some(*end as i64)
    });
    array(&mut out, "Name=\"connectivity\"", connectivity.iter().map(|&v| v as i64));
    array(&mut out, "Name=\"offsets\"", ends);
    array(&mut out, "Name=\"types\"", kinds.iter().map(|(_, kind)| *kind));
    out.push_str("</Cells>\n<PointData>\n");
    for field in point_data {
        field.write(&mut out);
    }
    out.push_str("</PointData>\n<CellData>\n");
    for field in cell_data {
        field.write(&mut out);
    }
    out.push_str("</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
    out
}

/// A number type of a data array.
trait Number: Copy {
    const TYPE: &'static str;
    fn push(self, bytes: &mut Vec<u8>);
}

impl Number for f64 {
    const TYPE: &'static str = "Float64";
    fn push(self, bytes: &mut Vec<u8>) {
        bytes.extend(self.to_le_bytes());
    }
}

impl Number for i64 {
    const TYPE: &'static str = "Int64";
    fn push(self, bytes: &mut Vec<u8>) {
        bytes.extend(self.to_le_bytes());
    }
}

impl Number for u8 {
    const TYPE: &'static str = "UInt8";
    fn push(self, bytes: &mut Vec<u8>) {
        bytes.push(self);
    }
}

/// A data array: its length in bytes and its values, base64 together.
fn array<T: Number>(out: &mut String, attributes: &str, values: impl Iterator<Item = T>) {
    let mut data = Vec::new();
    values.for_each(|value| value.push(&mut data));
    let mut bytes = (data.len() as u64).to_le_bytes().to_vec();
    bytes.append(&mut data);
    let _ = write!(out, "<DataArray type=\"{}\" {attributes} format=\"binary\">", T::TYPE);
    STANDARD.encode_string(&bytes, out);
    out.push_str("</DataArray>\n");
}

/// A text as XML attribute.
fn escape(name: &str) -> String {
    name.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first values of the named array, decoded.
    fn decode(text: &str, name: &str) -> Vec<u8> {
        let start = text.find(&format!("Name=\"{name}\"")).unwrap();
        let data = &text[start..];
        let data = &data[data.find('>').unwrap() + 1..data.find("</DataArray>").unwrap()];
        let bytes = STANDARD.decode(data).unwrap();
        let length = u64::from_le_bytes(bytes[..8].try_into().unwrap());
        assert_eq!(length as usize, bytes.len() - 8);
        bytes[8..].to_vec()
    }

    #[test]
    fn values_come_back_bit_for_bit() {
        let points = [
            Point3::new(0.0, 0.0, 0.1),
            Point3::new(1.0, 0.0, 0.2),
            Point3::new(1.0, 1.0, 0.3),
            Point3::new(0.0, 1.0, 0.4),
        ];
        let text = document(
            &points,
            Cells::Surface { quads: &[[0, 1, 2, 3]], points: &[2] },
            &[Field::Scalar("a < \"b\"", &[0.1, 0.2, 0.3, f64::MIN_POSITIVE])],
            &[Field::SymmetricTensor("stress", &[[1.0, 2.0, 3.0, 4.0, 5.0, 6.0], [0.0; 6]])],
        );
        let floats = |bytes: Vec<u8>| -> Vec<f64> {
            bytes.chunks(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect()
        };
        assert_eq!(floats(decode(&text, "a &lt; &quot;b&quot;")), [0.1, 0.2, 0.3, f64::MIN_POSITIVE]);
        assert_eq!(floats(decode(&text, "stress"))[..6], [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!(floats(decode(&text, "Points"))[11], 0.4);
        assert_eq!(decode(&text, "types"), [9, 1]);
        assert_eq!(decode(&text, "offsets"), [4i64, 5].map(i64::to_le_bytes).concat());
    }

    #[test]
    fn a_field_of_another_mesh_is_refused_by_name() {
        let cells = Cells::Surface { quads: &[], points: &[0] };
        let error = vtu(&[Point3::origin()], cells, &[Field::Scalar("pressure", &[1.0, 2.0])], &[]);
        assert!(error.unwrap_err().to_string().starts_with("point data pressure = 2 values"));
    }

    #[test]
    fn a_collection_names_every_file_with_its_parameter() {
        let text = pvd(&[(1.5, "fields/a-01.vtu".into()), (20.0, "a & b.vtu".into())]);
        assert_eq!(text.matches("<DataSet ").count(), 2);
        assert!(text.contains("timestep=\"1.5\" group=\"\" part=\"0\" file=\"fields/a-01.vtu\"/>"), "{text}");
        assert!(text.contains("timestep=\"20\"") && text.contains("file=\"a &amp; b.vtu\""), "{text}");
    }
}
