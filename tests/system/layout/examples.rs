//! The layout test tested: small trees with one fault each, and one without.

use super::modules::Tree;
use super::{example_crate, violations};

/// A tree of sources: crate, path in `src`, text.
fn tree(crates: &[(&str, &[&str])], sources: &[(&str, &str, &str)]) -> Tree {
    let mut tree = Tree::default();
    tree.crates.extend(crates.iter().map(|(name, uses)| example_crate(name, uses)));
    for (name, within, text) in sources {
        tree.add(name, within, &format!("{name}/src/{within}"), text);
    }
    tree
}

fn found(crates: &[(&str, &[&str])], sources: &[(&str, &str, &str)]) -> String {
    violations(&tree(crates, sources), &[]).join("\n")
}

#[test]
fn an_arrow_up_is_found_in_manifests_and_in_paths() {
    let sources = [
        ("signal", "lib.rs", "fn a() { println!(\"{}\", evidence::campaign::TITLE); }"),
        ("evidence", "lib.rs", "pub mod campaign;\nuse signal::a;"),
        ("evidence", "campaign.rs", "pub const TITLE: &str = \"\";"),
    ];
    let crates: [(&str, &[&str]); 2] = [("signal", &["evidence"]), ("evidence", &["signal"])];
    let said = found(&crates, &sources);
    assert!(said.contains("signal/Cargo.toml: signal depends on evidence"), "{said}");
    assert!(said.contains("signal/src/lib.rs:1: signal uses evidence"), "{said}");
    assert_eq!(said.lines().count(), 2, "{said}");
    let said = found(&[("signal", &["report"]), ("report", &[])], &[]);
    assert_eq!(said, "signal/Cargo.toml: signal depends on report", "one group");
    assert_eq!(found(&[("novel", &[])], &[]), "novel: is in no layer");
}

#[test]
fn a_circle_is_found_through_a_re_export_and_an_inline_path() {
    let said = found(
        &[("files", &[])],
        &[
            ("files", "lib.rs", "mod deep;\nmod a;\nmod b;\npub use deep::Thing as Renamed;"),
            ("files", "deep/mod.rs", "mod inner;\npub use inner::Thing;"),
            ("files", "deep/inner.rs", "pub struct Thing;\nfn f() { crate::b::g::<u8>() }"),
            ("files", "a.rs", "use crate::Renamed;\npub fn h() {}"),
            ("files", "b.rs", "use super::a;\npub fn g<T>() { vec![a::h()]; }"),
        ],
    );
    let expected = "circle of 3 files:
    files/src/a.rs -> files/src/deep/inner.rs (line 1: crate::Renamed)
    files/src/b.rs -> files/src/a.rs (line 2: a::h)
    files/src/deep/inner.rs -> files/src/b.rs (line 2: crate::b::g)";
    assert_eq!(said, expected);
}

#[test]
fn parents_children_tests_comments_and_strings_are_no_circles() {
    let said = found(
        &[("files", &[])],
        &[
            ("files", "lib.rs", "pub mod a;\npub mod b;\npub struct Limit;\nuse a::A;"),
            ("files", "a.rs", "use crate::Limit;\nuse crate::b::B;\npub struct A;"),
            (
                "files",
                "b.rs",
                "//! crate::a::A\npub struct B;\nconst S: &str = \"crate::a::A\";\n\
                 #[cfg(test)]\nmod tests { use crate::a::A; }\n\
                 #[cfg(test)]\nuse crate::a::A;\n#[cfg(test)]\nmod more;\n\
                 #[cfg(test)]\n#[path = \"b_tests.rs\"]\nmod tests;\n\
                 fn f(x: &'static B) -> impl Sized + use<'_> { x }",
            ),
            ("files", "b/more.rs", "use crate::a::A;"),
            ("files", "b_tests.rs", "use super::*;\nuse crate::a::A;"),
        ],
    );
    assert_eq!(said, "");
}

#[test]
fn imports_of_everything_are_refused_and_benign_circles_must_exist() {
    let sources = [
        ("files", "lib.rs", "mod a;\nmod b;"),
        ("files", "a.rs", "use crate::b::B;\npub struct A;"),
        ("files", "b.rs", "use crate::a::*;\npub struct B(crate::a::A);"),
    ];
    let tree = tree(&[("files", &[])], &sources);
    let circle: &[&str] = &["files/src/a.rs", "files/src/b.rs"];
    let said = violations(&tree, &[(circle, "an example")]).join("\n");
    assert_eq!(said, "files/src/b.rs:1: crate::a::*, expected the names that are used");
    let said = violations(&tree, &[(circle, "an example"), (&["c", "d"], "gone")]).join("\n");
    assert!(said.contains("c, d: no circle any more"), "{said}");
}
