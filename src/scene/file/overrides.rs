//! What lies over a scene file: changes from the command line, `material.Chrome.roughness=0.2`, as a TOML document that goes
//! before the file's; and over them a file that is being edited and not yet saved.

use std::path::{Path, PathBuf};

use toml::{Spanned, Table, Value, de::DeTable};

use super::{
    layers::{self, Text},
    source::Source,
};
use crate::{Cause, Diagnostic};

/// Changes to what a scene file says, by the same key paths. Cameras, lights and imports are named where the file has a
/// list: `camera.main.yfov`, or counted from 0: `camera[0].yfov`.
#[derive(Clone, Debug, Default)]
pub struct Overrides {
    /// One `key.path = value` a line.
    document: String,
    /// What goes before everything else.
    draft: Option<Text>,
}

impl Overrides {
    /// Reads changes written `key.path=value`. Values are those of TOML; what is none is taken as a string, so that words
    /// need no quotes. Parts of a path that hold dots are quoted: `material."Chrome.001".roughness`.
    ///
    /// # Errors
    /// What is not of this form, all of it.
    pub fn parse<T: AsRef<str>>(changes: &[T]) -> Result<Self, Vec<Diagnostic>> {
        let mut document = String::new();
        let mut errors = Vec::new();
        for change in changes {
            match line(change.as_ref()) {
                Ok(line) => document.push_str(&line),
                Err(why) => errors.push(complaint(change.as_ref(), &why)),
            }
        }
        if errors.is_empty()
            && let Err(error) = DeTable::parse(&document)
        {
            // Every line is sound by itself: two do not go together.
            let all: Vec<_> = changes.iter().map(AsRef::as_ref).collect();
            errors.push(complaint(&all.join(" --set "), error.message()));
        }
        if errors.is_empty() { Ok(Self { document, draft: None }) } else { Err(errors) }
    }

    /// The changes one by one, each a table that leads to its value. What is no change is left out.
    pub fn tables<T: AsRef<str>>(changes: &[T]) -> Vec<Table> {
        changes.iter().filter_map(|change| line(change.as_ref()).ok()?.parse().ok()).collect()
    }

    /// The same, below a scene file of this text which would be saved at `path`.
    ///
    /// # Errors
    /// The text is no TOML.
    pub fn below(self, path: impl Into<PathBuf>, text: impl Into<String>) -> Result<Self, Vec<Diagnostic>> {
        let draft = Text { path: path.into(), text: text.into() };
        layers::parse(&draft.path, &draft.text)?;
        Ok(Self { draft: Some(draft), ..self })
    }

    /// What goes before the file at `path`, the first of which counts.
    pub(super) fn sources<'a>(&'a self, path: &'a Path) -> Vec<Source<'a>> {
        let mut sources =
            self.draft.as_ref().map_or_else(Vec::new, |it| layers::sources(std::slice::from_ref(it)));
        // Parsed before.
        let document = DeTable::parse(&self.document).unwrap_or_else(|_| Spanned::new(0..0, DeTable::new()));
        sources.push(Source::command_line(path, &self.document, document));
        sources
    }
}

fn complaint(change: &str, why: &str) -> Diagnostic {
    Diagnostic::error(why).element(format!("--set {change}")).because(Cause::Usage)
}

/// One change as a line of TOML.
fn line(change: &str) -> Result<String, String> {
    let (keys, value) = split(change).ok_or("expected KEY=VALUE, as in render.max_depth=4")?;
    let path: Vec<_> = keys.iter().map(|key| string(key)).collect();
    let is_value = |text: &str| {
        let alone = format!("x = {text}");
        DeTable::parse(&alone).is_ok_and(|it| it.get_ref().len() == 1)
    };
    let value = value.trim();
    let value = if is_value(value) { value.to_owned() } else { string(value) };
    let line = format!("{} = {value}\n", path.join("."));
    DeTable::parse(&line).map_err(|e| e.message().to_owned())?;
    Ok(line)
}

fn string(text: &str) -> String {
    Value::from(text).to_string()
}

/// The parts of the key path, and the value.
fn split(change: &str) -> Option<(Vec<String>, &str)> {
    let (mut keys, mut key, mut quote) = (Vec::new(), String::new(), None);
    for (at, c) in change.char_indices() {
        match (c, quote) {
            (c, Some(open)) if c == open => quote = None,
            (c, Some(_)) => key.push(c),
            ('"' | '\'', None) => quote = Some(c),
            ('.' | '=', None) => {
                let (name, position) = indexed(key.trim());
                keys.push(name.to_owned());
                keys.extend(position.map(str::to_owned));
                key.clear();
                if c == '=' {
                    return keys.iter().all(|key| !key.is_empty()).then_some((keys, change.get(at + 1..)?));
                }
            }
            (c, None) => key.push(c),
        }
    }
    None
}

/// `camera[0]` as `camera` and `0`.
fn indexed(key: &str) -> (&str, Option<&str>) {
    let inside = key.strip_suffix(']').and_then(|key| key.rsplit_once('['));
    match inside.filter(|(_, position)| position.parse::<usize>().is_ok()) {
        Some((name, position)) => (name, Some(position)),
        None => (key, None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_are_lines_of_toml() {
        for (change, wanted) in [
            ("render.max_depth=4", "\"render\".\"max_depth\" = 4\n"),
            ("render.time=10m", "\"render\".\"time\" = \"10m\"\n"),
            ("render.integrator = bdpt", "\"render\".\"integrator\" = \"bdpt\"\n"),
            ("output.aov=[\"depth\"]", "\"output\".\"aov\" = [\"depth\"]\n"),
            ("material.Leather*.roughness=0.5", "\"material\".\"Leather*\".\"roughness\" = 0.5\n"),
            ("material.'a.b=c'.ior=1.5", "\"material\".\"a.b=c\".\"ior\" = 1.5\n"),
            ("camera[1].yfov=30", "\"camera\".\"1\".\"yfov\" = 30\n"),
        ] {
            assert_eq!(line(change).as_deref(), Ok(wanted), "{change}");
        }
    }

    #[test]
    fn what_is_no_change_is_refused() {
        for wrong in ["", "render", "render.spp", "=3", "a..b=1", ".a=1", "a.=1", "\"a=1"] {
            let found = Overrides::parse(&[wrong]).unwrap_err();
            assert!(found.len() == 1 && found[0].cause == Cause::Usage, "{wrong}: {found:?}");
        }
        assert!(Overrides::parse(&["a.b=1", "a=1"]).is_err(), "a table and a number");
        assert!(Overrides::parse(&["a.b=1", "a.c=1"]).is_ok());
    }

    #[test]
    fn changes_are_tables() {
        let tables = Overrides::tables(&["render.spp=4", "nothing", "camera[1].yfov=30"]);
        assert_eq!(tables.len(), 2);
        assert_eq!(tables[0]["render"]["spp"].as_integer(), Some(4));
        assert_eq!(tables[1]["camera"]["1"]["yfov"].as_integer(), Some(30));
    }

    #[test]
    fn a_value_cannot_smuggle_lines() {
        let smuggled = line("a.b=1\nc = 2").unwrap();
        assert_eq!(DeTable::parse(&smuggled).unwrap().get_ref().len(), 1, "{smuggled}");
    }
}
