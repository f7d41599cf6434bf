//! A load case of a program that has its own integration: wheel on a short rail, a constant lateral force and a vertical one that swings (S.H. Ju 2016, section 4.1).
//!
//! The host has a hub, a suspended mass on spring and damper, and its rail by the modes in the element file. `contact` evaluates the contact as statics and integrates the wheel's modes with the rest of the host;
//! `unit` lets the element do so, and moves hub and rail explicitly.
//!
//! ```sh
//! cargo run --release -p railspring-element --example host -- pair.rse contact 16 >forces.csv
//! ```
//! The number is that of steps in a row of half a millisecond; columns are time (s), P and Q (N).

use nalgebra::{DMatrix, DVector, Vector3, Vector6};
use railspring_element::contact::{Motions, StaticContact};
use railspring_element::element::{Element, RailModes};
use railspring_element::unit::{Host, Motion, Unit};
use std::error::Error;
use std::path::Path;
use std::sync::Arc;

const ROW: f64 = 0.5e-3;
const ROWS: usize = 550;
const SUSPENDED: f64 = 6250.0;
const SPRING: f64 = 1.2e6;
const DAMPER: f64 = 4e4;

/// The last step of Newton's method, m: ten newtons in a contact.
const SETTLED: f64 = 1e-8;

/// Lateral force on the hub and vertical one on the suspended mass, N.
fn loads(time: f64) -> [f64; 2] {
    [20e3, 10e3 + 61.25e3 * (std::f64::consts::TAU * 10.0 * time).sin()]
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, file, kind, steps] = &arguments[..] else {
        return Err("usage: host FILE contact|unit STEPS".into());
    };
    let element = Arc::new(Element::open(Path::new(file))?);
    let steps: usize = steps.parse()?;
    let rail = element.rail_at_wheel.clone().ok_or("an element with a rail")?;
    println!("time_s,p_n,q_n");
    match kind.as_str() {
        "contact" => contact(&element, &rail, steps),
        "unit" => unit(&element, &rail, steps),
        _ => Err("contact or unit".into()),
    }
}

fn row(time: f64, rim: &Vector3<f64>) {
    println!("{time},{},{}", -rim.y, -rim.x);
}

/// Newmark's scheme with average acceleration over hub (y, z), suspended mass, wheel's modes and rail's modes, and Newton's method for the contact.
fn contact(element: &Arc<Element>, rail: &RailModes, steps: usize) -> Result<(), Box<dyn Error>> {
    let mut contact = StaticContact::new(element.clone(), element.friction)?;
    contact.set_section_rest(rail.rest)?;
    let wheel = element.superelement();
    // hub y and z without its rotation, which is held
    let of_wheel: Vec<usize> = [0, 1].into_iter().chain(3..wheel.mass.nrows()).collect();
    let (count, modes) = (of_wheel.len(), rail.modes.len());
    let size = count + 1 + modes;
    let mut mass = DMatrix::zeros(size, size);
    let (mut damping, mut stiffness) = (mass.clone(), mass.clone());
    let mut carried = DMatrix::zeros(6, size);
    for (i, &of_i) in of_wheel.iter().enumerate() {
        for (k, &of_k) in of_wheel.iter().enumerate() {
            mass[(i, k)] = wheel.mass[(of_i, of_k)];
            damping[(i, k)] = wheel.damping[(of_i, of_k)];
            stiffness[(i, k)] = wheel.stiffness[(of_i, of_k)];
        }
        (0..3).for_each(|row| carried[(row, i)] = wheel.rim[(row, of_i)]);
    }
    mass[(count, count)] = SUSPENDED;
    for (i, k, sign) in [(1, 1, 1.0), (count, count, 1.0), (1, count, -1.0), (count, 1, -1.0)] {
        stiffness[(i, k)] += sign * SPRING;
        damping[(i, k)] += sign * DAMPER;
    }
    for (n, mode) in rail.modes.iter().enumerate() {
        let i = count + 1 + n;
        mass[(i, i)] = 1.0;
        stiffness[(i, i)] = mode.square;
        damping[(i, i)] = rail.damping * mode.square;
        (0..3).for_each(|row| carried[(3 + row, i)] = mode.section[row]);
    }
    let h = ROW / steps as f64;
    let outside = |time: f64| {
        let mut force = DVector::zeros(size);
        [force[0], force[count]] = loads(time);
        force
    };
    let motions = |x: &DVector<f64>| {
        let carried = &carried * x;
        Motions {
            rim: carried.fixed_rows::<3>(0).into(),
            section: carried.fixed_rows::<3>(3).into(),
            place: rail.place,
        }
    };
    let both = |rim: &Vector3<f64>, section: &Vector3<f64>| {
        Vector6::new(rim.x, rim.y, rim.z, section.x, section.y, section.z)
    };
    let (mut x, mut v) = (DVector::zeros(size), DVector::zeros(size));
    let start = contact.start(&motions(&x))?;
    let force = outside(0.0) + carried.tr_mul(&both(&start.rim, &start.section));
    let mut a = mass.clone().cholesky().ok_or("a mass")?.solve(&force);
    row(0.0, &start.rim);
    let (mut evaluations, begun) = (0, std::time::Instant::now());
    for step in 1..=ROWS * steps {
        let time = step as f64 * h;
        // displacement at the end without an acceleration there
        let (free_x, free_v) = (&x + &v * h + &a * (0.25 * h * h), &v + &a * (0.5 * h));
        let mut end = &x + &v * h + &a * (0.5 * h * h);
        let mut forces;
        let mut iteration = 0;
        loop {
            forces = contact.evaluate(&motions(&end))?;
            evaluations += 1;
            a = (&end - &free_x) * (4.0 / (h * h));
            let velocity = &free_v + &a * (0.5 * h);
            let off = outside(time) + carried.tr_mul(&both(&forces.rim, &forces.section))
                - (&mass * &a + &damping * &velocity + &stiffness * &end);
            let tangent = DMatrix::from_fn(6, 6, |i, k| forces.tangent[(i, k)]);
            let system = &mass * (4.0 / (h * h)) + &damping * (2.0 / h) + &stiffness
                - carried.transpose() * tangent * &carried;
            let change = system.lu().solve(&off).ok_or("a singular step")?;
            end += &change;
            iteration += 1;
            if change.amax() < SETTLED {
                break;
            }
            if iteration == 100 {
                return Err(format!("no balance at {time} s: {:e} m", change.amax()).into());
            }
        }
        a = (&end - &free_x) * (4.0 / (h * h));
        v = &free_v + &a * (0.5 * h);
        x = end;
        contact.commit();
        if step % steps == 0 {
            row(time, &forces.rim);
        }
    }
    let taken = begun.elapsed().as_secs_f64() / (ROWS * steps) as f64;
    eprintln!(
        "{:.2} evaluations and {:.1} us a step",
        evaluations as f64 / (ROWS * steps) as f64,
        1e6 * taken
    );
    Ok(())
}

/// Hub, suspended mass and rail explicitly (central differences), the wheel's modes inside the element.
fn unit(element: &Arc<Element>, rail: &RailModes, steps: usize) -> Result<(), Box<dyn Error>> {
    let mut unit = Unit::new(element.clone(), element.friction, 0.0)?;
    unit.set_section_rest(rail.rest)?;
    let hub = unit.hub_mass().fixed_view::<2, 2>(0, 0).into_owned();
    let inverse = hub.try_inverse().ok_or("a mass")?;
    let modes = rail.modes.len();
    let h = ROW / steps as f64;
    // hub y and z, suspended mass, modes of the rail
    let (mut x, mut v) = (DVector::<f64>::zeros(3 + modes), DVector::<f64>::zeros(3 + modes));
    let host = |x: &DVector<f64>, v: &DVector<f64>| {
        let hub = |of: &DVector<f64>| Vector3::new(of[0], of[1], 0.0);
        let section =
            |of: &DVector<f64>| rail.modes.iter().enumerate().map(|(n, mode)| mode.section * of[3 + n]).sum();
        Host {
            hub: Motion { displacement: hub(x), velocity: hub(v) },
            section: Motion { displacement: section(x), velocity: section(v) },
            place: rail.place,
        }
    };
    let accelerations =
        |time: f64, x: &DVector<f64>, v: &DVector<f64>, forces: &railspring_element::unit::HostForces| {
            let [lateral, vertical] = loads(time);
            let spring = SPRING * (x[2] - x[1]) + DAMPER * (v[2] - v[1]);
            let of_hub = inverse * nalgebra::Vector2::new(lateral + forces.hub.x, forces.hub.y + spring);
            let mut a = DVector::zeros(3 + modes);
            (a[0], a[1], a[2]) = (of_hub.x, of_hub.y, (vertical - spring) / SUSPENDED);
            for (n, mode) in rail.modes.iter().enumerate() {
                let i = 3 + n;
                a[i] = mode.section.dot(&forces.section) - mode.square * (x[i] + rail.damping * v[i]);
            }
            a
        };
    let forces = unit.start(&host(&x, &v), false)?;
    let mut a = accelerations(0.0, &x, &v, &forces);
    row(0.0, &forces.rim);
    let begun = std::time::Instant::now();
    for step in 1..=ROWS * steps {
        let time = step as f64 * h;
        x += &v * h + &a * (0.5 * h * h);
        let expected = &v + &a * h;
        let forces = unit.advance(h, &host(&x, &expected))?;
        unit.commit();
        let after = accelerations(time, &x, &expected, &forces);
        v += (&a + &after) * (0.5 * h);
        a = after;
        if step % steps == 0 {
            row(time, &forces.rim);
        }
    }
    eprintln!("{:.1} us a step", 1e6 * begun.elapsed().as_secs_f64() / (ROWS * steps) as f64);
    Ok(())
}
