//! What pages change of a scene: a scene file that lies over the one that is watched and is not saved until somebody asks.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use ajar_output::{OutputError, write_atomically};
use serde::Deserialize;
use toml::{Table, Value};

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
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Material => "material",
            Self::Node => "node",
            Self::Camera => "camera",
            Self::Light => "light",
        }
    }

    /// Tables of this kind as scene files have them: by name, or in a list where each says its name.
    fn group(self, named: Vec<(String, Table)>) -> Value {
        let says_name = |(name, mut table): (String, Table)| {
            table.insert("name".into(), name.into());
            Value::Table(table)
        };
        match self {
            Self::Material | Self::Node => {
                Value::Table(named.into_iter().map(|(name, table)| (name, table.into())).collect())
            }
            Self::Camera | Self::Light => Value::Array(named.into_iter().map(says_name).collect()),
        }
    }
}

/// Changes that are not saved.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Draft {
    tables: BTreeMap<(Kind, String), Table>,
    /// The camera to look through.
    camera: Option<String>,
}

impl Draft {
    pub fn is_empty(&self) -> bool {
        self.tables.is_empty() && self.camera.is_none()
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

    /// As a scene file.
    pub fn text(&self) -> String {
        let mut file = Table::new();
        for kind in [Kind::Camera, Kind::Light, Kind::Material, Kind::Node] {
            let named = self.tables.iter().filter(|((it, _), _)| *it == kind);
            let named: Vec<_> = named.map(|((_, name), table)| (name.clone(), table.clone())).collect();
            if !named.is_empty() {
                file.insert(kind.name().into(), kind.group(named));
            }
        }
        if let Some(camera) = &self.camera {
            file.insert(
                "render".into(),
                Table::from_iter([("camera".to_owned(), camera.as_str().into())]).into(),
            );
        }
        // Cannot fail: values come from TOML or JSON, and tables have names.
        toml::to_string(&file).unwrap_or_default()
    }

    /// As a scene file beside the one at `scene`, over which it lies.
    fn layer(&self, scene: &Path) -> String {
        let name = Value::from(scene.file_name().unwrap_or_default().to_string_lossy().into_owned());
        let below = if is_scene_file(scene) {
            format!("extends = {name}")
        } else {
            format!("[[import]]\nfile = {name}")
        };
        format!("{below}\n\n{}", self.text())
    }

    /// Saves it at `path`, beside the `scene` over which it lies.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn save(&self, path: &Path, scene: &Path) -> Result<(), OutputError> {
        let text = self.layer(scene);
        write_atomically(path, |file| file.write_all(text.as_bytes()))
    }

    /// With the path that it would be saved at, if there is something to save.
    pub fn at(&self, path: &Path) -> Option<(PathBuf, String)> {
        (!self.is_empty()).then(|| (path.to_owned(), self.text()))
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
    fn a_layer_names_what_it_lies_over() {
        let mut draft = Draft::default();
        draft.set(setting(Kind::Node, "Lamp", "light_scale", 2.0));
        let over = |scene: &str| draft.layer(Path::new(scene)).parse::<Table>().unwrap();
        assert_eq!(over("a/scene.toml")["extends"].as_str(), Some("scene.toml"));
        assert_eq!(over("a/chair \"b\".glb")["import"][0]["file"].as_str(), Some("chair \"b\".glb"));
        assert_eq!(over("a/scene.toml")["node"]["Lamp"]["light_scale"].as_float(), Some(2.0));
    }
}
