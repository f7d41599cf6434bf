//! Profiles from DXF drawings: lines, arcs, polylines and splines, joined to the running surface.
//!
//! The drawings are written here from the curve of a standard section, whose definition is lines and arcs.

use nalgebra::{Point2, Vector2};
use railspring_profiles::error::Error;
use railspring_profiles::profile::ProfileCurve;
use railspring_profiles::profile_file::{
    Action, FindingKind, MeasuredProfile, PrepareOptions, ProfileFormat, ProfileKind, ReadOptions, parse,
    prepare,
};
use railspring_profiles::section::rail_section;
use railspring_testing::dxf::Entity;

const MM: f64 = 1e-3;
const UM: f64 = 1e-6;

fn read(text: &str, part: Option<&str>) -> Result<MeasuredProfile, String> {
    let options = ReadOptions { part: part.map(str::to_owned), ..ReadOptions::default() };
    parse("a.dxf", text.as_bytes(), &options).map_err(|error| match error {
        Error::Input(input) => {
            assert!(input.key.starts_with("a.dxf:"), "{input}");
            input.to_string()
        }
        other => panic!("{other}"),
    })
}

fn refused(text: &str, part: Option<&str>) -> String {
    match read(text, part) {
        Err(message) => message,
        Ok(profile) => panic!("read {} points: {:?}", profile.points.len(), profile.findings),
    }
}

/// A line or arc of the drawing, mm, z upwards: its ends and its bulge.
#[derive(Debug, Clone, Copy)]
struct Segment {
    from: Point2<f64>,
    to: Point2<f64>,
    bulge: f64,
}

fn head() -> ProfileCurve {
    rail_section("60E1").unwrap().running
}

/// The segments of the head's definition.
fn segments(curve: &ProfileCurve) -> Vec<Segment> {
    let mut places = vec![0.0];
    places.extend(curve.breakpoints());
    places.push(curve.length());
    places.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    let point = |s: f64| {
        let p = curve.point(s);
        Point2::new(p.x / MM, -p.y / MM)
    };
    places
        .windows(2)
        .map(|pair| {
            let [from, to] = [point(pair[0]), point(pair[1])];
            let middle = point(0.5 * (pair[0] + pair[1]));
            // The height of the arc over its chord, to the right of it: half the chord times the bulge.
            let chord: Vector2<f64> = to - from;
            let bulge = -2.0 * chord.perp(&(middle - from)) / chord.norm_squared();
            Segment { from, to, bulge: if bulge.abs() < 1e-7 { 0.0 } else { bulge } }
        })
        .collect()
}

impl Segment {
    fn centre(&self) -> Point2<f64> {
        let chord = self.to - self.from;
        let half = 0.25 * (1.0 / self.bulge - self.bulge);
        nalgebra::center(&self.from, &self.to) + half * Vector2::new(-chord.y, chord.x)
    }

    /// As LINE or ARC, which runs from the smaller angle to the larger one.
    fn entity(&self) -> String {
        let [from, to] = [self.from, self.to].map(<[f64; 2]>::from);
        let entity = match self.bulge {
            0.0 => Entity::Line([to, from]),
            _ => Entity::Arc { ends: [from, to], centre: self.centre().into() },
        };
        entity.text("head")
    }

    /// An arc as a rational spline of degree 2.
    fn spline(&self) -> String {
        let angle = 2.0 * self.bulge.atan();
        let chord = self.to - self.from;
        let top =
            nalgebra::center(&self.from, &self.to) - 0.5 * angle.tan() * Vector2::new(-chord.y, chord.x);
        let knots: String = [0, 0, 0, 1, 1, 1].iter().map(|k| format!("40\n{k}\n")).collect();
        let weights: String = [1.0, angle.cos(), 1.0].iter().map(|w| format!("41\n{w}\n")).collect();
        let points: String =
            [self.from, top, self.to].iter().map(|p| format!("10\n{}\n20\n{}\n30\n0\n", p.x, p.y)).collect();
        format!("0\nSPLINE\n8\nhead\n70\n12\n71\n2\n72\n6\n73\n3\n{knots}{weights}{points}")
    }
}

fn drawing(header: &str, entities: &str) -> String {
    format!(
        "  0\nSECTION\n  2\nHEADER\n{header}  0\nENDSEC\n  0\nSECTION\n  2\nTABLES\n  0\nENDSEC\n  0\nSECTION\n  2\nBLOCKS\n  0\n\
         LINE\n 10\n1\n 20\n1\n 11\n9\n 21\n9\n  0\nENDSEC\n  0\nSECTION\n  2\nENTITIES\n{entities}  0\nENDSEC\n  0\nEOF\n"
    )
}

fn lightweight(segments: &[Segment], more: &str) -> String {
    let vertex = |p: &Point2<f64>, bulge: f64| format!("10\n{}\n20\n{}\n42\n{bulge}\n", p.x, p.y);
    let mut text = format!("0\nLWPOLYLINE\n8\nhead\n90\n{}\n70\n0\n38\n5.0\n{more}", segments.len() + 1);
    text.extend(segments.iter().map(|s| vertex(&s.from, s.bulge)));
    text + &vertex(&segments[segments.len() - 1].to, 0.0)
}

fn polyline(segments: &[Segment]) -> String {
    let vertex = |p: &Point2<f64>, bulge: f64| {
        format!("0\nVERTEX\n8\nhead\n10\n{}\n20\n{}\n30\n0\n42\n{bulge}\n", p.x, p.y)
    };
    let mut text = String::from("0\nPOLYLINE\n8\nhead\n66\n1\n10\n0\n20\n0\n30\n0\n70\n0\n");
    text.extend(segments.iter().map(|s| vertex(&s.from, s.bulge)));
    text + &vertex(&segments[segments.len() - 1].to, 0.0) + "0\nSEQEND\n"
}

/// Source: the definition of the 60E1 head. Goal: the same curve from drawings of its lines and arcs in every kind of
/// entity, in any order and direction. Accuracy: 0.1 µm, as derived in the constant.
#[test]
fn a_head_of_lines_and_arcs_is_the_standard() {
    /// DISCRETISATION: a spline through points 0.16 mm apart over a jump in curvature (R80 to R13, 64 1/m) is off by
    /// 64·0.16²/32 = 0.05 µm.
    const DISCRETISATION: f64 = 0.1 * UM;
    let curve = head();
    let segments = segments(&curve);
    let n = segments.len();
    let step = [5, 7, 11].into_iter().find(|step| !n.is_multiple_of(*step)).unwrap();
    let shuffled: String = (0..n).map(|i| segments[i * step % n].entity()).collect();
    let mirrored: Vec<Segment> = segments
        .iter()
        .map(|s| Segment {
            from: Point2::new(-s.from.x, s.from.y),
            to: Point2::new(-s.to.x, s.to.y),
            bulge: -s.bulge,
        })
        .collect();
    let inches: Vec<Segment> =
        segments.iter().map(|s| Segment { from: s.from / 25.4, to: s.to / 25.4, bulge: s.bulge }).collect();
    let arcs =
        segments.iter().map(|s| if s.bulge == 0.0 { s.entity() } else { s.spline() }).collect::<String>();
    let millimetres = "  9\n$INSUNITS\n 70\n     4\n";
    for (name, text) in [
        ("lines and arcs", drawing(millimetres, &shuffled)),
        ("polyline with bulges", drawing(millimetres, &lightweight(&segments, ""))),
        ("old polyline", drawing("", &polyline(&segments))),
        ("seen from below", drawing("", &lightweight(&mirrored, "210\n0.0\n220\n0.0\n230\n-1.0\n"))),
        ("inches", drawing("9\n$INSUNITS\n70\n1\n", &lightweight(&inches, ""))),
        ("splines", drawing("", &arcs)),
        ("CRLF", drawing("", &shuffled).replace('\n', "\r\n")),
    ] {
        let profile = read(&text, None).unwrap_or_else(|message| panic!("{name}: {message}"));
        assert_eq!((profile.format, profile.kind), (ProfileFormat::Dxf, ProfileKind::Rail), "{name}");
        let found = prepare(&profile, &PrepareOptions::default()).unwrap().curve;
        let off = found.sample(0.05 * MM).iter().map(|p| curve.closest(p).1).fold(0.0, f64::max);
        let missed = curve.sample(0.05 * MM).iter().map(|p| found.closest(p).1).fold(0.0, f64::max);
        println!(
            "{name}: {} points, {:.1e} mm off, {:.1e} mm missed",
            profile.points.len(),
            off / MM,
            missed / MM
        );
        assert!(off.max(missed) < DISCRETISATION, "{name}: {off} {missed}");
    }
}

/// A measured line is taken by its vertices, to the last digit, whatever the order and direction of its pieces.
#[test]
fn measured_polylines_keep_their_points() {
    let points: Vec<Point2<f64>> =
        head().sample(0.5 * MM).iter().map(|p| Point2::new(p.x / MM, -p.y / MM)).collect();
    let segments: Vec<Segment> =
        points.windows(2).map(|w| Segment { from: w[0], to: w[1], bulge: 0.0 }).collect();
    let n = segments.len();
    let step = [7, 11, 13].into_iter().find(|step| !n.is_multiple_of(*step)).unwrap();
    let lines: String = (0..n)
        .map(|i| {
            let Segment { from, to, bulge } = segments[i * step % n];
            let turned = Segment { from: to, to: from, bulge };
            if i % 3 == 0 { turned.entity() } else { segments[i * step % n].entity() }
        })
        .collect();
    for text in
        [drawing("", &lightweight(&segments, "")), drawing("", &polyline(&segments)), drawing("", &lines)]
    {
        let profile = read(&text, None).unwrap();
        assert_eq!(profile.points.len(), points.len());
        for (p, q) in profile.points.iter().zip(&points) {
            assert_eq!(p.point, Point2::new(q.x / 1e3, -q.y / 1e3));
        }
    }
}

#[test]
fn several_lines_are_listed_and_one_is_chosen_by_layer_or_number() {
    let segments = segments(&head());
    let frame = "0\nLINE\n8\nFRAME\n10\n-60\n20\n10\n11\n60\n21\n10\n0\nLINE\n8\nFRAME\n10\n60\n20\n10\n11\n60\n21\n-50\n";
    let rest = "0\nTEXT\n8\nhead\n10\n0\n20\n0\n40\n3\n1\n60E1\n0\nDIMENSION\n8\nFRAME\n0\nELLIPSE\n8\nhead\n10\n0\n20\n0\n\
                0\nLINE\n8\nhead\n67\n1\n10\n0\n20\n0\n11\n5\n21\n5\n";
    let text = drawing("", &format!("{frame}{}{rest}", lightweight(&segments, "")));
    let message = refused(&text, None);
    for part in [
        "2 lines that do not meet",
        "1 (layer \"FRAME\", 2 pieces",
        "2 (layer \"head\"",
        "give `profile_part`",
    ] {
        assert!(message.contains(part), "{part}: {message}");
    }
    for part in ["Head", "2"] {
        let profile = read(&text, Some(part)).unwrap();
        assert!(profile.points.len() > 500);
        let said: String = profile.findings.iter().map(|finding| format!("{finding}\n")).collect();
        for text in ["x of the drawing is y", "1 ELLIPSE: not read", "TEXT: no lines of the profile"] {
            assert!(said.contains(text), "{text}: {said}");
        }
        assert!(profile.findings.iter().any(|f| f.action == Action::Left && f.text.contains("ELLIPSE")));
    }
    let by_layer = read(&text, Some("head")).unwrap();
    assert!(by_layer.findings.iter().any(|f| f.text.contains("1 DIMENSION, 2 curves: on other layers")));
    let message = refused(&text, Some("tail"));
    assert!(message.contains("the name of a layer or the number of a line"), "{message}");
    // The same line twice is one line.
    let twice = drawing("", &format!("{0}{0}", lightweight(&segments, "")));
    let profile = read(&twice, None).unwrap();
    assert!(
        profile
            .findings
            .iter()
            .any(|f| f.kind == FindingKind::PassedOver && f.text.contains("1 line on top"))
    );
    // A small gap is bridged and said.
    let mut apart = segments.clone();
    apart[3].from.x += 0.003;
    let gap: String = apart.iter().map(Segment::entity).collect();
    let profile = read(&drawing("", &gap), None).unwrap();
    assert!(
        profile.findings.iter().any(|f| f.kind == FindingKind::Gap && f.text.contains("0.00")),
        "{:?}",
        profile.findings
    );
}

/// Goal: a drawing that ends among its entities is read with a finding that is left to be looked at; a whole one has none.
#[test]
fn a_drawing_that_is_cut_off_is_said() {
    let segments = segments(&head());
    let whole = drawing("", &lightweight(&segments, ""));
    let cut = whole.strip_suffix("  0\nENDSEC\n  0\nEOF\n").unwrap();
    let left = |text: &str| {
        let findings = read(text, None).unwrap().findings;
        findings.iter().filter(|f| f.action == Action::Left && f.text.contains("cut off")).count()
    };
    assert_eq!((left(&whole), left(cut)), (0, 1));
}

#[test]
fn drawings_that_are_not_certain_are_refused() {
    let segments = segments(&head());
    let lines: String = segments.iter().map(Segment::entity).collect();
    let last = segments[segments.len() - 1];
    let [a, b] = [segments[0].from, last.to];
    let closing = Segment { from: b, to: a, bulge: 0.0 }.entity();
    let branch = Segment { from: segments[2].from, to: Point2::new(0.0, 30.0), bulge: 0.0 }.entity();
    let line = |more: &str| format!("0\nLINE\n8\n0\n10\n0\n20\n0\n11\n50\n21\n9\n{more}");
    for (text, expected) in [
        (drawing("", &format!("{lines}{closing}")), "an open line, the running surface"),
        (drawing("", &format!("{lines}{branch}")), "two lines that meet, not three"),
        (drawing("", &Segment { from: a, to: a, bulge: 0.0 }.entity()), "lines without length"),
        (drawing("", ""), "lines, arcs, polylines or splines"),
        (drawing("", "0\nCIRCLE\n8\n0\n10\n0\n20\n0\n40\n5\n"), "1 CIRCLE"),
        (drawing("", &line("30\n0\n31\n4\n")), "1 LINE in another plane"),
        (drawing("", "0\nLINE\n8\n0\n10\n0\n20\n0\n"), "LINE with group 11"),
        (drawing("", "0\nLINE\n8\n0\n10\nx\n20\n0\n11\n1\n21\n1\n"), "a finite number (group 10 of LINE)"),
        (drawing("", "0\nARC\n8\n0\n10\n0\n20\n0\n40\n-5\n50\n0\n51\n90\n"), "finite coordinates"),
        (drawing("", "0\nSPLINE\n8\n0\n71\n3\n40\n0\n10\n0\n20\n0\n"), "a spline with as many weights"),
        ("0\nSECTION\n2\nENTITIES\nLINE\n8\n".into(), "a group code"),
        ("0\nSECTION\n2".into(), "a value after the group code"),
    ] {
        let message = refused(&text, None);
        assert!(message.contains(expected), "{expected}: {message}");
    }
    let binary = [b"AutoCAD Binary DXF\r\n\x1a\0".as_slice(), &[0; 20]].concat();
    let message = parse("a.dxf", &binary, &ReadOptions::default()).unwrap_err().to_string();
    assert!(message.contains("export the drawing as ASCII DXF"), "{message}");
}
