//! The element as a file.

use std::time::Duration;

use railspring_testing::fuzz::{Corpus, Effort, Fate};

use super::element;
use crate::element::Element;
use crate::file::with_own_hash;

/// Goal: what is written is read again to the last bit, and the same element gives the same bytes. Exact.
#[test]
fn a_file_is_the_element() {
    let element = element();
    let bytes = element.write();
    let read = Element::read(&bytes).unwrap();
    assert!(read.rail == element.rail && read.wheel_profile == element.wheel_profile);
    assert!(read.wheel == element.wheel && read.head == element.head && read.about == element.about);
    assert!(read.strips == element.strips && read.rail_at_wheel == element.rail_at_wheel);
    assert!(read == element);
    assert!(read.write() == bytes);
}

/// The bytes of a file whose text of the head is changed; as long as before.
fn changed(bytes: &[u8], from: &str, to: &str) -> Vec<u8> {
    let found = bytes.windows(from.len()).position(|window| window == from.as_bytes());
    let mut bytes = bytes.to_vec();
    bytes.splice(found.unwrap_or_else(|| panic!("{from}")).., []);
    let whole = element().write();
    let rest = &whole[bytes.len() + from.len()..];
    bytes.extend_from_slice(to.as_bytes());
    bytes.extend_from_slice(rest);
    bytes
}

/// Goal: files of another layout, cut short, or with values that no element has are refused with what is wrong and a remedy; none panics.
#[test]
fn files_of_no_element_are_refused() {
    let bytes = element().write();
    let said = |bytes: &[u8]| Element::read(bytes).unwrap_err().to_string();
    let other = said(&changed(&bytes, "railspring element 2", "railspring element 9"));
    assert!(other.contains("`railspring element 9`") && other.contains("`railspring element`"), "{other}");
    for length in [0, 7, 100, bytes.len() / 2, bytes.len() - 1] {
        assert!(said(&bytes[..length]).contains("layout"), "{length}");
    }
    for (from, to, wanted) in [
        ("wheel_damping_s", "wheel_damping_x", "unknown field"),
        ("\\\"friction\\\":0.4", "\\\"friction\\\":0.3", "not those that were written"),
    ] {
        let message = said(&changed(&bytes, from, to));
        assert!(message.contains(wanted), "{message}");
    }
    // one bit of any number
    for at in (bytes.len() - 2000..bytes.len()).step_by(97) {
        let mut flipped = bytes.clone();
        flipped[at] ^= 1;
        assert!(said(&flipped).contains("contents_blake3"), "{at}");
    }
    let wrong = |change: &dyn Fn(&mut Element)| {
        let mut element = element();
        change(&mut element);
        said(&element.write())
    };
    assert!(wrong(&|e| e.wheel.mass[(1, 1)] = -1.0).contains("mass is not positive"));
    assert!(wrong(&|e| e.wheel.modes[0].square = 0.0).contains("wheel that does not resist"));
    assert!(wrong(&|e| e.wheel.rest[(0, 0)] = f64::NAN).contains("wheel.rest with the value NaN"));
    assert!(wrong(&|e| e.friction = 999.0).contains("friction"));
    assert!(wrong(&|e| e.strips.influence.flexibility = -1.0).contains("relief"));
    assert!(wrong(&|e| e.tape.x = 1e6).contains("out of range"));
}

/// Goal: mutated files are refused, and with the hash that their content has they are read or refused: no panic, and in time. What is read is written and read again.
fn fuzzed(effort: Effort) {
    let whole = element().write();
    Corpus::of(vec![("element".into(), whole.clone())]).fuzz("elements", effort, |_, bytes| {
        let read = Element::read(bytes);
        if read.is_ok() && bytes != whole {
            return Fate::Silent("another file was taken as written".into());
        }
        let forged = with_own_hash(bytes).map(|bytes| Element::read(&bytes));
        if let Some(Ok(forged)) = forged
            && let Err(error) = Element::read(&forged.write())
        {
            return Fate::Silent(format!("what was read is refused when it is written: {error}"));
        }
        Fate::of(read)
    });
}

#[test]
fn mutated_files_are_refused() {
    fuzzed(Effort::Time(Duration::from_secs(5)));
}

/// Goal: no file of an element makes a panic or a hang in ten minutes of mutated bytes.
#[test]
#[ignore = "ten minutes: cargo long fuzz"]
fn ten_minutes_of_fuzzed_elements() {
    fuzzed(Effort::Time(Duration::from_secs(600)));
}
