//! The sources of the workspace as modules: what each of them defines, imports and names.
//!
//! Sources are read as tokens, so that paths inside macros count and comments and strings do not.

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A module by its names from the crate's own on, such as `["files", "folder"]`.
pub(super) type ModulePath = Vec<String>;

/// The workspace.
#[derive(Debug, Default)]
pub(super) struct Tree {
    /// By the name in the manifest.
    pub(super) crates: BTreeMap<String, Crate>,
    pub(super) modules: BTreeMap<ModulePath, Module>,
    /// Modules that are compiled for tests only.
    tests: BTreeSet<ModulePath>,
}

/// What a manifest says.
#[derive(Debug)]
pub(super) struct Crate {
    pub(super) manifest: String,
    pub(super) dependencies: Vec<String>,
    pub(super) dev_dependencies: Vec<String>,
}

/// A module; an inline one shares its file with others.
#[derive(Debug, Default)]
pub(super) struct Module {
    pub(super) file: String,
    /// Items that it defines.
    pub(super) items: BTreeSet<String>,
    /// What its names stand for: `use a::b as c` is `c` for `a::b`.
    pub(super) imports: BTreeMap<String, Vec<String>>,
    /// Modules of which it imports everything.
    pub(super) globs: Vec<Reference>,
    /// Every other path in it.
    pub(super) references: Vec<Reference>,
}

/// A path in a source.
#[derive(Debug, Clone)]
pub(super) struct Reference {
    pub(super) path: Vec<String>,
    pub(super) line: usize,
}

/// Keywords before the name of an item.
const ITEMS: [&str; 9] =
    ["struct", "enum", "union", "trait", "type", "fn", "const", "static", "macro_rules"];

impl Tree {
    /// Reads every crate below the root that has a manifest and a `src` folder.
    pub(super) fn read(root: &Path) -> Self {
        let mut tree = Self::default();
        let entries = std::fs::read_dir(root).unwrap().map(|entry| entry.unwrap().path());
        let folders = entries.filter(|path| path.join("Cargo.toml").is_file());
        for folder in folders.chain([root.to_owned()]) {
            let text = std::fs::read_to_string(folder.join("Cargo.toml")).unwrap();
            let manifest: toml::Table = text.parse().unwrap();
            let name = manifest["package"]["name"].as_str().unwrap().to_owned();
            let names = |key: &str| -> Vec<String> {
                let table = manifest.get(key).and_then(toml::Value::as_table);
                table.into_iter().flat_map(toml::Table::keys).cloned().collect()
            };
            let shown = |path: &Path| path.strip_prefix(root).unwrap().display().to_string();
            let about = Crate {
                manifest: shown(&folder.join("Cargo.toml")),
                dependencies: [names("dependencies"), names("build-dependencies")].concat(),
                dev_dependencies: names("dev-dependencies"),
            };
            tree.crates.insert(name.clone(), about);
            let source = folder.join("src");
            for path in rust_files(&source) {
                let text = std::fs::read_to_string(&path).unwrap();
                let within = path.strip_prefix(&source).unwrap().display().to_string();
                tree.add(&name, &within, &shown(&path), &text);
            }
        }
        tree
    }

    /// Adds a source file: crate, path in `src`, name in messages, text.
    pub(super) fn add(&mut self, name: &str, within: &str, shown: &str, text: &str) {
        let mut module = vec![identifier(name)];
        let parts = within.trim_end_matches(".rs").split('/');
        module.extend(parts.filter(|part| !["lib", "main", "mod"].contains(part)).map(identifier));
        let tokens = text.parse().unwrap_or_else(|why| panic!("{shown}: {why}"));
        self.read_module(module, shown, tokens);
    }

    /// True for code that is compiled for tests only.
    pub(super) fn is_test(&self, module: &[String]) -> bool {
        (1..=module.len()).any(|length| self.tests.contains(&module[..length]))
    }

    fn read_module(&mut self, path: ModulePath, file: &str, tokens: TokenStream) {
        let read = Module { file: file.to_owned(), ..Module::default() };
        let mut reader = Reader { module: read, inline: Vec::new(), tests: Vec::new() };
        if !is_test_file(&tokens) {
            reader.read(tokens, true);
        }
        let below = |name: String| [path.as_slice(), &[name]].concat();
        for test in reader.tests {
            self.tests.insert(match test.as_slice() {
                [up, name] if up == "super" => {
                    [&path[..path.len() - 1], std::slice::from_ref(name)].concat()
                }
                _ => [path.as_slice(), &test].concat(),
            });
        }
        for (name, tokens) in reader.inline {
            self.read_module(below(name), file, tokens);
        }
        self.modules.insert(path, reader.module);
    }
}

/// Reads the tokens of one module.
struct Reader {
    module: Module,
    inline: Vec<(String, TokenStream)>,
    /// Modules that are compiled for tests only, from this one on.
    tests: Vec<Vec<String>>,
}

impl Reader {
    /// Reads tokens; only `at_module_level` they define items of the module.
    fn read(&mut self, tokens: TokenStream, at_module_level: bool) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let mut at = 0;
        while at < tokens.len() {
            at = match &tokens[at] {
                TokenTree::Punct(punct) if punct.as_char() == '#' => self.attribute(&tokens, at),
                TokenTree::Group(group) => {
                    // A macro at module level may define items: its tokens are read as if they did.
                    let is_macro = at >= 2
                        && group.delimiter() == Delimiter::Brace
                        && is_punct(&tokens[at - 1], '!');
                    self.read(group.stream(), at_module_level && is_macro);
                    at + 1
                }
                TokenTree::Ident(ident) => {
                    let after_mark =
                        at > 0 && ['\'', '.'].iter().any(|mark| is_punct(&tokens[at - 1], *mark));
                    match ident.to_string().as_str() {
                        _ if after_mark => at + 1,
                        "use" => self.import(&tokens, at + 1),
                        "mod" => self.module_below(&tokens, at),
                        word if at_module_level && ITEMS.contains(&word) => {
                            let name = tokens[at + 1..].iter().find(|token| !is_punct(token, '!'));
                            if let Some(TokenTree::Ident(name)) = name {
                                self.module.items.insert(name.to_string());
                            }
                            at + 1
                        }
                        _ => self.path(&tokens, at),
                    }
                }
                _ => at + 1,
            };
        }
    }

    /// An attribute; with `cfg(test)` the item behind it is skipped.
    fn attribute(&mut self, tokens: &[TokenTree], at: usize) -> usize {
        let Some(TokenTree::Group(group)) = tokens.get(at + 1) else { return at + 1 };
        if !is_cfg_test(&group.stream()) {
            self.read(group.stream(), false);
            return at + 2;
        }
        let mut end = at + 2;
        while let Some(token) = tokens.get(end) {
            if is_ident(token, "mod")
                && let Some(TokenTree::Ident(name)) = tokens.get(end + 1)
            {
                self.tests.push(vec![name.to_string()]);
            }
            if let TokenTree::Group(group) = token
                && let Some(file) = path_attribute(&group.stream())
            {
                self.tests.push(vec!["super".to_owned(), file]);
            }
            end += 1;
            let is_body =
                matches!(token, TokenTree::Group(group) if group.delimiter() == Delimiter::Brace);
            if is_body || is_punct(token, ';') {
                break;
            }
        }
        end
    }

    /// `mod name;` or `mod name { ... }`.
    fn module_below(&mut self, tokens: &[TokenTree], at: usize) -> usize {
        match (tokens.get(at + 1), tokens.get(at + 2)) {
            (Some(TokenTree::Ident(name)), Some(TokenTree::Group(body)))
                if body.delimiter() == Delimiter::Brace =>
            {
                self.inline.push((name.to_string(), body.stream()));
                at + 3
            }
            _ => at + 2,
        }
    }

    /// `use ...;`
    fn import(&mut self, tokens: &[TokenTree], at: usize) -> usize {
        let length = tokens[at..].iter().take_while(|token| !is_punct(token, ';')).count();
        // `use<'a>` in a type is no import.
        if !tokens.get(at).is_some_and(|token| is_punct(token, '<')) {
            self.use_tree(&tokens[at..at + length], &[]);
        }
        at + length
    }

    fn use_tree(&mut self, tokens: &[TokenTree], before: &[String]) {
        let mut path = before.to_vec();
        let mut alias = None;
        let mut line = 0;
        for (at, token) in tokens.iter().enumerate() {
            match token {
                TokenTree::Ident(word) if *word == "as" => {
                    alias = tokens.get(at + 1).map(ToString::to_string);
                    break;
                }
                TokenTree::Ident(word) => {
                    line = word.span().start().line;
                    let is_self = *word == "self" && !path.is_empty();
                    path.extend((!is_self).then(|| word.to_string()));
                }
                TokenTree::Punct(star) if star.as_char() == '*' => {
                    let line = star.span().start().line;
                    self.module.globs.push(Reference { path, line });
                    return;
                }
                TokenTree::Group(group) => {
                    let inner: Vec<TokenTree> = group.stream().into_iter().collect();
                    for part in inner.split(|token| is_punct(token, ',')) {
                        self.use_tree(part, &path);
                    }
                    return;
                }
                _ => {}
            }
        }
        if let Some(last) = path.last() {
            let name = alias.unwrap_or_else(|| last.clone());
            self.module.imports.entry(name).or_insert_with(|| path.clone());
            self.module.references.push(Reference { path, line });
        }
    }

    /// `a::b::c`, of which the first may be `crate`, `self` or `super`.
    fn path(&mut self, tokens: &[TokenTree], start: usize) -> usize {
        let goes_on = start >= 2 && is_separator(tokens, start - 2);
        let mut path = vec![tokens[start].to_string()];
        let mut at = start + 1;
        while is_separator(tokens, at)
            && let Some(TokenTree::Ident(word)) = tokens.get(at + 2)
        {
            path.push(word.to_string());
            at += 3;
        }
        if path.len() > 1 && !goes_on {
            let line = tokens[start].span().start().line;
            self.module.references.push(Reference { path, line });
        }
        at
    }
}

/// True for `#![cfg(test)]`.
fn is_test_file(tokens: &TokenStream) -> bool {
    let tokens: Vec<TokenTree> = tokens.clone().into_iter().collect();
    tokens.windows(3).any(|three| {
        let inner = is_punct(&three[0], '#') && is_punct(&three[1], '!');
        inner && matches!(&three[2], TokenTree::Group(group) if is_cfg_test(&group.stream()))
    })
}

/// True for `cfg(test)`, `cfg(any(test, ...))` and the like, but not for `cfg(not(test))`.
fn is_cfg_test(attribute: &TokenStream) -> bool {
    fn names_test(tokens: TokenStream) -> bool {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        tokens.iter().enumerate().any(|(at, token)| match token {
            TokenTree::Ident(word) => *word == "test",
            TokenTree::Group(group) => {
                let negated = at > 0 && is_ident(&tokens[at - 1], "not");
                !negated && names_test(group.stream())
            }
            _ => false,
        })
    }
    let mut tokens = attribute.clone().into_iter();
    let is_cfg = tokens.next().is_some_and(|word| is_ident(&word, "cfg"));
    is_cfg && names_test(tokens.collect())
}

/// The module in the same folder that `path = "name.rs"` names.
fn path_attribute(attribute: &TokenStream) -> Option<String> {
    let mut tokens = attribute.clone().into_iter();
    let is_path = tokens.next().is_some_and(|word| is_ident(&word, "path"));
    let name = is_path.then(|| tokens.last())??.to_string();
    Some(name.trim_matches('"').strip_suffix(".rs")?.to_owned())
}

fn is_separator(tokens: &[TokenTree], at: usize) -> bool {
    let colon = |at: usize| tokens.get(at).is_some_and(|token| is_punct(token, ':'));
    colon(at) && colon(at + 1)
}

fn is_punct(token: &TokenTree, mark: char) -> bool {
    matches!(token, TokenTree::Punct(punct) if punct.as_char() == mark)
}

fn is_ident(token: &TokenTree, word: &str) -> bool {
    matches!(token, TokenTree::Ident(ident) if ident == word)
}

/// A crate's or a file's name as paths spell it.
pub(super) fn identifier(name: &str) -> String {
    name.replace('-', "_")
}

/// The Rust files of a folder and those below it.
fn rust_files(folder: &Path) -> Vec<std::path::PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            files.push(path);
        }
    }
    files.sort();
    files
}
