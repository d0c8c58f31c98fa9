//! The diagram of `docs/bench-states.md` is the machine of the code.

use crate::support::command::repository;
use firmware_core::supervision::write_diagram;

#[test]
fn the_page_has_the_diagram_of_the_code() {
    let page = std::fs::read_to_string(repository().join("docs/bench-states.md")).unwrap();
    let mut diagram = String::new();
    write_diagram(&mut diagram).unwrap();
    let block = format!("```mermaid\n{diagram}```\n");
    assert!(page.contains(&block), "the page needs this diagram:\n{block}");
}
