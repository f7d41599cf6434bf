//! Sections of rails drawn from the six dimensions that catalogues give: height, foot, head, web, and the depths of head and foot.
//!
//! Slopes and radii are those that most flat-bottom rails have: sides 1:20, underside of the head and top of the foot 1:4, a crown of R300 and
//! R80 with corners of R13. A body under a measured head needs no more: its stiffness against the rail's section depends on the head's width, the
//! web's thickness and the height.

use nalgebra::Vector2;
use serde::Serialize;

use super::rail_drawings::{Drawing, Foot, Head, Neck, Web};
use super::rails::{RailOutline, outline_of};
use crate::error::{InputError, Result};
use crate::field::InputField;
use crate::root::bisection;
use crate::units::{MILLIMETRE, in_millimetres};

/// The dimensions of a flat-bottom rail, m.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RailDimensions {
    /// Height.
    pub height: f64,
    /// Width of the foot.
    pub foot: f64,
    /// Width of the head, 14 mm below the top.
    pub head: f64,
    /// Least thickness of the web.
    pub web: f64,
    /// Depth of the head: from the top to where the slopes of its underside meet on the axis; `None` is 0.28 of the height.
    pub head_depth: Option<f64>,
    /// Depth of the foot: from where the slopes of its top meet on the axis to the bottom; `None` is 0.175 of the height.
    pub foot_depth: Option<f64>,
}

/// A rail of a catalogue.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CatalogueRail {
    /// Its name there.
    pub name: &'static str,
    dimensions: [f64; 4],
    depths: [Option<f64>; 2],
    /// Mass that the catalogue gives, kg/m.
    pub mass: Option<f64>,
}

const fn rail(
    name: &'static str,
    dimensions: [f64; 4],
    depths: [Option<f64>; 2],
    mass: Option<f64>,
) -> CatalogueRail {
    CatalogueRail { name, dimensions, depths, mass }
}

/// Rails by their dimensions in mm: height, foot, head, web; depths of head and foot; mass in kg/m. From lists of suppliers of AREMA's rails (RE), and of
/// those of Australia (AS), Japan (JIS), China (CHN) and Russia (R); the drawings of the standards are not public.
pub const CATALOGUE_RAILS: [CatalogueRail; 18] = [
    rail("100RE", [152.40, 136.53, 68.26, 14.29], [None; 2], Some(50.35)),
    rail("115RE", [168.28, 139.70, 69.06, 15.88], [Some(42.86), Some(28.58)], Some(56.80)),
    rail("119RE", [173.04, 139.70, 67.47, 15.88], [None; 2], Some(58.86)),
    rail("132RE", [180.98, 152.40, 76.20, 16.67], [None; 2], Some(65.33)),
    rail("133RE", [179.39, 152.40, 76.20, 17.46], [None; 2], Some(66.10)),
    rail("136RE", [185.74, 152.40, 74.61, 17.46], [Some(49.21), Some(30.16)], Some(67.42)),
    rail("141RE", [188.91, 152.40, 77.79, 17.46], [Some(54.77), Some(30.16)], Some(69.80)),
    rail("AS60", [170.0, 146.0, 70.0, 16.5], [Some(49.0), Some(28.0)], Some(60.6)),
    rail("AS68", [185.7, 152.4, 74.6, 17.5], [Some(49.2), Some(30.2)], None),
    rail("JIS-37A", [122.24, 122.24, 62.71, 13.49], [Some(36.12), Some(21.43)], None),
    rail("JIS-40N", [140.0, 122.0, 64.0, 14.0], [Some(41.0), Some(25.5)], None),
    rail("JIS-50N", [153.0, 127.0, 65.0, 15.0], [Some(49.0), Some(30.0)], None),
    rail("JIS-60", [174.0, 145.0, 65.0, 16.5], [Some(49.0), Some(30.1)], None),
    rail("CHN50", [152.0, 132.0, 70.0, 15.5], [Some(42.0), None], Some(51.51)),
    rail("CHN60", [176.0, 150.0, 73.0, 16.5], [Some(48.5), None], Some(60.64)),
    rail("CHN75", [192.0, 150.0, 75.0, 20.0], [Some(55.3), None], Some(74.41)),
    rail("R50", [152.0, 132.0, 72.0, 16.0], [None; 2], Some(51.67)),
    rail("R65", [180.0, 150.0, 75.0, 18.0], [None; 2], Some(64.72)),
];

impl CatalogueRail {
    /// Its dimensions.
    pub fn dimensions(&self) -> RailDimensions {
        let [height, foot, head, web] = self.dimensions.map(|mm| mm * MILLIMETRE);
        let depth = |i: usize| self.depths[i].map(|depth| depth * MILLIMETRE);
        RailDimensions { height, foot, head, web, head_depth: depth(0), foot_depth: depth(1) }
    }
}

/// The catalogue's rail `name`.
pub fn catalogue_rail(name: &str) -> Option<&'static CatalogueRail> {
    CATALOGUE_RAILS.iter().find(|rail| rail.name == name)
}

/// Outline of a rail with the dimensions.
///
/// # Errors
/// [`InputError`] naming `rail_body` for a dimension that no rail has, and for dimensions of which there is no section.
pub fn rail_of_dimensions(dimensions: &RailDimensions) -> Result<RailOutline> {
    /// Slope of the underside of the head and of the top of the foot, depth over width.
    const FISHING: f64 = 0.25;
    /// Least thickness of the foot at its toe, mm.
    const TOE: f64 = 7.0;
    /// Radius between the web and the slopes, mm.
    const FILLET: f64 = 22.0;
    let refuse = |what: &str, value: f64, expected: String| {
        let remedy = "check the dimension and its unit";
        InputError::refuse(
            InputField::RailBody,
            format!("{what} of {} mm", in_millimetres(value)),
            expected,
            remedy,
        )
    };
    let RailDimensions { height, foot, head, web, head_depth, foot_depth } = *dimensions;
    for (what, value, [least, greatest]) in [
        ("height", height, [60.0, 230.0]),
        ("foot", foot, [50.0, 220.0]),
        ("head", head, [30.0, 100.0]),
        ("web", web, [6.0, 40.0]),
        ("head_depth", head_depth.unwrap_or(0.04), [20.0, 80.0]),
        ("foot_depth", foot_depth.unwrap_or(0.03), [10.0, 60.0]),
    ] {
        if !(least..=greatest).contains(&(value / MILLIMETRE)) {
            return refuse(what, value, format!("{least} to {greatest} mm"));
        }
    }
    let in_mm = |value: f64| value / MILLIMETRE;
    let (height, half_foot, half_head, half_web) =
        (in_mm(height), 0.5 * in_mm(foot), 0.5 * in_mm(head), 0.5 * in_mm(web));
    let apex = head_depth.map_or(0.28 * height, in_mm);
    let foot_depth = foot_depth.map_or(0.175 * height, in_mm);
    let slope = FISHING.min((foot_depth - TOE) / half_foot);
    let between = height - foot_depth - apex;
    let lower_edge = apex - FISHING * half_head;
    // the fillets of head and foot, and a straight piece of web between them
    if slope <= 0.02 || between < 2.0 * FILLET || lower_edge < 20.0 || half_head < half_web + FILLET {
        return refuse(
            "height",
            dimensions.height,
            format!(
                "a section whose head, web and foot have room: {between:.1} mm between head and foot, a head {lower_edge:.1} mm deep at its side"
            ),
        );
    }
    // The corner begins where the side has its place 14 mm below the top.
    let joints = joints(half_head);
    let drawing = Drawing {
        head: Head {
            radii: RADII.to_vec(),
            joints: joints.to_vec(),
            side_slope: SIDE,
            lower_corner: 3.0,
            apex,
        },
        fishing_slope: slope,
        web: Web { half_thickness: half_web, upper: Neck::plain(FILLET), lower: Neck::plain(FILLET) },
        foot: Foot {
            apex: height - foot_depth,
            outer: None,
            half_width: half_foot,
            toe: [3.0, 2.0],
            bottom: height,
        },
    };
    Ok(outline_of(&drawing))
}

/// Crown, shoulder and corner of the head, mm.
const RADII: [f64; 3] = [300.0, 80.0, 13.0];
/// Inclination of the side of the head: width over depth.
const SIDE: f64 = 1.0 / 20.0;
/// Depth at which the width of a head is given, mm.
const WIDTH_DEPTH: f64 = 14.0;

/// Half-widths at which the arcs of the head give way to each other, mm, so that the head is twice `half_head` wide 14 mm below its top.
fn joints(half_head: f64) -> [f64; 2] {
    /// Where the crown ends, of half the width: as on 60E1.
    const CROWN: f64 = 0.28;
    let crown = CROWN * half_head;
    let half_width = |shoulder: f64| {
        let mut centre = Vector2::new(0.0, RADII[0]);
        for (i, y) in [crown, shoulder].into_iter().enumerate() {
            let reach = y - centre.x;
            let joint = Vector2::new(y, centre.y - (RADII[i] * RADII[i] - reach * reach).sqrt());
            centre += (1.0 - RADII[i + 1] / RADII[i]) * (joint - centre);
        }
        let end = centre + RADII[2] * Vector2::new(1.0, -SIDE).normalize();
        end.x + SIDE * (WIDTH_DEPTH - end.y)
    };
    [crown, bisection(crown, half_head, |shoulder| half_width(shoulder) > half_head)]
}
