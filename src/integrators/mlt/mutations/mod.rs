//! The mutations, one a file.

mod bidirectional;
mod caustic;
mod eye_chain;
mod inversion;

pub use bidirectional::Bidirectional;
pub use caustic::Caustic;
pub use eye_chain::{Lens, MultiChain};
pub use inversion::{Technique, Window};

use super::{
    Mutation,
    choice::{CLASSES, Table, has_pair},
};

/// The list of mutations, with the weights that the choice between them begins from. Where no two neighbours of a path
/// scatter smoothly only a move of the whole path changes what mirrors and lenses see.
pub fn mutations() -> (Vec<&'static dyn Mutation>, Table) {
    let list: [(&'static dyn Mutation, f64, f64); 6] = [
        (&Bidirectional, 0.25, 0.25),
        (&Lens, 0.4, 0.4),
        (&Caustic, 0.1, 0.1),
        (&MultiChain, 0.4, 0.4),
        (&Window, 0.2, 0.2),
        (&Technique, 0.05, 0.3),
    ];
    let mut table = Table::uniform(&list.map(|(_, weight, _)| weight));
    for class in (0..CLASSES).filter(|&class| !has_pair(class)) {
        for (weight, (_, _, without_pair)) in table.weights[class].iter_mut().zip(list) {
            *weight = without_pair;
        }
    }
    (list.iter().map(|(mutation, ..)| *mutation).collect(), table)
}
