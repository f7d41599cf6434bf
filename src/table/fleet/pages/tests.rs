//! A fleet that is made up, with a trend, outliers and groups of shapes that are known.

use std::collections::BTreeSet;
use std::time::Instant;

use serde_json::{Map, Value};

use super::*;
use crate::engine::columns::Cell;
use crate::table::fleet::quantity::{Role, with_role};
use crate::table::fleet::{medoids, outliers};

/// Axles of a vehicle.
const AXLES: usize = 4;
/// Shifts of a wheel, mm.
const SHIFTS: [f64; 5] = [-4.0, -2.0, 0.0, 2.0, 4.0];
/// The vehicle whose wheels wear three times as fast.
const FAST: &str = "V07";
/// Wheels whose stiffness is 1.6 times that of others.
const STIFF: [&str; 3] = ["V03-A1-L-2", "V11-A4-R-7", "V20-A2-L-5"];
/// The axle whose left wheel is 1.5 mm smaller.
const UNEQUAL: [&str; 3] = ["V05", "2", "2021-01-01"];
/// Points of a shape.
const POINTS: usize = 120;

/// A made-up fleet.
struct Fleet {
    rows: Rows,
    shapes: Vec<Option<Shape>>,
    names: BTreeSet<String>,
}

/// Numbers from -1 to 1 that look random, by what they are of.
fn noise(seed: usize) -> f64 {
    let mut mixed = (seed as u64).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// The group of a wheel: half of them 0, three tenths 1, a fifth 2.
fn group(wheel: usize) -> usize {
    [0, 0, 1, 0, 2, 0, 1, 0, 1, 2][wheel % 10]
}

/// A bump at the flange, a hollow tread or a worn field side, of 0.6 mm with some noise.
fn shape(wheel: usize) -> Shape {
    let (middle, width) = [(-30.0, 12.0), (0.0, 15.0), (40.0, 10.0)][group(wheel)];
    let depth = 600.0 * (1.0 + 0.15 * noise(7 * wheel));
    let y_mm: Vec<f64> = (0..POINTS).map(|n| -50.0 + n as f64).collect();
    let of = |(n, y): (usize, &f64)| {
        depth * (-((y - middle) / width).powi(2)).exp() + 20.0 * noise(POINTS * wheel + n)
    };
    let off_um = y_mm.iter().enumerate().map(of).collect();
    Shape { y_mm, off_um }
}

impl Fleet {
    /// Of so many vehicles and campaigns: eight wheels a vehicle, five rows a wheel.
    fn of(vehicles: usize, campaigns: usize) -> Self {
        let columns = [
            "wheel",
            "rail",
            "tape_diameter_m",
            "rail_inclination",
            "gauge_mm",
            "friction",
            "direction",
            "side",
            "shift_mm",
            "contact_angle_deg",
            "rolling_radius_mm",
            "stiffness_kn_per_m_at_20kn",
            "stiffness_kn_per_m_at_60kn",
            "horizontal_kn_per_m_at_20kn",
            "horizontal_kn_per_m_at_60kn",
            "status",
            "reason",
            "wheel_vehicle",
            "wheel_axle",
            "wheel_side",
            "wheel_date",
            "wheel_mileage_km",
            "wheel_tread_wear_mm",
            "wheel_flange_thickness_mm",
            "wheel_hollow_mm",
            "conicity_at_1mm",
            "conicity_at_3mm",
        ];
        let (mut rows, mut shapes, mut names) = (Vec::new(), Vec::new(), BTreeSet::new());
        for wheel in 0..vehicles * 2 * AXLES * campaigns {
            let (place, campaign) = (wheel / campaigns, wheel % campaigns);
            let (vehicle, place) = (place / (2 * AXLES), place % (2 * AXLES));
            let vehicle = format!("V{vehicle:02}");
            let (axle, side) = ((place / 2 + 1).to_string(), ["left", "right"][place % 2]);
            let name = format!("{vehicle}-A{axle}-{}-{campaign}", side[..1].to_uppercase());
            let date = format!("{}-{:02}-01", 2020 + campaign / 2, 1 + 6 * (campaign % 2));
            let mileage = 20_000.0 * campaign as f64 + 2000.0 * noise(13 * wheel);
            let speed =
                if vehicle == FAST { 3.0 } else { 1.0 + 0.05 * noise(wheel / (2 * AXLES * campaigns)) };
            let wear = 1e-5 * speed * mileage;
            let is_small = [&*vehicle, &*axle, &*date] == UNEQUAL && side == "left";
            let stiff = if STIFF.contains(&&*name) { 1.6 } else { 1.0 };
            for (number, shift) in SHIFTS.into_iter().enumerate() {
                let k = |load: f64| {
                    stiff * (0.9e6 + 5e3 * load - 5e4 * wear + 1e4 * shift + 5e3 * noise(31 * wheel + number))
                };
                let fails = wheel % 97 == 5 && number == 4;
                let value = |value: f64| Cell::from(Some(value).filter(|_| !fails));
                let (status, reason) = match fails {
                    true => ("failed", format!("no touch at y = {:.1} mm", shift + noise(wheel))),
                    false => ("complete", String::new()),
                };
                rows.push(vec![
                    name.as_str().into(),
                    "60E1".into(),
                    0.92.into(),
                    0.025.into(),
                    1435.0.into(),
                    0.3.into(),
                    "vertical".into(),
                    "right".into(),
                    shift.into(),
                    value(1.4 + 0.1 * shift),
                    value(460.0 - wear - if is_small { 1.5 } else { 0.0 } + 0.05 * noise(3 * wheel)),
                    value(k(20.0)),
                    value(k(60.0)),
                    value(0.5 * k(20.0)),
                    value(0.5 * k(60.0)),
                    status.into(),
                    reason.into(),
                    vehicle.as_str().into(),
                    axle.as_str().into(),
                    side.into(),
                    date.as_str().into(),
                    mileage.into(),
                    (wear + 0.02 * noise(5 * wheel)).into(),
                    (32.0 - 0.5 * wear + 0.1 * noise(11 * wheel)).into(),
                    (0.3 * wear + 0.05 * noise(17 * wheel)).into(),
                    (0.05 + 0.01 * noise(19 * wheel)).into(),
                    (0.12 + 0.05 * wear + 0.01 * noise(23 * wheel)).into(),
                ]);
                shapes.push((number == 0).then(|| shape(wheel)));
            }
            names.insert(name);
        }
        Self {
            rows: Rows { columns: columns.map(String::from).to_vec(), rows, metadata: 0..0 },
            shapes,
            names,
        }
    }

    fn about<'a>(&self, name: &'a str, earlier: Option<&'a Rows>) -> About<'a> {
        let keys = |name: &String| {
            let file = Value::from(format!("measured/{name}.whl"));
            (name.clone(), Map::from_iter([("profile_file".to_string(), file)]))
        };
        let keys = self.names.iter().map(keys).collect();
        let rail = serde_json::json!([{ "profile": "60E1" }]);
        let table = Map::from_iter([("rail".to_string(), rail)]);
        About { name, wheels: self.names.clone(), keys, table, earlier, ..About::default() }
    }

    fn bodies(&self) -> Bodies<'_> {
        Bodies::of(Kind::Wheel, &self.rows, &self.names)
    }
}

/// 10,000 rows of 2000 wheels of 25 vehicles.
fn fleet() -> Fleet {
    Fleet::of(25, 10)
}

/// Source: the made-up fleet. Goal: the vehicle that wears three times as fast is first and its interval has its slope of 3 mm per 100,000 km;
/// all others have about 1. Accuracy: DESIGN, the 5 % by which the speeds differ and the noise of the wear.
#[test]
fn the_vehicle_that_wears_fast_is_first() {
    const DESIGN: f64 = 0.08;
    let fleet = fleet();
    let bodies = fleet.bodies();
    let wear = bodies.quantities.iter().find(|quantity| quantity.name == "tread wear").unwrap();
    let trends = super::trends::of_quantity(&bodies, wear);
    assert_eq!((trends.len(), &*trends[0].vehicle), (25, FAST));
    let slope = trends[0].slope;
    let [low, high] = slope.interval.unwrap();
    assert!(low <= 3.0 && 3.0 <= high && high - low < 0.1 && slope.points == 80, "{slope:?}");
    assert!(
        trends[1..].iter().all(|trend| (trend.slope.slope - 1.0).abs() < DESIGN && trend.slope.is_sure())
    );
    let k = with_role(&bodies.quantities, Role::Stiffness).unwrap();
    let slope = super::trends::of_quantity(&bodies, k)[0].slope.slope;
    assert!((slope + 0.15).abs() < 0.01, "5e4 kN/m per mm, 3 mm per 100,000 km: {slope}");
}

/// Source: the made-up fleet. Goal: the three stiff wheels are the first outliers of stiffness.
#[test]
fn the_stiff_wheels_are_outliers() {
    let fleet = fleet();
    let bodies = fleet.bodies();
    let first: BTreeSet<&str> = outliers::outliers(&bodies)
        .iter()
        .take(3)
        .map(|outlier| &*bodies.bodies[outlier.body].name)
        .collect();
    assert_eq!(first, BTreeSet::from(STIFF));
}

/// Source: the made-up fleet: shares of 50, 30 and 20 %. Goal: three groups with these shares, each around a wheel of its own group; the file names them.
#[test]
fn typical_wheels_are_of_the_three_groups() {
    let fleet = fleet();
    let shapes: Vec<&Shape> = fleet.shapes.iter().flatten().collect();
    let groups = medoids::Groups::of(&shapes, 2..=8).unwrap();
    let of_medoids: Vec<usize> = groups.medoids.iter().map(|medoid| group(*medoid)).collect();
    assert_eq!(of_medoids, [0, 1, 2], "{:?}", groups.tried);
    assert_eq!([0, 1, 2].map(|at| groups.size(at)), [1000, 600, 400]);
    assert!((0..2000).all(|wheel| groups.group[wheel] == Some(group(wheel))));
    let pages = page(&fleet.rows, &fleet.shapes, &fleet.about("made up", None)).unwrap();
    let table: toml::Table = pages.typical.unwrap().parse().unwrap();
    assert_eq!(table["wheel"].as_array().unwrap().len(), 3);
}

/// Source: the made-up fleet. Goal: the page names what is known, links and counts; the axle with unequal wheels is first; the same bytes each time.
#[test]
fn the_page_shows_what_is_known() {
    let fleet = fleet();
    let mut earlier = Fleet::of(25, 9).rows;
    let k = earlier.column("stiffness_kn_per_m_at_60kn").unwrap();
    for row in earlier.rows.iter_mut().filter(|row| row[0].text() == "V01-A1-R-8") {
        row[k] = row[k].number().map(|k| 0.5 * k).into();
    }
    let about = fleet.about("made <up>", Some(&earlier));
    let pages = page(&fleet.rows, &fleet.shapes, &about).unwrap();
    // for looking at the page
    if let Some(folder) = std::env::var_os("RAILSPRING_SAMPLE_REPORT") {
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(std::path::Path::new(&folder).join("table_fleet.html"), &pages.html).unwrap();
    }
    assert_eq!(page(&fleet.rows, &fleet.shapes, &about).unwrap(), pages);
    let html = &pages.html;
    assert!(html.contains("10000 places: 9979 complete, 0 with a law that ends early, 21 without a law"));
    assert!(!html.contains("made <up>") && html.contains("V01-A1-R-9"));
    let after = |text: &str| &html[html.find(text).unwrap_or_else(|| panic!("no {text}"))..];
    let first = |text: &str| after(text).split_once("<tbody><tr>").unwrap().1.split_once("</tr>").unwrap().0;
    assert!(
        first("Left less right, rolling radius").starts_with("<td>V05</td><td>2</td><td>2021-01-01</td>")
    );
    assert!(first("k at 60 kN, 10\u{2076} kN/m: the largest").starts_with("<td>V01-A1-R-9</td>"));
    assert!(first("tread wear, mm per 100,000 km").starts_with("<td>V07</td>"));
    assert_eq!(html.matches("<svg").count(), 4 + 6 + 12 + 3, "measures, trends, outliers, groups");
    assert!(html.len() < 1_000_000, "{} bytes", html.len());
}

/// Goal: a table without measured wheels, with few or without any of the columns has no page, or one that says what is missing.
#[test]
fn a_table_with_few_columns_says_so() {
    let fleet = Fleet::of(3, 1);
    assert_eq!(page(&fleet.rows, &[], &About::default()), None);
    let few = About { wheels: fleet.names.iter().take(20).cloned().collect(), ..About::default() };
    assert_eq!(page(&fleet.rows, &[], &few), None);
    let mut rows = fleet.rows.clone();
    rows.columns = vec!["wheel".into(), "stiffness_kn_per_m_at_60kn".into()];
    rows.rows.iter_mut().for_each(|row| *row = vec![row[0].clone(), row[12].clone()]);
    let pages = page(&rows, &[], &fleet.about("few", None)).unwrap();
    for missing in [
        "no column <code>status",
        "<code>wheel_mileage_km",
        "No row has a <code>wheel_vehicle",
        "0 wheels are known",
        "No axle",
    ] {
        assert!(pages.html.contains(missing), "{missing}");
    }
    assert_eq!(pages.typical, None);
    let empty = Rows { columns: Vec::new(), rows: Vec::new(), metadata: 0..0 };
    assert_eq!(page(&empty, &[], &fleet.about("empty", None)), None);
}

/// Goal: a fleet of rails has sections of its own.
#[test]
fn rails_are_a_fleet() {
    let mut rows = Fleet::of(4, 2).rows;
    let renamed = [
        ("wheel", "rail"),
        ("rail", "wheel"),
        ("wheel_vehicle", "rail_line"),
        ("wheel_date", "rail_date"),
        ("wheel_tread_wear_mm", "rail_vertical_wear_mm"),
    ];
    for name in &mut rows.columns {
        if let Some((_, new)) = renamed.iter().find(|(old, _)| old == name) {
            *name = (*new).into();
        }
    }
    let rails = rows.rows.iter().map(|row| row[0].text()).collect();
    let html = page(&rows, &[], &About { rails, ..About::default() }).unwrap().html;
    assert!(html.contains("64 measured rails") && html.contains("How fast each line changes"));
    assert!(html.contains("vertical wear, mm per year") && !html.contains("wheel-axles"));
}

/// Goal: time and size of the page of 50,000 rows with 10,000 shapes, printed. Not a test of the page: `--ignored`.
#[test]
#[ignore = "times a page of 50,000 rows, some seconds: cargo long page_of_many"]
fn a_page_of_many_rows() {
    let fleet = Fleet::of(125, 10);
    let about = fleet.about("many", Some(&fleet.rows));
    let begin = Instant::now();
    let pages = page(&fleet.rows, &fleet.shapes, &about).unwrap();
    let seconds = begin.elapsed().as_secs_f64();
    let begin = Instant::now();
    let columns = super::super::parquet(&fleet.rows);
    let path = std::env::temp_dir().join("railspring-fleet-of-50000.html");
    std::fs::write(&path, &pages.html).unwrap();
    println!(
        "{} rows: page {seconds:.2} s, {:.2} MB; table.parquet {:.2} s, {:.2} MB, table.csv {:.2} MB; {}",
        fleet.rows.rows.len(),
        1e-6 * pages.html.len() as f64,
        begin.elapsed().as_secs_f64(),
        1e-6 * columns.len() as f64,
        1e-6 * fleet.rows.csv().len() as f64,
        path.display()
    );
}
