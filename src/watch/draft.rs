//! What pages change of a scene: a scene file that lies over the one that is watched and is not saved until somebody asks.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use serde::Deserialize;
use toml::{Table, Value};

use super::layer::written;
use crate::session::is_scene_file;

/// A value of a table that has a name.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Setting {
    /// `material`, `node`, `camera` or `light`.
    table: Kind,
    /// Of the material and so on.
    name: String,
    key: String,
    value: Value,
}

impl Setting {
    /// What is changed, for people.
    pub fn label(&self) -> String {
        format!("{} {}", self.name, self.key)
    }
}

/// Tables of scene files that have names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Kind {
    Material,
    Node,
    Camera,
    Light,
    /// Chosen by requests of their own.
    #[serde(skip_deserializing)]
    Import,
}

impl Kind {
    /// What scene files call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Material => "material",
            Self::Node => "node",
            Self::Camera => "camera",
            Self::Light => "light",
            Self::Import => "import",
        }
    }

    /// Tables of this kind as scene files have them: by name, or in a list where each says its name.
    pub fn group(self, named: Vec<(String, Table)>) -> Value {
        let says_name = |(name, mut table): (String, Table)| {
            table.insert("name".into(), name.into());
            Value::Table(table)
        };
        match self {
            Self::Material | Self::Node => {
                Value::Table(named.into_iter().map(|(name, table)| (name, table.into())).collect())
            }
            Self::Camera | Self::Light | Self::Import => {
                Value::Array(named.into_iter().map(says_name).collect())
            }
        }
    }
}

/// What a layer says besides imports.
const OVER_ASSETS: &[Kind] = &[Kind::Camera, Kind::Light, Kind::Material, Kind::Node];
/// The key of an import's variants.
const VARIANT: &str = "variant";

/// Changes that are not saved.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Draft {
    tables: BTreeMap<(Kind, String), Table>,
    /// The camera to look through.
    camera: Option<String>,
    /// Whether everything is shown as if made of clay: a way to look at a scene, which no file says.
    is_clay: bool,
}

impl Draft {
    /// What it is called where it is read as a file.
    pub const NAME: &str = "changes made on the page";

    pub fn is_empty(&self) -> bool {
        self.tables.is_empty() && self.camera.is_none()
    }

    /// Forgets all that could be saved.
    pub fn clear(&mut self) {
        *self = Self { is_clay: self.is_clay, ..Self::default() };
    }

    /// Whether everything is shown as if made of clay.
    pub fn is_clay(&self) -> bool {
        self.is_clay
    }

    /// Shows everything as if made of clay, or as it is.
    pub fn show_clay(&mut self, show: bool) {
        self.is_clay = show;
    }

    /// Adds a change, over those before.
    pub fn set(&mut self, setting: Setting) {
        let Setting { table, name, key, value } = setting;
        self.table(table, name).insert(key, value);
    }

    /// What is changed of the thing of this name.
    pub fn table(&mut self, kind: Kind, name: impl Into<String>) -> &mut Table {
        self.tables.entry((kind, name.into())).or_default()
    }

    /// Looks through this camera.
    pub fn look_through(&mut self, camera: impl Into<String>) {
        self.camera = Some(camera.into());
    }

    /// Shows these variants of an import; what the file shows by itself where there are none.
    pub fn show_variants(&mut self, import: impl Into<String>, variants: Vec<String>) {
        self.table(Kind::Import, import).insert(VARIANT.into(), variants.into());
    }

    /// The variants that are shown of an asset which is not imported by a scene file.
    pub fn variants(&self) -> Vec<String> {
        let imports = self.tables.iter().filter(|((kind, _), _)| *kind == Kind::Import);
        let named = imports.filter_map(|(_, table)| table.get(VARIANT)?.as_array());
        named.flatten().filter_map(|name| name.as_str().map(str::to_owned)).collect()
    }

    /// What is changed of the things of a kind, by their names.
    pub fn named(&self, kind: Kind) -> impl Iterator<Item = (&str, &Table)> {
        self.tables.iter().filter(move |((it, _), _)| *it == kind).map(|((_, name), table)| (&**name, table))
    }

    /// The table that chooses the camera, if one is chosen.
    pub fn render(&self) -> Table {
        let camera = self.camera.iter().map(|camera| ("camera".to_owned(), camera.as_str().into()));
        let table: Table = camera.collect();
        if table.is_empty() { table } else { Table::from_iter([("render".to_owned(), table.into())]) }
    }

    /// The camera to look through, if one is chosen.
    pub fn camera(&self) -> Option<&str> {
        self.camera.as_deref()
    }

    /// As a scene file.
    pub fn text(&self) -> String {
        self.text_of(&[Kind::Import, Kind::Camera, Kind::Light, Kind::Material, Kind::Node])
    }

    /// Of these kinds.
    fn text_of(&self, kinds: &[Kind]) -> String {
        let mut file = self.render();
        for kind in kinds.iter().copied() {
            let named: Vec<_> =
                self.named(kind).map(|(name, table)| (name.to_owned(), table.clone())).collect();
            if !named.is_empty() {
                file.insert(kind.name().into(), kind.group(named));
            }
        }
        written(&file)
    }

    /// As a scene file over the `scene`, with a path beside it, if there is something. Variants of an asset which is no
    /// scene file are not in it.
    pub fn over(&self, scene: &Path) -> Option<(PathBuf, String)> {
        let text = || if is_scene_file(scene) { self.text() } else { self.text_of(OVER_ASSETS) };
        (!self.is_empty()).then(|| (scene.with_file_name(Self::NAME), text()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn setting(table: Kind, name: &str, key: &str, value: impl Into<Value>) -> Setting {
        Setting { table, name: name.into(), key: key.into(), value: value.into() }
    }

    #[test]
    fn changes_become_a_scene_file() {
        let mut draft = Draft::default();
        draft.set(setting(Kind::Material, "Chrome.001 \"x\"", "roughness", 0.5));
        draft.set(setting(Kind::Material, "Chrome.001 \"x\"", "roughness", 0.2));
        draft.set(setting(Kind::Light, "sun", "illuminance", 3.0));
        draft.set(setting(Kind::Light, "sun", "color", vec![1.0, 0.5, 0.25]));
        draft.look_through("top");
        let read: Table = draft.text().parse().unwrap();
        assert_eq!(read["material"]["Chrome.001 \"x\""]["roughness"].as_float(), Some(0.2));
        assert_eq!(read["light"].as_array().unwrap().len(), 1);
        assert_eq!(read["light"][0]["name"].as_str(), Some("sun"));
        assert_eq!(read["render"]["camera"].as_str(), Some("top"));
    }

    #[test]
    fn variants_are_those_of_an_import() {
        let mut draft = Draft::default();
        draft.show_variants("shoe", vec!["Red".into()]);
        let read: Table = draft.text().parse().unwrap();
        assert_eq!(read["import"][0]["name"].as_str(), Some("shoe"));
        assert_eq!(draft.variants(), ["Red"]);
        assert_eq!(draft.over(Path::new("a/shoe.glb")).unwrap().1, "");
    }
}
