//! The track of a study: beams, supports, sleepers, a bridge.

use railspring_calibrate::beam::{BeamSection, Torsion};
use railspring_calibrate::section_analysis::rail_properties;
use railspring_calibrate::solid::Material;
use railspring_profiles::error::{Error, InputError};
use railspring_profiles::section::rail_section;
use railspring_profiles::units::KILONEWTON;
use railspring_simulate::time::scenario::Kelvin;
use railspring_simulate::track::{Bridge, Carrier, Direction, Held, Layers, LineBeam, Onto, Track};

use super::document::{EndKey, RailKeys, SectionKeys, SleeperKeys, SupportKey, SupportKeys, TrackDocument};

type Result<T> = std::result::Result<T, InputError>;

/// A node is hit if a place misses it by less than this share of an element.
const AT_A_NODE: f64 = 1e-6;
/// Most elements of a rail.
const MOST_ELEMENTS: usize = 10_000;
/// Most sleepers.
const MOST_SLEEPERS: usize = 100_000;

/// Spring and damper of keys in kN/m and kN·s/m.
pub(super) fn kelvin(stiffness: f64, damping: f64) -> Kelvin {
    Kelvin { stiffness: stiffness * KILONEWTON, damping: damping * KILONEWTON }
}

/// The track; none where the rail does not move.
///
/// # Errors
/// All that is wrong with it.
pub(super) fn track(document: &TrackDocument) -> std::result::Result<Option<Track>, Vec<InputError>> {
    let rail = &document.rail;
    if rail.rigid {
        return rigid(document).map(|()| None).map_err(|error| vec![error]);
    }
    let mut mistakes = Vec::new();
    let needed = |key: &str, meaning: &str| {
        let expected = format!("{meaning} of a rail that moves");
        InputError::new(
            format!("rail.{key}"),
            "(missing)",
            expected,
            "add this key, or set `rail.rigid = true`",
        )
    };
    let (Some(length), Some(elements)) = (rail.length_m, rail.elements) else {
        mistakes.extend(rail.length_m.is_none().then(|| needed("length_m", "the length")));
        mistakes.extend(rail.elements.is_none().then(|| needed("elements", "the number of elements")));
        return Err(mistakes);
    };
    let mut building =
        Building { length, elements, held: Vec::new(), layers: Vec::new(), mistakes, at_nodes: Vec::new() };
    let section = building.took(rail_section_of(rail));
    building.ends(Carrier::Rail, [0, elements], rail.ends);
    for (index, support) in rail.support.iter().enumerate() {
        building.support(&format!("rail.support[{index}]"), Carrier::Rail, support, [0.0, length]);
    }
    let mut bridge = None;
    if let Some(keys) = &document.bridge {
        let nodes = [("from_m", keys.from_m), ("to_m", keys.to_m)]
            .map(|(key, x)| building.node(&format!("bridge.{key}"), x));
        if let [Some(from), Some(to)] = nodes {
            if from >= to {
                building.mistakes.push(InputError::new(
                    "bridge.to_m",
                    keys.to_m,
                    format!("a place behind bridge.from_m = {}", keys.from_m),
                    "give the bridge a length",
                ));
            }
            building.ends(Carrier::Bridge, [from, to], keys.ends);
            let beam = LineBeam {
                section: section_of(&keys.section),
                damping: keys.stiffness_damping_s,
                mass_damping: keys.mass_damping_per_s,
            };
            bridge = Some(Bridge { beam, nodes: [from, to] });
        }
        for (index, support) in keys.support.iter().enumerate() {
            let range = [keys.from_m, keys.to_m];
            building.support(&format!("bridge.support[{index}]"), Carrier::Bridge, support, range);
        }
        if rail.sleepers.is_none() {
            building.mistakes.push(InputError::new(
                "rail.sleepers",
                "(missing)",
                "sleepers or pads, through which a bridge carries the rail",
                "add this section, or make the bridge the rail",
            ));
        }
        if rail.foundation.is_some() {
            building.mistakes.push(InputError::new(
                "rail.foundation",
                "given",
                "no foundation beside a bridge, which it would pass by",
                "carry the rail on `rail.sleepers`, on the bridge and beside it",
            ));
        }
    }
    if let Some(sleepers) = &rail.sleepers {
        let on_bridge = document.bridge.as_ref().map(|keys| [keys.from_m, keys.to_m]);
        building.sleepers(sleepers, on_bridge);
    }
    let bed = rail.foundation.map(|bed| kelvin(bed.stiffness_kn_per_m2, bed.damping_kn_s_per_m2));
    building.check_nodes();
    let Building { held, layers, mistakes, .. } = building;
    match section {
        Some(section) if mistakes.is_empty() => Ok(Some(Track {
            length,
            elements,
            rail: LineBeam {
                section,
                damping: rail.stiffness_damping_s,
                mass_damping: rail.mass_damping_per_s,
            },
            bridge,
            bed,
            held,
            layers,
        })),
        _ => Err(mistakes),
    }
}

/// A rail that does not move has nothing else.
fn rigid(document: &TrackDocument) -> Result<()> {
    let rail = &document.rail;
    let given = [
        ("rail.length_m", rail.length_m.is_some()),
        ("rail.elements", rail.elements.is_some()),
        ("rail.section", rail.section.is_some()),
        ("rail.profile", rail.profile.is_some()),
        ("rail.support", !rail.support.is_empty()),
        ("rail.sleepers", rail.sleepers.is_some()),
        ("rail.foundation", rail.foundation.is_some()),
        ("bridge", document.bridge.is_some()),
    ];
    match given.iter().find(|(_, given)| *given) {
        None => Ok(()),
        Some((key, _)) => Err(InputError::new(
            *key,
            "given",
            "nothing of a rail that does not move (`rail.rigid = true`)",
            "leave it out, or remove `rail.rigid`",
        )),
    }
}

fn rail_section_of(rail: &RailKeys) -> Result<BeamSection> {
    match (&rail.section, &rail.profile) {
        (Some(section), None) => Ok(section_of(section)),
        (None, Some(name)) => {
            let of_profile = || {
                let properties = rail_properties(&rail_section(name)?)?;
                BeamSection::rail(&properties, &Material::STEEL, 1.0, Torsion::SaintVenant)
            };
            of_profile().map_err(|error: Error| match error {
                Error::Input(error) => InputError::new(
                    "rail.profile",
                    format!("{name:?}"),
                    error.expected,
                    "`railspring profile list` has the standard rails; or give `rail.section`",
                ),
                other => InputError::new(
                    "rail.profile",
                    other,
                    "a section that can be analysed",
                    "give `rail.section`",
                ),
            })
        }
        (both, _) => Err(InputError::new(
            "rail.section",
            if both.is_some() { "given beside rail.profile" } else { "(missing)" },
            "either rail.section or rail.profile",
            "give one of the two",
        )),
    }
}

fn section_of(keys: &SectionKeys) -> BeamSection {
    let young = keys.young_gpa * 1e9;
    let bending = young * keys.inertia_m4;
    let shear = young / (2.0 * (1.0 + keys.poisson));
    let shear = keys.shear_area_m2.map_or(f64::INFINITY, |area| shear * area);
    BeamSection {
        // in the vertical plane only the z direction counts
        axial: bending,
        bending_y: bending,
        bending_z: bending,
        shear_y: shear,
        shear_z: shear,
        torsion: bending,
        mass: keys.mass_kg_per_m,
        rotary_y: keys.rotary_kg_m,
        rotary_z: keys.rotary_kg_m,
        polar: keys.mass_kg_per_m,
        centroid: [0.0; 2],
    }
}

/// A track that is being put together.
struct Building {
    length: f64,
    elements: usize,
    held: Vec<Held>,
    layers: Vec<Layers>,
    mistakes: Vec<InputError>,
    /// Places that have to be nodes, with their keys.
    at_nodes: Vec<(String, f64)>,
}

impl Building {
    fn took<T>(&mut self, part: Result<T>) -> Option<T> {
        part.map_err(|mistake| self.mistakes.push(mistake)).ok()
    }

    fn off(&mut self, key: &str, x: f64, [from, to]: [f64; 2]) -> bool {
        let off = !(from..=to).contains(&x);
        if off {
            let expected = format!("a place on it, {from} to {to} m");
            self.mistakes.push(InputError::new(key, x, expected, "correct the place, or the length"));
        }
        off
    }

    /// The node nearest to a place that has to be one.
    fn node(&mut self, key: &str, x: f64) -> Option<usize> {
        if self.off(key, x, [0.0, self.length]) {
            return None;
        }
        self.at_nodes.push((key.into(), x));
        Some((x / self.length * self.elements as f64).round() as usize)
    }

    /// That all places which have to be nodes are some, and with how many elements they would be.
    fn check_nodes(&mut self) {
        let missed = |x: f64, elements: usize| {
            let along = x / self.length * elements as f64;
            (along - along.round()).abs() > AT_A_NODE
        };
        let wrong: Vec<_> = self.at_nodes.iter().filter(|(_, x)| missed(*x, self.elements)).collect();
        let all = |elements: &usize| !self.at_nodes.iter().any(|(_, x)| missed(*x, *elements));
        let Some((key, x)) = wrong.first() else { return };
        let remedy = match (self.elements..=MOST_ELEMENTS).find(all) {
            Some(elements) => format!("set `rail.elements = {elements}`"),
            None => "choose a length and places that are multiples of one element".into(),
        };
        let pitch = self.length / self.elements as f64;
        let expected = format!("a node of the rail, which has one every {pitch} m");
        let mistake = InputError::new(key.clone(), x, expected, remedy);
        self.mistakes.push(mistake);
    }

    fn ends(&mut self, of: Carrier, nodes: [usize; 2], ends: [EndKey; 2]) {
        for (node, end) in nodes.into_iter().zip(ends) {
            let held = match end {
                EndKey::Free => &[][..],
                EndKey::Pinned => &[Direction::Vertical],
                EndKey::Fixed => &[Direction::Vertical, Direction::Rotation],
            };
            self.held.extend(held.iter().map(|&direction| Held { of, node, direction }));
        }
    }

    fn support(&mut self, key: &str, of: Carrier, keys: &SupportKeys, range: [f64; 2]) {
        if self.off(&format!("{key}.x_m"), keys.x_m, range) {
            return;
        }
        let of_spring = [
            ("stiffness_kn_per_m", keys.stiffness_kn_per_m),
            ("damping_kn_s_per_m", keys.damping_kn_s_per_m),
            ("rotation_kn_m_per_rad", keys.rotation_kn_m_per_rad),
        ];
        if keys.kind != SupportKey::Spring {
            if let Some((name, value)) = of_spring.iter().find_map(|(name, value)| Some((name, (*value)?))) {
                let expected = "this key for kind = \"spring\" alone";
                let remedy = "leave it out, or take kind = \"spring\"";
                self.mistakes.push(InputError::new(format!("{key}.{name}"), value, expected, remedy));
            }
            let Some(node) = self.node(&format!("{key}.x_m"), keys.x_m) else { return };
            let fixed = keys.kind == SupportKey::Fixed;
            self.held.push(Held { of, node, direction: Direction::Vertical });
            self.held.extend(fixed.then_some(Held { of, node, direction: Direction::Rotation }));
            return;
        }
        if of_spring.iter().all(|(_, value)| value.unwrap_or(0.0) == 0.0) {
            self.mistakes.push(InputError::new(
                format!("{key}.stiffness_kn_per_m"),
                "(missing)",
                "a stiffness, a damping or a rotational stiffness of a spring",
                "add this key, or remove the support",
            ));
        }
        let [stiffness, damping, rotation] = of_spring.map(|(_, value)| value.unwrap_or(0.0));
        let layer =
            |direction, upper| Layers { of, x: keys.x_m, direction, upper, below: None, onto: Onto::Ground };
        let springs =
            [(Direction::Vertical, kelvin(stiffness, damping)), (Direction::Rotation, kelvin(rotation, 0.0))];
        let given = springs.into_iter().filter(|(_, spring)| spring.stiffness + spring.damping > 0.0);
        self.layers.extend(given.map(|(direction, spring)| layer(direction, spring)));
    }

    fn sleepers(&mut self, keys: &SleeperKeys, on_bridge: Option<[f64; 2]>) {
        let last = keys.last_m.unwrap_or(self.length);
        let here = [0.0, self.length];
        if self.off("rail.sleepers.first_m", keys.first_m, here)
            || self.off("rail.sleepers.last_m", last, here)
        {
            return;
        }
        let ballast = [
            ("ballast_stiffness_kn_per_m", keys.ballast_stiffness_kn_per_m),
            ("ballast_damping_kn_s_per_m", keys.ballast_damping_kn_s_per_m),
        ];
        let below = match (keys.mass_kg, ballast) {
            (Some(mass), [(_, Some(stiffness)), (_, damping)]) => {
                Some((mass, kelvin(stiffness, damping.unwrap_or(0.0))))
            }
            (Some(_), [(name, None), _]) => {
                let expected = "the ballast under a sleeper with a mass";
                let key = format!("rail.sleepers.{name}");
                let remedy = "add this key, or leave `rail.sleepers.mass_kg` out";
                self.mistakes.push(InputError::new(key, "(missing)", expected, remedy));
                None
            }
            (None, given) => {
                if let Some((name, value)) = given.iter().find_map(|(name, value)| Some((name, (*value)?))) {
                    let key = format!("rail.sleepers.{name}");
                    let expected = "no ballast without a sleeper of a mass between";
                    self.mistakes.push(InputError::new(
                        key,
                        value,
                        expected,
                        "give `rail.sleepers.mass_kg`, or leave it out",
                    ));
                }
                None
            }
        };
        let count = number_of_sleepers(keys, self.length);
        if !(count >= 1.0 && count <= MOST_SLEEPERS as f64) {
            self.mistakes.push(InputError::new(
                "rail.sleepers.spacing_m",
                format!("{} from {} to {last} m", keys.spacing_m, keys.first_m),
                format!("1 to {MOST_SLEEPERS} sleepers"),
                "correct the distance, or the first and the last place",
            ));
            return;
        }
        let rounding = 1e-9 * self.length;
        self.layers.extend(sleeper_places(keys, self.length).map(|x| {
            let carried = on_bridge.is_some_and(|[from, to]| (from - rounding..=to + rounding).contains(&x));
            Layers {
                of: Carrier::Rail,
                x,
                direction: Direction::Vertical,
                upper: kelvin(keys.pad_stiffness_kn_per_m, keys.pad_damping_kn_s_per_m),
                below,
                onto: if carried { Onto::Bridge } else { Onto::Ground },
            }
        }));
    }
}

fn number_of_sleepers(keys: &SleeperKeys, length: f64) -> f64 {
    // the last one may miss its place by rounding
    ((keys.last_m.unwrap_or(length) - keys.first_m) / keys.spacing_m + 1e-9).floor().max(-1.0) + 1.0
}

/// Where sleepers lie on a rail of a `length`, m.
pub(super) fn sleeper_places(keys: &SleeperKeys, length: f64) -> impl Iterator<Item = f64> {
    let (first, spacing) = (keys.first_m, keys.spacing_m);
    let count = number_of_sleepers(keys, length) as usize;
    (0..count).map(move |number| (first + number as f64 * spacing).min(length))
}
