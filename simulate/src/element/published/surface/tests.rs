use super::*;
use nalgebra::Point2 as P;
use railspring_profiles::section::wheel_section;

/// A round wheel profile, so that curvature matters.
fn wheel() -> ProfileCurve {
    let points: Vec<P<f64>> = (0..=60)
        .map(|i| {
            let angle = (-60.0 + 2.0 * f64::from(i)).to_radians();
            // A circle above the profile's origin: the wheel is convex towards the rail.
            P::new(0.2 * angle.sin(), 0.2 * angle.cos() - 0.2)
        })
        .collect();
    ProfileCurve::from_points(&points, &[]).unwrap()
}

fn law() -> ContactLaw {
    ContactLaw { penalty: 1e10, friction: 0.3, frictionless: None, sliding: SlidingMatrix::Consistent }
}

/// Goal: the stiffness is the derivative of the forces, in sticking and in sliding, with all masters moving.
/// Central differences with h = 1e-7 m: rounding 1e-16·0.5/1e-7·k, discretisation (h/R)² — both below 1e-7 of the penalty.
#[test]
fn stiffness_is_derivative_of_force() {
    const DISCRETISATION: f64 = 2e-7;
    let wheel = wheel();
    let points: Vec<Vector2<f64>> = (-20..=20)
        .map(|i| {
            let x = 0.4e-3 * f64::from(i);
            Vector2::new(x + 0.01, 0.12 - x * x / 0.6)
        })
        .collect();
    let centre = Vector2::new(0.012, 0.12 + 0.43);
    // Penetration 0.1 mm, a tilted wheel and a twisted rail; the tangential motion decides between the modes.
    for (slide, mode) in [(2e-6, ContactMode::Stick), (3e-4, ContactMode::Slip), (-3e-4, ContactMode::Slip)] {
        let mut surface = ContactSurface::new(&points, &wheel, 0.43, centre);
        let start = Pose::from([0.0, -0.1e-3, 0.0, 0.0, 1e-3, 2e-3]);
        surface.list(&start, 1e-3);
        // A first motion leaves every node with a tangential force to carry on.
        let pressed = start + Pose::from([3e-6, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let first = surface.evaluate(&law(), &pressed, FrictionLimit::Coulomb(&[]));
        assert!(first.active.iter().any(|a| a.tangential_force.abs() > 1e4));
        surface.commit(&pressed, &first.active);
        let pose = pressed + Pose::from([slide, 3e-6, 1e-6, 2e-6, -1e-6, 2e-6]);
        let forces = surface.evaluate(&law(), &pose, FrictionLimit::Coulomb(&[]));
        let modes =
            |forces: &ContactForces| forces.active.iter().map(|a| (a.node, a.mode)).collect::<Vec<_>>();
        assert!(modes(&forces).iter().filter(|m| m.1 == mode).count() > 5, "{:?}", forces.active);
        for j in 0..6 {
            let h = 1e-7;
            let mut shift = Pose::zeros();
            shift[j] = h;
            let (up, down) = (
                surface.evaluate(&law(), &(pose + shift), FrictionLimit::Coulomb(&[])),
                surface.evaluate(&law(), &(pose - shift), FrictionLimit::Coulomb(&[])),
            );
            assert_eq!(modes(&up), modes(&down));
            let difference = (up.force - down.force) / (2.0 * h);
            let column = forces.stiffness.column(j);
            let error = (difference - column).norm();
            assert!(
                error < DISCRETISATION * 1e10 * forces.active.len() as f64,
                "column {j}: {error:e}\n{difference}{column}"
            );
        }
    }
}

/// Goal: action and reaction: forces on B and C are opposite, and their moments balance about any point.
#[test]
fn contact_forces_balance() {
    const ROUNDOFF: f64 = 1e-12;
    let wheel = wheel();
    let points: Vec<Vector2<f64>> = (-5..=5).map(|i| Vector2::new(1e-3 * f64::from(i), 0.0)).collect();
    let centre = Vector2::new(0.0, 0.43);
    let mut surface = ContactSurface::new(&points, &wheel, 0.43, centre);
    surface.list(&Pose::zeros(), 1e-3);
    let pose = Pose::from([1e-4, -0.2e-3, 2e-4, 1e-4, 1e-3, -1e-3]);
    let p = surface.evaluate(&law(), &pose, FrictionLimit::Coulomb(&[])).force;
    assert!(
        p[1] < -1.0 && (p[0] + p[2]).abs() < ROUNDOFF * p.norm() && (p[1] + p[3]).abs() < ROUNDOFF * p.norm()
    );
    let (b, c) = (centre + Vector2::new(pose[0], pose[1]), Vector2::new(pose[2], pose[3]));
    let moment = b.x * p[1] - b.y * p[0] + p[5] + c.x * p[3] - c.y * p[2] + p[4];
    assert!(moment.abs() < ROUNDOFF * p.norm());
}

/// Goal: a point that the bound places below the whole wheel has its nearest foot on S1002 ahead of it, as
/// the search on the whole spline finds. The bound places points 1.5 mm off the tread and the face of the
/// flange below the wheel. Exact: a sign.
#[test]
fn what_is_below_the_wheel_is_not_in_it() {
    let wheel = wheel_section("S1002", 0.858).unwrap().running;
    let surface = ContactSurface::new(&[Vector2::zeros()], &wheel, 0.429, Vector2::new(0.0, 0.429));
    let mut counts = [0; 2];
    for (i, j) in (-90..=90).flat_map(|i| (-30..=50).map(move |j| (i, j))) {
        let point = P::new(1e-3 * f64::from(i), 1e-3 * f64::from(j));
        let above = surface.underside.is_above(&point);
        assert!(!above || surface.foot_anywhere(&point).gap > 0.0, "{point}");
        counts[usize::from(above)] += 1;
    }
    assert!(counts.iter().all(|count| *count > 1000), "{counts:?}");
    for s in wheel.sample_parameters(1e-3) {
        let off = wheel.point(s) - 1.5e-3 * wheel.upward_normal(s);
        assert!(wheel.upward_normal(s).y > -0.3 || surface.underside.is_above(&off), "{s}: {off}");
    }
}
