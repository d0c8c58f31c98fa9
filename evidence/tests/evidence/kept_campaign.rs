//! The cases of the kept campaign were computed before results had an identity: they still merge
//! among themselves, to the same table.

use evidence::campaign::{Campaign, CaseResult, Table, text};
use signal::shards::merge;
use std::path::{Path, PathBuf};

fn kept(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data/identification-campaign").join(name)
}

#[test]
fn the_kept_campaign_merges_to_its_own_table_byte_by_byte() {
    let cases: Vec<CaseResult> = merge(&[kept("cases-1-of-1.jsonl")], None).unwrap();
    assert_eq!(cases.len(), 773);
    let table = Table::new(&cases);
    let read = |name: &str| std::fs::read_to_string(kept(name)).unwrap();
    assert_eq!(serde_json::to_string_pretty(&table).unwrap().trim(), read("table.json").trim());
    assert_eq!(text(&table).trim(), read("table.txt").trim());
}

#[test]
fn the_kept_campaign_is_not_taken_for_one_of_this_program() {
    let identity = Campaign { cases: 773, seed: 2016, brief: false }.identity().unwrap();
    let merged = merge::<CaseResult>(&[kept("cases-1-of-1.jsonl")], Some(&identity));
    let why = merged.unwrap_err().to_string();
    assert!(why.contains("without an identity"), "{why}");
    assert!(why.ends_with("run the shards again"), "{why}");
}
