//! Where paths lead: the order of modules, and circles among files.

use crate::module_tree::{Definition, Module, ModuleTree, Named, Place};
use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// What a path ends at.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Target {
    Module(usize),
    /// An item of the module.
    Item(usize),
}

impl ModuleTree {
    /// Names that lead from a module to one after it in `order`, and modules that are not in it. A module has the
    /// place of the longest entry that it is or is inside of; modules that hold entries have none, and only
    /// re-export.
    pub fn upward_imports(&self, order: &[&str]) -> Vec<String> {
        let mut found = BTreeSet::new();
        for (from, module) in self.modules.iter().enumerate() {
            let Some(own) = place(module, order) else {
                if first_inside(module, order).is_none() {
                    found.insert(format!("{}: not in the order of modules", module.file));
                    continue;
                }
                let is_item = |definition: &Definition| matches!(definition, Definition::Item);
                for (name, _) in
                    module.scope.iter().filter(|(_, definitions)| definitions.iter().any(is_item))
                {
                    found.insert(format!("{}: `{name}` belongs into a module of the order", module.file));
                }
                continue;
            };
            for named in &module.named {
                let mut passed = BTreeSet::new();
                let ends = self.resolve(from, &named.path, &mut passed, &mut BTreeSet::new());
                passed.extend(ends.iter().map(|&end| match end {
                    Target::Module(module) | Target::Item(module) => module,
                }));
                let places = passed.into_iter().map(|to| &self.modules[to]);
                let later =
                    places.filter_map(|to| place(to, order).or_else(|| first_inside(to, order))).max();
                if let Some(later) = later.filter(|&later| later > own) {
                    found.insert(format!("{} uses {}", at(module, named), order[later]));
                }
            }
        }
        found.into_iter().collect()
    }

    /// Paths from `crate`, `self` or `super` that the checker cannot follow, and so cannot check.
    pub fn unresolved(&self) -> Vec<String> {
        let mut found = Vec::new();
        for (from, module) in self.modules.iter().enumerate() {
            for named in &module.named {
                let is_ours = matches!(&*named.path[0], "crate" | "super") && named.path.len() > 1;
                let ends = self.resolve(from, &named.path, &mut BTreeSet::new(), &mut BTreeSet::new());
                if is_ours && ends.is_empty() {
                    found.push(format!("{} leads nowhere", at(module, named)));
                }
            }
        }
        found
    }

    /// The shortest circle of files among each set of files that reach one another.
    pub fn circles(&self) -> Vec<String> {
        let mut edges: BTreeMap<&str, BTreeMap<&str, String>> = BTreeMap::new();
        for (from, module) in self.modules.iter().enumerate() {
            for named in module.named.iter().filter(|named| named.place != Place::Reexport) {
                for end in self.resolve(from, &named.path, &mut BTreeSet::new(), &mut BTreeSet::new()) {
                    if let Target::Item(to) = end
                        && self.modules[to].file != module.file
                    {
                        let to = self.modules[to].file.as_str();
                        let out = edges.entry(&module.file).or_default();
                        out.entry(to).or_insert_with(|| at(module, named));
                    }
                }
            }
        }
        let mut found: Vec<Vec<&str>> = Vec::new();
        let mut circles: Vec<Vec<&str>> =
            edges.keys().filter_map(|file| shortest_circle(&edges, file)).collect();
        circles.sort_by_key(Vec::len);
        for circle in circles {
            if !found.iter().any(|known| circle.iter().any(|file| known.contains(file))) {
                found.push(circle);
            }
        }
        let step = |pair: &[&str]| format!("{} -> {}", edges[pair[0]][pair[1]], pair[1]);
        found.iter().map(|circle| circle.windows(2).map(step).collect::<Vec<_>>().join(", ")).collect()
    }

    /// What `path` refers to in module `from`; `passed` gets the modules that it names.
    fn resolve(
        &self,
        from: usize,
        path: &[String],
        passed: &mut BTreeSet<usize>,
        open: &mut BTreeSet<(usize, String)>,
    ) -> BTreeSet<Target> {
        let Some((first, mut rest)) = path.split_first() else { return BTreeSet::new() };
        let mut ends = match &**first {
            "crate" => BTreeSet::from([Target::Module(0)]),
            "self" => BTreeSet::from([Target::Module(from)]),
            "super" => BTreeSet::from([Target::Module(self.modules[from].parent)]),
            name => self.look_up(from, name, open),
        };
        while let Some((name, after)) = rest.split_first() {
            let mut next = BTreeSet::new();
            for end in ends {
                match end {
                    // A variant or an associated item belongs to the file of its type.
                    Target::Item(_) => drop(next.insert(end)),
                    Target::Module(module) if name == "super" => {
                        next.insert(Target::Module(self.modules[module].parent));
                    }
                    Target::Module(module) => {
                        passed.insert(module);
                        next.extend(self.look_up(module, name, open));
                    }
                }
            }
            (ends, rest) = (next, after);
        }
        ends
    }

    /// What `name` stands for in `module`. `open` holds the names being looked up, so that an import under the
    /// name of a module it leads through is not followed for ever.
    fn look_up(&self, module: usize, name: &str, open: &mut BTreeSet<(usize, String)>) -> BTreeSet<Target> {
        let mut ends = BTreeSet::new();
        let key = (module, name.to_owned());
        let is_new = open.insert(key.clone());
        for definition in self.modules[module].scope.get(name).into_iter().flatten() {
            match definition {
                Definition::Module(child) => drop(ends.insert(Target::Module(*child))),
                Definition::Item => drop(ends.insert(Target::Item(module))),
                Definition::Import(path) if is_new => {
                    ends.extend(self.resolve(module, path, &mut BTreeSet::new(), open));
                }
                Definition::Import(_) => {}
            }
        }
        if ends.is_empty() && is_new {
            for glob in &self.modules[module].globs {
                for end in self.resolve(module, glob, &mut BTreeSet::new(), open) {
                    if let Target::Module(source) = end {
                        ends.extend(self.look_up(source, name, open));
                    }
                }
            }
        }
        if is_new {
            open.remove(&key);
        }
        ends
    }
}

/// Place of `module` in `order`.
fn place(module: &Module, order: &[&str]) -> Option<usize> {
    let name = module.name.join("::");
    let is_inside = |entry: &str| name == entry || name.starts_with(&format!("{entry}::"));
    (0..order.len()).filter(|&i| is_inside(order[i])).max_by_key(|&i| order[i].len())
}

/// Place of the first entry of `order` inside of `module`.
fn first_inside(module: &Module, order: &[&str]) -> Option<usize> {
    let within = module.name.iter().map(|name| format!("{name}::")).collect::<String>();
    order.iter().position(|entry| entry.starts_with(&within))
}

fn at(module: &Module, named: &Named) -> String {
    format!("{}:{} `{}`", module.file, named.line, named.path.join("::"))
}

/// The shortest way from `start` back to it, both ends included.
fn shortest_circle<'a>(
    edges: &BTreeMap<&'a str, BTreeMap<&'a str, String>>,
    start: &'a str,
) -> Option<Vec<&'a str>> {
    let mut before: BTreeMap<&str, &str> = BTreeMap::new();
    let mut pending = VecDeque::from([start]);
    while let Some(file) = pending.pop_front() {
        for &next in edges.get(file).into_iter().flat_map(BTreeMap::keys) {
            if before.contains_key(next) {
                continue;
            }
            before.insert(next, file);
            if next == start {
                let mut circle = vec![start];
                let mut file = before[start];
                while file != start {
                    circle.push(file);
                    file = before[file];
                }
                circle.push(start);
                circle.reverse();
                return Some(circle);
            }
            pending.push_back(next);
        }
    }
    None
}
