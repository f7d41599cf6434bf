//! Drawings in DXF as text, of lines and arcs.

/// A line or an arc of a drawing, y up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Entity {
    /// From one end to the other.
    Line([[f64; 2]; 2]),
    /// The shorter way round between two ends about a centre.
    Arc {
        /// Its ends.
        ends: [[f64; 2]; 2],
        /// Its centre.
        centre: [f64; 2],
    },
}

impl Entity {
    /// Its group codes and values, on a layer.
    #[must_use]
    pub fn text(&self, layer: &str) -> String {
        match self {
            Self::Line([[ax, ay], [bx, by]]) => {
                format!("0\nLINE\n8\n{layer}\n10\n{ax}\n20\n{ay}\n30\n0.0\n11\n{bx}\n21\n{by}\n31\n0.0\n")
            }
            Self::Arc { ends, centre: [x, y] } => {
                // an arc of DXF goes round counter-clockwise, from the end from which that is the shorter way
                let [a, b] = ends.map(|[px, py]| [px - x, py - y]);
                let [from, to] = if a[0] * b[1] - a[1] * b[0] > 0.0 { [a, b] } else { [b, a] };
                let [from, to] = [from, to].map(|[x, y]| y.atan2(x).to_degrees());
                let radius = a[0].hypot(a[1]);
                format!("0\nARC\n8\n{layer}\n10\n{x}\n20\n{y}\n30\n0.0\n40\n{radius}\n50\n{from}\n51\n{to}\n")
            }
        }
    }
}

/// A drawing of these entities alone.
#[must_use]
pub fn drawing(entities: impl IntoIterator<Item = Entity>) -> String {
    let entities: String = entities.into_iter().map(|entity| entity.text("0")).collect();
    format!("0\nSECTION\n2\nENTITIES\n{entities}0\nENDSEC\n0\nEOF\n")
}
