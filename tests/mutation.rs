//! Studies, laws and histories with mistakes in them: no panic, no hang, no silent answer.
//!
//! Some hundreds of each by default; `cargo long mutation` tries 10,000 of each, and of profiles. Every case has its number
//! as seed, so that a case that fails is repeated by its number alone.

mod histories;
mod laws;
mod mutate;
mod studies;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use mutate::Dice;

/// Cases of each kind in the normal suite.
const SOME: u64 = 300;
/// Cases of each kind in the long run.
const MANY: u64 = 10_000;
/// Longest time for one case; a case takes milliseconds.
const HANGS: Duration = Duration::from_secs(10);

/// What became of a mutated file.
enum Fate {
    /// It was refused with this message.
    Refused(String),
    /// It was read as what it says.
    Read,
    /// It was read as something else; says what.
    Silent(String),
}

/// Tries `count` mutations; fails with all cases that panicked, hung, or were read as something else.
fn tried(kind: &str, count: u64, case: impl Fn(&mut Dice) -> (String, Fate)) {
    let mut faults = Vec::new();
    let (mut refused, mut read) = (0, 0);
    for number in 0..count {
        let begin = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| case(&mut Dice::new(number))));
        let fault = match outcome {
            Err(_) => Some("panicked".to_string()),
            Ok(_) if begin.elapsed() > HANGS => Some(format!("took {:?}", begin.elapsed())),
            Ok((_, Fate::Refused(message))) => {
                refused += 1;
                message.trim().is_empty().then(|| "refused without a word".to_string())
            }
            Ok((_, Fate::Read)) => {
                read += 1;
                None
            }
            Ok((changes, Fate::Silent(what))) => Some(format!("{what}\n    after {changes}")),
        };
        faults.extend(fault.map(|fault| format!("{kind} {number}: {fault}")));
    }
    println!("{kind}: {count} mutations, {refused} refused, {read} read as what they say");
    assert!(refused > 0 && read > 0, "the mutations of {kind} test nothing");
    assert!(faults.is_empty(), "{} of {count}:\n{}", faults.len(), faults[..faults.len().min(40)].join("\n"));
}

#[test]
fn mutated_studies() {
    studies::try_mutations(SOME);
}

#[test]
fn mutated_laws() {
    laws::try_mutations(SOME);
}

#[test]
fn mutated_histories() {
    histories::try_mutations(SOME);
}

/// Goal: 10,000 studies with mistakes end in a result or a message: no panic, no hang, no silent answer.
#[test]
#[ignore = "minutes: cargo long mutation"]
fn ten_thousand_mutated_studies() {
    studies::try_mutations(MANY);
}

/// Goal: 10,000 laws with mistakes end in a result or a message: no panic, no hang, no silent answer.
#[test]
#[ignore = "minutes: cargo long mutation"]
fn ten_thousand_mutated_laws() {
    laws::try_mutations(MANY);
}

/// Goal: 10,000 histories with mistakes end in a result or a message: no panic, no hang, no silent answer.
#[test]
#[ignore = "minutes: cargo long mutation"]
fn ten_thousand_mutated_histories() {
    histories::try_mutations(MANY);
}
