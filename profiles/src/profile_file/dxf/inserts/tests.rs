//! Source: a head of lines and arcs, mm, y of the drawing upwards, drawn once directly and once as a block, whose numbers were moved, turned,
//! scaled and turned over by hand so that the insertion undoes it. Goal: the same points. Units: m. Accuracy: ROUNDOFF.

use crate::error::Error;
use crate::profile_file::{Action, MeasuredPoint, MeasuredProfile, ReadOptions, parse, parse_rail_section};

/// ROUNDOFF, m: ten operations on numbers up to 0.1 m, each with 2⁻⁵³ of them, and angles of 3 rad that are rounded at radii of 13 mm.
const ROUNDOFF: f64 = 2e-16;

/// A line or an arc from one angle to the other, degrees.
#[derive(Clone, Copy)]
enum Drawn {
    Line([f64; 4]),
    Arc([f64; 5]),
}

use Drawn::{Arc, Line};

/// A head that is no mirror image of itself: gauge corner R13, field corner R10.
const HEAD: [Drawn; 5] = [
    Line([-35.0, -40.0, -35.0, -13.0]),
    Arc([-22.0, -13.0, 13.0, 90.0, 180.0]),
    Line([-22.0, 0.0, 20.0, 0.0]),
    Arc([20.0, -10.0, 10.0, 0.0, 90.0]),
    Line([30.0, -10.0, 30.0, -40.0]),
];

/// The same moved by (7, -3).
const MOVED: [Drawn; 5] = [
    Line([-28.0, -43.0, -28.0, -16.0]),
    Arc([-15.0, -16.0, 13.0, 90.0, 180.0]),
    Line([-15.0, -3.0, 27.0, -3.0]),
    Arc([27.0, -13.0, 10.0, 0.0, 90.0]),
    Line([37.0, -13.0, 37.0, -43.0]),
];

/// The same turned by -90°, (x, y) to (y, -x), at half its size.
const TURNED: [Drawn; 5] = [
    Line([-20.0, 17.5, -6.5, 17.5]),
    Arc([-6.5, 11.0, 6.5, 0.0, 90.0]),
    Line([0.0, 11.0, 0.0, -10.0]),
    Arc([-5.0, -10.0, 5.0, -90.0, 0.0]),
    Line([-5.0, -15.0, -20.0, -15.0]),
];

/// The same turned over, x to -x.
const OVER: [Drawn; 5] = [
    Line([35.0, -40.0, 35.0, -13.0]),
    Arc([22.0, -13.0, 13.0, 0.0, 90.0]),
    Line([22.0, 0.0, -20.0, 0.0]),
    Arc([-20.0, -10.0, 10.0, 90.0, 180.0]),
    Line([-30.0, -10.0, -30.0, -40.0]),
];

fn entities(drawn: &[Drawn], layer: &str) -> String {
    let text = |drawn: &Drawn| match drawn {
        Line([ax, ay, bx, by]) => format!("0\nLINE\n8\n{layer}\n10\n{ax}\n20\n{ay}\n11\n{bx}\n21\n{by}\n"),
        Arc([x, y, r, from, to]) => {
            format!("0\nARC\n8\n{layer}\n10\n{x}\n20\n{y}\n40\n{r}\n50\n{from}\n51\n{to}\n")
        }
    };
    drawn.iter().map(text).collect()
}

fn block(name: &str, base: [f64; 2], entities: &str) -> String {
    format!("0\nBLOCK\n8\n0\n2\n{name}\n70\n0\n10\n{}\n20\n{}\n{entities}0\nENDBLK\n8\n0\n", base[0], base[1])
}

/// The other groups come after the place.
fn insert(name: &str, [x, y]: [f64; 2], more: &str) -> String {
    format!("0\nINSERT\n8\nrail\n2\n{name}\n10\n{x}\n20\n{y}\n{more}")
}

fn drawing(blocks: &str, entities: &str) -> String {
    format!(
        "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nBLOCKS\n{blocks}0\nENDSEC\n\
         0\nSECTION\n2\nENTITIES\n{entities}0\nENDSEC\n0\nEOF\n"
    )
}

fn read(text: &str, part: Option<&str>) -> Result<MeasuredProfile, String> {
    let options = ReadOptions { part: part.map(str::to_owned), ..ReadOptions::default() };
    parse("a.dxf", text.as_bytes(), &options).map_err(|error| match error {
        Error::Input(input) => input.to_string(),
        other => panic!("{other}"),
    })
}

fn directly() -> MeasuredProfile {
    read(&drawing("", &entities(&HEAD, "rail")), None).unwrap()
}

/// Greatest distance of the points of two profiles that have as many, moved by `shift` along y, m.
fn apart(one: &MeasuredProfile, other: &MeasuredProfile, shift: f64) -> f64 {
    assert_eq!(one.points.len(), other.points.len());
    let off = |(p, q): (&MeasuredPoint, &MeasuredPoint)| {
        (p.point.x - q.point.x - shift).hypot(p.point.y - q.point.y)
    };
    one.points.iter().zip(&other.points).map(off).fold(0.0, f64::max)
}

#[test]
fn a_block_is_read_where_it_is_inserted() {
    let expected = directly();
    let plain = |drawn: &[Drawn]| block("Head", [0.0; 2], &entities(drawn, "0"));
    let moved = block("Head", [7.0, -3.0], &entities(&MOVED, "0"));
    let turned = insert("HEAD", [0.0; 2], "41\n2\n42\n2\n43\n2\n50\n90\n");
    let nested = |inner: &str, outer: &str| block("outer", [5.0, 1.0], inner) + outer;
    for (name, blocks, inserts, shift) in [
        ("base", moved, insert("head", [0.0; 2], ""), 0.0),
        ("turned and scaled", plain(&TURNED), turned.clone(), 0.0),
        ("turned over by its scale", plain(&OVER), insert("Head", [0.0; 2], "41\n-1\n42\n1\n"), 0.0),
        ("seen from below", plain(&OVER), insert("Head", [0.0; 2], "210\n0\n220\n0\n230\n-1\n"), 0.0),
        // Moved by 3 to the right before it is turned over.
        (
            "seen from below at a place",
            block("Head", [1.0, -1.5], &entities(&OVER, "0")),
            insert("Head", [4.0, -1.5], "210\n0\n220\n0\n230\n-1\n"),
            -3e-3,
        ),
        // y to -y, and half a turn: x to -x.
        ("turned over and turned", plain(&OVER), insert("Head", [0.0; 2], "42\n-1\n50\n180\n"), 0.0),
        ("in a block", nested(&turned, &plain(&TURNED)), insert("outer", [5.0, 1.0], ""), 0.0),
        // The inner block lies at the base point of the outer one, which turns it.
        (
            "turned by the outer block",
            nested(&insert("Head", [5.0, 1.0], ""), &plain(&TURNED)),
            insert("outer", [0.0; 2], "41\n2\n42\n2\n50\n90\n"),
            0.0,
        ),
        (
            "with a text of its own",
            plain(&HEAD),
            insert("Head", [0.0; 2], "70\n1\n71\n0\n66\n1\n0\nATTRIB\n1\n60E1\n0\nSEQEND\n"),
            0.0,
        ),
    ] {
        let found = read(&drawing(&blocks, &inserts), Some("rail")).unwrap_or_else(|e| panic!("{name}: {e}"));
        let off = apart(&found, &expected, shift);
        println!("{name}: {off:.1e} m");
        assert!(off < ROUNDOFF, "{name}: {off}");
        let said = &found.findings;
        assert!(said.iter().all(|f| f.action != Action::Left), "{name}: {said:?}");
        let text = "read where the drawing inserts them: \"";
        assert!(said.iter().any(|f| f.text.contains(text)), "{name}: {said:?}");
    }
}

/// On other layers than 0 the entities of a block keep theirs, and points have the lines of the block.
#[test]
fn layers_and_lines_are_those_of_the_block() {
    let text = drawing(
        &block("Head", [0.0; 2], &(entities(&HEAD, "surface") + "0\nTEXT\n8\n0\n1\n60E1\n")),
        &(insert("Head", [0.0; 2], "") + &entities(&[Line([-90.0, 5.0, 90.0, 5.0])], "frame")),
    );
    let found = read(&text, Some("surface")).unwrap();
    assert!(apart(&found, &directly(), 0.0) < ROUNDOFF);
    let lines: Vec<&str> = text.lines().collect();
    let first = found.points[0].line;
    assert_eq!(lines[first - 1], "LINE");
    assert!(lines.iter().position(|line| *line == "ENDBLK").unwrap() > first, "{first}");
    let refused = read(&text, None).unwrap_err();
    for part in ["2 lines that do not meet", "(layer \"surface\", 5 pieces", "(layer \"frame\", 1 piece"] {
        assert!(refused.contains(part), "{part}: {refused}");
    }
}

/// Rows and columns are several profiles, one of which is chosen; their distances are turned with the block, and not scaled.
#[test]
fn rows_and_columns_are_several_profiles() {
    let blocks = block("Head", [0.0; 2], &entities(&TURNED, "0"));
    // Two columns 200 apart, turned by a quarter: 200 upwards; and two rows 100 apart, -100 along x.
    let more = "41\n2\n42\n2\n50\n90\n70\n2\n44\n200\n71\n2\n45\n100\n";
    let text = drawing(&blocks, &insert("Head", [0.0; 2], more));
    assert!(read(&text, None).unwrap_err().contains("4 lines that do not meet"));
    let expected = directly();
    for (part, shift) in [("1", 0.0), ("3", -0.1)] {
        let found = read(&text, Some(part)).unwrap();
        let off = apart(&found, &expected, shift);
        assert!(off < 2.0 * ROUNDOFF, "{part}: {off}");
    }
    let second = read(&text, Some("2")).unwrap();
    let top = |p: &MeasuredProfile| p.points.iter().map(|p| p.point.y).fold(f64::INFINITY, f64::min);
    assert!((top(&expected) - top(&second) - 0.2).abs() < 2.0 * ROUNDOFF, "{}", top(&second));
}

/// A scale of x alone makes ellipses of arcs: with 1.25, the gauge corner has the half axes 16.25 and 13 mm about (-27.5, -13) mm.
#[test]
fn an_uneven_scale_makes_ellipses() {
    let text = drawing(
        &block("Head", [0.0; 2], &entities(&HEAD, "0")),
        &insert("Head", [0.0; 2], "41\n1.25\n42\n1\n"),
    );
    let corner: Vec<f64> = (read(&text, None).unwrap().points.iter())
        .map(|p| [1e3 * p.point.x, -1e3 * p.point.y])
        .filter(|[y, z]| *y < -27.6 && *z > -12.9)
        .map(|[y, z]| ((y + 27.5) / 16.25).hypot((z + 13.0) / 13.0))
        .collect();
    assert!(corner.len() > 20, "{}", corner.len());
    // ROUNDOFF: 2e-16 m on the shorter half axis, a few times that with the factors between.
    assert!(corner.iter().all(|r| (r - 1.0).abs() < 5.0 * ROUNDOFF / 13e-3), "{corner:?}");
}

/// The outline of a section in a block is the one that is drawn directly.
#[test]
fn a_section_may_lie_in_a_block() {
    // Foot, web and head of a rail, mm.
    let half =
        [[75.0, 0.0], [75.0, 12.0], [9.0, 30.0], [9.0, 110.0], [36.0, 120.0], [36.0, 150.0], [25.0, 160.0]];
    let mut corners = half.to_vec();
    corners.extend(half.iter().rev().map(|[x, y]| [-x, *y]));
    let sides = |over: f64| -> String {
        let next = (0..corners.len()).map(|i| (corners[i], corners[(i + 1) % corners.len()]));
        let lines: Vec<Drawn> = next.map(|(a, b)| Line([over * a[0], a[1], over * b[0], b[1]])).collect();
        entities(&lines, "0")
    };
    let direct = parse_rail_section("a.dxf", drawing("", &sides(1.0)).as_bytes()).unwrap();
    let over = drawing(&block("A", [0.0; 2], &sides(-1.0)), &insert("A", [0.0; 2], "41\n-1\n"));
    let inserted = parse_rail_section("a.dxf", over.as_bytes()).unwrap();
    assert_eq!(direct.running, inserted.running);
    assert_eq!(direct.rest, inserted.rest);
    let two = drawing(
        &block("A", [0.0; 2], &sides(1.0)),
        &(insert("A", [0.0; 2], "") + &insert("A", [300.0, 0.0], "")),
    );
    let refused = parse_rail_section("a.dxf", two.as_bytes()).unwrap_err().to_string();
    assert!(refused.contains("2 closed lines"), "{refused}");
}

/// What cannot be put in its place is refused with the line that says so, and how to mend it.
#[test]
fn wrong_insertions_are_refused_with_their_line() {
    let head = entities(&HEAD, "0");
    let lone = |entities: &str| block("Head", [0.0; 2], entities);
    let at = [0.0; 2];
    let inner = |n: usize| block(&format!("b{n}"), at, &insert(&format!("b{}", n + 1), at, ""));
    let deep: String = (0..20).map(inner).collect::<String>() + &block("b20", at, &head);
    let shallow: String = (5..20).map(inner).collect::<String>() + &block("b20", at, &head);
    for (name, blocks, inserts, line, expected, remedy) in [
        ("missing", lone(&head), insert("tail", at, ""), "INSERT", "\"tail\"", "explode this one"),
        (
            "itself",
            lone(&(insert("Head", at, "") + &head)),
            insert("head", at, ""),
            "INSERT",
            "\"head in head\"",
            "take the block out of itself",
        ),
        (
            "circle",
            block("a", at, &insert("B", at, "")) + &block("b", at, &insert("A", at, "")),
            insert("a", at, ""),
            "INSERT",
            "\"a in b in a\"",
            "take the block out of itself",
        ),
        (
            "flat",
            lone(&head),
            insert("head", at, "41\n0.0\n"),
            "0.0",
            "a scale other than 0",
            "with its scale",
        ),
        (
            "flat in y",
            lone(&head),
            insert("head", at, "42\n0\n"),
            "0",
            "(group 42 of INSERT)",
            "with its scale",
        ),
        ("deep", deep, insert("b0", at, ""), "INSERT", "more than 16 blocks", "explode the outer ones"),
        (
            "twice",
            lone(&head) + &lone(&head),
            insert("head", at, ""),
            "INSERT",
            "one block of this name",
            "rename",
        ),
        (
            "many",
            lone(&head),
            insert("head", at, "70\n30000\n71\n30000\n"),
            "INSERT",
            "at most 1000000 entities",
            "the profile alone",
        ),
        (
            "nowhere",
            lone(&head),
            "0\nINSERT\n8\n0\n2\nhead\n".into(),
            "INSERT",
            "INSERT with group 10",
            "again",
        ),
        (
            "faulty",
            lone("0\nLINE\n8\n0\n10\n1\n20\n1\n"),
            insert("head", at, ""),
            "LINE",
            "group 11",
            "again",
        ),
        ("none", lone(&head), String::new(), "0", "lines, arcs", "the drawing inserts none of \"Head\""),
    ] {
        let text = drawing(&blocks, &inserts);
        let message = read(&text, None).unwrap_err();
        assert!(message.contains(expected) && message.contains(remedy), "{name}: {message}");
        let place = message.split("a.dxf:").nth(1).unwrap_or_else(|| panic!("{name}: {message}"));
        let at: usize = place.split(':').next().unwrap().parse().unwrap();
        assert_eq!(text.lines().nth(at - 1), Some(line), "{name}: {message}");
    }
    assert!(read(&drawing(&shallow, &insert("b5", at, "")), None).is_ok());
    // What nobody inserts may be faulty.
    let idle = block("idle", at, "0\nLINE\n8\n0\n10\n1\n20\n1\n0\nINSERT\n2\nnone\n10\n0\n20\n0\n");
    assert!(apart(&read(&drawing(&idle, &head), None).unwrap(), &directly(), 0.0) == 0.0);
    // A drawing of its own is elsewhere.
    let elsewhere = lone("").replacen("70\n0", "70\n4", 1);
    let left = read(&drawing(&elsewhere, &(head + &insert("head", at, ""))), None).unwrap().findings;
    assert!(
        left.iter().any(|f| f.action == Action::Left && f.text.contains("1 INSERT of another drawing")),
        "{left:?}"
    );
}
