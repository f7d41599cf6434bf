use super::*;

/// Wheels `A` and `B</script>` on one rail at shifts of 0 to 20 mm, with a stiffness of 1e6 kN/m that grows with the contact angle, but for one
/// place, and a place without a law.
fn rows() -> Rows {
    let columns = ["wheel", "rail", "tape_diameter_m", "rail_inclination", "direction", "shift_mm"];
    let columns =
        columns.into_iter().chain(["contact_angle_deg", "stiffness_kn_per_m_at_50kn", "status", "reason"]);
    let row = |wheel: &str, shift: f64| {
        let stiffness = 1e6 + 1e3 * shift;
        let stiffness = if (wheel, shift) == ("A", 7.0) { 1.5 * stiffness } else { stiffness };
        let fails = (wheel, shift) == ("A", 20.0);
        let at = |value: f64| Some(value).filter(|_| !fails);
        let (status, reason) = if fails { ("failed", "off the <rail>") } else { ("complete", "") };
        vec![
            Cell::from(wheel),
            "60E1".into(),
            0.92.into(),
            0.025.into(),
            "vertical".into(),
            shift.into(),
            at(0.5 * shift).into(),
            at(stiffness).into(),
            status.into(),
            reason.into(),
        ]
    };
    let wheels = ["A", "B</script>"];
    let rows = wheels
        .into_iter()
        .flat_map(|wheel| (0..=20).map(move |shift| row(wheel, f64::from(shift))))
        .collect();
    Rows { columns: columns.map(String::from).collect(), rows, metadata: 0..0 }
}

/// Goal: the page counts, names the odd place first, has every pair and every reason, and no name ends its script or becomes a tag.
#[test]
fn a_page_shows_what_is_odd_and_what_is_missing() {
    let page = page("a <b>", "", &rows(), None);
    // for looking at the page
    if let Some(folder) = std::env::var_os("RAILSPRING_SAMPLE_REPORT") {
        let folder = std::path::Path::new(&folder);
        std::fs::create_dir_all(folder).unwrap();
        std::fs::write(folder.join("table.html"), &page).unwrap();
    }
    assert!(page.contains("42 places: 41 complete, 0 with a law that ends early, 1 without a law"));
    assert_eq!(page.matches("</script>").count(), 2, "one of the data, one of the program");
    assert!(!page.contains("a <b>") && !page.contains("off the <rail>"));
    let odd = odd(&seen(&rows(), "50kn"));
    assert_eq!(odd.len(), ODD);
    assert_eq!((odd[0]["wheel"].as_str(), odd[0]["shift"].as_str()), (Some("A"), Some("7")));
    let heat = heat(&seen(&rows(), "50kn"), "50 kN").unwrap();
    assert_eq!(heat["rails"], json!(["60E1"]));
    let texts: Vec<&str> = heat["rows"]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| row["cells"][0]["text"].as_str().unwrap())
        .collect();
    assert_eq!(texts, ["1.000", "1.000"]);
    let missing = reasons(&rows(), &seen(&rows(), "50kn"));
    assert_eq!(missing.len(), 1);
    assert_eq!(missing[0]["reason"], "off the <rail>");
}

/// Goal: numbers have six digits, and what rounding leaves of a zero is 0.
#[test]
fn numbers_have_six_digits() {
    let cases =
        [(0.123_456_789, 0.123_457), (-1.661e-13, 0.0), (2.5e-9, 2.5e-9), (-1_234_567.0, -1_234_570.0)];
    for (value, expected) in cases {
        assert_eq!(rounded(value).as_f64(), Some(expected), "{value}");
    }
}

/// Goal: what the page's program reads is the rows: a column that is the same everywhere once, words by their number, numbers of six digits,
/// nothing where there is nothing.
#[test]
fn the_rows_are_embedded_by_columns() {
    let data: Value = serde_json::from_str(&embedded(&rows())).unwrap();
    assert_eq!(data["rows"], 42);
    let column = |name: &str| {
        let columns = data["columns"].as_array().unwrap();
        columns.iter().find(|column| column["name"] == name).unwrap().clone()
    };
    assert_eq!(column("rail"), json!({ "name": "rail", "constant": "60E1" }));
    assert_eq!(column("tape_diameter_m"), json!({ "name": "tape_diameter_m", "constant": 0.92 }));
    let wheels = column("wheel");
    assert_eq!(wheels["words"], json!(["A", "B</script>"]));
    assert_eq!((wheels["values"][20].as_u64(), wheels["values"][21].as_u64()), (Some(0), Some(1)));
    let stiffness = column("stiffness_kn_per_m_at_50kn");
    assert_eq!(stiffness["values"][3], 1.003e6);
    assert!(stiffness["values"][20].is_null());
}

/// Goal: the middle of an odd and of an even number of values.
#[test]
fn medians() {
    assert_eq!(median(&mut []), None);
    assert_eq!(median(&mut [3.0, 1.0, 2.0]), Some(2.0));
    assert_eq!(median(&mut [4.0, 1.0, 2.0, 3.0]), Some(2.5));
}

/// Goal: a page of a million places, to be opened in a browser; its path is printed. Not a test of the page: `--ignored`.
#[test]
#[ignore = "writes a page of 25 MB: cargo long million_places"]
fn a_page_of_a_million_places() {
    let (columns, few) = (rows().columns, rows().rows);
    let rows = (0..1_000_000)
        .map(|place: usize| {
            let mut row = few[place % few.len()].clone();
            row[0] = format!("wheel {}", place / 1000).as_str().into();
            row[7] = (1e6 + (place as f64 * 0.618_034).fract() * 1e5).into();
            row
        })
        .collect();
    let page = page("a million", "", &Rows { columns, rows, metadata: 0..0 }, None);
    let path = std::env::temp_dir().join("railspring-a-million-places.html");
    std::fs::write(&path, &page).unwrap();
    println!("{}: {:.0} MB", path.display(), 1e-6 * page.len() as f64);
}
