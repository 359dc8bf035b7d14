//! The files that `pdss vectors` writes: read back they are what the formulas give, and a number changed is caught.
use pdss::skin::vectors::{FORMULAS, File, SCHEMA, wrong};
use std::process::Command;

#[test]
fn written_vectors_are_the_formulas_and_a_changed_number_is_caught() {
    let folder = tempfile::tempdir().expect("a folder");
    let inner = folder.path().join("made/for/it");
    let done = Command::new(env!("CARGO_BIN_EXE_pdss")).arg("vectors").arg("-o").arg(&inner).output().expect("it runs");
    assert!(done.status.success(), "{done:?}");
    let names: Vec<_> = std::fs::read_dir(&inner).expect("a folder").flatten().map(|e| e.file_name()).collect();
    assert_eq!(names.len(), FORMULAS.len(), "{names:?}: a file a formula, and nothing half written");
    for f in FORMULAS {
        let text = std::fs::read_to_string(inner.join(format!("{}.json", f.name))).expect("a file");
        let file: File = serde_json::from_str(&text).expect("the schema");
        assert_eq!((file.schema, file.formula.as_str(), file.tolerance), (SCHEMA, f.name, f.tolerance));
        assert!(!file.cases.is_empty() && !file.source.is_empty(), "{}", f.name);
        let finite = file.cases.iter().flat_map(|c| c.input.iter().chain(&c.output)).all(|x| x.is_finite());
        assert!(finite, "{}: JSON holds no infinities", f.name);
        assert_eq!(wrong(f, &file), 0, "{}", f.name);
        // Outputs differ among the cases: a port that answers with a constant is caught.
        let first = &file.cases[0].output;
        assert!(file.cases.iter().any(|c| c.output != *first), "{}: every case has the same answer", f.name);
        let mut caught = 0;
        for i in 0..file.cases.len() {
            for k in 0..file.cases[i].output.len() {
                let mut other = file.clone();
                other.cases[i].output[k] += 3. * f.tolerance + 1e-12 * other.cases[i].output[k].abs();
                caught += wrong(f, &other);
            }
        }
        let outputs: usize = file.cases.iter().map(|c| c.output.len()).sum();
        assert_eq!(caught, outputs, "{}: a changed number passes", f.name);
        let mut short = file.clone();
        short.cases[0].output.pop();
        assert_eq!(wrong(f, &short), 1, "{}: a missing number passes", f.name);
        println!("{:18} {:4} cases, tolerance {:.0e}", f.name, file.cases.len(), f.tolerance);
    }
}

#[test]
fn a_folder_that_cannot_be_is_one_line_and_code_2() {
    let file = tempfile::NamedTempFile::new().expect("a file");
    let done =
        Command::new(env!("CARGO_BIN_EXE_pdss")).arg("vectors").arg("-o").arg(file.path()).output().expect("it runs");
    assert_eq!(done.status.code(), Some(2));
    assert_eq!(String::from_utf8_lossy(&done.stderr).lines().count(), 1);
}
