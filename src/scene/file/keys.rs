//! Reads a table key by key. Reading a key is what makes it known: whatever is left unread at the end is an unknown key,
//! so the readers are the one definition of the file's keys. Tables of several files and of the command line lie over each
//! other as layers and are read by the same readers.

use std::{
    collections::{BTreeMap, BTreeSet},
    ops::{Range, RangeBounds},
};

use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

use super::{
    report::{Complaint, advice},
    source::{Setting, Settings, Source},
    value::{flag, number},
};

type Entry<'a> = &'a Spanned<DeValue<'a>>;

/// A table of one source.
#[derive(Clone)]
struct Layer<'a> {
    source: &'a Source<'a>,
    span: Range<usize>,
    table: &'a DeTable<'a>,
}

impl<'a> Layer<'a> {
    fn entry(&self, key: &str) -> Option<Entry<'a>> {
        self.table.iter().find_map(|(name, value)| (name.get_ref() == key).then_some(value))
    }

    /// The table below, in the same source.
    fn below(&self, span: Range<usize>, table: &'a DeTable<'a>) -> Self {
        Self { source: self.source, span, table }
    }
}

/// One table, with the keys asked for so far.
pub(super) struct Keys<'a> {
    path: String,
    /// The first that says something counts. Never empty.
    layers: Vec<Layer<'a>>,
    settings: &'a Settings,
    known: Vec<String>,
}

impl<'a> Keys<'a> {
    /// A reader of whole documents, the first of which counts.
    pub fn new(sources: impl IntoIterator<Item = &'a Source<'a>>, settings: &'a Settings) -> Self {
        let layer = |source: &'a Source<'a>| Layer {
            source,
            span: source.document.span(),
            table: source.document.get_ref(),
        };
        let layers = sources.into_iter().map(layer).collect();
        Self { path: String::new(), layers, settings, known: Vec::new() }
    }

    fn below(&self, path: String, layers: Vec<Layer<'a>>) -> Self {
        Self { path, layers, settings: self.settings, known: Vec::new() }
    }

    /// Where a key is, in the file's own terms.
    fn element(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }

    /// Whether the table has this key; does not count as reading it.
    pub fn has(&self, key: &str) -> bool {
        self.find(key).is_some()
    }

    /// Whether the value of this key is a table; does not count as reading it.
    pub fn is_table(&self, key: &str) -> bool {
        self.find(key).is_some_and(|(_, value)| value.get_ref().is_table())
    }

    fn know(&mut self, key: &str) {
        if !self.is_known(key) {
            self.known.push(key.to_owned());
        }
    }

    fn is_known(&self, key: &str) -> bool {
        self.known.iter().any(|known| known == key)
    }

    /// The value that counts, and its layer.
    fn find(&self, key: &str) -> Option<(&Layer<'a>, Entry<'a>)> {
        self.layers.iter().find_map(|layer| Some((layer, layer.entry(key)?)))
    }

    /// Reports what is wrong with the value of `key`, or with the table where it is absent.
    pub fn complain(&self, key: &str, complaint: Complaint) {
        match self.find(key) {
            Some((layer, value)) => layer.source.error(&value.span(), self.element(key), complaint),
            None => self.complain_whole(self.element(key), complaint),
        }
    }

    /// Reports an error about the table, or about an element of it: in a file where there is one.
    fn complain_whole(&self, element: String, complaint: Complaint) {
        if let Some(layer) = self.whole() {
            layer.source.error(&layer.span, element, complaint);
        }
    }

    fn whole(&self) -> Option<&Layer<'a>> {
        self.layers.iter().find(|layer| !layer.source.is_command_line()).or(self.layers.first())
    }

    /// Reports that the table as such is wrong.
    pub fn reject(&self, complaint: Complaint) {
        self.complain_whole(self.path.clone(), complaint);
    }

    /// Warns about the table as such.
    pub fn warn(&self, message: &str) {
        if let Some(layer) = self.whole() {
            layer.source.warn(&layer.span, self.path.clone(), message);
        }
    }

    /// The value of `key` as `read` understands it; absent or, after a report, wrong: `None`.
    pub fn optional<T>(
        &mut self,
        key: &str,
        read: impl FnOnce(&DeValue<'_>) -> Result<T, Complaint>,
    ) -> Option<T> {
        self.optional_of(key, |value, _| read(value))
    }

    /// The same, where it matters who says it.
    pub fn optional_of<T>(
        &mut self,
        key: &str,
        read: impl FnOnce(&DeValue<'_>, &Source<'a>) -> Result<T, Complaint>,
    ) -> Option<T> {
        self.know(key);
        let (layer, value) = self.find(key)?;
        self.note(key, layer, value);
        read(value.get_ref(), layer.source).map_err(|complaint| self.complain(key, complaint)).ok()
    }

    /// The same, with a report where the key is absent.
    pub fn required<T>(
        &mut self,
        key: &str,
        read: impl FnOnce(&DeValue<'_>) -> Result<T, Complaint>,
    ) -> Option<T> {
        self.required_of(key, |value, _| read(value))
    }

    /// Both.
    pub fn required_of<T>(
        &mut self,
        key: &str,
        read: impl FnOnce(&DeValue<'_>, &Source<'a>) -> Result<T, Complaint>,
    ) -> Option<T> {
        if !self.has(key) {
            self.complain(key, Complaint::new("is missing"));
        }
        self.optional_of(key, read)
    }

    /// Remembers who set a value.
    fn note(&self, key: &str, layer: &Layer<'a>, value: Entry<'a>) {
        let said = self.layers.iter().filter(|layer| layer.entry(key).is_some());
        self.settings.borrow_mut().push(Setting {
            key: self.element(key),
            value: layer.source.written(value.span()),
            by: layer.source.name(),
            over: said.skip(1).map(|layer| layer.source.name()).collect(),
            place: layer.source.place(&value.span()),
        });
    }

    /// The table below `key`. A layer that says something else than a table overrules those below it.
    pub fn table(&mut self, key: &str) -> Option<Keys<'a>> {
        self.know(key);
        let mut layers = Vec::new();
        for (layer, value) in self.layers.iter().filter_map(|layer| Some((layer, layer.entry(key)?))) {
            match value.get_ref() {
                DeValue::Table(table) => layers.push(layer.below(value.span(), table)),
                other if layers.is_empty() => {
                    layer.source.error(&value.span(), self.element(key), not_a_table(key, other));
                    return None;
                }
                _ => break,
            }
        }
        (!layers.is_empty()).then(|| self.below(self.element(key), layers))
    }

    /// The tables of `[[key]]`, those of the lowest layer first. An item that has the name of one in a lower layer changes
    /// it, and `remove = true` takes it away. `name` tells what an item is called.
    pub fn tables(&mut self, key: &str, name: impl Fn(&DeTable<'_>) -> Option<String>) -> Vec<Keys<'a>> {
        self.know(key);
        let mut items: Vec<(Option<String>, Vec<Layer<'a>>)> = Vec::new();
        for layer in self.layers.iter().rev() {
            let Some(value) = layer.entry(key) else { continue };
            if layer.source.is_command_line() {
                self.change_items(key, layer, value, &mut items);
                continue;
            }
            let below = items.len();
            for item in self.items(key, layer, value) {
                let name = name(item.table);
                let same = items.iter_mut().take(below).find(|(known, _)| name.is_some() && *known == name);
                match same {
                    Some((_, layers)) => layers.insert(0, item),
                    None => items.push((name, vec![item])),
                }
            }
        }
        let keys = |(index, (_, layers))| self.below(format!("{}[{index}]", self.element(key)), layers);
        let mut found: Vec<_> = items.into_iter().enumerate().map(keys).collect();
        found.retain_mut(|item| !item.optional("remove", flag).unwrap_or(false));
        found
    }

    /// The changes of the command line to items of a list, each named by its name or its position.
    fn change_items(
        &self,
        key: &str,
        layer: &Layer<'a>,
        value: Entry<'a>,
        items: &mut [(Option<String>, Vec<Layer<'a>>)],
    ) {
        let is_no_table = || Complaint::new("is a list of tables: name one of them, and a key of it");
        let Some(changes) = value.get_ref().as_table() else {
            layer.source.error(&value.span(), self.element(key), is_no_table());
            return;
        };
        for (item, value) in changes {
            let item = item.get_ref().as_ref();
            let element = self.element(&format!("{key}.{item}"));
            let position = items
                .iter()
                .position(|(name, _)| name.as_deref() == Some(item))
                .or_else(|| item.parse().ok().filter(|&position| position < items.len()));
            let complaint = match (position, value.get_ref().as_table()) {
                (Some(position), Some(table)) => {
                    items[position].1.insert(0, layer.below(value.span(), table));
                    continue;
                }
                (Some(_), None) => is_no_table(),
                (None, _) => {
                    let names = items.iter().filter_map(|(name, _)| name.as_deref());
                    Complaint::new(format!("there is no such {key}")).hint(advice(item, names))
                }
            };
            layer.source.error(&value.span(), element, complaint);
        }
    }

    /// The tables of a layer below `[[key]]`.
    fn items(&self, key: &str, layer: &Layer<'a>, value: Entry<'a>) -> Vec<Layer<'a>> {
        let expected = |what: &str, found: &DeValue<'_>| {
            let complaint = Complaint::new(format!("expected {what}, found {}", found.type_str()));
            complaint.hint(Some(format!("write [[{key}]]")))
        };
        let DeValue::Array(items) = value.get_ref() else {
            let complaint = expected("a list of tables", value.get_ref());
            layer.source.error(&value.span(), self.element(key), complaint);
            return Vec::new();
        };
        let mut found = Vec::new();
        for (index, item) in items.iter().enumerate() {
            match item.get_ref() {
                DeValue::Table(table) => found.push(layer.below(item.span(), table)),
                other => {
                    let path = format!("{}[{index}]", self.element(key));
                    layer.source.error(&item.span(), path, expected("a table", other));
                }
            }
        }
        found
    }

    /// All tables below this one, whatever their names: those of the lowest layer first, each layer in its own order.
    pub fn named_tables(&self) -> Vec<(String, Keys<'a>)> {
        let mut found = Vec::new();
        for layer in self.layers.iter().rev() {
            let mut entries: Vec<_> = layer.table.iter().collect();
            entries.sort_by_key(|(name, _)| name.span().start);
            for (name, value) in entries {
                let name = name.get_ref();
                let path = format!("{}.\"{}\"", self.path, name.escape_debug());
                match value.get_ref() {
                    DeValue::Table(table) => {
                        found.push((
                            name.to_string(),
                            self.below(path, vec![layer.below(value.span(), table)]),
                        ));
                    }
                    other => layer.source.error(&value.span(), self.element(name), not_a_table(name, other)),
                }
            }
        }
        found
    }

    /// All numbers of this table, whatever their names.
    pub fn numbers_by_name(mut self, range: impl RangeBounds<f64> + Clone) -> BTreeMap<String, f64> {
        let names: BTreeSet<String> = self
            .layers
            .iter()
            .flat_map(|layer| layer.table)
            .map(|(name, _)| name.get_ref().to_string())
            .collect();
        let value = |name: String| Some((name.clone(), self.optional(&name, number(range.clone()))?));
        names.into_iter().filter_map(value).collect()
    }

    /// Reports all keys that nothing read.
    pub fn finish(self) {
        for layer in &self.layers {
            for (name, _) in layer.table {
                let name_of = name.get_ref().as_ref();
                if !self.is_known(name_of) {
                    let complaint = Complaint::new("unknown key")
                        .hint(advice(name_of, self.known.iter().map(String::as_str)));
                    layer.source.error(&name.span(), self.element(name_of), complaint);
                }
            }
        }
    }
}

fn not_a_table(key: &str, found: &DeValue<'_>) -> Complaint {
    let complaint = Complaint::new(format!("expected a table, found {}", found.type_str()));
    complaint.hint(Some(format!("write [{key}]")))
}
