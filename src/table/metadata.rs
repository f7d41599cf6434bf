//! What is known of a measurement beside its profile: vehicle, axle, date, mileage and whatever else its sources say.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use serde_json::Value;

use super::dates::iso;

/// What is known of a measurement, by the names of columns: texts, and numbers where the name has a unit.
pub type Metadata = BTreeMap<String, Value>;

/// Fixed names, and the keys that stand for them in letters and digits alone: the first one that a source has.
const KNOWN: [(&str, &[&str]); 9] = [
    (
        "vehicle",
        &[
            "vehicle",
            "vehicleno",
            "vehicleid",
            "vehiclenumber",
            "carno",
            "car",
            "carid",
            "carnumber",
            "wagonno",
            "wagon",
            "trainno",
            "train",
            "trainid",
        ],
    ),
    ("axle", &["axle", "axleno", "axleid", "axlenumber"]),
    ("wheel", &["wheel", "wheelid", "wheelno", "wheelnumber"]),
    ("side", &["side", "rail"]),
    ("date", &["date", "measuringdate", "measurementdate", "dateofmeasurement"]),
    (MILEAGE, &["mileage", "km", "kp", "kilometer", "kilometre", "chainage"]),
    (
        TAPE_DIAMETER,
        &["tapediameter", "tapecirclediameter", "diametertaperline", "wheeldiameter", "diameter"],
    ),
    ("line", &["line", "lineno", "lineid", "linenumber"]),
    ("position", &["position", "location", "pos"]),
];
/// The fixed name of the mileage.
const MILEAGE: &str = "mileage_km";
/// The fixed name of the diameter at the tape circle, which is the key of a wheel.
pub(super) const TAPE_DIAMETER: &str = "tape_diameter_m";
/// Diameters of wheels, m; what is outside is not one, or not in the unit that is said.
const DIAMETERS: RangeInclusive<f64> = 0.2..=2.0;
/// Entries in the headers of MiniProf files that say what was measured; the others are of the instrument and the points.
const OF_A_HEADER: [&str; 38] = [
    "vehicle",
    "vehicleno",
    "vehicleid",
    "car",
    "carno",
    "train",
    "trainno",
    "stock",
    "bogie",
    "axle",
    "axleno",
    "axleid",
    "wheel",
    "wheelid",
    "wheelno",
    "side",
    "rail",
    "date",
    "time",
    "mileage",
    "kp",
    "chainage",
    "line",
    "track",
    "tracksection",
    "sectionno",
    "position",
    "location",
    "curve",
    "direction",
    "elevation",
    "username",
    "emplnum",
    "comment",
    "flag",
    "id",
    "temperature",
    "diametertaperline",
];

/// What the header of a file says of its measurement.
pub(super) fn of_header(entries: Vec<(String, String)>) -> Metadata {
    let is_of_it = |(key, _): &(String, String)| {
        let plain = plain(split_unit(key).0);
        OF_A_HEADER.contains(&plain.as_str()) || plain.starts_with("location") || is_users(&plain)
    };
    of_source(entries.into_iter().filter(is_of_it).collect())
}

/// Whether an entry is one of the fields that the user of an instrument defines.
fn is_users(plain: &str) -> bool {
    plain.strip_prefix("uof").is_some_and(|number| number.chars().all(|c| c.is_ascii_digit()))
}

/// What one source says, under fixed names where they are known and else in snake case; what is empty is left out.
pub(super) fn of_source(mut entries: Vec<(String, String)>) -> Metadata {
    entries.retain(|(_, value)| !value.trim().is_empty());
    let mut metadata = Metadata::new();
    for (name, keys) in KNOWN {
        let is_it = |key: &str, (other, value): &(String, String)| {
            plain(split_unit(other).0) == key && (name != "side" || key != "rail" || is_a_side(value))
        };
        let at = |key: &&str| entries.iter().position(|entry| is_it(key, entry));
        let Some(at) = keys.iter().find_map(at) else { continue };
        let (key, value) = &entries[at];
        let value: Option<Value> = match name {
            MILEAGE => kilometres(key, value).map(Value::from),
            TAPE_DIAMETER => metres(key, value).map(Value::from),
            "date" => Some(iso(value).unwrap_or_else(|| value.trim().to_owned()).into()),
            _ => Some(value.trim().into()),
        };
        // a mileage or a diameter that is no number stays what it is
        if let Some(value) = value {
            metadata.insert(name.into(), value);
            entries.remove(at);
        }
    }
    for (key, value) in entries {
        let name = snake(&key);
        if !name.is_empty() {
            metadata.entry(name).or_insert_with(|| value.trim().into());
        }
    }
    metadata
}

/// Whether the rail of an entry is a side of the track, and no section.
fn is_a_side(value: &str) -> bool {
    ["left", "right", "l", "r", "links", "rechts"].contains(&plain(value).as_str())
}

/// Letters and digits of a key, in lower case.
fn plain(key: &str) -> String {
    key.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// A key without its unit, and the unit: `Mileage [km]`, `mileage_km`.
fn split_unit(key: &str) -> (&str, Option<&str>) {
    if let Some((name, unit)) = key.split_once(['[', '(']) {
        return (name, Some(unit.trim_matches([']', ')', ' '])));
    }
    match key.trim().rsplit_once(['_', ' ']) {
        Some((name, unit @ ("km" | "m" | "mm"))) => (name, Some(unit)),
        _ => (key, None),
    }
}

/// The number of a value, and its unit in lower case if it or the key has one.
fn with_unit<'v>(key: &str, value: &'v str) -> (&'v str, Option<String>) {
    let value = value.trim();
    let (_, of_key) = split_unit(key);
    let end = value.rfind(|c: char| c.is_ascii_digit()).map_or(0, |at| at + 1);
    let (number, of_value) = (&value[..end], value[end..].trim());
    let of_value = Some(of_value.trim_matches(['[', ']', '(', ')'])).filter(|unit| !unit.is_empty());
    (number, of_value.or(of_key).map(str::to_lowercase))
}

/// A diameter of a wheel, m, by the unit of its key or of its value; without one it is in mm or in m, whichever a wheel can have.
fn metres(key: &str, value: &str) -> Option<f64> {
    let (number, unit) = with_unit(key, value);
    let number: f64 = number.replace(',', ".").parse().ok()?;
    let in_m = match unit.as_deref() {
        Some("m") => number,
        Some("mm") => number * 1e-3,
        None if DIAMETERS.contains(&number) => number,
        None => number * 1e-3,
        Some(_) => return None,
    };
    DIAMETERS.contains(&in_m).then(|| (in_m * 1e9).round() / 1e9)
}

/// A mileage, km, by the unit of its key or of its value: that of a mileage or of a kilometre is km, that of a chainage has to be said.
fn kilometres(key: &str, value: &str) -> Option<f64> {
    let (number, unit) = with_unit(key, value);
    let usual = (plain(split_unit(key).0) != "chainage").then(|| "km".to_owned());
    let unit = unit.or(usual)?;
    let to_km = match unit.as_str() {
        "km" => 1.0,
        "m" => 1e-3,
        _ => return None,
    };
    // 12,345 m may be twelve thousand
    let decimals = number.split_once(',').map(|(_, decimals)| decimals);
    if unit == "m" && decimals.is_some_and(|decimals| decimals.len() == 3) {
        return None;
    }
    let number: f64 = number.replace(',', ".").parse().ok()?;
    let km = number * to_km;
    km.is_finite().then(|| (km * 1e9).round() / 1e9)
}

/// A key in snake case: `UserName` and `User name` are `user_name`.
fn snake(key: &str) -> String {
    let characters: Vec<char> = key.chars().collect();
    let mut name = String::new();
    for (at, c) in characters.iter().enumerate() {
        let before = at.checked_sub(1).map(|before| characters[before]);
        let after = characters.get(at + 1);
        let begins_word = c.is_uppercase()
            && before.is_some_and(|before| {
                before.is_lowercase()
                    || (before.is_uppercase() && after.is_some_and(|after| after.is_lowercase()))
            });
        if (!c.is_alphanumeric() || begins_word) && !name.is_empty() && !name.ends_with('_') {
            name.push('_');
        }
        if c.is_alphanumeric() {
            name.extend(c.to_lowercase());
        }
    }
    name.trim_end_matches('_').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(entries: &[(&str, &str)]) -> String {
        let entries = entries.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        let words = of_source(entries).into_iter().map(|(key, value)| format!("{key}={value}"));
        words.collect::<Vec<_>>().join(" ").replace('"', "")
    }

    /// Goal: keys of all writings have the fixed names, the first of several that stand for one; others are in snake case; empty ones are left out.
    #[test]
    fn keys_have_fixed_names() {
        assert_eq!(of(&[("CarNo", "7"), ("AxleNo", "2"), ("WheelID", "L2")]), "axle=2 vehicle=7 wheel=L2");
        assert_eq!(of(&[("TrainNo", "ICE 1"), ("Vehicle no.", "7")]), "train_no=ICE 1 vehicle=7");
        assert_eq!(of(&[("Rail", "Left"), ("Line", " 1700 "), ("Track", "")]), "line=1700 side=Left");
        assert_eq!(of(&[("Side", "L"), ("Rail", "60E1")]), "rail=60E1 side=L");
        assert_eq!(
            of(&[("UserName", "A. B."), ("EmplNum", "3"), ("GPSPos", "x")]),
            "empl_num=3 gps_pos=x user_name=A. B."
        );
        assert_eq!(
            of(&[("Date", "12.05.2024"), ("Location.Latitude", "51")]),
            "date=2024-05-12 location_latitude=51"
        );
        assert_eq!(of(&[("date", "05/06/24")]), "date=05/06/24");
        let header = vec![
            ("MPTypeNo".to_owned(), "201".to_owned()),
            ("UOF1".into(), "x".into()),
            ("Sd".into(), "30".into()),
        ];
        assert_eq!(of_header(header).into_keys().collect::<Vec<_>>(), ["uof1"]);
    }

    /// Goal: a diameter is in m, by its unit or by what a wheel can have; what is no diameter of a wheel stays a text under its own name. Unit: m.
    /// Accuracy: 1e-9, what is written.
    #[test]
    fn diameters_are_in_metres() {
        for (key, value, expected) in [
            ("DiameterTaperline", "852.4", "tape_diameter_m=0.8524"),
            ("Wheel diameter [mm]", "852,4", "tape_diameter_m=0.8524"),
            ("tape_diameter_m", "0.8524", "tape_diameter_m=0.8524"),
            ("diameter", "0.92 m", "tape_diameter_m=0.92"),
            ("diameter", "920", "tape_diameter_m=0.92"),
            ("diameter_mm", "0.92", "diameter_mm=0.92"),
            ("DiameterTaperline", "0", "diameter_taperline=0"),
            ("diameter", "36 in", "diameter=36 in"),
            ("diameter", "new", "diameter=new"),
        ] {
            assert_eq!(of(&[(key, value)]), expected, "{key} {value}");
        }
    }

    /// Goal: a mileage is in km where its unit is known; else it stays a text under its own name. Unit: km. Accuracy: 1e-9, what is written.
    #[test]
    fn mileages_are_in_kilometres() {
        for (key, value, expected) in [
            ("Mileage", "12.345", "mileage_km=12.345"),
            ("Mileage [m]", "12345", "mileage_km=12.345"),
            ("mileage_km", "12,345", "mileage_km=12.345"),
            ("mileage_m", "12345.5", "mileage_km=12.3455"),
            ("KP", "12.3 km", "mileage_km=12.3"),
            ("Chainage", "12345 m", "mileage_km=12.345"),
            ("Chainage", "12345", "chainage=12345"),
            ("Mileage", "12,345 m", "mileage=12,345 m"),
            ("Mileage", "12 mi", "mileage=12 mi"),
            ("Mileage", "12+345", "mileage=12+345"),
            ("Mileage", "unknown", "mileage=unknown"),
        ] {
            assert_eq!(of(&[(key, value)]), expected, "{key} {value}");
        }
    }
}
