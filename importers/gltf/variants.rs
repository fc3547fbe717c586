//! KHR_materials_variants: which material a primitive has in the variants that were chosen.

use ajar_scene::{Cause, Diagnostic, VariantSet};
use gltf::json::{Root, mesh::Primitive};
use serde::Deserialize;

use super::{Context, extensions};

const NAME: &str = "KHR_materials_variants";

#[derive(Deserialize, Default)]
struct Names {
    variants: Vec<Variant>,
}

#[derive(Deserialize)]
struct Variant {
    name: String,
}

#[derive(Deserialize)]
struct Mappings {
    mappings: Vec<Mapping>,
}

#[derive(Deserialize)]
struct Mapping {
    material: u32,
    variants: Vec<usize>,
}

/// Indices of the chosen variants.
pub(super) struct Variants(Vec<usize>);

impl Variants {
    /// Those that the request names, and all there are.
    ///
    /// # Errors
    /// The file has no variant of such a name: tells which it has.
    pub fn chosen(root: &Root, context: &mut Context) -> Result<(Self, Vec<VariantSet>), Diagnostic> {
        let others = root.extensions.as_ref().map(|extensions| &extensions.others);
        let known: Names = extensions::read(others, NAME, "", &mut context.report).unwrap_or_default();
        let names: Vec<_> = known.variants.iter().map(|variant| variant.name.as_str()).collect();
        let listed = names.join(", ");
        let chosen = &context.request.choice.variants;
        if chosen.is_empty() && !names.is_empty() {
            let message =
                format!("has the variants {listed}; none is chosen, the default materials are shown");
            context.report.note(format!("extensions.{NAME}"), message);
        }
        let find = |name: &String| {
            names.iter().position(|known| known == name).ok_or_else(|| {
                let error = Diagnostic::error(format!("there is no variant \"{}\"", name.escape_debug()));
                let hint =
                    if names.is_empty() { "the file has none".into() } else { format!("variants: {listed}") };
                error.because(Cause::Usage).hint(hint)
            })
        };
        let indices = chosen.iter().map(find).collect::<Result<_, _>>()?;
        let choices: Vec<_> = names.into_iter().map(str::to_owned).collect();
        let set = VariantSet { name: String::new(), choices, chosen: chosen.first().cloned() };
        let sets = [set].into_iter().filter(|set| !set.choices.is_empty());
        Ok((Self(indices), sets.collect()))
    }

    /// The material of a primitive: that of the first chosen variant which says one, else its own.
    pub fn material(&self, primitive: &Primitive, context: &mut Context, element: &str) -> Option<usize> {
        let own = primitive.material.map(|material| material.value());
        let others = primitive.extensions.as_ref().map(|extensions| &extensions.others);
        if self.0.is_empty() {
            return own;
        }
        let Some(Mappings { mappings }) = extensions::read(others, NAME, element, &mut context.report) else {
            return own;
        };
        let of = |variant| mappings.iter().find(|mapping: &&Mapping| mapping.variants.contains(variant));
        self.0.iter().find_map(of).map(|mapping| mapping.material as usize).or(own)
    }
}
