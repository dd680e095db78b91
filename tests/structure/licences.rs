//! What the crates that we depend on may be used under: one of the licences that `deny.toml` allows. `make audit` asks
//! cargo-deny, which not every machine has; this asks cargo alone.

use std::process::Command;

/// The strings of the list that begins at `start`, without comments.
fn list<'a>(text: &'a str, start: &str) -> Vec<&'a str> {
    let (_, after) = text.split_once(start).unwrap();
    let inside = after[..after.find(']').unwrap()].lines().map(|line| line.split('#').next().unwrap());
    inside.flat_map(|line| line.split('"').skip(1).step_by(2)).collect()
}

/// Whether an expression of the form that Cargo.toml has, with OR before AND but for brackets, is met by `allowed`.
fn is_allowed(expression: &str, allowed: &dyn Fn(&str) -> bool) -> bool {
    let expression = expression.trim();
    // Cuts at a word outside of brackets.
    let cut = |word: &str| {
        let depth = |end: usize| {
            let count = |bracket| expression[..end].matches(bracket).count();
            count('(') - count(')')
        };
        let place = expression.match_indices(word).map(|(at, _)| at).find(|&at| depth(at) == 0)?;
        Some((&expression[..place], &expression[place + word.len()..]))
    };
    // AND binds closer, so that OR is cut first; a slash is an OR of old.
    for word in [" OR ", "/"] {
        if let Some((a, b)) = cut(word) {
            return is_allowed(a, allowed) || is_allowed(b, allowed);
        }
    }
    if let Some((a, b)) = cut(" AND ") {
        return is_allowed(a, allowed) && is_allowed(b, allowed);
    }
    match expression.strip_prefix('(').and_then(|inside| inside.strip_suffix(')')) {
        Some(inside) => is_allowed(inside, allowed),
        None => allowed(expression),
    }
}

#[test]
fn every_crate_has_a_licence_that_is_allowed() {
    let deny = include_str!("../../deny.toml");
    let general = list(deny, "\nallow = [");
    assert!(general.contains(&"MIT") && general.len() > 3, "{general:?}");
    let output = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()))
        .args(["tree", "--offline", "--workspace", "--all-features", "-e", "normal,build,dev"])
        .args(["--prefix", "none", "--format", "{p}|{l}"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let mut crates: Vec<&str> = text.lines().filter(|line| !line.is_empty()).collect();
    crates.sort_unstable();
    crates.dedup();
    assert!(crates.len() > 100, "{} crates", crates.len());
    let refused: Vec<&&str> = crates
        .iter()
        .filter(|line| {
            let (package, licence) = line.split_once('|').unwrap();
            let name = package.split(' ').next().unwrap();
            let exception = format!("crate = \"{name}\", allow = [");
            let own = if deny.contains(&exception) { list(deny, &exception) } else { Vec::new() };
            let licence = licence.trim_end_matches(" (*)");
            !is_allowed(licence, &|licence| general.contains(&licence) || own.contains(&licence))
        })
        .collect();
    assert!(refused.is_empty(), "not allowed by deny.toml: {refused:?}");
}

#[test]
fn licences_are_read_as_cargo_writes_them() {
    let allowed = |licence: &str| ["MIT", "Zlib"].contains(&licence);
    for met in ["MIT", "MIT OR GPL-3.0", "GPL-3.0/MIT", "(GPL-3.0 OR MIT) AND Zlib", "GPL-3.0 AND X OR Zlib"]
    {
        assert!(is_allowed(met, &allowed), "{met}");
    }
    for refused in ["", "GPL-3.0", "MIT AND GPL-3.0", "(MIT OR Zlib) AND GPL-3.0", "GPL-3.0 OR X"] {
        assert!(!is_allowed(refused, &allowed), "{refused}");
    }
}
