//! What a scene *is*: plain data that can be validated, printed, hashed, overridden, written and read back.
//!
//! Units: metres, radians, candela, lux, cd/m². Right-handed, +Y up. Colours are linear Rec.709. This crate knows no
//! rendering and reads no asset format; it defines the [`Importer`] that does.

mod arena;
mod bounds;
mod camera;
mod defaults;
mod diagnostic;
mod edit;
mod file;
mod hash;
mod import;
mod light;
mod material;
mod mesh;
mod node;
mod quantity;
mod ranges;
mod scene;
mod serde_finite;
mod settings;
mod texture;
mod validate;

pub use arena::{Arena, Id};
pub use bounds::looking;
pub use camera::{Camera, Projection};
pub use defaults::framing_camera;
pub use diagnostic::{Cause, Diagnostic, Loss, Severity};
pub use file::{Overrides, SCHEMA, SceneFile, Setting, VariedImport, load, load_asset};
pub use import::{
    Choice, Feature, ImportRequest, Imported, Importer, Looked, Moment, Preference, VariantSet,
};
pub use light::{Light, LightKind};
pub use material::{AlphaMode, Channel, Input, Material, NormalMap, TextureInput};
pub use mesh::Mesh;
pub use node::Node;
pub use quantity::{parse_duration, parse_percent};
pub use scene::{Placed, Scene};
pub use settings::{OutputSettings, RenderSettings};
pub use texture::{ColorSpace, Filter, Image, ImageSource, Texture, Wrap};
