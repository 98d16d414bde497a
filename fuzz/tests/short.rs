//! The fuzzer finds what it looks for, and a short run of it finds nothing in the readers. A long one is `fuzz/run all`.

use std::fs;
use std::path::Path;
use std::sync::Mutex;

use koiter_fuzz::{Options, Report, Target, fuzz, read_corpus};

/// Memory and panics are counted for the whole process, so one test runs at a time.
static ALONE: Mutex<()> = Mutex::new(());

fn run(
    read: &dyn Fn(&[u8]) -> bool,
    dictionary: &[&str],
    corpus: Vec<Vec<u8>>,
    inputs: u64,
) -> Report {
    let _alone = ALONE
        .lock()
        .unwrap_or_else(|poisoned| poisoned.into_inner());
    let folder = tempfile::tempdir().unwrap();
    let options = Options {
        inputs,
        max_length: 1 << 14,
        ..Options::default()
    };
    fuzz(
        read,
        dictionary,
        corpus,
        &options,
        &folder.path().join("current"),
    )
    .unwrap()
}

#[test]
fn damaged_files_neither_panic_nor_take_more_than_they_should() {
    for target in Target::ALL {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("corpus")
            .join(target.name());
        let corpus = read_corpus(&folder).unwrap();
        let report = run(
            &|bytes| target.read(bytes),
            target.dictionary(),
            corpus,
            2000,
        );
        assert!(
            report.panics.is_empty(),
            "{target}: {:?}",
            report.panics.keys()
        );
        // Not so much damage, and not so little, that the test is empty.
        assert!(
            (20..1980).contains(&report.accepted),
            "{target}: {} accepted",
            report.accepted
        );
    }
}

#[test]
fn every_file_of_the_corpus_is_good() {
    for target in Target::ALL {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("corpus")
            .join(target.name());
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            assert!(target.read(&fs::read(&path).unwrap()), "{}", path.display());
        }
    }
}

#[test]
fn panics_are_counted_by_place_with_their_first_input() {
    let read = |bytes: &[u8]| {
        assert!(!bytes.contains(&b'!'), "an exclamation mark");
        true
    };
    let report = run(&read, &["!"], vec![b"hello".to_vec()], 300);
    let (message, (count, input)) = report.panics.first_key_value().unwrap();
    assert!(
        message.contains("an exclamation mark") && message.contains("short.rs"),
        "{message}"
    );
    assert!(report.panics.len() == 1 && *count > 10 && input.contains(&b'!'));
    assert_eq!(report.accepted + count, 300);
}

#[test]
fn the_input_that_takes_most_memory_is_named() {
    let read = |bytes: &[u8]| {
        let size = if bytes.contains(&b'!') { 1 << 20 } else { 1 };
        vec![1u8; size].iter().all(|&byte| byte == 1)
    };
    let report = run(&read, &["!"], vec![b"hello".to_vec()], 300);
    assert!(report.hungriest.0 >= 1 << 20 && report.hungriest.1.contains(&b'!'));
}

#[test]
fn the_same_seed_gives_the_same_inputs() {
    let inputs = || {
        let seen = Mutex::new(Vec::new());
        run(
            &|bytes| {
                seen.lock().unwrap().push(bytes.to_vec());
                true
            },
            &["x"],
            vec![b"v 0 0 0\nv 1.5 2 3\n".to_vec()],
            200,
        );
        seen.into_inner().unwrap()
    };
    assert_eq!(inputs(), inputs());
}
