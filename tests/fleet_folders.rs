//! Folders with the measured profiles of a fleet as wheels of a table.
//!
//! Goal: every profile in a folder and in the folders in it is a wheel, in whatever format. A file that is
//! none is a row with its reason or is left out, and never ends the table. Facts about the measurements stand
//! in columns. Source: the worn wheel of `data/profiles`, written in several formats.

use std::collections::BTreeMap;
use std::path::Path;

use railspring::engine::store::Store;
use railspring::results::bodies::estimate::Resources;
use railspring::table::{Places, Table};
use railspring_profiles::monitor::Silent;
use railspring_profiles::profile_file::{ProfileFormat, ProfileKind, ReadOptions, read, write};

use crate::tables::Place;

const TABLE: &str = "name = \"fleet\"\nbase = \"base.toml\"\nshifts_mm = [0]\nstiffness_at_kn = [20]\n\
    [[wheel]]\nfolder = \"measured\"\nstandard = \"S1002\"\n[[rail]]\nprofile = \"60E1\"\n";

/// The worn wheel in a format.
fn worn(format: ProfileFormat) -> String {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/profiles/worn-s1002.whl");
    let wheel = read(&file, &ReadOptions::default()).unwrap();
    write(format, ProfileKind::Wheel, &wheel.points, "worn")
}

/// A place with a folder of wheels in three formats, of files that are none, and of other kinds.
fn fleet(table: &str) -> Place {
    let place = Place::new(table);
    let write = |name: &str, content: &[u8]| {
        let path = place.path("measured").join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, content).unwrap();
    };
    let header = "CarNo=4711\nAxleNo=2\nWheelID=L\nDate=12.05.2024\nMileage[m]=12345\nUserName=-\n";
    write("May/4711_1.whl", format!("{header}{}", worn(ProfileFormat::MiniProf)).as_bytes());
    write("May/4711_2.prw", worn(ProfileFormat::Simpack).as_bytes());
    write("June/depot/0815_1.csv", worn(ProfileFormat::Csv).as_bytes());
    write("June/broken.whl", b"CarNo=13\nColumnDef=X,Y\n\nnothing\n");
    write("June/round.slcw", b"0 1\n2\n0 0 0\n1\n0.5 'depot/0815_1.csv'\n1 'gone.whl'\n");
    write("June/photo.png", b"\x89PNG\r\n\x1a\n\0\0");
    write("protocol.pdf", b"%PDF-1.4\n\0");
    write(".hidden.whl", b"");
    place
}

fn rows(place: &Place) -> Vec<BTreeMap<String, String>> {
    csv::Reader::from_path(place.path("out/table.csv")).unwrap().deserialize().map(Result::unwrap).collect()
}

/// Goal: the wheels of three formats in three folders have the same law. Files that are no profiles are rows
/// with their reasons. Files of other kinds are left out, and the terminal counts them. Entries of a list, of
/// the names and of the headers stand in columns behind the identity. `table.json` has them, and `--where`
/// knows them. Accuracy: FORMAT, the points of the formats have six digits and more; the smoothing of their
/// scatter is the same.
#[test]
fn a_folder_of_a_fleet_is_a_table() {
    const FORMAT: f64 = 1e-3;
    let keys =
        "[[wheel]]\nmetadata_file = \"measured/fleet.csv\"\nname_pattern = \"{month}/{vehicle}_{axle}\"";
    let place = fleet(&TABLE.replace("[[wheel]]", keys));
    let list = "file;Depot;axle\nMay/4711_2;Nord;7\nJune/depot/0815_1.csv;S\u{fc}d;\ngone;West;\n";
    std::fs::write(place.path("measured/fleet.csv"), list).unwrap();
    let (code, said) = place.run(&["table", "table.toml", "-o", "out"]);
    assert_eq!(code, Some(1), "{said}");
    for part in [
        "left out, as they are no profiles: June/photo.png, protocol.pdf",
        "1 of 3 rows of measured/fleet.csv have no file",
        "3 of 5 files have no row in measured/fleet.csv",
        "3 of 5 files have names of another pattern",
        "5 pairs at 5 places, 0 of them in the store, 1 of files that cannot be read; 4 to be made",
        "5 places: 3 complete, 0 with a law that ends early, 2 without a law",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
    let rows = rows(&place);
    let wheels: Vec<&str> = rows.iter().map(|row| row["wheel"].as_str()).collect();
    assert_eq!(wheels, ["June/broken", "June/depot/0815_1", "June/round/gone", "May/4711_1", "May/4711_2"]);
    let row = |at: usize, column: &str| rows[at][column].as_str();
    for (at, name) in [(0, "broken.whl"), (2, "gone.whl")] {
        assert_eq!(row(at, "status"), "failed");
        assert!(row(at, "reason").contains(name), "{}", row(at, "reason"));
    }
    let stiffness = |at: usize| row(at, "stiffness_kn_per_m_at_20kn").parse::<f64>().unwrap();
    for at in [1, 4] {
        assert!((stiffness(at) / stiffness(3) - 1.0).abs() < FORMAT, "{} {}", stiffness(at), stiffness(3));
    }
    let known = |at: usize| {
        let columns = ["vehicle", "axle", "wheel", "date", "mileage_km", "user_name", "depot", "month"];
        columns.map(|column| row(at, &format!("wheel_{column}"))).join(" ")
    };
    assert_eq!(known(3), "4711 1 L 2024-05-12 12.345 -  May");
    assert_eq!(known(4), "4711 7     Nord May");
    assert_eq!(known(0), "13       ");
    assert_eq!((row(1, "wheel_depot"), row(1, "wheel_slice_position_rad")), ("S\u{fc}d", "0.5"));
    let header = std::fs::read_to_string(place.path("out/table.csv")).unwrap();
    assert!(header.contains(",shift_mm,wheel_axle,wheel_date,wheel_depot,wheel_mileage_km,"), "{header}");
    let case = &place.json("out/table.json")["cases"][3];
    assert_eq!((&case["wheel_metadata"]["mileage_km"], case.get("rail_metadata")), (&12.345.into(), None));
    let export =
        ["export", "out/table.json", "--to", "json", "--where", "wheel_depot=Nord", "-o", "exported"];
    let (code, said) = place.run(&export);
    assert_eq!(code, Some(0), "{said}");

    // what is known of a measurement is no other place and no other result
    std::fs::write(place.path("measured/fleet.csv"), list.replace("Nord", "Ost")).unwrap();
    let (code, said) = place.run(&["table", "table.toml", "-o", "out", "--diff", "out/table.csv"]);
    assert_eq!(code, Some(1), "{said}");
    assert!(said.contains("3 of them in the store, 1 of files that cannot be read; 1 to be made"), "{said}");
    assert!(said.contains("0 places with other values, 0 new, 0 gone"), "{said}");
}

/// Goal: a list of pairs has those pairs alone; a name that no body has is refused with its line, and so are two ways to say which pairs there are, keys of a folder without
/// one, and keys of a study that are wrong.
#[test]
fn pairs_come_from_a_list() {
    let place = fleet(TABLE);
    let parse = |text: &str| Table::parse(&place.path("table.toml"), text);
    let listed = TABLE.replace("shifts_mm", "pairs_file = \"pairs.csv\"\nshifts_mm");
    place.write("pairs.csv", "rail,wheel\n60E1,May/4711_1\n60E1,June/broken\n");
    let pairs = |table: Table| -> Vec<String> { table.cases.into_iter().map(|case| case.wheel).collect() };
    assert_eq!(pairs(parse(&listed).unwrap()), ["May/4711_1", "June/broken"]);
    assert_eq!(pairs(parse(&TABLE.replace("shifts_mm", "pairs = \"all\"\nshifts_mm")).unwrap()).len(), 5);

    place.write("wrong.csv", "wheel,rail\nMay/4711_3,60E1\n");
    let refused = |from: &str, to: &str, said: &[&str]| {
        assert!(TABLE.contains(from));
        let mistakes = parse(&TABLE.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(said.iter().all(|said| mistakes.contains(said)), "{said:?}: {mistakes}");
    };
    refused(
        "shifts_mm",
        "pairs_file = \"wrong.csv\"\nshifts_mm",
        &["pairs_file", "on line 2", "did you mean"],
    );
    refused(
        "shifts_mm",
        "pairs_file = \"none.csv\"\nshifts_mm",
        &["table.toml:3: pairs_file = \"none.csv\""],
    );
    refused(
        "shifts_mm",
        "pairs = \"all\"\npairs_file = \"pairs.csv\"\nshifts_mm",
        &["either pairs or pairs_file"],
    );
    refused(
        "profile = \"60E1\"",
        "profile = \"60E1\"\nname_pattern = \"{a}\"",
        &["rail[0].name_pattern", "folder"],
    );
    refused("standard =", "name_pattern = \"a\"\nstandard =", &["wheel[0].name_pattern", "placeholder"]);
    refused(
        "standard =",
        "metadata_file = \"none.csv\"\nstandard =",
        &["wheel[0].metadata_file = \"none.csv\""],
    );
    refused("\"S1002\"", "\"S1003\"", &["wheel[0].standard = \"S1003\""]);
    refused("measured", "none", &["wheel[0].folder"]);
}

/// Goal: a profile file that is named itself and cannot be read ends the table, as before.
#[test]
fn a_file_that_is_named_is_refused() {
    let place = fleet(TABLE);
    let one = TABLE.replace("folder = \"measured\"", "profile_file = \"measured/June/round.slcw\"");
    let mistakes = Table::parse(&place.path("table.toml"), &one).unwrap_err().to_string();
    assert!(mistakes.contains("wheel[0].profile_file"), "{mistakes}");
}

/// Goal: the wheels of a folder are pressed on the wheel of their standard, and on the rail of the table, whether that is a standard one or was measured; the store keeps these alone.
/// What that changes is within the band of the rows. Source: the same table with `bodies = "own"`. Accuracy: the band, and GRID for the tangent, which is noisy where a contact begins.
#[test]
fn the_wheels_of_a_folder_share_their_bodies() {
    const GRID: f64 = 0.5e-2;
    let worn_rail = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/profiles/worn-60e1.prr");
    let measured = TABLE.replace("profile = \"60E1\"", &format!("profile_file = {worn_rail:?}"));
    for (table, rail) in [(TABLE, "60E1"), (&*measured, "worn-60e1")] {
        let place = fleet(table);
        let run = |table: &str, out: &str| -> Vec<BTreeMap<String, String>> {
            place.write("one.toml", table);
            let (code, said) = place.run(&["table", "one.toml", "-o", out]);
            assert_eq!(code, Some(1), "{said}");
            let rows = csv::Reader::from_path(place.path(out).join("table.csv"));
            rows.unwrap().deserialize().map(Result::unwrap).collect()
        };
        let shared = run(table, "shared");
        let names =
            std::fs::read_dir(place.path("cache/store")).unwrap().map(|entry| entry.unwrap().file_name());
        let of_bodies = names.filter(|name| name.to_string_lossy().starts_with("body-")).count();
        assert!(
            (2..=4).contains(&of_bodies),
            "{rail}: {of_bodies} bodies: a wheel and a rail, and those of coarser elements"
        );
        let own = run(&table.replace("shifts_mm", "bodies = \"own\"\nshifts_mm"), "own");
        let number = |row: &BTreeMap<String, String>, column: &str| row[column].parse::<f64>().unwrap();
        for (shared, own) in shared.iter().zip(&own).filter(|(shared, _)| shared["status"] == "complete") {
            assert_eq!((shared["bodies"].as_str(), own["bodies"].as_str()), ("nominal-wheels", "own"));
            assert!(number(shared, "off_bodies_mm") > 0.5 && own["off_bodies_mm"].is_empty());
            for (value, band, grid) in [
                ("displacement_mm_at_20kn", "displacement_rel_bodies_band", 0.0),
                ("stiffness_kn_per_m_at_20kn", "stiffness_rel_bodies_band", GRID),
                ("horizontal_kn_per_m_at_20kn", "horizontal_rel_bodies_band", 0.0),
            ] {
                let change = number(own, value) / number(shared, value) - 1.0;
                assert!(change.abs() < number(shared, band) + grid, "{rail}: {value}: {change}");
                assert!(change != 0.0, "{rail}: {value} is that of other bodies");
            }
            // what is read off the profile does not depend on them
            for column in
                ["wheel_flange_height_mm", "wheel_hollow_mm", "conicity_at_3mm", "rolling_radius_mm"]
            {
                assert!((number(own, column) - number(shared, column)).abs() < 1e-9, "{column}");
            }
        }
    }
}

/// Goal: wheels whose list says their diameters have these, and are pressed on a wheel between the two whose diameters are the next multiples of 20 mm. Source: the same table with
/// `bodies = "own"`. Accuracy: the band, and GRID for the tangent, which is noisy where a contact begins; the horizontal stiffness of the smaller wheel of the two is off by more than its band.
#[test]
fn wheels_have_the_diameters_of_their_list() {
    const GRID: f64 = 0.5e-2;
    let table = TABLE.replace("[[wheel]]", "[[wheel]]\nmetadata_file = \"measured/fleet.csv\"");
    let place = Place::new(&table);
    std::fs::create_dir(place.path("measured")).unwrap();
    place.write("measured/fleet.csv", "file,Diameter [mm]\n1,842\n2,853.5\n3,\n");
    for name in ["1", "2", "3"] {
        place.write(&format!("measured/{name}.csv"), &worn(ProfileFormat::Csv));
    }
    let run = |table: &str| {
        place.write("table.toml", table);
        let (code, said) = place.run(&["table", "table.toml", "-o", "out"]);
        assert_eq!(code, Some(0), "{said}");
        assert!(said.contains("2 of 3 wheels say their diameters; they are taken"), "{said}");
        rows(&place)
    };
    let shared = run(&table);
    let kept = std::fs::read_dir(place.path("cache/store")).unwrap();
    let names = kept.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned());
    let of_bodies = names.filter(|name| name.starts_with("body-")).count();
    // wheels of 840, 860 and, as the study has it, of 858 mm on one rail, and those of coarser elements
    assert!((4..=8).contains(&of_bodies), "{of_bodies}");
    let own = run(&table.replace("shifts_mm", "bodies = \"own\"\nshifts_mm"));
    let number = |row: &BTreeMap<String, String>, column: &str| row[column].parse::<f64>().unwrap();
    for (radius, (shared, own)) in [421.0, 426.75, 429.0].iter().zip(shared.iter().zip(&own)) {
        assert_eq!(shared["bodies"], "nominal-wheels");
        assert!((number(shared, "rolling_radius_mm") - radius).abs() < 1.0, "{radius}");
        assert!((0.5..4.0).contains(&number(shared, "off_bodies_mm")), "{radius}");
        for (value, band, grid) in [
            ("displacement_mm_at_20kn", "displacement_rel_bodies_band", 0.0),
            ("stiffness_kn_per_m_at_20kn", "stiffness_rel_bodies_band", GRID),
            ("horizontal_kn_per_m_at_20kn", "horizontal_rel_bodies_band", 0.0),
        ] {
            let change = number(own, value) / number(shared, value) - 1.0;
            println!("{radius} {value}: {change} {}", number(shared, band));
            assert!(
                change != 0.0 && change.abs() < number(shared, band) + grid,
                "{radius} {value}: {change}"
            );
        }
    }
    let horizontal = |row: usize| number(&shared[row], "horizontal_kn_per_m_at_20kn");
    let change = horizontal(1) / horizontal(0) - 1.0;
    assert!(change.abs() > number(&shared[0], "horizontal_rel_bodies_band"), "{change}");
}

/// Goal: one wheel in a hundred, by the hash of what its springs depend on, is pressed on its own bodies as well. Its columns have what these change: the
/// difference between its row with `bodies = "own"` and the one it has, within the band. The store keeps no body of it, and its own rail is that of the others. The plan counts the time
/// of its body. A table again with another shift compares this one as well. Source: the worn wheel lowered by micrometres until its hash is one of these; the same wheel on its
/// own bodies, with another store. Accuracy: ROUNDOFF of the values in the file; GRID as above.
#[test]
fn one_wheel_in_a_hundred_is_pressed_on_its_own_bodies() {
    const ROUNDOFF: f64 = 1e-9;
    const GRID: f64 = 0.5e-2;
    let place = Place::new(TABLE);
    std::fs::create_dir(place.path("measured")).unwrap();
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/profiles/worn-s1002.whl");
    let worn = read(&file, &ReadOptions::default()).unwrap();
    let lowered = |lower: u32| {
        let mut points = worn.points.clone();
        points.iter_mut().for_each(|point| point.point.y += 1e-6 * f64::from(lower));
        place.write("measured/one.whl", &write(ProfileFormat::Csv, ProfileKind::Wheel, &points, "worn"));
        Table::read(&place.path("table.toml")).unwrap()
    };
    let is_checked = |lower: &u32| {
        let table = lowered(*lower);
        let hash = railspring::hash::key(&table.cases[0].study.statics());
        u32::from_str_radix(&hash[..8], 16).unwrap().is_multiple_of(100)
    };
    // seconds and bytes
    let needs = |lower: u32| {
        let (table, store) = (lowered(lower), Store::open(&place.path("cache/store")).unwrap());
        let places = Places::of(&table, &store, false, Resources::of_the_machine(&Silent));
        places.plan(true).unwrap().needs.unwrap()
    };
    let checked = (0..2000).find(is_checked).expect("a hash of a hundred ends in two zeros");
    assert!(!is_checked(&(checked + 1)));
    let [(of_other, _), (of_checked, _)] = [checked + 1, checked].map(needs);
    assert!(of_checked > 1.3 * of_other, "{of_checked} {of_other} s");
    let run = |table: &str, store: &str| -> Vec<BTreeMap<String, String>> {
        place.write("table.toml", table);
        let (code, said) = place.run(&["table", "table.toml", "-o", "out", "--cache", store]);
        assert_eq!(code, Some(0), "{said}");
        rows(&place)
    };
    let bodies = |store: &str| {
        let kept = std::fs::read_dir(place.path(store)).unwrap();
        let names = kept.map(|file| file.unwrap().file_name());
        names.filter(|name| name.to_string_lossy().starts_with("body-")).count()
    };
    let shared = run(TABLE, "store").remove(0);
    assert_eq!(bodies("store"), 2);
    let own = run(&TABLE.replace("shifts_mm", "bodies = \"own\"\nshifts_mm"), "other").remove(0);
    assert_eq!(bodies("other"), 2);
    let number = |row: &BTreeMap<String, String>, column: &str| row[column].parse::<f64>().unwrap();
    for (value, found, band, grid) in [
        ("displacement_mm", "displacement_rel_own_bodies", "displacement_rel_bodies_band", 0.0),
        ("stiffness_kn_per_m", "stiffness_rel_own_bodies", "stiffness_rel_bodies_band", GRID),
        ("horizontal_kn_per_m", "horizontal_rel_own_bodies", "horizontal_rel_bodies_band", 0.0),
    ] {
        let value = format!("{value}_at_20kn");
        let change = number(&own, &value) / number(&shared, &value) - 1.0;
        assert!((number(&shared, found) - change).abs() < ROUNDOFF, "{value}: {change}");
        assert!(change != 0.0 && change.abs() < number(&shared, band) + grid, "{value}: {change}");
        assert_eq!(own[found], "");
    }
    let again = run(&TABLE.replace("shifts_mm = [0]", "shifts_mm = [0, 1]"), "store");
    assert_eq!((again.len(), bodies("store")), (2, 2));
    for row in again {
        assert!(row["displacement_rel_own_bodies"].parse::<f64>().is_ok(), "{row:?}");
    }
}

/// Source: two wheels of one shape are a wheelset of equal sides. Goal: the conicity of an axle whose left and right wheels were measured is that of either where both are alike, and lies
/// between those of two that differ; a wheel without the other one of its axle has none. The standard and the uncertainty of the place stand in columns. Accuracy: ROUNDOFF, of radii in nanometres.
#[test]
fn an_axle_runs_on_both_of_its_wheels() {
    const ROUNDOFF: f64 = 1e-4;
    let place =
        Place::new(&TABLE.replace("[[wheel]]", "[[wheel]]\nname_pattern = \"{vehicle}_{axle}_{side}\""));
    std::fs::create_dir(place.path("measured")).unwrap();
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/profiles/worn-s1002.whl");
    let worn = read(&file, &ReadOptions::default()).unwrap();
    let hollow = |depth: f64| {
        let mut points = worn.points.clone();
        for point in &mut points {
            point.point.y -= depth * (-((point.point.x - 5e-3) / 18e-3).powi(2)).exp();
        }
        write(ProfileFormat::Csv, ProfileKind::Wheel, &points, "worn")
    };
    for (name, depth) in [("7_1_L", 0.0), ("7_1_R", 0.0), ("7_2_L", 0.0), ("7_2_R", 1e-3), ("7_3_L", 0.0)] {
        place.write(&format!("measured/{name}.csv"), &hollow(depth));
    }
    let (code, said) = place.run(&["table", "table.toml", "-o", "out"]);
    assert_eq!(code, Some(0), "{said}");
    let rows = rows(&place);
    let number = |row: usize, column: &str| rows[row][column].parse::<f64>().unwrap();
    let (own, axle) = ("conicity_at_3mm", "axle_conicity_at_3mm");
    for row in 0..2 {
        assert!((number(row, axle) / number(row, own) - 1.0).abs() < ROUNDOFF, "{row}");
    }
    let (least, most) = (number(2, own).min(number(3, own)), number(2, own).max(number(3, own)));
    assert!(most > 1.02 * least && (least..=most).contains(&number(2, axle)), "{least} {most}");
    assert_eq!(rows[2][axle], rows[3][axle]);
    assert_eq!(rows[4][axle], "");
    assert_eq!(rows[0]["wheel_standard"], "S1002");
    assert!((0.0..5.0).contains(&number(0, "wheel_lateral_uncertainty_mm")));
}
