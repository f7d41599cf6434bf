//! The exported springs in the programs that can be had.

use std::path::Path;

use railspring::results::crosscheck::calculix;
use railspring_profiles::monitor::Silent;
use railspring_testing::{Need, needs};

use super::{LOADS_KN, PROMISED, export, law, rows, said, springs, text};

/// Source: openseespy, run on the exported file. Goal: its spring has the law's displacement (m) at 10, 50, 85 and 120 kN, and no force in tension.
/// Accuracy: PROMISED.
#[test]
fn opensees_has_the_law() {
    let (place, record) = springs(None);
    let folder = export(&place, "opensees", &[]);
    // the Tcl file has the same numbers
    let [python, tcl] = ["py", "tcl"].map(|end| text(&folder, &format!("wheel_rail_spring.{end}")));
    let numbers = |text: &str| -> Vec<f64> {
        let lines = text.lines().filter(|line| line.starts_with("    "));
        lines.filter_map(|line| line.trim().trim_end_matches(',').parse().ok()).collect()
    };
    assert!(numbers(&python).len() > 40);
    assert_eq!(numbers(&python), numbers(&tcl));
    let Some(interpreter) = railspring_testing::opensees(Path::new(env!("CARGO_TARGET_TMPDIR"))) else {
        return;
    };
    let run = |arguments: &[&str]| -> String {
        let mut command = std::process::Command::new(&interpreter);
        let output = command.current_dir(&folder).args(arguments).output().unwrap();
        let messages = said(&output);
        assert!(output.status.success() && !messages.contains("WARNING"), "{messages}");
        String::from_utf8(output.stdout).unwrap()
    };
    let loads = LOADS_KN.map(|load| load.to_string());
    let mut arguments = vec!["wheel_rail_spring.py"];
    arguments.extend(loads.iter().map(String::as_str));
    let law = law(&record, "beam");
    let found = rows(&run(&arguments));
    assert_eq!(found.len(), LOADS_KN.len());
    for ([load, displacement], wanted) in found.into_iter().zip(LOADS_KN) {
        let expected = law.displacement(1e3 * wanted);
        assert_eq!(load, wanted);
        assert!((displacement / expected - 1.0).abs() < PROMISED, "{load} kN: {displacement} {expected}");
    }
    // beyond the range there is no law, and its first load there is refused
    let beyond = std::process::Command::new(&interpreter)
        .current_dir(&folder)
        .args(["wheel_rail_spring.py", "150.1"])
        .output()
        .unwrap();
    assert!(
        !beyond.status.success()
            && said(&beyond).contains("150.1 kN: expected a force above 0 and up to 150")
    );
    // pulled apart and pressed by given displacements, which a penalty holds
    let driver = "import openseespy.opensees as o, wheel_rail_spring as s\n\
                  for x in (1e-5, 1e-2, -5e-5):\n    o.wipe()\n    o.model('basic', '-ndm', 1, '-ndf', 1)\n    o.node(1, 0.0)\n    \
                  o.node(2, 0.0)\n    o.fix(1, 1)\n    s.define(o, 1, 1, 1, 2, 1)\n    o.timeSeries('Linear', 1)\n    \
                  o.pattern('Plain', 1, 1)\n    o.sp(2, 1, x)\n    o.constraints('Penalty', 1e14, 1e14)\n    \
                  o.numberer('Plain')\n    o.system('BandGeneral')\n    o.test('NormDispIncr', 1e-12, 10)\n    \
                  o.algorithm('Newton')\n    o.integrator('LoadControl', 1.0)\n    o.analysis('Static')\n    \
                  assert o.analyze(1) == 0\n    print(o.nodeDisp(2, 1), o.eleResponse(1, 'material', 1, 'stress')[0])\n";
    let found = rows(&run(&["-c", driver]));
    let [near, far, pressed] = found[..] else { panic!("{found:?}") };
    assert!((near[0] - 1e-5).abs() < 1e-9 && (far[0] - 1e-2).abs() < 1e-9, "{found:?}");
    assert_eq!((near[1], far[1]), (0.0, 0.0));
    assert!((pressed[1] / -law.force(-pressed[0]) - 1.0).abs() < PROMISED && pressed[0] < -4e-5, "{found:?}");
}

/// Source: `HertzianContact` of STEM's vehicle models (UVEC), with the exported file as its parameters. Goal: its static deformation (m) under 10, 50, 85 and
/// 120 kN is that of a law without a constant part, its force there the load, and none in tension. Its linear spring at 60 kN has the law's tangent (N/m), in a gap too. Accuracy: some powers, ROUNDOFF.
#[test]
fn stem_has_the_law() {
    const ROUNDOFF: f64 = 1e-12;
    let Some(interpreter) = railspring_testing::stem(Path::new(env!("CARGO_TARGET_TMPDIR"))) else { return };
    let (place, record) = springs(Some([0.0, 4.3e5, 0.25]));
    let folder = export(&place, "stem", &[]);
    let driver = "import numpy as n\nfrom stem_contact import CONTACT\n\
                  from UVEC.uvec_ten_dof_vehicle_2D.hertzian_contact import HertzianContact\nh = HertzianContact()\n\
                  h.contact_coeff = CONTACT['contact_coefficient']\nh.contact_power = CONTACT['contact_power']\n\
                  for f in (10e3, 50e3, 85e3, 120e3):\n    x = h.calculate_contact_deformation(n.array([f]))[0]\n    \
                  print(x, h.calculate_contact_force(n.array([-x]))[0])\n\
                  n.seterr(invalid='ignore')\nprint(1e-5, h.calculate_contact_force(n.array([1e-5]))[0])\n\
                  from stem_contact import LINEAR\nh.contact_coeff, h.contact_power = LINEAR[60000].values()\n\
                  for x in (-1e-5, 1e-5):\n    print(x, h.calculate_contact_force(n.array([x]))[0])\n";
    let output =
        std::process::Command::new(&interpreter).current_dir(&folder).args(["-c", driver]).output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
    let found = rows(&String::from_utf8(output.stdout).unwrap());
    let law = law(&record, "beam");
    assert_eq!((found.len(), found[4]), (7, [1e-5, 0.0]));
    // the linear spring at 60 kN has the tangent there, and pushes in a gap, as the file says
    let tangent = 1e-5 * law.tangent(60e3);
    assert!((found[5][1] / tangent - 1.0).abs() < ROUNDOFF && (found[6][1] / tangent - 1.0).abs() < ROUNDOFF);
    for ([displacement, force], load) in found.into_iter().zip(LOADS_KN) {
        let expected = law.displacement(1e3 * load);
        assert!((displacement / expected - 1.0).abs() < ROUNDOFF, "{load} kN: {displacement} {expected}");
        assert!((force / (1e3 * load) - 1.0).abs() < ROUNDOFF, "{load} kN: {force}");
    }
}

/// Source: CalculiX (SPRINGA, linear kinematics) on the exported deck. Goal: lowered to the law's displacements under 10, 50, 85 and 120 kN it has
/// these reactions (N). Accuracy: PROMISED. Abaqus, which is not at hand, gets the same points behind the blank line that it wants.
#[test]
fn calculix_has_the_law() {
    let (place, _) = springs(None);
    let name = "wheel_rail_spring_calculix";
    let folder = export(&place, "calculix", &[]);
    let deck = text(&folder, &format!("{name}.inp"));
    let abaqus = text(&export(&place, "abaqus", &[]), "wheel_rail_spring_abaqus.inp");
    let points =
        |deck: &str| rows(deck.split("NONLINEAR\n").nth(1).unwrap().split("*BOUNDARY").next().unwrap());
    assert!(points(&deck).len() > 20 && abaqus.contains("NONLINEAR\n\n-"));
    assert_eq!(points(&deck), points(&abaqus));
    let last = points(&deck).pop().unwrap();
    assert!(last[0] == 0.0 && last[1] > 0.0, "the branch in tension");
    let version = calculix::version();
    if !needs(Need::Calculix, "CalculiX (ccx)", version.is_ok()) {
        return;
    }
    let (program, _) = version.unwrap();
    let steps =
        calculix::run(program, &folder, name, LOADS_KN.len(), &Silent).unwrap_or_else(|e| panic!("{e}"));
    for ((_, reaction), load) in steps.into_iter().zip(LOADS_KN) {
        assert!((-reaction / (1e3 * load) - 1.0).abs() < PROMISED, "{load} kN: {reaction}");
    }
}
