//! Contact zones that grow with the contact, from a study to pressed bodies.

use std::path::Path;
use std::sync::Mutex;

use railspring_calibrate::analytic::hertz::point_contact;
use railspring_calibrate::pair::{CondensedPair, PairBody, condense_all};
use railspring_profiles::error::{Error, InputError, NumericsError, Result};
use railspring_profiles::monitor::Monitor;
use railspring_simulate::time::history::{Ending, SurfaceEnd};

use crate::results::bodies::meshes::{self, Meshes};
use crate::results::bodies::zones::*;
use crate::results::bodies::{geometry, solids};
use crate::results::springs::make;
use crate::study::Study;

/// Keeps the notes that are reported to it.
#[derive(Default)]
struct Notes(Mutex<Vec<String>>);

impl Monitor for Notes {
    fn progress(&self, _: &str, _: usize, _: usize) -> Result<()> {
        Ok(())
    }

    fn notice(&self, text: &str) {
        self.0.lock().unwrap().push(text.into());
    }
}

/// S1002 with its flange on the gauge face, coarse and in a moment; `keys` go to the end of the file. 8 kN downwards are a normal force of 13 kN there: the
/// largest load is as large that they are put on.
fn flange_contact(keys: &str) -> Study {
    let text = format!(
        "name = \"flange\"\n[rail]\nprofile = \"60E1\"\nlength_m = 0.3\n[wheel]\nprofile = \"S1002\"\n\
         tape_diameter_m = 0.858\n[track]\nlateral_shift_mm = 7\n[contact]\nfriction = 0.3\n\
         [calibration]\nloads_kn = [1, 2, 4, 8, 20]\nhorizontal_preloads_kn = [4]\n\
         [mesh]\ncontact_element_mm = 3\ncontact_element_along_mm = 3\nelement = \"full-integration\"\n{keys}"
    );
    Study::parse(Path::new("flange.toml"), &text).map_err(|e| e.to_string()).unwrap()
}

/// Goal: a flange contact 13 mm below the tape circle, on a wheel whose zone ends 13.5 mm below it, reaches the end
/// of the zone; the zone is made longer until it holds the contact, and both the note and the meshes say so.
#[test]
fn a_zone_that_the_contact_leaves_is_made_longer() {
    let mut study = flange_contact("");
    study.mesh.wheel_zone.face_depth = 13.5e-3;
    let notes = Notes::default();
    let geometry = geometry::geometry(study.statics()).unwrap();
    let options = mesh_options(study.statics(), &geometry);
    let mut meshes = meshes::meshes(study.statics(), &geometry, options, (None, None), &notes).unwrap();
    let press = |meshes: &Meshes| {
        let solids = solids::solids(study.statics(), &geometry, meshes);
        let bodies = condense_all(("superelements", &notes), PairBody::of_pair(false), true, |body| {
            solids.condense(body, solids.key(body))
        })?;
        let condensed = CondensedPair::new(bodies)?;
        make::press(study.statics(), &geometry, &condensed, &notes)
    };
    let Err(Error::Numerics(cause)) = press(&meshes) else { panic!("the contact fits the short zone") };
    assert_eq!(SurfaceEnd::of(cause.reason), Some(SurfaceEnd::ContactZone));
    within_zones(study.statics(), &geometry, &mut meshes, &notes, |_| Ok(()), press, |_| None).unwrap();
    assert!(meshes.options.wheel_zone.face_depth > 17e-3, "{:?}", meshes.options.wheel_zone);
    let notes = notes.0.into_inner().unwrap();
    assert!(!notes.is_empty() && notes.iter().all(|n| n.contains("meshed again")), "{notes:?}");
}

/// Goal: a run that has ended at the end of a zone is kept where larger meshes are refused, with the reason,
/// and is not whole then. It is kept unchanged where no larger zone can be had: at the end of a profile, or
/// with a window that the study gives. Otherwise the zone is made longer, each time by twice as much, until
/// it holds the whole profiles. An error without a result stays the refusal.
#[test]
fn what_was_done_is_kept_where_no_larger_zone_can_be_had() {
    use nalgebra::Point2;
    use railspring_profiles::error::StopReason;
    let study = flange_contact("window_half_length_mm = 12\n");
    let geometry = geometry::geometry(study.statics()).unwrap();
    let options = mesh_options(study.statics(), &geometry);
    let meshes =
        meshes::meshes(study.statics(), &geometry, options, (None, None), &Notes::default()).unwrap();
    let ended = |end| Ending::EndOfSurface { time: 0.0435, end, rail: Point2::new(-0.03, 0.01) };
    let refuse = |_: &Meshes| {
        Err(InputError::new("--memory", "1 GiB", "2 GiB for the larger meshes", "raise it").into())
    };
    let within = |end, accept: &dyn Fn(&Meshes) -> Result<()>| {
        let (mut used, notes, runs) = (meshes.clone(), Notes::default(), Mutex::new(0));
        let work = |_: &Meshes| {
            *runs.lock().unwrap() += 1;
            Ok(ended(end))
        };
        let reached = |ending: &Ending| ZoneLimit::in_time(*ending);
        let done =
            within_zones(study.statics(), &geometry, &mut used, &notes, accept, work, reached).unwrap();
        assert_eq!(done.result, ended(end));
        let longer = (used.options != meshes.options).then_some(used.options);
        (done.refused, longer, runs.into_inner().unwrap(), notes.0.into_inner().unwrap())
    };
    let (refused, longer, runs, notes) = within(SurfaceEnd::ContactZone, &refuse);
    assert_eq!((refused, longer, runs, notes.len()), (true, None, 1, 1));
    assert!(notes[0].contains("at 0.0435 s") && notes[0].contains("is refused: --memory"), "{notes:?}");
    for end in [SurfaceEnd::ContactWindow, SurfaceEnd::RailProfile] {
        assert_eq!(within(end, &refuse), (false, None, 1, Vec::new()));
    }
    let (refused, longer, runs, notes) = within(SurfaceEnd::ContactZone, &|_| Ok(()));
    // 4, 8 and 16 mm
    let mut whole = meshes.options.clone();
    extend_zones(&geometry, &mut whole, 28e-3);
    let held = whole.clone();
    extend_zones(&geometry, &mut whole, 1.0);
    assert_eq!(held, whole);
    assert_eq!((refused, longer, runs, notes.len()), (false, Some(whole), 4, 3));

    let stop = NumericsError {
        stage: "contact".into(),
        step: None,
        iteration: 0,
        residual: 0.0,
        active: 1,
        reason: StopReason::EdgeOfCandidates,
    };
    let fail = |_: &Meshes| -> Result<Ending> { Err(stop.clone().into()) };
    let notes = Notes::default();
    let failed =
        within_zones(study.statics(), &geometry, &mut meshes.clone(), &notes, refuse, fail, |_| None)
            .map(|_| ());
    assert!(failed.unwrap_err().to_string().starts_with("--memory = 1 GiB"));

    // a fine grid that does not settle is not a matter of the zone: nothing is meshed again for it
    let unsettled = |_: &Meshes| -> Result<Ending> {
        Err(NumericsError { reason: StopReason::GridUnsettled, ..stop.clone() }.into())
    };
    let failed = within_zones(
        study.statics(),
        &geometry,
        &mut meshes.clone(),
        &notes,
        |_| Ok(()),
        unsettled,
        |_| None,
    );
    let failed = failed.map(|_| ()).unwrap_err().to_string();
    assert!(failed.contains("does not hold the patch"), "{failed}");
    assert!(notes.0.into_inner().unwrap().is_empty());
}

/// Goal: the contact grid that the program chooses is as long as the patch on the flange asks for, which the normal force makes: 1.25 times the
/// load, at which loads end, and not the load over the cosine of the contact angle, 2.9 times. A usual load keeps the usual window. One that the study
/// gives stays, and the load is refused.
#[test]
fn the_window_follows_the_patch_unless_the_study_gives_it() {
    let loads = |text: &str| flange_contact(text);
    let mut study = loads("");
    study.rail.length = 0.555;
    study.calibration.loads = vec![160e3];
    let geometry = geometry::geometry(study.statics()).unwrap();
    let [along, across] = geometry.pair.relative_radii();
    let hertz = |load| {
        point_contact(load, along, across, study.rail.material.contact_modulus(&study.wheel.material))
            .unwrap()
    };
    let usual = mesh_options(study.statics(), &geometry);
    assert!(usual.contact_half_length > hertz(1.25 * 160e3).semi_axis_x);
    assert!(usual.contact_half_length < hertz(160e3 / geometry.pair.touch.contact_angle.cos()).semi_axis_x);
    assert_eq!(usual.window_half_length, study.mesh.window_half_length);
    let notes = Notes::default();
    check_loads(study.statics(), &geometry, &notes).unwrap();
    assert!(notes.0.lock().unwrap().is_empty());
    study.calibration.loads = vec![500e3];
    let patch = hertz(1.25 * 500e3).semi_axis_x;
    check_loads(study.statics(), &geometry, &notes).unwrap();
    let longer = mesh_options(study.statics(), &geometry);
    assert!(patch > usual.contact_half_length && longer.contact_half_length > patch, "{patch}");
    assert!(longer.window_half_length > usual.window_half_length);
    assert!(notes.0.into_inner().unwrap()[0].contains("instead of"));

    let mut given = loads("window_half_length_mm = 12\n");
    given.rail.length = 0.555;
    given.calibration.loads = vec![85e3];
    let refused = check_loads(given.statics(), &geometry, &Notes::default()).unwrap_err().to_string();
    assert!(refused.contains("fits the contact zone of \u{b1}12.0 mm"), "{refused}");
    assert_eq!(mesh_options(given.statics(), &geometry).window_half_length, 12e-3);
}
