//! The generating dimensions of the standard rails, as their drawings give them.

/// A standard rail.
pub struct StandardRail {
    /// Name, spelled as the standard does.
    pub name: &'static str,
    /// What it is and, where that is not sure, what it was checked against.
    pub description: &'static str,
    pub(super) drawing: Drawing<'static>,
}

/// What the drawing of a flat-bottom rail gives, mm; depths count from the top of the rail, slopes are depth over width.
pub(super) struct Drawing<'a> {
    pub head: Head<'a>,
    /// Slope of the underside of the head and of the inner top of the foot.
    pub fishing_slope: f64,
    pub web: Web,
    pub foot: Foot,
}

pub(super) struct Head<'a> {
    /// Radii of the arcs from the crown to the side.
    pub radii: &'a [f64],
    /// Half-widths at which each radius gives way to the next.
    pub joints: &'a [f64],
    /// Inclination of the side: width over depth.
    pub side_slope: f64,
    /// Radius of the lower corner, between the straight side and the underside.
    pub lower_corner: f64,
    /// Apex of the slopes of the underside, on the axis.
    pub apex: f64,
}

pub(super) struct Web {
    /// Half of the least thickness; the sides are straight where no arc of the necks is.
    pub half_thickness: f64,
    /// From the underside of the head into the web.
    pub upper: Neck,
    /// From the web into the foot.
    pub lower: Neck,
}

/// Concave arcs between a sloping line and the side of the web.
pub(super) struct Neck {
    pub fillet: f64,
    pub middle: Option<Middle>,
    /// Arc of the web's side; without one the side is straight up to the fillet.
    pub side: Option<SideArc>,
}

/// An arc between the fillet and the arc of the web's side, whose centre lies `rise` beyond that of the latter.
pub(super) struct Middle {
    pub radius: f64,
    pub rise: f64,
}

/// Arc of the web's side, which is thinnest at `depth`.
pub(super) struct SideArc {
    pub radius: f64,
    pub depth: f64,
}

pub(super) struct Foot {
    /// Apex of the inner slopes of the top, on the axis.
    pub apex: f64,
    /// Outer part of the top; without one the inner slope runs on to the toe.
    pub outer: Option<OuterTop>,
    pub half_width: f64,
    /// Radii of the upper and lower rounding of the toe.
    pub toe: [f64; 2],
    /// Height of the rail.
    pub bottom: f64,
}

pub(super) struct OuterTop {
    /// Radius between inner and outer slope.
    pub bend: f64,
    pub slope: f64,
    /// Depth at which the outer slope and the toe would meet in a sharp corner.
    pub corner_depth: f64,
}

impl Neck {
    /// A fillet to a straight side.
    pub(super) const fn plain(fillet: f64) -> Self {
        Self { fillet, middle: None, side: None }
    }

    /// A fillet to an arc of the web's side.
    const fn to_arc(fillet: f64, radius: f64, depth: f64) -> Self {
        Self { fillet, middle: None, side: Some(SideArc { radius, depth }) }
    }

    /// A fillet, a middle arc (`middle`: radius and rise), and an arc of the web's side.
    const fn with_middle(fillet: f64, [middle, rise]: [f64; 2], radius: f64, depth: f64) -> Self {
        Self { middle: Some(Middle { radius: middle, rise }), ..Self::to_arc(fillet, radius, depth) }
    }
}

const fn outer(bend: f64, slope: f64, corner_depth: f64) -> Option<OuterTop> {
    Some(OuterTop { bend, slope, corner_depth })
}

/// A rail of the 60 family with the given arcs of the head.
const fn family_60(radii: &'static [f64], joints: &'static [f64]) -> Drawing<'static> {
    Drawing {
        head: Head { radii, joints, side_slope: 1.0 / 20.0, lower_corner: 3.0, apex: 51.0 },
        fishing_slope: 1.0 / 2.75,
        web: Web {
            half_thickness: 8.25,
            upper: Neck::with_middle(7.0, [35.0, 19.5], 120.0, 79.75),
            lower: Neck::with_middle(7.0, [35.0, 19.5], 120.0, 111.75),
        },
        foot: Foot {
            apex: 140.5,
            outer: outer(40.0, 1.0 / 14.0, 160.5),
            half_width: 75.0,
            toe: [4.0, 2.0],
            bottom: 172.0,
        },
    }
}

/// 40E1 and 41E1, which differ by the corner of the head.
const fn family_41(radii: &'static [f64], joints: &'static [f64]) -> Drawing<'static> {
    Drawing {
        head: Head { radii, joints, side_slope: 0.0, lower_corner: 2.0, apex: 43.0 },
        fishing_slope: 1.0 / 3.0,
        web: Web {
            half_thickness: 6.0,
            upper: Neck::to_arc(7.0, 100.0, 59.5),
            lower: Neck::to_arc(7.0, 140.0, 89.5),
        },
        foot: Foot {
            apex: 114.0,
            outer: outer(40.0, 1.0 / 11.32, 128.52),
            half_width: 62.5,
            toe: [3.0, 1.5],
            bottom: 138.0,
        },
    }
}

/// The standard rails, the heaviest first. Sources and checks: `data/profiles/README.md`.
pub const STANDARD_RAILS: [StandardRail; 15] = [
    StandardRail {
        name: "60E1",
        description: "rail, EN 13674-1",
        drawing: family_60(&[300.0, 80.0, 13.0], &[10.228, 26.0265]),
    },
    StandardRail {
        name: "UIC60",
        description: "rail, head of UIC 861-3 on web and foot of 60E1",
        drawing: family_60(&[300.0, 80.0, 13.0], &[10.5, 25.98804]),
    },
    StandardRail {
        name: "60E2",
        description: "rail, EN 13674-1, relieved gauge corner",
        drawing: family_60(&[200.0, 70.0, 16.0, 8.0], &[11.889, 24.4565, 35.387]),
    },
    StandardRail {
        name: "60N-on-60E1",
        description: "rail, head of the Chinese 60N on web and foot of 60E1: those of 60N itself are not known here",
        drawing: family_60(&[200.0, 60.0, 16.0, 8.0], &[9.0, 25.5345, 34.4145]),
    },
    StandardRail {
        name: "56E1",
        description: "rail, EN 13674-1 (BS 113 lb)",
        drawing: Drawing {
            head: Head {
                radii: &[305.0, 80.0, 12.7],
                joints: &[5.8935, 25.6175],
                side_slope: 1.0 / 20.0,
                lower_corner: 3.0,
                apex: 49.21,
            },
            fishing_slope: 1.0 / 2.75,
            web: Web { half_thickness: 10.0, upper: Neck::plain(8.0), lower: Neck::plain(15.0) },
            foot: Foot {
                apex: 128.59,
                outer: outer(20.0, 1.0 / 10.0, 147.55),
                half_width: 70.0,
                toe: [3.0, 1.5],
                bottom: 158.75,
            },
        },
    },
    StandardRail {
        name: "55E1",
        description: "rail, EN 13674-1 (U55)",
        drawing: Drawing {
            head: Head {
                radii: &[200.0, 60.0, 13.0],
                joints: &[13.973, 20.294],
                side_slope: 1.0 / 20.0,
                lower_corner: 2.0,
                apex: 53.0,
            },
            fishing_slope: 1.0 / 3.0,
            web: Web { half_thickness: 9.5, upper: Neck::plain(12.0), lower: Neck::plain(12.0) },
            foot: Foot {
                apex: 124.0,
                outer: outer(23.0, 1.0 / 10.0, 141.0),
                half_width: 67.0,
                toe: [3.0, 2.0],
                bottom: 155.0,
            },
        },
    },
    StandardRail {
        name: "54E1",
        description: "rail, EN 13674-1 (UIC 54)",
        drawing: Drawing {
            head: Head {
                radii: &[300.0, 80.0, 13.0],
                joints: &[10.012, 24.8635],
                side_slope: 1.0 / 20.0,
                lower_corner: 3.0,
                apex: 49.4,
            },
            fishing_slope: 1.0 / 2.75,
            web: Web {
                half_thickness: 8.0,
                upper: Neck::with_middle(8.0, [22.0, 25.4], 508.0, 82.8),
                lower: Neck::to_arc(16.0, 508.0, 82.8),
            },
            foot: Foot {
                apex: 128.8,
                outer: outer(20.0, 1.0 / 10.0, 148.0),
                half_width: 70.0,
                toe: [3.0, 2.0],
                bottom: 159.0,
            },
        },
    },
    StandardRail {
        name: "54E2",
        description: "rail, EN 13674-1 (UIC 54 E)",
        drawing: Drawing {
            head: Head {
                radii: &[300.0, 80.0, 13.0],
                joints: &[9.473, 23.155],
                side_slope: 1.0 / 20.0,
                lower_corner: 2.0,
                apex: 51.4,
            },
            fishing_slope: 1.0 / 2.75,
            web: Web {
                half_thickness: 8.0,
                upper: Neck::with_middle(8.0, [22.0, 25.4], 508.0, 84.8),
                lower: Neck::to_arc(16.0, 508.0, 84.8),
            },
            foot: Foot {
                apex: 130.8,
                outer: outer(20.0, 1.0 / 10.0, 149.0),
                half_width: 62.5,
                toe: [3.0, 2.0],
                bottom: 161.0,
            },
        },
    },
    StandardRail {
        name: "54E3",
        description: "rail, EN 13674-1 (DIN S54), weakly checked: by the mass of the older DIN rail alone",
        drawing: Drawing {
            head: Head {
                radii: &[300.0, 80.0, 13.0],
                joints: &[7.6335, 23.4175],
                side_slope: 1.0 / 17.2,
                lower_corner: 5.0,
                apex: 55.0,
            },
            fishing_slope: 1.0 / 3.0,
            web: Web {
                half_thickness: 8.0,
                upper: Neck::to_arc(16.0, 500.0, 79.0),
                lower: Neck::to_arc(16.0, 500.0, 79.0),
            },
            foot: Foot {
                apex: 125.0,
                outer: outer(40.0, 1.0 / 7.81, 142.0),
                half_width: 62.5,
                toe: [3.0, 2.0],
                bottom: 154.0,
            },
        },
    },
    StandardRail {
        name: "50E5",
        description: "rail, EN 13674-1 (50 UNI), weakly checked: by a mass that may be another rail's",
        drawing: Drawing {
            head: Head {
                radii: &[400.0, 14.0],
                joints: &[20.2355],
                side_slope: 1.0 / 16.0,
                lower_corner: 2.0,
                apex: 50.5,
            },
            fishing_slope: 1.0 / 3.0,
            web: Web {
                half_thickness: 7.0,
                upper: Neck::to_arc(7.0, 80.0, 66.0),
                lower: Neck::to_arc(7.0, 120.0, 96.0),
            },
            foot: Foot {
                apex: 120.5,
                outer: outer(40.0, 1.0 / 8.0, 138.0),
                half_width: 67.5,
                toe: [3.0, 2.0],
                bottom: 148.0,
            },
        },
    },
    StandardRail {
        name: "49E1",
        description: "rail, EN 13674-1 (DIN S49)",
        drawing: Drawing {
            head: Head {
                radii: &[300.0, 80.0, 13.0],
                joints: &[7.6335, 23.4175],
                side_slope: 1.0 / 17.2,
                lower_corner: 2.0,
                apex: 51.5,
            },
            fishing_slope: 1.0 / 3.0,
            web: Web {
                half_thickness: 7.0,
                upper: Neck::to_arc(7.0, 80.0, 67.0),
                lower: Neck::to_arc(7.0, 120.0, 97.0),
            },
            foot: Foot {
                apex: 121.5,
                outer: outer(40.0, 1.0 / 7.81, 138.5),
                half_width: 62.5,
                toe: [3.0, 1.5],
                bottom: 149.0,
            },
        },
    },
    StandardRail {
        name: "41E1",
        description: "rail, EN 13674-4 (S41 R10)",
        drawing: family_41(&[400.0, 10.0], &[24.1025]),
    },
    StandardRail {
        name: "40E1",
        description: "rail, EN 13674-4 (S41 R14)",
        drawing: family_41(&[400.0, 14.0], &[20.207]),
    },
    StandardRail {
        name: "33E1",
        description: "rail, EN 13674-4 (S33)",
        drawing: Drawing {
            head: Head {
                radii: &[225.0, 14.0],
                joints: &[15.9955],
                side_slope: 0.0,
                lower_corner: 2.0,
                apex: 39.0,
            },
            fishing_slope: 1.0 / 4.0,
            web: Web {
                half_thickness: 5.5,
                upper: Neck::to_arc(6.0, 100.0, 57.0),
                lower: Neck::to_arc(6.0, 160.0, 87.0),
            },
            foot: Foot {
                apex: 115.0,
                outer: outer(10.0, 1.0 / 13.67, 124.5),
                half_width: 52.5,
                toe: [3.0, 2.0],
                bottom: 134.0,
            },
        },
    },
    StandardRail {
        name: "30E1",
        description: "rail, EN 13674-4 (S30)",
        drawing: Drawing {
            head: Head {
                radii: &[305.0, 8.0],
                joints: &[22.7465],
                side_slope: 0.0,
                lower_corner: 1.6,
                apex: 31.0,
            },
            fishing_slope: 1.0 / 4.33,
            web: Web {
                half_thickness: 6.15,
                upper: Neck::to_arc(6.4, 305.0, 59.75),
                lower: Neck::to_arc(6.4, 305.0, 59.75),
            },
            foot: Foot { apex: 88.5, outer: None, half_width: 54.0, toe: [1.6, 1.6], bottom: 108.0 },
        },
    },
];

/// Their names.
pub const RAIL_NAMES: [&str; STANDARD_RAILS.len()] = {
    let mut names = [""; STANDARD_RAILS.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = STANDARD_RAILS[i].name;
        i += 1;
    }
    names
};
