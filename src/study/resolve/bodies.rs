//! Rail and wheel of a study from their keys.

use railspring_calibrate::solid::{Material, Materials};
use railspring_profiles::error::{Error, InputError};
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::profile::rail_catalogue::{
    CATALOGUE_RAILS, RailDimensions, catalogue_rail, rail_of_dimensions,
};
use railspring_profiles::profile::rails::RAIL_NAMES;
use railspring_profiles::profile::wheels::{Flange, WHEEL_NAMES, wheel_profile_with_flange};
use railspring_profiles::section::{WebShape, WheelBody, wheel_section_on};
use railspring_profiles::units::MILLIMETRE;

use crate::study::check::nearest;
use crate::study::collect::Collector;
use crate::study::document::{
    ElementKey, Inclination, MaterialKeys, MeshFileKeys, RailBodyKey, RailKeys, WebKey, WheelKeys,
};
use crate::study::measured::Surface;
use crate::study::mesh_file::BodyMesh;
use crate::study::pair::{MeasuredSurface, MeshFile, Rail, RailBody, SectionFile, Wheel};
use crate::study::source::Source;

/// What rail and wheel have alike.
struct Parts {
    section: Option<Option<SectionFile>>,
    surface: Option<(Option<String>, Option<MeasuredSurface>)>,
    mesh: Option<Option<MeshFile>>,
    material: Material,
    materials: Option<Materials>,
}

/// `held_meaning`: what the held nodes of a mesh are. `material` and `element`: those of the study for both bodies.
fn parts(
    surface: &Surface<'_>,
    (mesh, held_meaning): (&MeshFileKeys, &'static str),
    (material, element): (&MaterialKeys, ElementKey),
    source: &Source,
    collector: &mut Collector,
) -> Parts {
    let section = match &surface.keys.section_file {
        Some(file) => surface.own_section(file, source, collector).map(Some),
        None => Some(None),
    };
    let material = mesh.material.over(material).material();
    let mesh = BodyMesh { section: surface.section, held_meaning, keys: mesh };
    Parts {
        section,
        surface: surface.resolve(source, collector),
        mesh: mesh.resolve(source.path(), collector),
        material,
        materials: mesh.materials(&material, element, collector),
    }
}

/// `solid`: material and element of the study for both bodies.
pub(super) fn rail(
    keys: &RailKeys,
    solid: (&MaterialKeys, ElementKey),
    source: &Source,
    collector: &mut Collector,
) -> Option<Rail> {
    let inclination = match &keys.inclination {
        None => Ok(TrackGeometry::standard().inclination),
        Some(Inclination::Slope(slope)) => Ok(*slope),
        Some(Inclination::Ratio(text)) => slope_of(text).ok_or_else(|| {
            InputError::new(
                "rail.inclination",
                format!("{text:?}"),
                "a ratio such as \"1:40\" (from 1:5 on) or a slope such as 0.025",
                "write the ratio with a colon, or the slope as a number",
            )
        }),
    };
    let inclination = collector.take(&["rail.inclination"], inclination);
    let named = Surface {
        section: "rail",
        names: &RAIL_NAMES,
        meaning: "Name of the standard section",
        keys: &keys.surface,
    };
    let parts = parts(
        &named,
        (&keys.mesh, "the name in the mesh file of the nodes at the foot"),
        solid,
        source,
        collector,
    );
    let body = collector.take(&["rail.body", "rail.body.*"], rail_body(keys));
    let (profile, measured) = parts.surface?;
    Some(Rail {
        profile,
        body: body?,
        section: parts.section?,
        measured,
        inclination: inclination?,
        inclination_given: keys.inclination.is_some() || keys.surface.profile_file.is_none(),
        length: keys.length_m,
        mesh: parts.mesh?,
        material: parts.material,
        materials: parts.materials?,
    })
}

/// The body under a measured head.
fn rail_body(keys: &RailKeys) -> Result<Option<RailBody>, InputError> {
    let Some(body) = &keys.body else { return Ok(None) };
    let refuse = |value: String, expected: String, remedy: &str| {
        Err(InputError::new("rail.body", value, expected, remedy))
    };
    let given = match body {
        RailBodyKey::Name(name) => format!("{name:?}"),
        RailBodyKey::Dimensions(_) => "dimensions".into(),
    };
    let others = [
        ("rail.standard", &keys.surface.standard),
        ("rail.profile", &keys.surface.profile),
        ("rail.section_file", &keys.surface.section_file),
    ];
    if let Some((other, _)) = others.iter().find(|(_, value)| value.is_some()) {
        return refuse(given, format!("either rail.body or {other}"), "both say what body it is: remove one");
    }
    if keys.surface.profile_file.is_none() {
        let remedy = "the key is the body under a measured head: give its file, or remove the key";
        return refuse(given, "rail.profile_file beside it".into(), remedy);
    }
    match body {
        RailBodyKey::Name(name) if RAIL_NAMES.contains(&name.as_str()) => {
            Ok(Some(RailBody::Standard(name.clone())))
        }
        RailBodyKey::Name(name) => match catalogue_rail(name) {
            Some(rail) => Ok(Some(RailBody::Drawn(name.clone(), rail.dimensions()))),
            None => {
                let names = RAIL_NAMES.iter().copied().chain(CATALOGUE_RAILS.iter().map(|rail| rail.name));
                let near = nearest(name, names.clone());
                let near = near.map_or(String::new(), |near| format!("did you mean {near:?}? "));
                let expected = format!("one of {}", names.collect::<Vec<_>>().join(", "));
                let remedy = format!(
                    "{near}another rail is given by its dimensions: height_mm, foot_mm, head_mm, web_mm"
                );
                refuse(given, expected, &remedy)
            }
        },
        RailBodyKey::Dimensions(keys) => {
            let metres = |mm: f64| mm * MILLIMETRE;
            let dimensions = RailDimensions {
                height: metres(keys.height_mm),
                foot: metres(keys.foot_mm),
                head: metres(keys.head_mm),
                web: metres(keys.web_mm),
                head_depth: keys.head_depth_mm.map(metres),
                foot_depth: keys.foot_depth_mm.map(metres),
            };
            let name = format!("a rail {} mm high", keys.height_mm);
            match rail_of_dimensions(&dimensions) {
                Ok(_) => Ok(Some(RailBody::Drawn(name, dimensions))),
                Err(Error::Input(error)) => Err(InputError { key: "rail.body".into(), ..error }),
                Err(other) => refuse(given, other.to_string(), "check the dimensions"),
            }
        }
    }
}

/// As [`rail`].
pub(super) fn wheel(
    keys: &WheelKeys,
    solid: (&MaterialKeys, ElementKey),
    source: &Source,
    collector: &mut Collector,
) -> Option<Wheel> {
    let named = Surface {
        section: "wheel",
        names: &WHEEL_NAMES,
        meaning: "Name of the standard running profile",
        keys: &keys.surface,
    };
    let parts = parts(
        &named,
        (&keys.mesh, "the name in the mesh file of the nodes at the bore"),
        solid,
        source,
        collector,
    );
    let flange = Flange {
        height: keys.flange_height_mm * MILLIMETRE,
        thickness: keys.flange_thickness_mm * MILLIMETRE,
    };
    let turned_off = 0.5 * (keys.new_diameter_m.unwrap_or(keys.tape_diameter_m) - keys.tape_diameter_m);
    if turned_off < 0.0 {
        let mistake = InputError::new(
            "wheel.new_diameter_m",
            keys.new_diameter_m.unwrap_or_default(),
            format!("at least wheel.tape_diameter_m = {}, what is left of it", keys.tape_diameter_m),
            "correct one of the two, or remove the key",
        );
        collector.add(&["wheel.new_diameter_m", "wheel.tape_diameter_m"], mistake);
    }
    let body = WheelBody {
        web: match keys.body {
            WebKey::StraightWeb => WebShape::Straight,
            WebKey::SWeb => WebShape::S,
            WebKey::ConicalWeb => {
                WebShape::Conical { hub: keys.web_hub_y_mm * MILLIMETRE, rim: keys.web_rim_y_mm * MILLIMETRE }
            }
        },
        bore_diameter: keys.bore_mm * MILLIMETRE,
        hub_diameter: keys.hub_diameter_mm * MILLIMETRE,
        rim_depth: keys.rim_depth_mm * MILLIMETRE - turned_off,
        web_thickness: keys.web_thickness_mm.map(|mm| mm * MILLIMETRE),
        ..WheelBody::default()
    };
    let (profile, measured) = parts.surface?;
    if keys.body != WebKey::ConicalWeb {
        for key in ["wheel.web_hub_y_mm", "wheel.web_rim_y_mm"].into_iter().filter(|key| source.gives(key)) {
            let value = match key {
                "wheel.web_hub_y_mm" => keys.web_hub_y_mm,
                _ => keys.web_rim_y_mm,
            };
            let remedy = "set wheel.body = \"conical-web\", or remove the key";
            collector.add(&[key], InputError::new(key, value, "a conical web beside it", remedy));
        }
    }
    let standard = profile.as_deref().unwrap_or(ANY_WHEEL);
    if keys.surface.section_file.is_some() {
        refuse_beside_section(source, collector);
    } else if let Err(Error::Input(mistake)) = wheel_profile_with_flange(standard, &flange)
        .and_then(|running| wheel_section_on(running, standard, keys.tape_diameter_m, &body))
    {
        // A flange or a body that the standard cannot have.
        collector.add(&["wheel.*"], source.with_keys(mistake));
    }
    let section = parts.section?;
    if let (Some(mm), None, None) =
        (keys.tape_circle_mm, &keys.surface.profile_file, &keys.surface.section_file)
    {
        let mistake = InputError::new(
            "wheel.tape_circle_mm",
            mm,
            "wheel.profile_file or wheel.section_file beside it",
            "standard profiles say where their tape circle is: remove the key",
        );
        collector.add(&["wheel.tape_circle_mm"], mistake);
    }
    Some(Wheel {
        profile,
        section,
        measured,
        tape_circle: keys.tape_circle_mm.map(|mm| mm * MILLIMETRE),
        tape_diameter: keys.tape_diameter_m,
        new_diameter: keys.new_diameter_m,
        diameter_measured: false,
        flange,
        body,
        body_given: keys.surface.profile_file.is_none() || BODY_KEYS.iter().any(|key| source.gives(key)),
        mesh: parts.mesh?,
        material: parts.material,
        materials: parts.materials?,
    })
}

/// Refuses the keys of a generic wheel beside a section in a file, which has its own flange and body.
fn refuse_beside_section(source: &Source, collector: &mut Collector) {
    const FLANGE: [&str; 2] = ["wheel.flange_height_mm", "wheel.flange_thickness_mm"];
    for key in FLANGE.into_iter().chain(BODY_KEYS).filter(|key| source.gives(key)) {
        let mistake = InputError::new(
            key,
            "given",
            "no key of a generic wheel beside wheel.section_file",
            "the file has flange, web, hub, bore and rim: remove one of the two keys",
        );
        collector.add(&["wheel.section_file"], mistake);
    }
}

/// Keys of the generic body of a wheel.
const BODY_KEYS: [&str; 8] = [
    "wheel.body",
    "wheel.bore_mm",
    "wheel.hub_diameter_mm",
    "wheel.rim_depth_mm",
    "wheel.web_thickness_mm",
    "wheel.web_hub_y_mm",
    "wheel.web_rim_y_mm",
    "wheel.new_diameter_m",
];
/// A standard wheel whose body is checked where the standard of a measured profile is still to be found.
const ANY_WHEEL: &str = "S1002";

/// Slope of a ratio such as `1:40`.
fn slope_of(text: &str) -> Option<f64> {
    let (rise, run) = text.split_once(':')?;
    let (rise, run): (f64, f64) = (rise.trim().parse().ok()?, run.trim().parse().ok()?);
    let slope = rise / run;
    (run > 0.0 && slope.is_finite() && slope.abs() <= 0.2).then_some(slope)
}
