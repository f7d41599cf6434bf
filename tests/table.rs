//! Tables of springs: `railspring table`.
//!
//! Goal: a row is what the commands for one study say of that pair; whatever was made is not made again, and what a change has no
//! influence on stays; a case that fails is a row. Source: `railspring calibrate` on the studies that
//! the cases are, and tables with an empty store, equal to the byte.

use std::collections::BTreeMap;
use std::path::Path;

use crate::tables::Place;

/// Two wheels on two rails at two shifts, with columns at loads of the study.
const TABLE: &str = "name = \"fleet\"\nbase = \"base.toml\"\nshifts_mm = [0, 2]\nstiffness_at_kn = [20, 60]\n\
    [[wheel]]\nprofile = \"S1002\"\n[[wheel]]\nname = \"worn\"\nprofile_file = \"worn.whl\"\nstandard = \"S1002\"\n\
    [[rail]]\nprofile = \"60E1\"\n[[rail]]\nprofile = \"54E1\"\ninclination = \"1:20\"\n";

impl Place {
    /// The table of a file, which holds.
    fn table(&self, file: &str, out: &str, more: &[&str]) -> String {
        let (code, said) = self.run(&[&["table", file, "-o", out], more].concat());
        assert_eq!(code, Some(0), "{said}");
        said
    }

    fn rows(&self, out: &str) -> Vec<BTreeMap<String, String>> {
        rows(&self.path(out).join("table.csv"))
    }
}

fn rows(file: &Path) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(file).unwrap();
    reader.deserialize().map(Result::unwrap).collect()
}

fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("{column} = {:?}", row[column]))
}

/// Goal: the row of a pair without a shift has the springs that `railspring calibrate` makes of the same keys, and its tangents are
/// those of the load curve; the row of another shift those of a study with that shift. Source: `stiffness.json`, `load_curve.csv`.
/// Accuracy: ROUNDOFF, the same numbers through other sums.
#[test]
fn a_row_is_the_calibration_of_its_study() {
    const ROUNDOFF: f64 = 1e-9;
    let place = Place::new(TABLE);
    place.table("table.toml", "out", &[]);
    let rows = place.rows("out");
    assert_eq!(rows.len(), 8);
    let base = std::fs::read_to_string(place.path("base.toml")).unwrap();
    let of_rail = "profile = \"54E1\"\ninclination = \"1:20\"";
    let study = base
        .replace("profile = \"60E1\"", of_rail)
        .replace("profile = \"S1002\"", "profile_file = \"worn.whl\"\nstandard = \"S1002\"");
    for shift in ["0", "2"] {
        place.write("one.toml", &format!("{study}[track]\nlateral_shift_mm = {shift}\n"));
        let (code, said) = place.run(&["calibrate", "one.toml", "-o", "one"]);
        assert_eq!(code, Some(0), "{said}");
        let stiffness = place.json("one/stiffness.json");
        let is_it = |row: &&BTreeMap<String, String>| {
            (row["wheel"].as_str(), row["rail"].as_str(), row["shift_mm"].as_str()) == ("worn", "54E1", shift)
        };
        let row = rows.iter().find(is_it).unwrap();
        assert_eq!((row["reference"].as_str(), row["status"].as_str()), ("beam", "complete"));
        let same = |column: &str, other: f64| {
            let own = number(row, column);
            assert!(
                (own - other).abs() <= ROUNDOFF * other.abs(),
                "shift {shift}, {column}: {own} and {other}"
            );
        };
        for key in ["a_kn_per_m", "b_kn_per_m", "c", "f0_kn"] {
            same(key, stiffness["law"][key].as_f64().unwrap());
        }
        same("contact_angle_deg", stiffness["touch"]["angle_deg"].as_f64().unwrap());
        for of_load in self::rows(&place.path("one/load_curve.csv")) {
            let load = of_load["force_kn"].trim_end_matches(".0").to_owned();
            if ["20", "60"].contains(&load.as_str()) {
                same(&format!("displacement_mm_at_{load}kn"), number(&of_load, "displacement_mm"));
                same(&format!("stiffness_kn_per_m_at_{load}kn"), number(&of_load, "solid_tangent_kn_per_m"));
            }
        }
    }
}

/// Source: `input_uncertainty` of a study of the same pair at that shift. Goal: a table that gives uncertainties has the half widths of displacement and stiffness of its rows, which are
/// those of the study; a table without them has no such column; along the contact normal the cells are empty. Unit: 1. Accuracy: FAR, the compliance far from the contact
/// is that of the largest load, which is 60 kN in the table and 85 kN in the study.
#[test]
fn a_row_has_the_uncertainty_of_its_study() {
    const FAR: f64 = 0.02;
    const LOADS: [f64; 2] = [20.0, 60.0];
    let pair = TABLE.split("[[wheel]]").next().unwrap().replace("[0, 2]", "[2]");
    let pair = format!("{pair}[[wheel]]\nprofile = \"S1002\"\n[[rail]]\nprofile = \"60E1\"\n");
    let place = Place::new(&pair);
    let column = |name: &str, load: f64| format!("{name}_rel_input_uncertainty_at_{load}kn");
    place.table("table.toml", "plain", &[]);
    assert!(place.rows("plain")[0].keys().all(|name| !name.contains("input_uncertainty")));

    let base = std::fs::read_to_string(place.path("base.toml")).unwrap();
    assert!(base.contains("error_band = false") && base.contains("full-integration"));
    let base = base
        .replace("error_band = false", "error_band = true")
        .replace("full-integration", "incompatible-modes");
    // so many that the uncertainty of the study is stated at each
    let base = base.replace("[5, 20, 40, 60, 85]", "[5, 20, 60, 85]");
    let base = format!("{base}\n[uncertainty]\nsamples = 0\nfriction = 0.05\n");
    place.write("base.toml", &base);
    place.write("one.toml", &format!("{base}[track]\nlateral_shift_mm = 2\n"));
    let (code, said) = place.run(&["calibrate", "one.toml", "-o", "one"]);
    assert_eq!(code, Some(0), "{said}");
    let of_study = place.json("one/stiffness.json")["input_uncertainty"]["points"].clone();
    place.table("table.toml", "out", &[]);
    let rows = place.rows("out");
    for load in LOADS {
        let points = of_study.as_array().unwrap();
        let at =
            points.iter().find(|point| (point["force_kn"].as_f64().unwrap() - load).abs() < 1e-6).unwrap();
        for (name, key) in [("displacement", "displacement"), ("stiffness", "tangent")] {
            let (own, other) = (number(&rows[0], &column(name, load)), at[key]["input"].as_f64().unwrap());
            assert!(other > 0.005 && (own / other - 1.0).abs() < FAR, "{name} at {load} kN: {own}, {other}");
        }
    }
    place.write("normal.toml", &pair.replace("shifts_mm", "direction = \"normal\"\nshifts_mm"));
    place.table("normal.toml", "normal", &[]);
    assert_eq!(place.rows("normal")[0][&column("stiffness", 20.0)], "");
}

/// Goal: Hertz beside the solid, and the contact's own share of the lateral compliance, of a wheel and a rail that are nearly Hertz's
/// bodies. Source: Hertz; for a sticking contact Mindlin, whose tangential compliance over the normal one of a circle is
/// `(1 - ν/2)/(1 - ν)` = 1.214 for ν = 0.3. Accuracy: MODEL, patches of 6 mm elements on profiles of changing curvature, and an ellipse
/// for the circle: a quarter.
#[test]
fn hertz_and_mindlin_stand_beside_the_solid() {
    const MODEL: f64 = 0.25;
    const MINDLIN: f64 = 1.214;
    let place = Place::new(TABLE);
    place.write("one.toml", &TABLE.replace("shifts_mm = [0, 2]", "shifts_mm = [-2]"));
    place.table("one.toml", "out", &[]);
    let rows = place.rows("out");
    let row = rows.iter().find(|row| row["wheel"] == "S1002" && row["rail"] == "60E1").unwrap();
    for load in ["20", "60"] {
        let at = |name: &str| number(row, &format!("{name}_at_{load}kn"));
        let local = at("local_stiffness_kn_per_m");
        assert!((local / at("hertz_normal_stiffness_kn_per_m") - 1.0).abs() < MODEL, "{row:?}");
        let lateral = at("horizontal_contact_share") / at("horizontal_kn_per_m");
        assert!((lateral * local / MINDLIN - 1.0).abs() < MODEL, "{lateral} {local}");
    }
}

/// Goal: a second run makes nothing and writes the same bytes, whatever the threads. After a wheel file has
/// changed, the places of that wheel alone are made, and the comparison with the earlier table names the
/// wheel. A left wheel is a right one under the opposite shift and is not made again.
#[test]
#[ignore = "a quarter of a minute: cargo long table"]
fn what_is_there_is_not_made_again() {
    let place = Place::new(TABLE);
    let said = place.table("table.toml", "out", &["--cache", "store"]);
    assert!(
        said.contains("4 pairs at 8 places, 0 of them in the store; 8 to be made on 4 pairs of 6 bodies"),
        "{said}"
    );
    let bodies = || {
        let files = std::fs::read_dir(place.path("store")).unwrap().flatten();
        files.filter(|file| file.file_name().to_string_lossy().starts_with("body-")).count()
    };
    // two wheels, and two rails with contact zones for standard and for measured wheels
    assert_eq!(bodies(), 6);
    let first = place.files("out");
    let said = place.table("table.toml", "again", &["--cache", "store"]);
    assert!(said.contains("4 pairs at 8 places, 8 of them in the store\n"), "{said}");
    assert!(place.files("again") == first);
    place.table("table.toml", "alone", &["--cache", "other", "--threads", "1"]);
    assert!(place.files("alone") == first);

    place.write(
        "sides.toml",
        &TABLE.replace("shifts_mm = [0, 2]", "shifts_mm = [-2, 0, 2]\nsides = [\"right\", \"left\"]"),
    );
    let said = place.table("sides.toml", "sides", &["--cache", "store"]);
    assert!(said.contains("at 24 places, 16 of them in the store"), "{said}");
    let rows = place.rows("sides");
    for left in rows.iter().filter(|row| row["side"] == "left") {
        let towards = number(left, "shift_mm");
        let is_it = |row: &&BTreeMap<String, String>| {
            row["side"] == "right"
                && number(row, "shift_mm") == -towards
                && ["wheel", "rail"].iter().all(|name| row[*name] == left[*name])
        };
        let right = rows.iter().find(is_it).unwrap();
        let differ: Vec<&String> = left.keys().filter(|name| left[*name] != right[*name]).collect();
        assert!(differ.iter().all(|name| ["side", "shift_mm"].contains(&name.as_str())), "{differ:?}");
    }

    // one point of the tread a hundredth of a millimetre lower
    let text = std::fs::read_to_string(place.path("worn.whl")).unwrap();
    place.write("worn.whl", &moved(&text));
    let said = place.table("table.toml", "out", &["--cache", "store", "--diff", "out/table.csv"]);
    assert!(said.contains("4 of them in the store; 4 to be made on 2 pairs"), "{said}");
    assert!(said.contains("since the earlier table: 4 places with other values, 0 new, 0 gone"), "{said}");
    let changes = std::fs::read_to_string(place.path("out/table_changes.csv")).unwrap();
    assert!(
        changes.lines().skip(1).all(|line| line.starts_with("worn,") && line.ends_with(",the wheel")),
        "{changes}"
    );
    let (old, new) = (rows_of(&first["table.csv"]), place.rows("out"));
    for (old, new) in old.iter().zip(&new) {
        assert_eq!(old == new, old["wheel"] == "S1002", "{old:?}");
    }
}

fn rows_of(csv: &[u8]) -> Vec<BTreeMap<String, String>> {
    csv::Reader::from_reader(csv).deserialize().map(Result::unwrap).collect()
}

/// The profile with the point nearest to the tape circle lowered by 0.01 mm.
fn moved(profile: &str) -> String {
    let numbers = |line: &str| -> Option<[f64; 2]> {
        let values: Vec<f64> = line.split_whitespace().map(str::parse).collect::<Result<_, _>>().ok()?;
        values.try_into().ok()
    };
    let nearest = profile
        .lines()
        .enumerate()
        .filter_map(|(at, line)| Some((at, numbers(line)?)))
        .min_by(|a, b| a.1[0].abs().total_cmp(&b.1[0].abs()))
        .unwrap();
    let lines = profile.lines().enumerate().map(|(at, line)| match at == nearest.0 {
        true => format!("{} {}", nearest.1[0], nearest.1[1] + 0.01),
        false => line.into(),
    });
    lines.collect::<Vec<String>>().join("\n") + "\n"
}

/// Goal: a file that is no profile, and a shift at which the wheel is off the rail, are rows with their
/// reasons. The others are complete, and the exit code says that not all is. The table of the folder has a
/// wheel for every file.
#[test]
fn a_case_that_fails_is_a_row() {
    let place = Place::new(TABLE);
    std::fs::create_dir(place.path("measured")).unwrap();
    place.write("measured/good.whl", include_str!("../data/profiles/worn-s1002.whl"));
    place.write("measured/notes.txt", "the wheels of the third of May\n");
    place.write(
        "folder.toml",
        "name = \"folder\"\nbase = \"base.toml\"\nshifts_mm = [0, 29]\nstiffness_at_kn = [20]\n\
         [[wheel]]\nname = \"May\"\nfolder = \"measured\"\nstandard = \"S1002\"\n[[rail]]\nprofile = \"60E1\"\n",
    );
    let (code, said) = place.run(&["table", "folder.toml", "-o", "out"]);
    assert_eq!(code, Some(1), "{said}");
    assert!(said.contains("4 places: 1 complete, 0 with a law that ends early, 3 without a law"), "{said}");
    let rows = place.rows("out");
    let row = |wheel: &str, shift: &str| {
        rows.iter().find(|row| row["wheel"] == wheel && row["shift_mm"] == shift).unwrap()
    };
    assert_eq!(row("May/good", "0")["status"], "complete");
    assert!(row("May/good", "29")["reason"].contains("leave this shift out"), "{rows:?}");
    let unreadable = &row("May/notes", "0")["reason"];
    assert!(unreadable.contains("notes.txt"), "{unreadable}");
    let page = std::fs::read_to_string(place.path("out/table.html")).unwrap();
    assert!(page.contains("4 places: 1 complete") && page.contains("May/notes"));
}

/// Goal: 21 measured wheels are a fleet with a page, also beside an earlier table; 20 have none, and that of an earlier table goes. Every table
/// has its rows as Parquet.
#[test]
fn many_measured_wheels_have_a_page() {
    let place = Place::new(TABLE);
    std::fs::create_dir(place.path("measured")).unwrap();
    for wheel in 1..=21 {
        std::fs::copy(place.path("worn.whl"), place.path(&format!("measured/w{wheel:02}.whl"))).unwrap();
    }
    place.write(
        "folder.toml",
        "name = \"folder\"\nbase = \"base.toml\"\nshifts_mm = [0]\nstiffness_at_kn = [20]\n\
         [[wheel]]\nname = \"May\"\nfolder = \"measured\"\nstandard = \"S1002\"\n[[rail]]\nprofile = \"60E1\"\n",
    );
    let said = place.table("folder.toml", "out", &[]);
    assert!(said.contains("table_fleet.html"), "{said}");
    let page = || std::fs::read_to_string(place.path("out/table_fleet.html")).unwrap();
    assert!(page().contains("21 places: 21 complete"));
    // wheels of one shape stand for each other, in a table that reads
    let typical = railspring::table::Table::read(&place.path("out/table_typical.toml")).unwrap();
    assert!((1..=2).contains(&typical.cases.len()), "{}", typical.cases.len());
    place.table("folder.toml", "out", &["--diff", "out/table.csv"]);
    assert!(page().contains("21 of 21 wheels are in the earlier table"), "{}", page());
    std::fs::remove_file(place.path("measured/w21.whl")).unwrap();
    place.table("folder.toml", "out", &[]);
    let of_fleet = ["table_fleet.html", "table_typical.toml"];
    assert!(of_fleet.iter().all(|file| !place.path("out").join(file).exists()));
    assert_eq!(&std::fs::read(place.path("out/table.parquet")).unwrap()[..4], b"PAR1");
}

/// Goal: what is wrong in a table is said with its file and line, all of it, before anything is made; a file that is no table is no
/// earlier table.
#[test]
fn mistakes_are_said_with_their_lines() {
    let place = Place::new(TABLE);
    let refused = |change: [&str; 2], expected: &[&str]| {
        let text = TABLE.replacen(change[0], change[1], 1);
        assert_ne!(text, TABLE);
        place.write("wrong.toml", &text);
        let (code, said) = place.run(&["table", "wrong.toml", "-o", "out"]);
        assert_eq!(code, Some(2), "{said}");
        for part in expected {
            assert!(said.contains(part), "{part}: {said}");
        }
        assert!(!place.path("out").exists());
    };
    refused(
        ["shifts_mm = [0, 2]", "shifts_mm = [2, 0]"],
        &["wrong.toml:3: shifts_mm = 2, 0", "sort the list"],
    );
    refused(["shifts_mm", "shift_mm"], &["wrong.toml:3: shift_mm", "did you mean `shifts_mm`?"]);
    refused(["[20, 60]", "[20, 600]"], &["wrong.toml:4: stiffness_at_kn = 600", "from 5 to 85 kN"]);
    refused(
        ["\"S1002\"", "\"S1003\""],
        &["wrong.toml:6: wheel[0].profile = \"S1003\"", "did you mean \"S1002\"?"],
    );
    refused(["worn.whl", "gone.whl"], &["wrong.toml:9: wheel[1].profile_file = \"gone.whl\""]);
    refused(["\"54E1\"", "[]"], &["wrong.toml:14: rail[1].profile = []"]);
    refused(["\"54E1\"", "\"60E1\""], &["wrong.toml:13: rail[1].name = \"60E1\"", "another `name`"]);
    refused(["base.toml", "none.toml"], &["wrong.toml:2: base = \"none.toml\"", "relative to the table"]);
    refused(
        ["[[wheel]]", "[sweep]\n\"simulation.law\" = [1]\n[[wheel]]"],
        &["wrong.toml:6: sweep.simulation.law"],
    );
    refused(
        ["[[wheel]]", "[sweep]\n\"contact.friction\" = [0.3, -1]\n[[wheel]]"],
        &["wrong.toml:6: sweep.contact.friction = -1"],
    );
    refused(
        ["[[wheel]]", "[study.track]\nlateral_shift_mm = 1\n[[wheel]]"],
        &["wrong.toml:6:", "`shifts_mm`"],
    );
    refused(
        ["[[wheel]]", "[[case]]\nwheel = \"S1002\"\nrail = \"60E2\"\n[[wheel]]"],
        &["case[0].rail = \"60E2\"", "60E1, 54E1"],
    );

    let broken =
        std::fs::read_to_string(place.path("base.toml")).unwrap().replace("friction = 0.5", "friction = -1");
    place.write("broken.toml", &broken);
    refused(["base.toml", "broken.toml"], &["broken.toml:", "contact.friction = -1"]);

    let (code, said) = place.run(&["table", "table.toml", "-o", "out", "--diff", "base.toml"]);
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("base.toml") && said.contains("table.csv"), "{said}");
}
