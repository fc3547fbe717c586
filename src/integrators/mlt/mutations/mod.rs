//! The mutations, one a file.

use std::collections::BTreeMap;

mod bidirectional;
mod caustic;
mod eye_chain;
mod inversion;
mod lens_subpath;
mod manifold;

pub use bidirectional::{Bidirectional, Chances};
pub use caustic::Caustic;
pub use eye_chain::{Lens, MultiChain};
pub use inversion::{EyeChain, LightChain, Technique, Window};
pub use lens_subpath::LensSubpath;
pub use manifold::Manifold;

use super::{
    Mutation,
    choice::{CLASSES, Table, has_pair},
};

/// All mutations. Where no two neighbours of a path can be connected, only a move of the whole path changes what mirrors
/// and lenses see: the second weight is for such paths (design notes, evidence 7).
const LIST: [(&dyn Mutation, f64, f64); 10] = [
    (&Bidirectional, 0.25, 0.25),
    (&Lens, 0.4, 0.4),
    (&Caustic, 0.1, 0.1),
    (&MultiChain, 0.4, 0.4),
    (&Window, 0.2, 0.2),
    (&Technique, 0.05, 0.3),
    (&EyeChain, 0.05, 0.05),
    (&LightChain, 0.05, 0.05),
    (&LensSubpath, 0.05, 0.05),
    (&Manifold, 0.05, 0.05),
];

/// Names of all mutations.
pub fn names() -> impl Iterator<Item = &'static str> {
    LIST.iter().map(|(mutation, ..)| mutation.name())
}

/// All mutations and the weights that the choice between them goes by: the usual ones, where `given` does not say others
/// by name.
pub fn mutations(given: &BTreeMap<String, f64>) -> (Vec<&'static dyn Mutation>, Table) {
    let weight = |i: usize, usual: f64| given.get(LIST[i].0.name()).copied().unwrap_or(usual);
    let mut table = Table::uniform(&std::array::from_fn::<_, { LIST.len() }, _>(|i| weight(i, LIST[i].1)));
    for class in (0..CLASSES).filter(|&class| !has_pair(class)) {
        for (i, (_, _, without_pair)) in LIST.iter().enumerate() {
            table.weights[class][i] = weight(i, *without_pair);
        }
    }
    (LIST.iter().map(|(mutation, ..)| *mutation).collect(), table)
}
