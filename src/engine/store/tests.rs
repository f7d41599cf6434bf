//! Source: what was written. Goal: an entry is taken as it was written or not at all.

use super::*;

fn store() -> (tempfile::TempDir, Store) {
    let root = tempfile::tempdir().unwrap();
    let store = Store::open(&root.path().join("store")).unwrap();
    (root, store)
}

fn artefact() -> Artefact {
    Artefact::default().with("a.json", "{}\n").with("b.vtu", vec![0, 10, 255, 10]).with("empty", "")
}

fn put(store: &Store, inputs: &str) -> Address {
    let address = Address::of(Kind::SimpleRun, &inputs);
    store.put(&address, "simple model, one", "coarse", &artefact()).unwrap();
    address
}

fn taken(store: &Store, address: &Address) -> Option<Artefact> {
    match store.take(address) {
        Found::Whole(artefact) => Some(artefact),
        Found::Damaged(_) | Found::Unsigned | Found::Nothing => None,
    }
}

/// Goal: what was put is taken, byte for byte, at its own address alone; each of kind and inputs makes another address.
#[test]
fn what_was_put_is_taken() {
    let (_root, store) = store();
    let address = put(&store, "x");
    assert_eq!(taken(&store, &address), Some(artefact()));
    assert_eq!(artefact().part("b.vtu"), Some(&[0, 10, 255, 10][..]));
    for other in [Address::of(Kind::SimpleRun, &"y"), Address::of(Kind::SolidRun, &"x")] {
        assert!(matches!(store.take(&other), Found::Nothing));
    }
    let other_program = Address::by(Kind::SimpleRun, &"x", "another program");
    assert!(matches!(store.take(&other_program), Found::Nothing));
}

/// Goal: with a key only entries that it has signed are taken: one without a signature, one of another key and one whose content and hash were forged are not, and stay
/// for others; without a key a signed entry is taken. A file that is no secret is no key.
#[test]
fn only_signed_entries_are_taken_with_a_key() {
    let (root, store) = store();
    let key = |name: &str, content: &[u8]| {
        let path = root.path().join(name);
        std::fs::write(&path, content).unwrap();
        StoreKey::read(&path)
    };
    let own = || Store::open(store.path()).unwrap().signed_with(Some(key("own", &[7; 32]).unwrap()));
    let other = Store::open(store.path()).unwrap().signed_with(Some(key("other", &[8; 32]).unwrap()));
    let address = put(&store, "x");
    assert!(matches!(own().take(&address), Found::Unsigned) && taken(&store, &address).is_some());
    put(&other, "x");
    assert!(matches!(own().take(&address), Found::Unsigned));
    put(&own(), "x");
    assert_eq!((taken(&own(), &address), taken(&store, &address)), (Some(artefact()), Some(artefact())));
    assert!(matches!(other.take(&address), Found::Unsigned));
    // another content with its own hash, under the signature of the first
    let path = store.folder.file(&address.file());
    let signed = std::fs::read(&path).unwrap();
    let line = String::from_utf8(signed.iter().copied().take_while(|byte| *byte != b'\n').collect()).unwrap();
    let signature = line.rsplit(' ').next().unwrap();
    let forged = encode(&address, "forged", "coarse", &artefact(), None);
    let end = forged.iter().position(|byte| *byte == b'\n').unwrap();
    let forged = [&forged[..end], b" ", signature.as_bytes(), &forged[end..]].concat();
    std::fs::write(&path, forged).unwrap();
    assert!(matches!(own().take(&address), Found::Unsigned) && taken(&store, &address).is_some());
    assert!(key("short", &[7; 31]).unwrap_err().to_string().contains("31 bytes"));
    assert!(StoreKey::read(&root.path().join("missing")).is_err());
}

/// Goal: an entry that is a link, also to a device that never ends, or a pipe is damaged and goes; what a link leads to stays.
#[cfg(unix)]
#[test]
fn an_entry_that_is_no_regular_file_goes() {
    let (root, store) = store();
    let address = put(&store, "x");
    let path = store.folder.file(&address.file());
    let whole = root.path().join("whole");
    std::fs::copy(&path, &whole).unwrap();
    for target in [Path::new("/dev/zero"), &whole] {
        std::fs::remove_file(&path).unwrap();
        std::os::unix::fs::symlink(target, &path).unwrap();
        assert!(!store.has(&address));
        assert!(matches!(store.take(&address), Found::Damaged(_)));
        assert!(path.symlink_metadata().is_err() && whole.exists());
        put(&store, "x");
    }
}

/// Goal: an entry with any byte changed, cut at any length, with bytes after its end, or of another address is said to
/// be damaged, and is gone after that.
#[test]
fn a_damaged_entry_is_removed() {
    let (_root, store) = store();
    let address = put(&store, "x");
    let path = store.folder.file(&address.file());
    let whole = std::fs::read(&path).unwrap();
    let refused = |bytes: &[u8], what: &str| {
        std::fs::write(&path, bytes).unwrap();
        assert!(matches!(store.take(&address), Found::Damaged(_)), "{what}");
        assert!(!path.exists() && matches!(store.take(&address), Found::Nothing), "{what}");
    };
    for at in 0..whole.len() {
        let mut changed = whole.clone();
        changed[at] ^= 1;
        refused(&changed, &format!("byte {at} changed"));
        refused(&whole[..at], &format!("cut after {at} bytes"));
    }
    refused(&[&whole[..], b"more"].concat(), "longer");
    let other = put(&store, "y");
    refused(&std::fs::read(store.folder.file(&other.file())).unwrap(), "another entry");
    std::fs::write(&path, &whole).unwrap();
    assert_eq!(taken(&store, &address), Some(artefact()), "the bytes as they were");
}

/// Goal: four threads that write, read and remove the same entry at the same time never take anything but the whole.
#[test]
fn writers_and_readers_do_not_meet() {
    let (root, store) = store();
    let address = Address::of(Kind::Calibration, &1);
    let large = Artefact::default().with("a", vec![7; 300_000]);
    let large = &large;
    store.put(&address, "x", "y", large).unwrap();
    let whole = std::thread::scope(|scope| {
        let work = |n: usize| {
            let (address, folder) = (address.clone(), root.path().join("store"));
            scope.spawn(move || {
                let store = Store::open(&folder).unwrap();
                let mut whole = 0;
                for round in 0..50 {
                    match n {
                        0 | 1 => store.put(&address, "x", "y", large).unwrap(),
                        2 if round % 10 == 9 => drop(store.discard(&address, String::new())),
                        _ => match store.take(&address) {
                            Found::Whole(found) => {
                                assert!(found == *large);
                                whole += 1;
                            }
                            Found::Damaged(reason) => panic!("{reason}"),
                            Found::Unsigned | Found::Nothing => {}
                        },
                    }
                }
                whole
            })
        };
        let workers: Vec<_> = (0..4).map(work).collect();
        workers.into_iter().map(|worker| worker.join().unwrap()).sum::<usize>()
    });
    // What the third thread takes before it removes the entry for the first time.
    assert!(whole >= 9, "{whole}");
}

/// Goal: pruning removes what it says and nothing else: by age since the last use, down to a size from the longest
/// unused on, all; entries that cannot be read always, files that are no entries never.
#[test]
fn pruning_removes_entries_alone() {
    const HOUR: Duration = Duration::from_secs(3600);
    let (_root, store) = store();
    let used = |address: &Address, ago: Duration| {
        let file = std::fs::File::options().write(true).open(store.folder.file(&address.file())).unwrap();
        file.set_modified(SystemTime::now() - ago).unwrap();
    };
    let names = || store.list().into_iter().map(|entry| entry.key).collect::<Vec<_>>();
    let strangers = ["notes.txt", "calibration-1.artefact", &format!("other-{:064}.artefact", 0)];
    strangers.iter().for_each(|name| std::fs::write(store.folder.file(name), "mine").unwrap());
    let folder = format!("simple-run-{:064}.artefact", 1);
    std::fs::create_dir(store.folder.file(&folder)).unwrap();

    let [a, b, c] = ["a", "b", "c"].map(|inputs| put(&store, inputs));
    [(&a, 3), (&b, 2), (&c, 1)].into_iter().for_each(|(address, hours)| used(address, hours * HOUR));
    assert_eq!(names(), [&c.key, &b.key, &a.key].map(String::clone), "the last used first");
    let entry = &store.list()[0];
    assert_eq!(entry.made, Some(("simple model, one".into(), "coarse".into())));
    assert_eq!(store.prune(Prune::default()).unwrap(), []);
    // Taken again, the oldest is the newest.
    assert!(taken(&store, &a).is_some());
    let half = Prune { older_than: Some(HOUR + HOUR / 2), ..Prune::default() };
    assert_eq!(store.prune(half).unwrap().len(), 1);
    assert_eq!(names(), [&a.key, &c.key].map(String::clone));
    let small = Prune { larger_than: Some(entry.bytes + 1), ..Prune::default() };
    assert_eq!(store.prune(small).unwrap().len(), 1);
    assert_eq!(names(), [a.key.as_str()]);

    std::fs::write(store.folder.file(&b.file()), "half").unwrap();
    assert_eq!(store.list().iter().filter(|entry| entry.made.is_none()).count(), 1);
    assert_eq!(store.prune(Prune::default()).unwrap().len(), 1);
    let abandoned = store.folder.file(&format!("{TEMPORARY}1"));
    let fresh = store.folder.file(&format!("{TEMPORARY}2"));
    for (path, ago) in [(&abandoned, ABANDONED + HOUR), (&fresh, HOUR)] {
        std::fs::write(path, "half").unwrap();
        std::fs::File::options()
            .write(true)
            .open(path)
            .unwrap()
            .set_modified(SystemTime::now() - ago)
            .unwrap();
    }
    assert_eq!(store.prune(Prune { all: true, ..Prune::default() }).unwrap().len(), 1);
    assert!(
        names().is_empty() && !abandoned.exists() && fresh.exists(),
        "the other may be of a living process"
    );
    assert!(
        strangers.iter().all(|name| store.folder.file(name).exists()) && store.folder.file(&folder).is_dir()
    );
}

/// Goal: a store that cannot be written says `--cache`, and one where an entry cannot be replaced stays as it was.
#[test]
fn a_folder_below_a_file_is_refused() {
    let root = tempfile::tempdir().unwrap();
    let file = root.path().join("file");
    std::fs::write(&file, "").unwrap();
    let error = Store::open(&file.join("store")).unwrap_err().to_string();
    assert!(error.starts_with("--cache = ") && error.contains("file/store"), "{error}");
}
