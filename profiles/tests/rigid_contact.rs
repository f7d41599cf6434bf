//! Rigid contact of wheelsets against independent tables.

use railspring_profiles::placement::{TrackGeometry, place_rail, touch};
use railspring_profiles::profile::wheels::wheel_profile;
use railspring_profiles::rigid_contact::{Roll, RunningFunction, WheelOnRail, Wheelset, WheelsetPosition};
use railspring_profiles::section::rail_section;
use railspring_testing::facts_text as facts;

fn rows(table: &str) -> impl Iterator<Item = Vec<&str>> {
    table.lines().filter(|l| !l.starts_with('#')).skip(1).map(|l| l.split(',').collect())
}

fn standard(rail: &str, inclination: f64, radius: f64) -> Wheelset {
    let track = TrackGeometry { inclination, ..TrackGeometry::standard() };
    let rail = place_rail(&rail_section(rail).unwrap(), &track).unwrap();
    let wheel = wheel_profile("S1002").unwrap();
    let tape_y = track.tape_y(&wheel);
    Wheelset::symmetric(WheelOnRail { rail, wheel, radius }, tape_y)
}

/// Source: first touch of the benchmark profiles by the CONTACT program under 10 N, shifts of -8 to 10 mm
/// (`contact/touch_point_right_wheel_no_yaw.csv`, mm and rad; its angle has the other sign, its rail's origin is the
/// top of the inclined rail at 760.5326 mm). Goal: our profiles from their definitions, lowered. Accuracy (MODEL):
/// positions 0.1 mm and angle 0.003 rad away from jumps, height 0.002 mm, a jump within 0.05 mm of shift.
#[test]
fn first_touch_follows_the_benchmark() {
    let Some(table) = facts("contact/touch_point_right_wheel_no_yaw.csv") else { return };
    let wheelset = standard("UIC60", 1.0 / 40.0, 0.460);
    let right = &wheelset.right;
    let lowered = |shift: f64| right.lower(wheelset.tape_y, shift, 0.0, 0.0, 0.0).unwrap();
    let y_at = |shift: f64| 1e3 * lowered(shift).points[0].point.y;
    let (mut compared, mut near_jumps) = (0, Vec::new());
    let mut worst = [0.0f64; 4];
    for row in rows(&table) {
        let value = |i: usize| row[i].parse::<f64>().unwrap();
        let (shift, height, y) = (1e-3 * value(0), value(3), value(4));
        let found = lowered(shift);
        let point = &found.points[0];
        let off = [
            1e3 * found.height - height,
            1e3 * point.point.y - y,
            1e3 * right.wheel.point(point.wheel_s).x - value(8),
            point.contact_angle + value(11),
        ];
        assert!(off[0].abs() < 2e-3, "shift {}: height {} against {height}", value(0), 1e3 * found.height);
        // The same first touch by another way.
        let same = touch(&right.rail, &right.wheel, wheelset.tape_y + shift).unwrap();
        assert!((same.tape_z - found.height).abs() < 1e-10 && (same.point.y - point.point.z).abs() < 1e-7);
        if off[1].abs() > 0.1 {
            // A jump: on the other side of it, at most 0.05 mm of shift away, the positions agree.
            let beside = [-0.05e-3, 0.05e-3].map(|d| (y_at(shift + d) - y).abs());
            near_jumps.push((value(0), off[1], beside));
            assert!(
                beside[0].min(beside[1]) < 0.5,
                "shift {}: y {} against {y}, {beside:?}",
                value(0),
                y + off[1]
            );
            continue;
        }
        for (w, o) in worst.iter_mut().zip(off) {
            *w = w.max(o.abs());
        }
        assert!(off[2].abs() < 0.1 && off[3].abs() < 0.003, "shift {}: {off:?}", value(0));
        compared += 1;
    }
    println!("{compared} rows, worst height, rail, wheel (mm), angle (rad): {worst:?}; jumps {near_jumps:?}");
    assert!(compared > 65, "{compared}");
}

/// Source: an independent calculation checked by the tables of EN 15302
/// (`geometry/equivalent_conicity_S1002_own.csv`). Goal: S1002 on 60E1, UIC60 and 60E2, 1:40 and 1:20, with and
/// without roll. Accuracy (DISCRETISATION of both tables of the difference, whose jumps are smeared): 0.004 for amplitudes of 1 to 4.5 mm; from 5 mm on,
/// where the contact jumps to the gauge corner and the jump's place is known to half a step, 0.015 without roll. With
/// roll the jumps are not compared: our shift is that of the axle, which the roll moves against the rails (MODEL).
#[test]
#[ignore = "a quarter of a minute: cargo long rigid_contact"]
fn equivalent_conicity_of_s1002() {
    const DISCRETISATION: [f64; 2] = [0.004, 0.015];
    let Some(table) = facts("geometry/equivalent_conicity_S1002_own.csv") else { return };
    let header: Vec<&str> = table.lines().find(|l| l.starts_with("amplitude")).unwrap().split(',').collect();
    for (column, name) in header.iter().enumerate().skip(1) {
        let parts: Vec<&str> = name.split('_').collect();
        let slope = if parts[1] == "1in40" { 1.0 / 40.0 } else { 1.0 / 20.0 };
        let roll = if parts.len() > 2 { Roll::Coupled } else { Roll::Fixed(0.0) };
        let wheelset = standard(parts[0], slope, 0.460);
        let function = RunningFunction::of(&wheelset, [-8.5e-3, 8.5e-3], 0.05e-3, roll).unwrap();
        let mut worst = [0.0f64; 2];
        for row in rows(&table) {
            let value = |i: usize| row[i].parse::<f64>().unwrap();
            let found = function.equivalent_conicity(1e-3 * value(0)).unwrap();
            let off = (found - value(column)).abs();
            let range = usize::from(value(0) > 4.5);
            if range == 1 && roll == Roll::Coupled {
                continue;
            }
            assert!(
                off < DISCRETISATION[range],
                "{name} at {} mm: {found} against {}",
                value(0),
                value(column)
            );
            worst[range] = worst[range].max(off);
        }
        let three = function.equivalent_conicity(3e-3).unwrap();
        println!("{name}: {three:.4} at 3 mm, worst {worst:?}");
    }
}

/// Source: Manchester benchmark, S1002 on UIC60 1:40 with yaw and roll (`contact/mbench_contact_positions.csv`,
/// mm and rad). The table's positions are pressure-weighted, and under load the conformal tread contact near the
/// centre lies elsewhere than the first touch: only the shifts at which the patch is small are compared, the right wheel
/// from 1 to 4.5 mm. Goal: lateral place and the lead of the contact by yaw. Accuracy (MODEL): 0.5 mm and 0.1 mm.
#[test]
fn yawed_contact_leads_as_in_the_manchester_benchmark() {
    let Some(table) = facts("contact/mbench_contact_positions.csv") else { return };
    let wheelset = standard("UIC60", 1.0 / 40.0, 0.460);
    let mut compared = 0;
    for row in rows(&table) {
        let value = |i: usize| row[i].parse::<f64>().unwrap();
        if row[0] != "right" || !(1.0..=4.5).contains(&value(2)) {
            continue;
        }
        let found = wheelset.right.lower(wheelset.tape_y, 1e-3 * value(2), value(3), value(4), 0.0).unwrap();
        let p = found.points[0].point * 1e3;
        println!("shift {}: x {:.3} ({}), y {:.3} ({})", value(2), p.x, value(6), p.y, value(7));
        assert!((p.y - value(7)).abs() < 0.5, "shift {}: y {} against {}", value(2), p.y, value(7));
        assert!((p.x - value(6)).abs() < 0.1, "shift {}: x {} against {}", value(2), p.x, value(6));
        compared += 1;
    }
    assert_eq!(compared, 8);
}

/// Both wheels touch after the roll has been found, and the mirrored position gives the mirrored answer. With yaw the
/// touching place is the closest one of the two bodies in space: no point of the wheel is below the rail.
#[test]
fn roll_couples_the_wheels_and_yaw_keeps_them_apart() {
    // SOLVER: of the roll's iteration.
    const SOLVER: f64 = 2e-9;
    let wheelset = standard("60E1", 1.0 / 40.0, 0.460);
    let at = |shift: f64, yaw: f64| {
        let position = WheelsetPosition { lateral_shift: shift, yaw, roll: Roll::Coupled };
        wheelset.contacts(&position, 20e-6).unwrap()
    };
    for (shift, yaw) in [(0.0, 0.0), (4e-3, 0.0), (4e-3, 10e-3), (6.5e-3, 24e-3)] {
        let (a, b) = (at(shift, yaw), at(-shift, -yaw));
        assert!((a.right.height - a.left.height).abs() < SOLVER);
        assert!((a.roll + b.roll).abs() < SOLVER && (a.right.height - b.left.height).abs() < SOLVER);
        assert!(a.right.points.windows(2).all(|p| p[0].gap <= p[1].gap) && a.right.points[0].gap == 0.0);
        // Circles of the right wheel, point by point, against the rail: touching within the clearance of the spline.
        let side = &wheelset.right;
        let (sin, cos) = (yaw.sin(), yaw.cos());
        let mut least = f64::INFINITY;
        for s in side.wheel.sample_parameters(0.2e-3) {
            let profile = side.wheel.point(s);
            for i in -200..=200 {
                let angle = f64::from(i) * 5e-4;
                let (eta, radius) = (wheelset.tape_y + profile.x, side.radius + profile.y);
                // Before the roll, which turns about the track's direction as seen by the yawed axle.
                let (y, z) = (
                    a.roll.cos() * eta - a.roll.sin() * radius * angle.cos(),
                    a.roll.sin() * eta + a.roll.cos() * radius * angle.cos(),
                );
                let lateral = sin * radius * angle.sin() + cos * y + shift;
                let height = z - side.radius + a.right.height;
                if let Some(rail_s) = side.rail.curve.s_at_y(lateral) {
                    least = least.min(side.rail.curve.point(rail_s).y - height);
                }
            }
        }
        // DISCRETISATION: circles 0.2 mm apart, points 0.23 mm apart on them: the sagitta on R13 is 0.4 µm on the flange.
        assert!((-1e-9..1.5e-6).contains(&least), "shift {shift} yaw {yaw}: {least:e}");
    }
}
