//! The stress table's quick rows, and the table itself: that a verdict can be no, that no row is blind, that a row is data.
use pdss::gpu::{Gpu, Options};
use pdss::stress::rows::ROWS;
use pdss::stress::{Bench, Engine, Measure, Row, StressError, Verdict, run, verdict};
use std::collections::BTreeSet;

fn bench() -> Bench {
    Bench { gpu: Gpu::open(&Options { validate: true, device: None }).expect("a device and the validation layer") }
}

fn close(bench: Bench) {
    assert_eq!(bench.gpu.messages(), Vec::<String>::new());
    bench.gpu.close().expect("nothing leaks");
}

#[test]
fn quick_rows_hold() {
    let bench = bench();
    let mut wrong = Vec::new();
    for row in ROWS.iter().filter(|r| r.quick) {
        for l in run(&bench, row) {
            let method = l.method.clone().unwrap_or_default();
            println!(
                "{:40} {method:12} {:22} {:?} <= {:.1e}, wrong input {:?}: {:?} {}",
                l.row, l.quantity, l.figure, l.bound, l.wrong, l.verdict, l.text
            );
            if matches!(l.verdict, Verdict::Fail | Verdict::Blind) && l.expected.is_none() {
                wrong.push(format!("{} {method} {}: {}", l.row, l.quantity, l.text));
            }
        }
    }
    assert_eq!(wrong, Vec::<String>::new());
    close(bench);
}

/// A figure beyond its bound fails, NaN and infinity with it; one whose wrong input passes is blind.
#[test]
fn verdicts_can_be_no() {
    let of = |figure: f64, wrong: f64| verdict(&Measure::new("q", figure, wrong, ""), 1.);
    assert_eq!(of(0.5, 2.), Verdict::Pass);
    assert_eq!(of(1., f64::INFINITY), Verdict::Pass);
    assert_eq!(of(0.5, f64::NAN), Verdict::Pass);
    for figure in [1.5, f64::NAN, f64::INFINITY] {
        assert_eq!(of(figure, 2.), Verdict::Fail);
    }
    assert_eq!(of(0.5, 0.9), Verdict::Blind);
}

/// What a row may do wrong is said of that row: an error, a quantity left out, a method that is refused by all.
#[test]
fn a_row_that_goes_wrong_fails() {
    let bench = bench();
    let row = |engine: Engine| Row { name: "r", holds: "h", bounds: &[("q", 1.)], quick: true, engine, expected: &[] };
    let lines = run(&bench, &row(Engine::Once(|_| Err(StressError::Row("no".to_owned())))));
    assert_eq!((lines[0].verdict, lines[0].text.as_str()), (Verdict::Fail, "no"));
    let lines = run(&bench, &row(Engine::Once(|_| Ok(vec![Measure::new("another", 0., 2., "")]))));
    assert_eq!(lines[0].verdict, Verdict::Fail);
    let refused = |_: &Bench, _| {
        let count = 1000;
        Err(StressError::Frame(pdss::frame::FrameError::Lights { count }))
    };
    assert!(run(&bench, &row(Engine::Each(refused))).iter().all(|l| l.verdict == Verdict::Fail));
    close(bench);
}

/// Names tell rows apart, quantities tell figures apart, and what is known to fail names a quantity that is there.
#[test]
fn the_table_is_sound() {
    let names: BTreeSet<_> = ROWS.iter().map(|r| r.name).collect();
    assert_eq!(names.len(), ROWS.len());
    for row in ROWS {
        let quantities: BTreeSet<_> = row.bounds.iter().map(|b| b.0).collect();
        assert!(!row.bounds.is_empty() && quantities.len() == row.bounds.len(), "{}", row.name);
        for (_, quantity, why) in row.expected {
            assert!(quantity.is_empty() || quantities.contains(quantity), "{}: no {quantity}", row.name);
            assert!(why.len() > 20, "{}: say why", row.name);
        }
    }
}
