//! The kept campaign: its 1254 cases give the kept table, and every target has the count of cases
//! that the page states. A folder that is missing is a failure.

use evidence::campaign::{Campaign, CaseResult, Table, text};
use signal::shards::merge;
use std::path::{Path, PathBuf};

fn kept(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data/identification-campaign").join(name)
}

fn read(name: &str) -> String {
    std::fs::read_to_string(kept(name)).unwrap_or_else(|why| panic!("{name}: {why}"))
}

#[test]
fn the_kept_campaign_is_whole_and_gives_its_own_table_byte_by_byte() {
    let cases: Vec<CaseResult> = merge(&[kept("cases.jsonl")], None).unwrap();
    assert_eq!(cases.len(), 1254);
    let indices: Vec<usize> = cases.iter().map(|case| case.index).collect();
    assert_eq!(indices, (0..1254).collect::<Vec<_>>());
    let nothing = cases.iter().filter(|case| case.kind == "nothing").count();
    assert!(nothing >= 300, "{nothing} cases with nothing missing");
    let table = Table::new(&cases);
    assert_eq!(serde_json::to_string_pretty(&table).unwrap().trim(), read("table.json").trim());
    assert_eq!(text(&table).trim(), read("table.txt").trim());
}

#[test]
fn one_program_has_run_all_of_it() {
    // Sources have changed since: its hash is not this program's, and is the same in every case.
    let own = Campaign { cases: 1254, seed: 2016, brief: false }.identity().unwrap();
    let origins: std::collections::BTreeSet<String> = read("cases.jsonl")
        .lines()
        .map(|line| {
            let value: serde_json::Value = serde_json::from_str(line).unwrap();
            value["origin"].to_string()
        })
        .collect();
    assert_eq!(origins.len(), 1, "{origins:?}");
    let merged = merge::<CaseResult>(&[kept("cases.jsonl")], Some(&own));
    if let Err(why) = merged {
        assert!(why.to_string().ends_with("run the shards again"), "{why}");
    }
}
