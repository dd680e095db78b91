//! The modules of a crate as the compiler sees them, with its tests or without: what each declares, imports and names.

use crate::items::{attributes, declared_name, given_path, is_for_tests};
use crate::sources::Sources;
use proc_macro2::{TokenStream, TokenTree};
use std::collections::HashMap;
use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{Attribute, Item, Meta, UseTree, Visibility};

/// What a name in a module stands for.
pub enum Definition {
    /// A module, by number.
    Module(usize),
    /// Anything else that is declared there.
    Item,
    /// What a path refers to.
    Import(Vec<String>),
}

/// How a path is written.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// In a `use` that only this module sees.
    Use,
    /// In a `use` that others see: a re-export.
    Reexport,
    /// In code.
    Inline,
}

/// A path as a module names it.
pub struct Named {
    pub path: Vec<String>,
    pub line: usize,
    pub place: Place,
}

/// A module, inline or in a file.
pub struct Module {
    /// Names from the crate's root to here.
    pub name: Vec<String>,
    pub file: String,
    pub parent: usize,
    pub scope: HashMap<String, Vec<Definition>>,
    pub globs: Vec<Vec<String>>,
    pub named: Vec<Named>,
}

/// All modules; the first is the crate's root.
pub struct ModuleTree {
    pub modules: Vec<Module>,
    has_tests: bool,
}

impl ModuleTree {
    /// Parses the modules reached from `lib.rs`, tests apart.
    ///
    /// # Panics
    /// If a file is missing or no Rust.
    pub fn of(sources: &Sources) -> Self {
        Self::read(sources, false)
    }

    /// As [`Self::of`], tests included.
    pub fn with_tests(sources: &Sources) -> Self {
        Self::read(sources, true)
    }

    fn read(sources: &Sources, has_tests: bool) -> Self {
        let mut tree = Self { modules: Vec::new(), has_tests };
        tree.add_file(sources, "lib.rs", Vec::new(), 0);
        tree
    }

    fn skips(&self, attributes: &[Attribute]) -> bool {
        !self.has_tests && attributes.iter().any(is_for_tests)
    }

    fn add(&mut self, file: &str, name: Vec<String>, parent: usize) -> usize {
        let (scope, globs, named) = (HashMap::new(), Vec::new(), Vec::new());
        self.modules.push(Module { name, file: file.to_owned(), parent, scope, globs, named });
        self.modules.len() - 1
    }

    fn add_file(&mut self, sources: &Sources, file: &str, name: Vec<String>, parent: usize) -> usize {
        let text = sources.0.get(file).unwrap_or_else(|| panic!("no file {file}"));
        let parsed = syn::parse_file(text).unwrap_or_else(|error| panic!("{file}: {error}"));
        let module = self.add(file, name, parent);
        let (folder, stem) = file.strip_suffix(".rs").unwrap().rsplit_once('/').unwrap_or(("", file));
        let below = match stem {
            "mod" | "lib.rs" => folder.to_owned(),
            stem => format!("{folder}/{stem}"),
        };
        self.add_items(sources, &parsed.items, module, folder, &below);
        module
    }

    /// Adds the items of a module whose files lie in `below`, and those given by `#[path]` in `folder`.
    fn add_items(&mut self, sources: &Sources, items: &[Item], module: usize, folder: &str, below: &str) {
        for item in items {
            if self.skips(attributes(item)) {
                continue;
            }
            if let Item::Mod(declared) = item {
                let ident = declared.ident.to_string();
                let mut name = self.modules[module].name.clone();
                name.push(ident.clone());
                let path = |rest: String| format!("{below}/{rest}").trim_start_matches('/').to_owned();
                let child = if let Some((_, items)) = &declared.content {
                    // Nobody imports the tests of a file: they are one of their own.
                    let is_for_tests = declared.attrs.iter().any(is_for_tests);
                    let tests = if is_for_tests { " (tests)" } else { "" };
                    let file = format!("{}{tests}", self.modules[module].file);
                    let child = self.add(&file, name, module);
                    self.add_items(sources, items, child, folder, &path(ident.clone()));
                    child
                } else {
                    let given = declared.attrs.iter().find_map(|attribute| given_path(attribute, folder));
                    let alone = path(format!("{ident}.rs"));
                    let is_alone = sources.0.contains_key(&alone);
                    let usual = if is_alone { alone } else { path(format!("{ident}/mod.rs")) };
                    self.add_file(sources, &given.unwrap_or(usual), name, module)
                };
                self.declare(module, ident, Definition::Module(child));
                continue;
            }
            if let Some(ident) = declared_name(item) {
                self.declare(module, ident, Definition::Item);
            }
            Collector { tree: self, module }.visit_item(item);
        }
    }

    fn declare(&mut self, module: usize, name: String, definition: Definition) {
        self.modules[module].scope.entry(name).or_default().push(definition);
    }
}

/// Gathers what a module imports and names.
struct Collector<'a> {
    tree: &'a mut ModuleTree,
    module: usize,
}

impl Collector<'_> {
    fn name(&mut self, path: Vec<String>, line: usize, place: Place) {
        self.tree.modules[self.module].named.push(Named { path, line, place });
    }

    fn import(&mut self, tree: &UseTree, mut prefix: Vec<String>, place: Place) {
        let line = tree.span().start().line;
        let (name, alias) = match tree {
            UseTree::Path(path) => {
                prefix.push(path.ident.to_string());
                return self.import(&path.tree, prefix, place);
            }
            UseTree::Group(group) => {
                return group.items.iter().for_each(|tree| self.import(tree, prefix.clone(), place));
            }
            UseTree::Glob(_) => {
                self.tree.modules[self.module].globs.push(prefix.clone());
                return self.name(prefix, line, place);
            }
            UseTree::Name(name) => (name.ident.to_string(), name.ident.to_string()),
            UseTree::Rename(rename) => (rename.ident.to_string(), rename.rename.to_string()),
        };
        let alias = if alias == "self" { prefix.last().cloned().unwrap_or(alias) } else { alias };
        if name != "self" {
            prefix.push(name);
        }
        self.tree.declare(self.module, alias, Definition::Import(prefix.clone()));
        self.name(prefix, line, place);
    }

    /// Paths among the tokens of a macro, which need not be Rust.
    fn scan(&mut self, tokens: TokenStream) {
        let (mut path, mut line, mut colons) = (Vec::new(), 0, 0);
        for token in tokens {
            match token {
                TokenTree::Ident(ident) => {
                    if colons != 2 {
                        self.end(&mut path, line);
                        line = ident.span().start().line;
                    }
                    path.push(ident.to_string());
                    colons = 0;
                }
                TokenTree::Punct(punct) if punct.as_char() == ':' && !path.is_empty() => colons += 1,
                other => {
                    self.end(&mut path, line);
                    colons = 0;
                    if let TokenTree::Group(group) = other {
                        self.scan(group.stream());
                    }
                }
            }
        }
        self.end(&mut path, line);
    }

    fn end(&mut self, path: &mut Vec<String>, line: usize) {
        let path = std::mem::take(path);
        if !path.is_empty() {
            self.name(path, line, Place::Inline);
        }
    }
}

impl<'ast> Visit<'ast> for Collector<'_> {
    // Visibility is no use of a module.
    fn visit_visibility(&mut self, _: &'ast Visibility) {}

    // Documentation may link anywhere; other attributes name functions, also in strings.
    fn visit_attribute(&mut self, attribute: &'ast Attribute) {
        let Meta::List(list) = &attribute.meta else { return };
        self.scan(list.tokens.clone());
        for token in list.tokens.clone() {
            if let TokenTree::Literal(literal) = token
                && let Ok(text) = syn::parse_str::<syn::LitStr>(&literal.to_string())
                && let Ok(path) = text.parse::<syn::Path>()
            {
                self.visit_path(&path);
            }
        }
    }

    fn visit_item(&mut self, item: &'ast Item) {
        if !self.tree.skips(attributes(item)) {
            visit::visit_item(self, item);
        }
    }

    fn visit_impl_item_fn(&mut self, item: &'ast syn::ImplItemFn) {
        if !self.tree.skips(&item.attrs) {
            visit::visit_impl_item_fn(self, item);
        }
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        if item.leading_colon.is_none() {
            let is_private = matches!(item.vis, Visibility::Inherited);
            let place = if is_private { Place::Use } else { Place::Reexport };
            self.import(&item.tree, Vec::new(), place);
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        if path.leading_colon.is_none() {
            let names = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
            self.name(names, path.span().start().line, Place::Inline);
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &'ast syn::Macro) {
        self.scan(call.tokens.clone());
    }
}
