//! Rail and wheel of a study from their keys.

use railspring_calibrate::error::{Error, InputError};
use railspring_calibrate::profile::rails::RAIL_NAMES;
use railspring_calibrate::profile::wheels::{Flange, WHEEL_NAMES, wheel_profile_with_flange};
use railspring_calibrate::section::{WebShape, WheelBody, wheel_section_on};
use railspring_calibrate::solid::Material;
use railspring_calibrate::units::MILLIMETRE;

use crate::study::collect::Collector;
use crate::study::document::{ElementKey, Inclination, RailKeys, WebKey, WheelKeys};
use crate::study::fields::translate;
use crate::study::measured::SurfaceKeys;
use crate::study::mesh_file::MeshFileKeys;
use crate::study::{Rail, Source, Wheel};

/// `material` and `element`: those of the study.
pub(super) fn rail(
    keys: &RailKeys,
    (material, element): (&Material, ElementKey),
    source: &Source,
    collector: &mut Collector,
) -> Option<Rail> {
    let inclination = match &keys.inclination {
        Inclination::Slope(slope) => Ok(*slope),
        Inclination::Ratio(text) => slope_of(text).ok_or_else(|| {
            InputError::new(
                "rail.inclination",
                format!("{text:?}"),
                "a ratio such as \"1:40\" (from 1:5 on) or a slope such as 0.025",
                "write the ratio with a colon, or the slope as a number",
            )
        }),
    };
    let inclination = collector.take(&["rail.inclination"], inclination);
    let named = SurfaceKeys {
        section: "rail",
        names: &RAIL_NAMES,
        meaning: "Name of the standard section",
        profile: keys.profile.as_deref(),
        own: keys.section_file.as_deref(),
        file: keys.profile_file.as_deref(),
        part: keys.profile_part.as_deref(),
        standard: keys.standard.as_deref(),
        smoothing_mm: keys.profile_smoothing_mm,
        aligned: keys.profile_aligned,
        unit: keys.profile_unit,
        mirrored: keys.profile_mirrored,
    };
    let section = match &keys.section_file {
        Some(file) => named.own_section(file, source, collector).map(Some),
        None => Some(None),
    };
    let surface = named.resolve(source, collector);
    let mesh = MeshFileKeys {
        section: "rail",
        held_meaning: "the name in the mesh file of the nodes at the foot",
        file: keys.mesh_file.as_deref(),
        unit: keys.mesh_unit,
        contact: keys.contact_surface.as_deref(),
        held: keys.held_nodes.as_deref(),
        materials: &keys.materials,
    };
    let (mesh, materials) =
        (mesh.resolve(source.path(), collector), mesh.materials(material, element, collector));
    let (profile, measured) = surface?;
    Some(Rail {
        profile,
        section: section?,
        measured,
        inclination: inclination?,
        length: keys.length_m,
        mesh: mesh?,
        materials: materials?,
    })
}

/// As [`rail`].
pub(super) fn wheel(
    keys: &WheelKeys,
    (material, element): (&Material, ElementKey),
    source: &Source,
    collector: &mut Collector,
) -> Option<Wheel> {
    let named = SurfaceKeys {
        section: "wheel",
        names: &WHEEL_NAMES,
        meaning: "Name of the standard running profile",
        profile: keys.profile.as_deref(),
        own: keys.section_file.as_deref(),
        file: keys.profile_file.as_deref(),
        part: keys.profile_part.as_deref(),
        standard: keys.standard.as_deref(),
        smoothing_mm: keys.profile_smoothing_mm,
        aligned: keys.profile_aligned,
        unit: keys.profile_unit,
        mirrored: keys.profile_mirrored,
    };
    let section = match &keys.section_file {
        Some(file) => named.own_section(file, source, collector).map(Some),
        None => Some(None),
    };
    let surface = named.resolve(source, collector);
    let flange = Flange {
        height: keys.flange_height_mm * MILLIMETRE,
        thickness: keys.flange_thickness_mm * MILLIMETRE,
    };
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
        rim_depth: keys.rim_depth_mm * MILLIMETRE,
    };
    let mesh = MeshFileKeys {
        section: "wheel",
        held_meaning: "the name in the mesh file of the nodes at the bore",
        file: keys.mesh_file.as_deref(),
        unit: keys.mesh_unit,
        contact: keys.contact_surface.as_deref(),
        held: keys.held_nodes.as_deref(),
        materials: &keys.materials,
    };
    let (mesh, materials) =
        (mesh.resolve(source.path(), collector), mesh.materials(material, element, collector));
    let (profile, measured) = surface?;
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
    if keys.section_file.is_some() {
        refuse_beside_section(source, collector);
    } else if let Err(Error::Input(mistake)) = wheel_profile_with_flange(&profile, &flange)
        .and_then(|running| wheel_section_on(running, &profile, keys.tape_diameter_m, &body))
    {
        // A flange or a body that the standard cannot have.
        collector.add(&["wheel.*"], translate(mistake, source, None));
    }
    let section = section?;
    if let (Some(mm), None, None) = (keys.tape_circle_mm, &keys.profile_file, &keys.section_file) {
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
        flange,
        body,
        mesh: mesh?,
        materials: materials?,
    })
}

/// Refuses the keys of a generic wheel beside a section in a file, which has its own flange and body.
fn refuse_beside_section(source: &Source, collector: &mut Collector) {
    const GENERIC: [&str; 8] = [
        "wheel.flange_height_mm",
        "wheel.flange_thickness_mm",
        "wheel.body",
        "wheel.bore_mm",
        "wheel.hub_diameter_mm",
        "wheel.rim_depth_mm",
        "wheel.web_hub_y_mm",
        "wheel.web_rim_y_mm",
    ];
    for key in GENERIC.into_iter().filter(|key| source.gives(key)) {
        let mistake = InputError::new(
            key,
            "given",
            "no key of a generic wheel beside wheel.section_file",
            "the file has flange, web, hub, bore and rim: remove one of the two keys",
        );
        collector.add(&["wheel.section_file"], mistake);
    }
}

/// Slope of a ratio such as `1:40`.
fn slope_of(text: &str) -> Option<f64> {
    let (rise, run) = text.split_once(':')?;
    let (rise, run): (f64, f64) = (rise.trim().parse().ok()?, run.trim().parse().ok()?);
    let slope = rise / run;
    (run > 0.0 && slope.is_finite() && slope.abs() <= 0.2).then_some(slope)
}
