//! What must hold whatever the figures are: no scattering is lambert, nothing depends on where the scene stands or how large
//! it is, a blur of a constant is that constant, nothing leaks across an edge, light is neither made nor lost.
//!
//! Each check prints its figure beside that of a twin: the same comparison of something that should not pass it.
mod studio;

#[path = "invariants/edges.rs"]
mod edges;
#[path = "invariants/energy.rs"]
mod energy;
#[path = "invariants/same_bits.rs"]
mod same_bits;
#[path = "invariants/spared.rs"]
mod spared;
#[path = "invariants/suits.rs"]
mod suits;
#[path = "invariants/symmetry.rs"]
mod symmetry;

use pdss::gpu::Gpu;
use std::sync::Arc;

/// Figures and verdict of one check.
pub struct Outcome {
    /// What was found.
    pub text: String,
    pub holds: bool,
    /// The twin was caught.
    pub can_fail: bool,
}

type Check = fn(&Arc<Gpu>) -> Vec<Outcome>;

const CHECKS: &[(&str, Check)] = &[
    ("radius 0 is lambert, to the bit", same_bits::radius_zero),
    ("no profile is lambert, to the bit", same_bits::no_profile),
    ("leaving out changes no bit", spared::left_out),
    ("what suits a device changes no bit", suits::same_bits),
    ("every stage that can be drawn is named", |_| vec![suits::fragments()]),
    ("what scatters nowhere is a plain deferred frame", spared::plain),
    ("another view records nothing again", spared::looks),
    ("shadow maps stay while lights do", spared::still),
    ("a frame run again is a submit", spared::submits),
    ("what memory held changes no bit", same_bits::unwritten),
    ("a mirrored scene gives a mirrored picture", symmetry::mirror),
    ("size does not matter", symmetry::scale),
    ("a rotated scene has the same H", symmetry::rotation),
    ("any size of picture", edges::sizes),
    ("a blur of a constant is that constant", edges::constant),
    ("nothing leaks across a step in depth", edges::leak),
    ("a sphere's exitance is the integral's", energy::sphere),
    ("light is neither made nor lost", energy::conserved),
];

#[test]
fn invariants() {
    let gpu = studio::open();
    let mut wrong = Vec::new();
    for (name, check) in CHECKS {
        let start = std::time::Instant::now();
        let outcomes = check(&gpu);
        println!("{name}: {:.1} s", start.elapsed().as_secs_f64());
        for Outcome { text, holds, can_fail } in outcomes {
            println!("  {text}{}", if holds { "" } else { "   FAILS" });
            if !holds {
                wrong.push(format!("{name}: {text}"));
            }
            if !can_fail {
                wrong.push(format!("{name}: {text}: the twin passes, so this check checks nothing"));
            }
        }
    }
    assert_eq!(wrong, Vec::<String>::new());
    studio::close(gpu);
}
