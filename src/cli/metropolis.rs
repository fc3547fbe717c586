//! What a scene file says of Metropolis light transport, its names checked.

use ajar_integrators::{
    Metropolis,
    mlt::{choice::Choice, lens_subpaths::Spread, mutations},
};
use ajar_scene::{Diagnostic, RenderSettings};

use super::job::wrong;

/// The settings of chains.
///
/// # Errors
/// A name that nothing has, or nothing is left to choose from.
pub(super) fn metropolis(render: &RenderSettings) -> Result<Metropolis, Diagnostic> {
    let known: Vec<_> = mutations::names().collect();
    if let Some(name) = render.mutations.keys().find(|name| !known.contains(&name.as_str())) {
        return Err(unknown("mutation", name, &known, &format!("mutations.{name}")));
    }
    if known.iter().all(|name| render.mutations.get(*name) == Some(&0.0)) {
        return Err(wrong("all mutations are switched off").element("render.mutations"));
    }
    let usual = Metropolis::default();
    Ok(Metropolis {
        weights: render.mutations.clone(),
        choice: named(&render.mutation_choice, &Choice::ALL, Choice::name, "mutation_choice")?,
        chain_length: render.chain_length.unwrap_or(usual.chain_length),
        lens_subpaths: named(&render.lens_subpaths, &Spread::ALL, Spread::name, "lens_subpaths")?,
    })
}

/// The one of `all` that has the name given, or the default.
fn named<T: Copy + Default>(
    given: &Option<String>,
    all: &[T],
    name: fn(T) -> &'static str,
    key: &str,
) -> Result<T, Diagnostic> {
    let Some(given) = given else { return Ok(T::default()) };
    let found = all.iter().copied().find(|one| name(*one) == given);
    found.ok_or_else(|| {
        let known: Vec<_> = all.iter().map(|one| name(*one)).collect();
        unknown(&key.replace('_', " "), given, &known, key)
    })
}

fn unknown(what: &str, name: &str, known: &[&str], key: &str) -> Diagnostic {
    wrong(format!("there is no {what} \"{name}\""))
        .element(format!("render.{key}"))
        .hint(format!("choose from: {}", known.join(", ")))
}
