//! What is changed of a scene as a file beside it, which renders the same without the program and its options.

use std::{
    fs::{self, File},
    io,
    path::{Path, PathBuf},
};

use ajar_output::write_atomically;
use ajar_scene::{Cause, Diagnostic};
use toml::{Table, Value};

use super::draft::{Draft, Kind};
use crate::session::is_scene_file;

/// What the command line says about the look of a scene.
#[derive(Debug, Default)]
pub struct Said {
    /// In the terms of scene files, one value each; lists are tables by names. Later ones go before earlier ones.
    pub changes: Vec<Table>,
    /// Keys of the import, where the scene is an asset.
    pub import: Table,
    /// Options that no scene file can say.
    pub unsaid: Vec<String>,
}

impl Said {
    /// Adds a value of a table.
    pub fn say(&mut self, table: &str, key: &str, value: impl Into<Value>) {
        self.changes.push(one(table, one(key, value)));
    }

    /// Of the things of a kind, by their names in the order in which they are named.
    fn named(&self, kind: Kind) -> Vec<(String, Table)> {
        let mut all: Vec<(String, Table)> = Vec::new();
        let tables = self.changes.iter().filter_map(|change| change.get(kind.name())?.as_table());
        for (name, value) in tables.flatten() {
            let Some(table) = value.as_table() else { continue };
            match all.iter_mut().find(|(known, _)| known == name) {
                Some((_, known)) => lay_over(known, table),
                None => all.push((name.clone(), table.clone())),
            }
        }
        all
    }

    /// Options that a layer over this scene does not hold.
    pub fn not_in_layer(&self, scene: &Path) -> Vec<String> {
        let mut options = self.unsaid.clone();
        if is_scene_file(scene) {
            options.extend(
                self.import.keys().map(|key| format!("--{}", if key == "time" { "at" } else { key })),
            );
        }
        // Items of lists are named in layers, by more than their position.
        let by_position = [Kind::Import, Kind::Camera, Kind::Light].into_iter().flat_map(|kind| {
            let named = self.named(kind).into_iter().filter(|(name, _)| is_position(name));
            named.map(move |(name, _)| format!("--set {}[{name}]", kind.name()))
        });
        options.extend(by_position);
        options
    }
}

fn one(key: &str, value: impl Into<Value>) -> Table {
    Table::from_iter([(key.to_owned(), value.into())])
}

fn is_position(name: &str) -> bool {
    name.bytes().all(|byte| byte.is_ascii_digit())
}

/// Adds what `over` says to a table; where both say something, `over` counts.
fn lay_over(table: &mut Table, over: &Table) {
    for (key, value) in over {
        match (table.get_mut(key), value) {
            (Some(Value::Table(below)), Value::Table(above)) => lay_over(below, above),
            _ => drop(table.insert(key.clone(), value.clone())),
        }
    }
}

/// A scene file beside the one at `scene`, over which it lies: what the command line says, and over that the draft.
pub(super) fn text(draft: &Draft, scene: &Path, said: &Said) -> String {
    let name = Value::from(scene.file_name().unwrap_or_default().to_string_lossy().into_owned());
    let mut file = Table::new();
    let mut lists = vec![Kind::Camera, Kind::Light];
    if is_scene_file(scene) {
        lists.push(Kind::Import);
        file.insert("extends".into(), name);
    } else {
        // An asset is imported once.
        let mut import = one("file", name);
        lay_over(&mut import, &said.import);
        if !draft.variants().is_empty() {
            import.insert("variant".into(), draft.variants().into());
        }
        file.insert("import".into(), vec![import].into());
    }
    for key in ["render", "output"] {
        let tables = said.changes.iter().filter_map(|change| change.get(key)?.as_table());
        let table = tables.fold(Table::new(), |mut all, table| {
            lay_over(&mut all, table);
            all
        });
        if !table.is_empty() {
            file.insert(key.into(), table.into());
        }
    }
    lay_over(&mut file, &draft.render());
    for kind in lists {
        let mut items: Vec<_> = said.named(kind).into_iter().filter(|(name, _)| !is_position(name)).collect();
        for (name, table) in draft.named(kind) {
            match items.iter_mut().find(|(known, _)| known == name) {
                Some((_, known)) => lay_over(known, table),
                None => items.push((name.to_owned(), table.clone())),
            }
        }
        if !items.is_empty() {
            file.insert(kind.name().into(), kind.group(items));
        }
    }
    let mut text = written(&file);
    for kind in [Kind::Material, Kind::Node] {
        text.extend(
            patterns(draft, said, kind)
                .into_iter()
                .map(|(name, table)| format!("\n{}", written(&one(kind.name(), one(&name, table))))),
        );
    }
    text
}

/// Tables that act one after the other, each on all that fits its name: those of the draft last.
fn patterns(draft: &Draft, said: &Said, kind: Kind) -> Vec<(String, Table)> {
    let mut all = said.named(kind);
    for (name, table) in draft.named(kind) {
        let below = all.iter().position(|(known, _)| known == name).map(|at| all.remove(at).1);
        let mut whole = below.unwrap_or_default();
        lay_over(&mut whole, table);
        all.push((name.to_owned(), whole));
    }
    all
}

/// As TOML.
pub(super) fn written(table: &Table) -> String {
    // Cannot fail: values come from TOML or JSON, and tables have names.
    toml::to_string(table).unwrap_or_default()
}

/// The file that was written last, and its text.
#[derive(Debug, Default)]
pub(super) struct Layer(Option<(PathBuf, String)>);

impl Layer {
    /// Writes a layer beside the `scene`: over the one that was written before, unless somebody changed that since,
    /// otherwise under a name that nothing has. Returns its path.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn save(&mut self, scene: &Path, text: String) -> Result<PathBuf, Diagnostic> {
        let own = self.0.take().filter(|(path, text)| fs::read_to_string(path).is_ok_and(|it| it == *text));
        let (path, is_new) = match own {
            Some((path, _)) => (path, false),
            None => (claim(scene).map_err(|e| failed(format!("cannot write a layer: {e}"), scene))?, true),
        };
        if let Err(error) = write_atomically(&path, |file| file.write_all(text.as_bytes())) {
            if is_new {
                // Nothing of ours is in it.
                let _ = fs::remove_file(&path);
            }
            return Err(failed(error.to_string(), &path));
        }
        self.0 = Some((path.clone(), text));
        Ok(path)
    }
}

fn failed(message: String, path: &Path) -> Diagnostic {
    Diagnostic::error(message).in_file(path).because(Cause::System)
}

/// Makes an empty file beside the scene, which nobody else can take for theirs.
fn claim(scene: &Path) -> io::Result<PathBuf> {
    let mut number = 1_u32;
    loop {
        let name = if number == 1 { "look.toml".to_owned() } else { format!("look-{number}.toml") };
        let path = scene.with_file_name(name);
        match File::create_new(&path) {
            Ok(_) => return Ok(path),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists && number < u32::MAX => number += 1,
            Err(error) => return Err(error),
        }
    }
}

#[cfg(test)]
mod tests;
