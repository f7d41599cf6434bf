//! Mutated files for what reads files: whatever the bytes, it reads or refuses them, without a panic and in time.
//!
//! A case has its number as seed, so that it is repeated by its number alone. The files that cases begin with lie in a folder of the repository.
//! The input of a fault is kept in a file, whose path is said. In the folder of the corpus it is tried first from then on.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::Random;

/// A case that takes longer hangs; it takes milliseconds on a machine that does nothing else.
const HANGS: Duration = Duration::from_secs(60);
/// Largest file that a case makes, bytes.
const LARGEST: usize = 1 << 20;
/// Most changes of a case.
const CHANGES: u64 = 8;
/// Faults after which no further case is tried.
const FAULTS: usize = 10;
/// Beginning of the names of inputs that were faults: they may be refused as they are.
const FAULT: &str = "fault-";

/// What may stand in the place of a number, or anywhere.
const TOKENS: [&str; 44] = [
    "nan",
    "inf",
    "-inf",
    "1e999",
    "-1e308",
    "1e308",
    "1e-320",
    "-0",
    "0",
    "-1",
    "1",
    "2",
    "1e9",
    "4294967296",
    "9223372036854775808",
    "18446744073709551615",
    "1_0",
    "0x10",
    "1,5",
    "true",
    "null",
    "\"\"",
    "{}",
    "[]",
    "[[]]",
    "{",
    "}",
    "[",
    "]",
    "(",
    "\"",
    "'",
    "=",
    ",",
    ";",
    "#",
    "!",
    "\n",
    "\r\n",
    "\t",
    "\0",
    "\u{feff}",
    "\u{2212}",
    "\u{1b}[2J",
];

/// How many cases are tried.
#[derive(Debug, Clone, Copy)]
pub enum Effort {
    /// As many as there is time for.
    Time(Duration),
    /// So many.
    Cases(u64),
}

/// What became of a case.
pub enum Fate {
    /// It was read.
    Read,
    /// It was refused with this message.
    Refused(String),
    /// It should not have been read as it was; says why.
    Silent(String),
}

impl Fate {
    /// That of a result.
    pub fn of<T, E: std::fmt::Display>(result: Result<T, E>) -> Self {
        result.map_or_else(|error| Self::Refused(error.to_string()), |_| Self::Read)
    }
}

/// Files that cases begin with: names and contents.
pub struct Corpus(Vec<(String, Vec<u8>)>);

impl Corpus {
    /// The files of a folder, in the order of their names.
    ///
    /// # Panics
    /// If the folder cannot be read or has none.
    pub fn of_folder(folder: &Path) -> Self {
        let mut files: Vec<(String, Vec<u8>)> = std::fs::read_dir(folder)
            .unwrap_or_else(|cause| panic!("{}: {cause}", folder.display()))
            .map(|entry| entry.expect("a file of the corpus").path())
            .filter(|path| path.is_file())
            .map(|path| {
                let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
                (name, std::fs::read(&path).expect("a file of the corpus"))
            })
            .collect();
        files.sort();
        Self::of(files)
    }

    /// These files.
    ///
    /// # Panics
    /// If there is none.
    pub fn of(files: Vec<(String, Vec<u8>)>) -> Self {
        assert!(!files.is_empty(), "a corpus has a file at least");
        Self(files)
    }

    /// The case of a number: the name of the file that it begins with, and its bytes.
    pub fn case(&self, number: u64) -> (&str, Vec<u8>) {
        let mut random = Random::new(number.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let (name, bytes) = &self.0[random.below(self.0.len() as u64) as usize];
        let mut bytes = bytes.clone();
        for _ in 0..=random.below(CHANGES) {
            self.change(&mut bytes, &mut random);
            bytes.truncate(LARGEST);
        }
        (name, bytes)
    }

    fn change(&self, bytes: &mut Vec<u8>, random: &mut Random) {
        let length = bytes.len() as u64;
        let at = random.below(length + 1) as usize;
        let part =
            |random: &mut Random, most: u64| at..(at + 1 + random.below(most) as usize).min(length as usize);
        match random.below(11) {
            0 if at < bytes.len() => bytes[at] = random.bits() as u8,
            1 if at < bytes.len() => bytes[at] ^= 1 << random.below(8),
            2 | 3 => drop(bytes.splice(at..at, random.one_of(&TOKENS).bytes())),
            4 if at < bytes.len() => drop(bytes.drain(part(random, 200))),
            5 if at < bytes.len() => {
                let again = bytes[part(random, 400)].repeat(1 + random.below(4) as usize);
                bytes.splice(at..at, again);
            }
            6 if random.chance(0.2) => bytes.truncate(at),
            // lines left out: what a hole in a list is
            6 => {
                let end = bytes.iter().enumerate().skip(at).filter(|(_, byte)| **byte == b'\n');
                let begin = end.clone().next().map_or(bytes.len(), |(line, _)| line + 1);
                let end = end.map(|(line, _)| line + 1).nth(1 + random.below(60) as usize);
                bytes.drain(begin..end.unwrap_or(bytes.len()).max(begin));
            }
            7 | 8 => {
                let is_of_number = |byte: &u8| byte.is_ascii_digit() || b"+-.eE".contains(byte);
                if let Some(begin) = bytes.iter().skip(at).position(u8::is_ascii_digit).map(|more| at + more)
                {
                    let end = bytes[begin..]
                        .iter()
                        .position(|byte| !is_of_number(byte))
                        .map_or(bytes.len(), |more| begin + more);
                    let number = match random.below(3) {
                        0 => random.one_of(&TOKENS).to_string(),
                        1 => format!("{:.4}", random.between(-100.0, 100.0)),
                        _ => {
                            format!("{}", random.between(-1.0, 1.0) * 10f64.powf(random.between(-12.0, 12.0)))
                        }
                    };
                    bytes.splice(begin..end, number.bytes());
                }
            }
            9 => {
                let (_, other) = &self.0[random.below(self.0.len() as u64) as usize];
                let from = random.below(other.len() as u64 + 1) as usize;
                let to = (from + 1 + random.below(400) as usize).min(other.len());
                bytes.splice(at..at, other[from..to].iter().copied());
            }
            _ => {
                let words: [u64; 6] = [0, 1, u64::MAX, 1 << 63, f64::NAN.to_bits(), f64::INFINITY.to_bits()];
                let end = (at + 8).min(bytes.len());
                let word = random.one_of(&words).to_le_bytes();
                bytes.splice(at..end, word.into_iter().take(end - at));
            }
        }
    }

    /// Tries cases on `target`, which gets the name of a file and bytes. The files as they are come first; they have to be read, unless they were faults.
    ///
    /// # Panics
    /// With the numbers and inputs of all cases that panicked, that hung, or that were read as they should not have been.
    pub fn fuzz(&self, kind: &str, effort: Effort, target: impl Fn(&str, &[u8]) -> Fate) {
        for (name, bytes) in &self.0 {
            match target(name, bytes) {
                Fate::Read => {}
                Fate::Refused(_) if name.starts_with(FAULT) => {}
                Fate::Refused(why) | Fate::Silent(why) => panic!("{kind}: {name} as it is: {why}"),
            }
        }
        let watch = Watch::begin(kind);
        let (mut number, mut read, mut refused, mut faults) = (0, 0_u64, 0_u64, Vec::new());
        let begun = Instant::now();
        let goes_on = |number: u64| match effort {
            Effort::Time(time) => begun.elapsed() < time,
            Effort::Cases(cases) => number < cases,
        };
        while goes_on(number) && faults.len() < FAULTS {
            let (name, bytes) = self.case(number);
            watch.of(Case { number, name: name.into(), bytes: bytes.clone(), begun: Instant::now() });
            let fault = match catch_unwind(AssertUnwindSafe(|| target(name, &bytes))) {
                Err(_) => Some("panicked".to_string()),
                Ok(Fate::Silent(why)) => Some(why),
                Ok(Fate::Refused(why)) if why.trim().is_empty() => Some("refused without a word".into()),
                Ok(Fate::Refused(_)) => {
                    refused += 1;
                    None
                }
                Ok(Fate::Read) => {
                    read += 1;
                    None
                }
            };
            faults.extend(fault.map(|fault| {
                let input = kept(kind, number, name, &bytes);
                format!("{kind} {number}, {name}: {fault}; its input is {}", input.display())
            }));
            number += 1;
        }
        let seconds = begun.elapsed().as_secs_f64();
        println!(
            "{kind}: {number} cases, {refused} refused, {read} read, in {seconds:.0} s ({:.0} a second)",
            number as f64 / seconds
        );
        assert!(faults.is_empty(), "{}", faults.join("\n"));
        assert!(refused > 0, "the cases of {kind} test nothing");
    }
}

/// Writes the input of a fault, in the folder of the kind beside the programs of the tests.
fn kept(kind: &str, number: u64, name: &str, bytes: &[u8]) -> PathBuf {
    let program = std::env::current_exe().unwrap_or_default();
    // target/release/deps/name-hash
    let folder = program.ancestors().nth(2).unwrap_or(Path::new(".")).join("faults").join(kind);
    let file = folder.join(format!("{FAULT}{number}-{name}"));
    if let Err(cause) = std::fs::create_dir_all(&folder).and_then(|()| std::fs::write(&file, bytes)) {
        eprintln!("{}: {cause}", file.display());
    }
    file
}

/// The case that is tried.
struct Case {
    number: u64,
    name: String,
    bytes: Vec<u8>,
    begun: Instant,
}

/// Ends the program with the input of a case that hangs: a test would wait for it without an end.
struct Watch(Arc<Mutex<Option<Case>>>);

impl Watch {
    fn begin(kind: &str) -> Self {
        let first = Case { number: 0, name: String::new(), bytes: Vec::new(), begun: Instant::now() };
        let now = Arc::new(Mutex::new(Some(first)));
        let (seen, kind) = (now.clone(), kind.to_string());
        std::thread::spawn(move || {
            loop {
                std::thread::sleep(Duration::from_secs(1));
                let case = seen.lock().unwrap_or_else(PoisonError::into_inner);
                let Some(Case { number, name, bytes, begun }) = &*case else { return };
                if begun.elapsed() > HANGS {
                    let input = kept(&kind, *number, name, bytes);
                    let (seconds, input) = (HANGS.as_secs(), input.display());
                    eprintln!("{kind} {number}, {name}: takes longer than {seconds} s; its input is {input}");
                    std::process::exit(101);
                }
            }
        });
        Self(now)
    }

    fn of(&self, case: Case) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(case);
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corpus() -> Corpus {
        Corpus::of(vec![("a.txt".into(), b"1 2\n3 4\n5 6\n".to_vec()), ("b.txt".into(), b"7 8\n".to_vec())])
    }

    /// Goal: a number is the same case every time, and cases differ from the files and from each other.
    #[test]
    fn a_case_is_its_number() {
        let corpus = corpus();
        let cases: std::collections::BTreeSet<Vec<u8>> =
            (0..1000).map(|number| corpus.case(number).1).collect();
        assert!(cases.len() > 800 && (0..1000).all(|number| corpus.case(number) == corpus.case(number)));
    }

    /// Goal: a reader that panics, one that takes what it should refuse and one that refuses its own files are found.
    #[test]
    fn what_is_wrong_is_found() {
        let short = Effort::Cases(300);
        let found = |target: &dyn Fn(&str, &[u8]) -> Fate| {
            let said =
                catch_unwind(AssertUnwindSafe(|| corpus().fuzz("numbers", short, target))).unwrap_err();
            said.downcast_ref::<String>().cloned().unwrap_or_default()
        };
        let is_plain = |bytes: &[u8]| bytes.iter().all(|byte| b"0123456789 \n".contains(byte));
        let said = found(&|_, bytes| if is_plain(bytes) { Fate::Read } else { panic!("no number") });
        assert!(said.contains("panicked"), "{said}");
        // what is kept is the case
        let (case, file) = said.lines().next().unwrap().split_once("; its input is ").unwrap();
        let number = case.split([' ', ',']).nth(1).unwrap().parse().unwrap();
        assert_eq!(std::fs::read(file).unwrap(), corpus().case(number).1);
        let silent = |_: &str, bytes: &[u8]| match is_plain(bytes) {
            true => Fate::Read,
            false => Fate::Silent("letters".into()),
        };
        assert!(found(&silent).contains("letters"));
        std::fs::remove_dir_all(Path::new(file).parent().unwrap()).unwrap();
        assert!(found(&|_, _| Fate::Refused("no".into())).contains("a.txt as it is: no"));
        let once = Corpus::of(vec![("fault-7-a.txt".into(), b"x".to_vec())]);
        once.fuzz("numbers", short, |_, _| Fate::Refused("no".into()));
        corpus().fuzz("numbers", short, |_, bytes| match is_plain(bytes) {
            true => Fate::Read,
            false => Fate::Refused("no number".into()),
        });
    }
}
