//! The shape of the source: within a crate, files of different folders do not import each other in a circle.
//!
//! What counts as an import: every path in a `use` or in the code that leads to another file of the crate. Paths through
//! a re-export lead to where the item stands. Tests inside a file do not count.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

#[test]
fn files_of_different_folders_import_each_other_in_no_circle() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut crates = Vec::new();
    find_crates(&root.join("src"), &mut crates);
    assert!(
        crates.len() > 10,
        "the crates are not where they were: {crates:?}"
    );
    let mut wrong = Vec::new();
    for folder in crates {
        let name = folder.strip_prefix(root).unwrap_or(&folder).display().to_string();
        let circles = Crate::read(&folder).circles();
        if !circles.is_empty() {
            wrong.push(format!("{name}: {circles:#?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_circle_is_found_and_a_path_through_a_reexport_is_none() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().expect("below the folder")).expect("a folder");
        std::fs::write(path, text).expect("written");
    };
    write("lib.rs", "mod a;\nmod b;\npub use b::Item;");
    write("a.rs", "use crate::b::Item;\npub struct Own;");
    write("b/mod.rs", "mod item;\nmod user;\npub use item::Item;");
    write("b/item.rs", "//! use crate::a::Own;\npub struct Item;");
    write("b/user.rs", "use crate::a::Own;\nuse crate::Item;");
    assert!(Crate::read(folder.path()).circles().is_empty());
    let in_a_test = "pub struct Item;\n#[cfg(test)]\nmod tests {\n    use crate::a::Own;\n}";
    write("b/item.rs", in_a_test);
    assert!(Crate::read(folder.path()).circles().is_empty());
    for text in [
        "use crate::{a::{self, Own}};\npub struct Item;",
        "pub struct Item(crate::a::Own);",
        "use super::super::a;\npub struct Item(a::Own);",
    ] {
        write("b/item.rs", text);
        let circles = Crate::read(folder.path()).circles();
        assert_eq!(circles, [["a.rs", "b/item.rs"]], "{text}");
    }
}

/// Folders that hold a `lib.rs`.
fn find_crates(folder: &Path, out: &mut Vec<PathBuf>) {
    if folder.join("lib.rs").is_file() {
        out.push(folder.to_owned());
        return;
    }
    let entries = std::fs::read_dir(folder).expect("a folder of the source");
    let mut inner: Vec<PathBuf> = entries.map(|e| e.expect("an entry").path()).collect();
    inner.sort();
    for path in inner.into_iter().filter(|p| p.is_dir()) {
        find_crates(&path, out);
    }
}

/// Names from the root of a crate: `["shell", "app", "SceneloomApp"]`.
type Names = Vec<String>;

/// One file.
struct Module {
    /// From the folder of the crate.
    file: String,
    /// Names that `use` brings in, and where they come from.
    imports: Vec<(String, Names)>,
    /// Paths in the code, as they stand there.
    paths: Vec<Names>,
    /// Paths of `use` that are no re-exports.
    used: Vec<Names>,
}

struct Crate {
    modules: BTreeMap<Names, Module>,
}

impl Crate {
    fn read(folder: &Path) -> Self {
        let mut modules = BTreeMap::new();
        read_module(folder, &folder.join("lib.rs"), Names::new(), &mut modules);
        Self { modules }
    }

    /// The module in which a path ends, re-exports followed.
    fn resolve(&self, path: &[String], depth: usize) -> Names {
        let mut len = path.len();
        while len > 0 && !self.modules.contains_key(&path[..len]) {
            len -= 1;
        }
        let found = path[..len].to_vec();
        let (Some(next), true) = (path.get(len), depth < 8) else {
            return found;
        };
        let module = &self.modules[&found];
        let import = module.imports.iter().find(|(name, _)| name == next);
        match import {
            Some((_, to)) if to[..] != path[..=len] => {
                let whole: Names = to.iter().chain(&path[len + 1..]).cloned().collect();
                self.resolve(&whole, depth + 1)
            }
            _ => found,
        }
    }

    fn targets(&self, of: &Names) -> BTreeSet<Names> {
        let module = &self.modules[of];
        let in_code = module.paths.iter().filter_map(|path| {
            let import = module.imports.iter().find(|(name, _)| *name == path[0]);
            match import {
                Some((_, to)) => Some(to.iter().chain(&path[1..]).cloned().collect()),
                None => absolute(of, path, &self.modules),
            }
        });
        let all = module.used.iter().cloned().chain(in_code);
        let targets = all.map(|path: Names| self.resolve(&path, 0));
        targets.filter(|to| to != of).collect()
    }

    /// The folder that a file belongs to: `a/b.rs` is the head of the folder `a/b` where there is one.
    fn folder_of(&self, file: &str) -> PathBuf {
        let path = Path::new(file);
        let own = path.with_extension("");
        let has_own = self
            .modules
            .values()
            .any(|m| Path::new(&m.file).parent() == Some(&own));
        if has_own {
            own
        } else {
            path.parent().unwrap_or(path).to_owned()
        }
    }

    /// Files that import each other in a circle and do not stand in one folder.
    fn circles(&self) -> Vec<Vec<String>> {
        let edges: BTreeMap<&Names, BTreeSet<Names>> = self
            .modules
            .keys()
            .map(|name| (name, self.targets(name)))
            .collect();
        let reached = |from: &Names| {
            let mut seen = BTreeSet::new();
            let mut open: Vec<&Names> = edges[from].iter().collect();
            while let Some(next) = open.pop() {
                if seen.insert(next.clone()) {
                    open.extend(&edges[next]);
                }
            }
            seen
        };
        let reach: BTreeMap<&Names, BTreeSet<Names>> = edges.keys().map(|n| (*n, reached(n))).collect();
        let mut done = BTreeSet::new();
        let mut out = Vec::new();
        for name in self.modules.keys() {
            let circle: Vec<&Names> = reach[name].iter().filter(|to| reach[to].contains(name)).collect();
            if circle.len() < 2 || !done.insert(circle[0]) {
                continue;
            }
            let mut files: Vec<String> = circle.iter().map(|n| self.modules[*n].file.clone()).collect();
            let folders: BTreeSet<PathBuf> = files.iter().map(|f| self.folder_of(f)).collect();
            if folders.len() > 1 {
                files.sort();
                out.push(files);
            }
        }
        out
    }
}

/// Reads a file and those that it declares.
fn read_module(folder: &Path, file: &Path, name: Names, out: &mut BTreeMap<Names, Module>) {
    let text = std::fs::read_to_string(file).expect("a file of the source");
    let tokens = without_tests(tokens(&text));
    let stem = file.file_stem().and_then(|s| s.to_str()).unwrap_or_default();
    let parent = file.parent().unwrap_or(folder);
    let inner = match stem {
        "lib" | "mod" => parent.to_owned(),
        stem => parent.join(stem),
    };
    let mut module = Module {
        file: file.strip_prefix(folder).unwrap_or(file).display().to_string(),
        imports: Vec::new(),
        paths: Vec::new(),
        used: Vec::new(),
    };
    let (mut uses, mut children) = (Vec::new(), Vec::new());
    let mut i = 0;
    while i < tokens.len() {
        match tokens[i].as_str() {
            "mod" if tokens.get(i + 2).is_some_and(|t| t == ";") => {
                children.push(tokens[i + 1].clone());
                i += 3;
            }
            "use" => {
                let is_public = i > 0 && (tokens[i - 1] == "pub" || tokens[i - 1] == ")");
                let end = tokens[i..]
                    .iter()
                    .position(|t| t == ";")
                    .map_or(tokens.len(), |n| i + n);
                let mut at = i + 1;
                let mut found = Vec::new();
                use_tree(&tokens[..end], &mut at, &Names::new(), &mut found);
                uses.extend(found.into_iter().map(|(n, path)| (n, path, is_public)));
                i = end + 1;
            }
            _ => {
                let mut path = Names::new();
                while tokens.get(i).is_some_and(|t| is_name(t)) {
                    path.push(tokens[i].clone());
                    i += 1;
                    match tokens.get(i).is_some_and(|t| t == "::") {
                        true => i += 1,
                        false => break,
                    }
                }
                match path.len() {
                    0 => i += 1,
                    1 => {}
                    _ => module.paths.push(path),
                }
            }
        }
    }
    for child in &children {
        let paths = [
            inner.join(format!("{child}.rs")),
            inner.join(child).join("mod.rs"),
        ];
        if let Some(path) = paths.iter().find(|p| p.is_file()) {
            let name: Names = name.iter().chain([child]).cloned().collect();
            read_module(folder, path, name, out);
        }
    }
    for (as_name, path, is_public) in uses {
        if let Some(to) = absolute(&name, &path, out) {
            // A module that only hands on what stands below it does not import it.
            if !is_public || children.is_empty() {
                module.used.push(to.clone());
            }
            module.imports.push((as_name, to));
        }
    }
    out.insert(name, module);
}

/// A path from the root of the crate; none if it leads out of it.
fn absolute(of: &Names, path: &Names, known: &BTreeMap<Names, Module>) -> Option<Names> {
    let supers = path.iter().take_while(|n| *n == "super").count();
    let child = || of.iter().chain([&path[0]]).cloned().collect::<Names>();
    Some(match path[0].as_str() {
        "crate" => path[1..].to_vec(),
        "self" => of.iter().chain(&path[1..]).cloned().collect(),
        "super" => {
            let kept = of.len().checked_sub(supers)?;
            of[..kept].iter().chain(&path[supers..]).cloned().collect()
        }
        _ if known.contains_key(&child()) => of.iter().chain(path).cloned().collect(),
        _ => return None,
    })
}

/// The paths of a `use`, each with the name that it brings in.
fn use_tree(tokens: &[String], at: &mut usize, before: &Names, out: &mut Vec<(String, Names)>) {
    let mut path = before.clone();
    while let Some(token) = tokens.get(*at) {
        *at += 1;
        match token.as_str() {
            "::" => {}
            "{" => {
                while tokens.get(*at).is_some_and(|t| t != "}") {
                    use_tree(tokens, at, &path, out);
                }
                *at += 1;
                if tokens.get(*at).is_some_and(|t| t == ",") {
                    *at += 1;
                }
                return;
            }
            "," => break,
            "}" => {
                *at -= 1;
                break;
            }
            "as" => {
                let name = tokens.get(*at).cloned().unwrap_or_default();
                *at += 1;
                out.push((name, path));
                if tokens.get(*at).is_some_and(|t| t == ",") {
                    *at += 1;
                }
                return;
            }
            "self" if !path.is_empty() => {}
            "*" => path.push("*".into()),
            name => path.push(name.into()),
        }
    }
    if path.last().is_some_and(|n| n == "*") {
        path.pop();
        out.push(("*".into(), path));
    } else if let Some(name) = path.last() {
        out.push((name.clone(), path.clone()));
    }
}

fn is_name(token: &str) -> bool {
    let first = token.chars().next();
    first.is_some_and(|c| c.is_alphabetic() || c == '_') && !["use", "mod", "pub", "fn"].contains(&token)
}

/// Names, `::` and single signs; no comments, no texts, no numbers.
fn tokens(text: &str) -> Vec<String> {
    let chars: Vec<char> = text.chars().collect();
    let (mut out, mut i) = (Vec::new(), 0);
    let at = |i: usize| chars.get(i).copied().unwrap_or('\0');
    while i < chars.len() {
        match (chars[i], at(i + 1)) {
            ('/', '/') => {
                i += chars[i..]
                    .iter()
                    .position(|c| *c == '\n')
                    .unwrap_or(chars.len() - i)
            }
            ('r', '"' | '#') if at(i + 1) == '"' || at(i + 2) == '"' => {
                let signs = usize::from(at(i + 1) == '#');
                i += 2 + signs;
                while i < chars.len() && !(chars[i] == '"' && (signs == 0 || at(i + 1) == '#')) {
                    i += 1;
                }
                i += 1 + signs;
            }
            ('"', _) => {
                i += 1;
                while i < chars.len() && chars[i] != '"' {
                    i += if chars[i] == '\\' { 2 } else { 1 };
                }
                i += 1;
            }
            ('\'', '\\') => i += 2 + chars[i + 2..].iter().position(|c| *c == '\'').unwrap_or(0) + 1,
            ('\'', _) if at(i + 2) == '\'' => i += 3,
            (':', ':') => {
                out.push("::".into());
                i += 2;
            }
            (c, _) if c.is_alphanumeric() || c == '_' => {
                let rest = chars[i..].iter();
                let len = rest.take_while(|c| c.is_alphanumeric() || **c == '_').count();
                out.push(chars[i..i + len].iter().collect());
                i += len;
            }
            (c, _) => {
                if !c.is_whitespace() {
                    out.push(c.to_string());
                }
                i += 1;
            }
        }
    }
    out
}

/// The same without what is compiled for tests only.
fn without_tests(tokens: Vec<String>) -> Vec<String> {
    const MARK: [&str; 7] = ["#", "[", "cfg", "(", "test", ")", "]"];
    let mut out = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let rest = &tokens[i..];
        if !(rest.len() > MARK.len() && rest.iter().zip(MARK).all(|(a, b)| a == b)) {
            out.push(tokens[i].clone());
            i += 1;
            continue;
        }
        i += MARK.len();
        let mut depth = 0;
        while i < tokens.len() {
            match tokens[i].as_str() {
                "{" => depth += 1,
                "}" => depth -= 1,
                _ => {}
            }
            let ends = depth == 0 && (tokens[i] == ";" || tokens[i] == "}");
            i += 1;
            if ends {
                break;
            }
        }
    }
    out
}
