//! Twelve brief cases of one seed: every motion twice, every noise, and every kind of truth.

use evidence::campaign::{Campaign, CaseResult, is_right};
use std::sync::atomic::AtomicBool;

const CAMPAIGN: Campaign = Campaign { cases: 1254, seed: 1, brief: true };
static NEVER: AtomicBool = AtomicBool::new(false);

fn case(index: usize) -> CaseResult {
    let case = CAMPAIGN.case(index, &NEVER).unwrap();
    println!("{case:?}");
    case
}

#[test]
fn p() {
    for index in [49, 108, 96, 104, 54, 1, 64, 81, 24, 84, 33, 93] {
        let c = case(index);
        println!(
            "== {index} {} {} {} {:?} {} {:?} right {} verdict {} named {:?} unexplained {:?} reached {} {:.0} {:.0} {:.0}",
            c.kind,
            c.motion,
            c.noise,
            c.truth,
            c.size,
            c.sizes,
            is_right(&c),
            c.verdict,
            c.named.iter().map(|n| (&n.name, &n.alternatives)).collect::<Vec<_>>(),
            c.unexplained,
            c.reached,
            c.sizing_seconds,
            c.seconds,
            c.next_test_seconds
        );
    }
}
