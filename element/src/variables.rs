//! The variables of an element as a functional mock-up unit of FMI 3.0 (Modelica Association, "Functional Mock-up Interface Specification", version 3.0, 2022), and its description.

use crate::element::Element;
use crate::file::FORMAT;
use std::fmt::Write;

/// Name of the shared library in a unit.
pub const MODEL: &str = "railspring_c";

/// Name of the element file among the resources of a unit.
pub const RESOURCE: &str = "pair.rse";

/// Contacts whose values a unit has.
pub const CONTACTS: usize = 3;

/// What a variable is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variable {
    /// Time, s.
    Time,
    /// A number of the host's motion: hub (y, z, roll), its velocities, section, its velocities, place.
    Motion(usize),
    /// A force: hub, section and rim (y, z, moment).
    Force(usize),
    /// How many contacts there are.
    Contacts,
    /// A number of a contact, as [`OF_CONTACT`].
    Contact(usize, usize),
    /// Coefficient of friction.
    Friction,
    /// Acceleration of gravity on the modes, m/s².
    Gravity,
    /// Flexibility of the section beyond the host's motions: yy, yz, yr, zz, zr, rr.
    Rest(usize),
    /// Whether inputs are the motions at the end of the step that follows, not at its beginning.
    AtEnd,
    /// Whether modes begin bent by weight and contact.
    Bent,
    /// Displacement of a mode of the wheel, with its velocity as derivative.
    Displacement(usize),
    /// Velocity of a mode.
    Velocity(usize),
    /// Derivative of a displacement.
    Rate(usize),
    /// Derivative of a velocity.
    Acceleration(usize),
}

/// Numbers of a motion with their units.
const MOTIONS: [(&str, &str, &str); 13] = [
    ("hub.y", "m", "displacement of the hub to the field side"),
    ("hub.z", "m", "displacement of the hub, down"),
    ("hub.roll", "rad", "rotation of the hub about the track"),
    ("hub.vy", "m/s", "velocity of the hub to the field side"),
    ("hub.vz", "m/s", "velocity of the hub, down"),
    ("hub.vroll", "rad/s", "rotational velocity of the hub"),
    ("section.y", "m", "displacement of the rail's shear centre to the field side"),
    ("section.z", "m", "displacement of the rail's shear centre, down"),
    ("section.roll", "rad", "rotation of the rail's section"),
    ("section.vy", "m/s", "velocity of the rail's shear centre to the field side"),
    ("section.vz", "m/s", "velocity of the rail's shear centre, down"),
    ("section.vroll", "rad/s", "rotational velocity of the rail's section"),
    (
        "place",
        "m",
        "place of the wheel along the study's rail, from its first end; -1 on a rail of the host's own",
    ),
];

/// Forces with their units.
const FORCES: [(&str, &str, &str); 9] = [
    ("hub.fy", "N", "force of the wheel on its hub to the field side"),
    ("hub.fz", "N", "force of the wheel on its hub, down"),
    ("hub.mx", "N.m", "moment of the wheel on its hub"),
    ("section.fy", "N", "force of the wheel on the rail's section to the field side"),
    ("section.fz", "N", "force of the wheel on the rail's section, down"),
    ("section.mx", "N.m", "moment of the wheel on the rail's section about its shear centre"),
    ("rim.fy", "N", "-Q: force on the wheel's rim to the field side"),
    ("rim.fz", "N", "-P: force on the wheel's rim, down"),
    ("rim.mx", "N.m", "moment on the wheel's rim about the origin of its profile"),
];

/// Numbers of a contact with their units.
pub const OF_CONTACT: [(&str, &str, &str); 5] = [
    ("normal", "N", "normal force"),
    ("tangential", "N", "friction force on the wheel, a quarter of a turn from the normal one"),
    ("rail_y", "m", "place on the rail's profile, to the field side"),
    ("rail_z", "m", "place on the rail's profile, down"),
    ("slides", "1", "1 where it slides, 0 where it sticks"),
];

/// Parts of the section's flexibility with their units.
const RESTS: [(&str, &str); 6] =
    [("yy", "m/N"), ("yz", "m/N"), ("yr", "rad/N"), ("zz", "m/N"), ("zr", "rad/N"), ("rr", "rad/(N.m)")];

/// The first reference of each kind.
const FIRST_FORCE: u32 = 14;
const CONTACT_COUNT: u32 = 23;
const FRICTION: u32 = 24;
const GRAVITY: u32 = 25;
const FIRST_REST: u32 = 26;
const AT_END: u32 = 32;
const BENT: u32 = 33;
const FIRST_CONTACT: u32 = 40;
const FIRST_STATE: u32 = 1000;
const FIRST_DERIVATIVE: u32 = 2000;

impl Variable {
    /// The variable with a reference, of an element with so many modes.
    pub fn of(reference: u32, modes: usize) -> Option<Self> {
        let of_mode = |first: u32, even: fn(usize) -> Self, odd: fn(usize) -> Self| {
            let at = (reference - first) as usize;
            (at / 2 < modes).then(|| if at.is_multiple_of(2) { even(at / 2) } else { odd(at / 2) })
        };
        Some(match reference {
            0 => Self::Time,
            1..FIRST_FORCE => Self::Motion(reference as usize - 1),
            FIRST_FORCE..CONTACT_COUNT => Self::Force((reference - FIRST_FORCE) as usize),
            CONTACT_COUNT => Self::Contacts,
            FRICTION => Self::Friction,
            GRAVITY => Self::Gravity,
            FIRST_REST..AT_END => Self::Rest((reference - FIRST_REST) as usize),
            AT_END => Self::AtEnd,
            BENT => Self::Bent,
            FIRST_CONTACT..FIRST_STATE => {
                let at = (reference - FIRST_CONTACT) as usize;
                let (contact, number) = (at / OF_CONTACT.len(), at % OF_CONTACT.len());
                return (contact < CONTACTS).then_some(Self::Contact(contact, number));
            }
            FIRST_STATE..FIRST_DERIVATIVE => {
                return of_mode(FIRST_STATE, Self::Displacement, Self::Velocity);
            }
            _ => return of_mode(FIRST_DERIVATIVE, Self::Rate, Self::Acceleration),
        })
    }

    /// Its reference.
    pub fn reference(self) -> u32 {
        match self {
            Self::Time => 0,
            Self::Motion(i) => 1 + i as u32,
            Self::Force(i) => FIRST_FORCE + i as u32,
            Self::Contacts => CONTACT_COUNT,
            Self::Friction => FRICTION,
            Self::Gravity => GRAVITY,
            Self::Rest(i) => FIRST_REST + i as u32,
            Self::AtEnd => AT_END,
            Self::Bent => BENT,
            Self::Contact(contact, number) => FIRST_CONTACT + (contact * OF_CONTACT.len() + number) as u32,
            Self::Displacement(i) => FIRST_STATE + 2 * i as u32,
            Self::Velocity(i) => FIRST_STATE + 2 * i as u32 + 1,
            Self::Rate(i) => FIRST_DERIVATIVE + 2 * i as u32,
            Self::Acceleration(i) => FIRST_DERIVATIVE + 2 * i as u32 + 1,
        }
    }
}

/// What a host hands over to say that library and description belong together.
pub fn token(element: &Element) -> String {
    let hashes: Vec<&str> = element.about.inputs.values().map(String::as_str).collect();
    format!("{FORMAT}, {}: {}", element.about.element, hashes.join(" "))
}

/// `modelDescription.xml` of an element.
pub fn model_description(element: &Element, version: &str) -> String {
    let mut text = String::new();
    let modes = element.wheel.modes.len();
    let mut line = |words: &str| {
        text.push_str(words);
        text.push('\n');
    };
    line(r#"<?xml version="1.0" encoding="UTF-8"?>"#);
    line(&format!(
        r#"<fmiModelDescription fmiVersion="3.0" modelName="{}" instantiationToken="{}" description="{}" generationTool="railspring {version}" variableNamingConvention="structured">"#,
        escaped(&element.about.study),
        escaped(&token(element)),
        escaped(&format!("Contact element of {}", element.about.pair)),
    ));
    let both = format!(
        r#"modelIdentifier="{MODEL}" canGetAndSetFMUState="true" providesDirectionalDerivatives="true""#
    );
    line(&format!(r#"  <ModelExchange {both} needsCompletedIntegratorStep="true"/>"#));
    line(&format!(r#"  <CoSimulation {both} canHandleVariableCommunicationStepSize="true"/>"#));
    line("  <UnitDefinitions>");
    for (name, base) in [
        ("s", r#"s="1""#),
        ("m", r#"m="1""#),
        ("rad", r#"rad="1""#),
        ("m/s", r#"m="1" s="-1""#),
        ("rad/s", r#"rad="1" s="-1""#),
        ("m/s2", r#"m="1" s="-2""#),
        ("N", r#"kg="1" m="1" s="-2""#),
        ("N.m", r#"kg="1" m="2" s="-2""#),
        ("m/N", r#"kg="-1" s="2""#),
        ("rad/N", r#"kg="-1" m="-1" s="2" rad="1""#),
        ("rad/(N.m)", r#"kg="-1" m="-2" s="2" rad="1""#),
    ] {
        line(&format!(r#"    <Unit name="{name}"><BaseUnit {base}/></Unit>"#));
    }
    line("  </UnitDefinitions>");
    line(r#"  <DefaultExperiment startTime="0" stopTime="0.01" stepSize="1e-5"/>"#);
    line("  <ModelVariables>");
    let mut real = |name: &str, of: Variable, rest: &str, about: &str| {
        let reference = of.reference();
        line(&format!(
            r#"    <Float64 name="{name}" valueReference="{reference}" {rest} description="{about}"/>"#
        ));
    };
    real("time", Variable::Time, r#"causality="independent" variability="continuous" unit="s""#, "time");
    let place = element.rail_at_wheel.as_ref().map_or(0.0, |rail| rail.place);
    for (i, (name, unit, about)) in MOTIONS.iter().enumerate() {
        let start = if *name == "place" { place } else { 0.0 };
        real(
            name,
            Variable::Motion(i),
            &format!(r#"causality="input" start="{start}" unit="{unit}""#),
            about,
        );
    }
    for (i, (name, unit, about)) in FORCES.iter().enumerate() {
        let rest = format!(r#"causality="output" initial="calculated" unit="{unit}""#);
        real(name, Variable::Force(i), &rest, about);
    }
    real("contacts", Variable::Contacts, r#"causality="output" initial="calculated""#, "number of contacts");
    for contact in 0..CONTACTS {
        for (number, (name, unit, about)) in OF_CONTACT.iter().enumerate() {
            let unit = if *unit == "1" { String::new() } else { format!(r#" unit="{unit}""#) };
            let rest = format!(r#"causality="output" initial="calculated"{unit}"#);
            let of = Variable::Contact(contact, number);
            real(&format!("contact[{}].{name}", contact + 1), of, &rest, about);
        }
    }
    let parameter = r#"causality="parameter" variability="fixed""#;
    let friction = format!(r#"{parameter} start="{}" min="0""#, element.friction);
    real("friction", Variable::Friction, &friction, "coefficient of friction");
    real(
        "gravity",
        Variable::Gravity,
        &format!(r#"{parameter} start="0" unit="m/s2""#),
        "acceleration of gravity on the modes of the wheel; the weight of the hub is the host's",
    );
    for (i, (name, unit)) in RESTS.iter().enumerate() {
        let rest = format!(r#"{parameter} start="0" unit="{unit}""#);
        real(
            &format!("rest.{name}"),
            Variable::Rest(i),
            &rest,
            "flexibility of the rail's section beyond the host's motion",
        );
    }
    for i in 0..modes {
        let state = r#"causality="local" variability="continuous" initial="exact" start="0""#;
        real(
            &format!("mode[{}].p", i + 1),
            Variable::Displacement(i),
            state,
            "displacement of a mode of the wheel",
        );
        real(&format!("mode[{}].v", i + 1), Variable::Velocity(i), state, "velocity of a mode of the wheel");
        let of = |state: Variable| {
            format!(
                r#"causality="local" variability="continuous" initial="calculated" derivative="{}""#,
                state.reference()
            )
        };
        let rate = of(Variable::Displacement(i));
        real(&format!("der(mode[{}].p)", i + 1), Variable::Rate(i), &rate, "velocity of a mode of the wheel");
        let acceleration = of(Variable::Velocity(i));
        let about = "acceleration of a mode of the wheel";
        real(&format!("der(mode[{}].v)", i + 1), Variable::Acceleration(i), &acceleration, about);
    }
    for (name, of, about) in [
        (
            "inputs_at_end",
            Variable::AtEnd,
            "in co-simulation: inputs are the motions at the end of the next step; otherwise at its beginning, from where they go on with their velocities",
        ),
        (
            "begins_bent",
            Variable::Bent,
            "in co-simulation: modes begin bent by weight and contact; otherwise as the hub has them",
        ),
    ] {
        let reference = of.reference();
        line(&format!(
            r#"    <Boolean name="{name}" valueReference="{reference}" {parameter} start="false" description="{about}"/>"#
        ));
    }
    line("  </ModelVariables>");
    line("  <ModelStructure>");
    let outputs = (0..FORCES.len()).map(Variable::Force).chain([Variable::Contacts]).chain(
        (0..CONTACTS).flat_map(|contact| (0..OF_CONTACT.len()).map(move |n| Variable::Contact(contact, n))),
    );
    let outputs: Vec<u32> = outputs.map(Variable::reference).collect();
    let derivatives: Vec<u32> = (0..modes)
        .flat_map(|i| [Variable::Rate(i), Variable::Acceleration(i)])
        .map(Variable::reference)
        .collect();
    for (kind, references) in [
        ("Output", &outputs),
        ("ContinuousStateDerivative", &derivatives),
        ("InitialUnknown", &outputs),
        ("InitialUnknown", &derivatives),
    ] {
        for reference in references {
            line(&format!(r#"    <{kind} valueReference="{reference}"/>"#));
        }
    }
    line("  </ModelStructure>");
    line("</fmiModelDescription>");
    text
}

/// Text as the value of an attribute.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '"' => escaped.push_str("&quot;"),
            c if c.is_control() => {
                let _ = write!(escaped, "&#{};", u32::from(c));
            }
            c => escaped.push(c),
        }
    }
    escaped
}
