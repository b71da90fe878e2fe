//! Files form no import cycle larger than a parent and its child; neither do sibling folders.

use proc_macro2::{TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use syn::{Attribute, Item, UseTree, Visibility};

/// Place of a file in its crate: `["offset", "batch"]`; none: `lib.rs`.
type Place = Vec<String>;

/// A name that a file imports: from where, as what.
struct Import {
    path: Place,
    name: String,
    is_public: bool,
}

/// Content of a file.
#[derive(Default)]
struct File {
    /// Names of its items.
    items: BTreeSet<String>,
    imports: Vec<Import>,
    /// Paths of its code outside imports.
    paths: Vec<Place>,
}

/// All files of a crate.
struct Crate(BTreeMap<Place, File>);

/// `#[cfg(test)]`, or that and more.
fn is_of_tests(attributes: &[Attribute]) -> bool {
    let words = |a: &Attribute| match &a.meta {
        syn::Meta::List(list) if list.path.is_ident("cfg") => {
            let mut words = Place::new();
            words_of(list.tokens.clone(), &mut words);
            words
        }
        _ => Vec::new(),
    };
    let mut all = attributes.iter().map(words);
    all.any(|words| words.iter().any(|w| w == "test") && !words.iter().any(|w| w == "not"))
}

fn words_of(tokens: TokenStream, into: &mut Vec<String>) {
    for token in tokens {
        match token {
            TokenTree::Ident(word) => into.push(word.to_string()),
            TokenTree::Group(group) => words_of(group.stream(), into),
            _ => {}
        }
    }
}

/// Name and attributes of an item that others may import.
fn named(item: &Item) -> (Option<String>, &[Attribute]) {
    match item {
        Item::Const(i) => (Some(i.ident.to_string()), &i.attrs),
        Item::Enum(i) => (Some(i.ident.to_string()), &i.attrs),
        Item::Fn(i) => (Some(i.sig.ident.to_string()), &i.attrs),
        Item::Macro(i) => (i.ident.as_ref().map(ToString::to_string), &i.attrs),
        Item::Static(i) => (Some(i.ident.to_string()), &i.attrs),
        Item::Struct(i) => (Some(i.ident.to_string()), &i.attrs),
        Item::Trait(i) => (Some(i.ident.to_string()), &i.attrs),
        Item::Type(i) => (Some(i.ident.to_string()), &i.attrs),
        Item::Impl(i) => (None, &i.attrs),
        Item::Mod(i) => (None, &i.attrs),
        Item::Use(i) => (None, &i.attrs),
        _ => (None, &[]),
    }
}

fn imports_of(tree: &UseTree, before: &[String], is_public: bool, into: &mut Vec<Import>) {
    let longer = |word: &syn::Ident| [before, &[word.to_string()]].concat();
    let mut import = |path: Place, name: String| {
        into.push(Import {
            path,
            name,
            is_public,
        });
    };
    match tree {
        UseTree::Path(path) => imports_of(&path.tree, &longer(&path.ident), is_public, into),
        UseTree::Group(group) => {
            for tree in &group.items {
                imports_of(tree, before, is_public, into);
            }
        }
        UseTree::Name(name) if name.ident == "self" => {
            import(before.to_vec(), before.last().cloned().unwrap_or_default());
        }
        UseTree::Name(name) => import(longer(&name.ident), name.ident.to_string()),
        UseTree::Rename(to) => import(longer(&to.ident), to.rename.to_string()),
        UseTree::Glob(_) => import(before.to_vec(), "*".into()),
    }
}

/// All `a::b::c` of some code, macros' arguments among it.
fn paths_of(tokens: TokenStream, into: &mut Vec<Place>) {
    let mut path = Place::new();
    let mut colons = 0;
    for token in tokens {
        match token {
            TokenTree::Punct(p) if p.as_char() == ':' && !path.is_empty() => {
                colons += 1;
                continue;
            }
            TokenTree::Ident(word) if colons == 2 => path.push(word.to_string()),
            other => {
                into.extend((path.len() > 1).then(|| std::mem::take(&mut path)));
                path.clear();
                match other {
                    TokenTree::Ident(word) => path.push(word.to_string()),
                    TokenTree::Group(group) => paths_of(group.stream(), into),
                    _ => {}
                }
            }
        }
        colons = 0;
    }
    into.extend((path.len() > 1).then_some(path));
}

impl File {
    fn take(&mut self, items: &[Item]) {
        for item in items {
            let (name, attributes) = named(item);
            if is_of_tests(attributes) {
                continue;
            }
            self.items.extend(name);
            match item {
                Item::Use(of) => {
                    let is_public = !matches!(of.vis, Visibility::Inherited);
                    imports_of(&of.tree, &[], is_public, &mut self.imports);
                }
                Item::Mod(of) => {
                    if let Some((_, items)) = &of.content {
                        self.take(items);
                    }
                }
                other => paths_of(quote::ToTokens::to_token_stream(other), &mut self.paths),
            }
        }
    }
}

impl Crate {
    fn read(sources: &Path) -> Self {
        let mut files = BTreeMap::new();
        let mut folders = vec![sources.to_path_buf()];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path);
                } else if path.extension().is_some_and(|e| e == "rs") {
                    let place = place_of(path.strip_prefix(sources).unwrap());
                    let text = std::fs::read_to_string(&path).unwrap();
                    let parsed = syn::parse_file(&text);
                    let parsed = parsed.unwrap_or_else(|e| panic!("{}: {e}", path.display()));
                    let file: &mut File = files.entry(place).or_default();
                    file.take(&parsed.items);
                }
            }
        }
        files.retain(|place, _| !place.iter().any(|word| word == "tests"));
        Self(files)
    }

    /// Returns the start of a path and its remainder; `None` if it leaves the crate.
    fn start(&self, from: &Place, path: &[String]) -> Option<(Place, Place)> {
        let ups = path.iter().take_while(|word| *word == "super").count();
        match path.first()?.as_str() {
            "crate" => Some((Vec::new(), path[1..].to_vec())),
            "self" => Some((from.clone(), path[1..].to_vec())),
            "super" => {
                let kept = from.len().saturating_sub(ups);
                Some((from[..kept].to_vec(), path[ups..].to_vec()))
            }
            word => {
                let child = [from.as_slice(), &[word.to_owned()]].concat();
                let is_there = self.0.contains_key(&child);
                is_there.then(|| (from.clone(), path.to_vec()))
            }
        }
    }

    /// Returns the file that defines the target of a path, following re-exports.
    fn file_of(&self, from: &Place, path: &[String], depth: usize) -> Option<Place> {
        const DEEPEST: usize = 12;
        let (mut at, rest) = self.start(from, path)?;
        for (k, word) in rest.iter().enumerate() {
            let child = [at.as_slice(), std::slice::from_ref(word)].concat();
            if self.0.contains_key(&child) {
                at = child;
                continue;
            }
            let file = self.0.get(&at)?;
            if file.items.contains(word) || depth > DEEPEST {
                return Some(at);
            }
            for import in &file.imports {
                let found = if import.name == *word {
                    let whole = [import.path.as_slice(), &rest[k + 1..]].concat();
                    self.file_of(&at, &whole, depth + 1)
                } else if import.name == "*" {
                    let there = self.file_of(&at, &import.path, depth + 1);
                    there.filter(|there| self.0[there].items.contains(word))
                } else {
                    None
                };
                if found.is_some() {
                    return found;
                }
            }
            return Some(at);
        }
        Some(at)
    }

    /// Returns the dependencies between files; a re-export of a child's item is no dependency.
    fn needs(&self) -> BTreeSet<(Place, Place)> {
        let mut all = BTreeSet::new();
        for (place, file) in &self.0 {
            let imports = file.imports.iter();
            let imported = imports.filter_map(|import| {
                let to = self.file_of(place, &import.path, 0)?;
                (!(import.is_public && to.starts_with(place))).then_some(to)
            });
            let written = file.paths.iter().filter_map(|path| {
                let own = file.imports.iter().find(|i| i.name == path[0]);
                let whole = own.map(|i| [i.path.as_slice(), &path[1..]].concat());
                self.file_of(place, whole.as_ref().unwrap_or(path), 0)
            });
            let others = imported.chain(written).filter(|to| to != place);
            all.extend(others.map(|to| (place.clone(), to)));
        }
        all
    }

    /// Returns all cycles among the entries of a folder, where a folder and its files count as one.
    fn circles(&self) -> Vec<String> {
        let needs = self.needs();
        let folders: BTreeSet<&[String]> = (self.0.keys())
            .flat_map(|place| (0..place.len()).map(|n| &place[..n]))
            .collect();
        let mut found = Vec::new();
        for folder in folders {
            let depth = folder.len();
            let inside = |place: &Place| place.len() > depth && place.starts_with(folder);
            let between: BTreeSet<(&str, &str)> = (needs.iter())
                .filter(|(a, b)| inside(a) && inside(b))
                .map(|(a, b)| (a[depth].as_str(), b[depth].as_str()))
                .filter(|(a, b)| a != b)
                .collect();
            let circle = in_circles(&between);
            if !circle.is_empty() {
                found.push(format!("{}: {}", folder.join("/"), circle.join(", ")));
            }
        }
        found
    }
}

/// Removes entries without dependencies or dependents repeatedly, and returns the rest.
fn in_circles(needs: &BTreeSet<(&str, &str)>) -> Vec<String> {
    let mut left = needs.clone();
    loop {
        let from: BTreeSet<&str> = left.iter().map(|(a, _)| *a).collect();
        let to: BTreeSet<&str> = left.iter().map(|(_, b)| *b).collect();
        let before = left.len();
        left.retain(|(a, b)| to.contains(a) && from.contains(b));
        if left.len() == before {
            let told = left.iter().map(|(a, b)| format!("{a} needs {b}"));
            return told.collect();
        }
    }
}

/// `offset/batch/mod.rs` and `offset/batch.rs` are `["offset", "batch"]`.
fn place_of(relative: &Path) -> Place {
    let words = relative.with_extension("");
    let mut place: Place = (words.iter())
        .map(|word| word.to_str().unwrap().to_owned())
        .collect();
    let last = place.last().map(String::as_str);
    if matches!(last, Some("mod")) || place.len() == 1 && matches!(last, Some("lib" | "main")) {
        place.pop();
    }
    place
}

/// Source folders of all crates, those with lock files of their own too.
fn sources() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut folders = vec![root.join("fleet")];
    for rooms in ["crates", "bindings"] {
        let entries = std::fs::read_dir(root.join(rooms)).unwrap();
        folders.extend(entries.map(|entry| entry.unwrap().path()));
    }
    let sources = folders.into_iter().map(|folder| folder.join("src"));
    sources.filter(|folder| folder.is_dir()).collect()
}

#[test]
fn modules_have_no_import_cycles() {
    let mut found = Vec::new();
    let mut files = 0;
    for folder in sources() {
        let of = Crate::read(&folder);
        files += of.0.len();
        let circles = of.circles();
        found.extend(circles.iter().map(|c| format!("{}/{c}", folder.display())));
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
    assert!(files > 500, "{files} files read");
}

#[test]
fn import_cycle_through_reexport_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("lib.rs", "mod a; mod b; mod c; pub use a::A;");
    write("a.rs", "use super::b::B; pub struct A(B);");
    write("b.rs", "pub struct B; fn of() { vec![crate::A::new()]; }");
    write("c.rs", "use crate::A; use crate::b::B;");
    let found = Crate::read(folder.path()).circles();
    assert_eq!(found, [": a needs b, b needs a"]);
    write(
        "b.rs",
        "pub struct B; #[cfg(all(test, unix))] mod tests { use super::super::a::A; }",
    );
    assert_eq!(Crate::read(folder.path()).circles(), Vec::<String>::new());
}
