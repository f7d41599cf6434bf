//! Slices of the CONTACT program: one of many profiles, by its name or number.

use std::path::Path;

use railspring_profiles::profile_file::{
    FindingKind, MeasuredPoint, MeasuredProfile, ProfileFormat, ProfileKind, ReadOptions, parse, read, write,
};
use railspring_profiles::section::{rail_section, wheel_section};

/// A folder that is removed at the end.
struct Folder(std::path::PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("railspring-slices-{}-{name}", std::process::id()));
        std::fs::create_dir_all(folder.join("wing")).unwrap();
        Self(folder)
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.0.join(name), text).unwrap();
    }

    fn read(&self, name: &str, part: Option<&str>) -> Result<MeasuredProfile, String> {
        let options = ReadOptions { part: part.map(str::to_owned), ..ReadOptions::default() };
        read(&self.0.join(name), &options).map_err(|error| error.to_string())
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn points(kind: ProfileKind, lower: f64) -> Vec<MeasuredPoint> {
    let running = match kind {
        ProfileKind::Rail => rail_section("60E1").unwrap().running,
        ProfileKind::Wheel => wheel_section("S1002", 0.92).unwrap().running,
    };
    let sample = running.sample(1e-3).into_iter();
    let at = |p: nalgebra::Point2<f64>| nalgebra::Point2::new(p.x, p.y + lower);
    sample.map(|p| MeasuredPoint { point: at(p), line: 0, weight: 1.0 }).collect()
}

/// The list as the program's own files have it: comments, words after numbers, either quote, windows separators.
fn list() -> &'static str {
    "% a wing rail\n\n  0.5  1000.0   S_OFFSET [m], S_SCALE [mm/m]\n 3   NSLC\n 5 1 0  NFEAT, NKINK, NACCEL\n 1  S_METHOD\n\n\
     %  - slice positions\n 0.0  'wing/one.prr'   % the first\n ! a remark\n 0.1  \"wing\\two.txt\"\n 0.25 'wing/three.prr'\n\n\
     % kinks\n 3  P_KINK\n 0.0  1 2 3 4 5\n"
}

fn wing(name: &str) -> Folder {
    let folder = Folder::new(name);
    let rail = |lower: f64| points(ProfileKind::Rail, lower);
    folder.write("wing/one.prr", &write(ProfileFormat::Simpack, ProfileKind::Rail, &rail(0.0), "one"));
    folder.write("wing/two.txt", &write(ProfileFormat::Text, ProfileKind::Rail, &rail(1e-3), "two"));
    folder.write("wing/three.prr", &write(ProfileFormat::Simpack, ProfileKind::Rail, &rail(2e-3), "three"));
    folder.write("wing.slcs", list());
    folder
}

#[test]
fn a_slice_is_chosen_by_name_or_number() {
    let folder = wing("chosen");
    for (part, lower, format) in [
        ("1", 0.0, ProfileFormat::Simpack),
        ("wing/one.prr", 0.0, ProfileFormat::Simpack),
        ("TWO", 1e-3, ProfileFormat::Text),
        ("three.prr", 2e-3, ProfileFormat::Simpack),
        ("3", 2e-3, ProfileFormat::Simpack),
    ] {
        let profile = folder.read("wing.slcs", Some(part)).unwrap();
        assert_eq!((profile.format, profile.kind), (format, ProfileKind::Rail), "{part}");
        let expected = points(ProfileKind::Rail, lower);
        assert_eq!(profile.points.len(), expected.len());
        for (p, q) in profile.points.iter().zip(&expected) {
            // ROUNDOFF: metres to millimetres and back, below 0.15 m.
            assert!((p.point - q.point).amax() <= 1e-16, "{part}");
        }
        let about = &profile.findings[0];
        assert_eq!(about.kind, FindingKind::PassedOver);
        assert!(about.text.contains("of 3 of ") && about.text.contains(" mm: the others"), "{about}");
    }
    // Position is scale times offset and position: 1000·(0.5 + 0.25).
    let third = folder.read("wing.slcs", Some("3")).unwrap();
    assert!(third.findings[0].text.contains("at 750 mm"), "{}", third.findings[0]);
}

#[test]
fn without_a_choice_the_slices_are_listed() {
    let folder = wing("listed");
    let message = folder.read("wing.slcs", None).unwrap_err();
    for part in [
        "wing.slcs:9:1 = \"3 slices\"",
        "1 \"wing/one.prr\" at 500 mm",
        "3 \"wing/three.prr\"",
        "give `profile_part`",
    ] {
        assert!(message.contains(part), "{part}: {message}");
    }
    for part in ["four", "0", "4"] {
        let message = folder.read("wing.slcs", Some(part)).unwrap_err();
        assert!(message.contains("the name or the number of a slice"), "{message}");
    }
    // A wheel's slices stand at angles, and a single one needs no choice.
    let wheel = points(ProfileKind::Wheel, 0.0);
    folder.write("wing/wheel.txt", &write(ProfileFormat::Text, ProfileKind::Wheel, &wheel, "flat"));
    folder.write("flat.slcw", "0 1 TH_OFFSET\n1\n0 0 0\n2\n-3.1 'wing/wheel.txt'\n");
    let profile = folder.read("flat.slcw", None).unwrap();
    assert_eq!((profile.kind, profile.points.len()), (ProfileKind::Wheel, wheel.len()));
    assert!(profile.findings[0].text.contains("-3.1 rad"), "{}", profile.findings[0]);
}

#[test]
fn lists_that_are_not_understood_are_refused_with_their_line() {
    let folder = wing("refused");
    for (text, place, expected) in [
        ("", "x.slcs:1:1", "offset and scale"),
        ("0\n", "x.slcs:1:1", "offset and scale"),
        ("0 1\nmany\n", "x.slcs:2:1", "the number of slices"),
        ("0 1\n2.5\n0 0 0\n1\n", "x.slcs:2:1", "a number of slices from 1"),
        ("0 1\n2\n0 0\n", "x.slcs:3:1", "features, kinks and accelerations"),
        ("0 1\n2\n0 0 0\n1\n0 'wing/one.prr'\n", "x.slcs:6:1", "2 slices as line 2 says; there are 1"),
        ("0 1\n1\n0 0 0\n1\nzero 'wing/one.prr'\n", "x.slcs:5:1", "position and 'file'"),
        ("0 1\n1\n0 0 0\n1\n0\n", "x.slcs:5:1", "position and 'file'"),
        ("0 1\n1\n0 0 0\n1\n0 'wing/nowhere.prr'\n", "x.slcs:5:1", "a readable profile file"),
        ("0 1\n1\n0 0 0\n1\n0 'x.slcs'\n", "x.slcs:5:1", "a single profile"),
    ] {
        folder.write("x.slcs", text);
        let message = folder.read("x.slcs", None).unwrap_err();
        assert!(message.contains(place) && message.contains(expected), "{text:?}: {message}");
    }
    folder.write("twice.slcs", "0 1\n2\n0 0 0\n1\n0 'wing/one.prr'\n0 'wing/one.prr'\n");
    let message = folder.read("twice.slcs", Some("one")).unwrap_err();
    assert!(message.contains("2 are called so") && message.contains("number"), "{message}");
    let chosen = folder.read("twice.slcs", Some("2")).unwrap();
    assert!(chosen.findings[0].text.contains("do not increase"), "{}", chosen.findings[0]);
    // Points that are not in the list itself are not looked for there.
    let name = Path::new("wing.slcs").display().to_string();
    let message = parse(&name, list().as_bytes(), &ReadOptions::default()).unwrap_err().to_string();
    assert!(message.contains("its slices are files of their own"), "{message}");
}
