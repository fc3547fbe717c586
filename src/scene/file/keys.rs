//! Reads a table key by key. Reading a key is what makes it known: whatever is left unread at the end is an unknown key,
//! so the readers are the one definition of the file's keys. Changes from the command line lie over the file's tables and
//! are read by the same readers.

use std::{
    collections::BTreeMap,
    ops::{Range, RangeBounds},
};

use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

use super::{
    report::{Complaint, Report, advice},
    value::number,
};
use crate::Diagnostic;

type Entry<'a> = &'a Spanned<DeValue<'a>>;

/// One table, with the keys asked for so far.
pub(super) struct Keys<'a> {
    pub report: &'a Report<'a>,
    path: String,
    span: Range<usize>,
    /// What the file says.
    table: Option<&'a DeTable<'a>>,
    /// What the command line says; it goes first.
    changes: Option<&'a DeTable<'a>>,
    known: Vec<String>,
}

/// The entry of `key`.
fn entry<'a>(table: Option<&'a DeTable<'a>>, key: &str) -> Option<Entry<'a>> {
    table?.iter().find_map(|(name, value)| (name.get_ref() == key).then_some(value))
}

impl<'a> Keys<'a> {
    /// A reader of a whole document, absent where there is no file, below changes.
    pub fn new(
        report: &'a Report<'a>,
        document: Option<&'a Spanned<DeTable<'a>>>,
        changes: &'a DeTable<'a>,
    ) -> Self {
        let span = document.map_or(0..0, Spanned::span);
        let table = document.map(Spanned::get_ref);
        Self { report, path: String::new(), span, table, changes: Some(changes), known: Vec::new() }
    }

    fn below(
        &self,
        path: String,
        span: Range<usize>,
        table: Option<&'a DeTable<'a>>,
        changes: Option<&'a DeTable<'a>>,
    ) -> Self {
        Self { report: self.report, path, span, table, changes, known: Vec::new() }
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
        self.find(key).is_some_and(|value| value.get_ref().is_table())
    }

    fn find(&self, key: &str) -> Option<Entry<'a>> {
        entry(self.changes, key).or_else(|| entry(self.table, key))
    }

    fn know(&mut self, key: &str) {
        if !self.known.iter().any(|known| known == key) {
            self.known.push(key.to_owned());
        }
    }

    /// Reports what is wrong with the value of `key`, or with the table where it is absent.
    pub fn complain(&self, key: &str, complaint: Complaint) {
        let changed = entry(self.changes, key).is_some();
        match entry(self.table, key).filter(|_| !changed) {
            Some(value) => self.report.error(&value.span(), self.element(key), complaint),
            None if changed => self.report.usage(&self.element(key), complaint),
            None => self.complain_whole(self.element(key), complaint),
        }
    }

    /// Reports an error about the table, or about an element of it.
    fn complain_whole(&self, element: String, complaint: Complaint) {
        match self.table {
            Some(_) => self.report.error(&self.span, element, complaint),
            None => self.report.usage(&element, complaint),
        }
    }

    /// Reports that the table as such is wrong.
    pub fn reject(&self, complaint: Complaint) {
        self.complain_whole(self.path.clone(), complaint);
    }

    /// Warns about the table as such.
    pub fn warn(&self, message: &str) {
        let warning = Diagnostic::warning(message).element(self.path.clone());
        match self.table {
            Some(_) => self.report.push(&self.span, warning),
            None => self.report.push_elsewhere(warning),
        }
    }

    /// The value of `key` as `read` understands it; absent or, after a report, wrong: `None`.
    pub fn optional<T>(
        &mut self,
        key: &str,
        read: impl FnOnce(&DeValue<'_>) -> Result<T, Complaint>,
    ) -> Option<T> {
        self.know(key);
        let value = self.find(key)?;
        read(value.get_ref()).map_err(|complaint| self.complain(key, complaint)).ok()
    }

    /// The same, with a report where the key is absent.
    pub fn required<T>(
        &mut self,
        key: &str,
        read: impl FnOnce(&DeValue<'_>) -> Result<T, Complaint>,
    ) -> Option<T> {
        if !self.has(key) {
            self.complain(key, Complaint::new("is missing"));
        }
        self.optional(key, read)
    }

    /// The table below `key`.
    pub fn table(&mut self, key: &str) -> Option<Keys<'a>> {
        self.know(key);
        let (file, changes) = (entry(self.table, key), entry(self.changes, key));
        let table = |value: Entry<'a>| match value.get_ref() {
            DeValue::Table(table) => Some(table),
            other => {
                let complaint = Complaint::new(format!("expected a table, found {}", other.type_str()));
                self.complain(key, complaint.hint(Some(format!("write [{key}]"))));
                None
            }
        };
        let found = (file.and_then(table), changes.and_then(table));
        let span = file.map_or(self.span.clone(), Spanned::span);
        (found.0.is_some() || found.1.is_some())
            .then(|| self.below(self.element(key), span, found.0, found.1))
    }

    /// The tables of `[[key]]`. `name` tells what an item is called by changes.
    pub fn tables(&mut self, key: &str, name: impl Fn(&DeTable<'_>) -> Option<String>) -> Vec<Keys<'a>> {
        self.know(key);
        let items = self.items(key);
        let names: Vec<_> = items.iter().map(|(_, _, table)| name(table)).collect();
        let mut changes = self.changes_of_items(key, &names);
        let below = |(index, span, table)| {
            let path = format!("{}[{index}]", self.element(key));
            self.below(path, span, Some(table), changes.remove(&index))
        };
        items.into_iter().map(below).collect()
    }

    /// The changes to items of a list, by position; an item is named by its name or its position.
    fn changes_of_items(&self, key: &str, names: &[Option<String>]) -> BTreeMap<usize, &'a DeTable<'a>> {
        let mut found = BTreeMap::new();
        let Some(changes) = entry(self.changes, key) else { return found };
        let is_no_table = || Complaint::new("is a list of tables: name one of them, and a key of it");
        let Some(changes) = changes.get_ref().as_table() else {
            self.report.usage(&self.element(key), is_no_table());
            return found;
        };
        for (item, value) in changes {
            let item = item.get_ref().as_ref();
            let element = self.element(&format!("{key}.{item}"));
            let position = names
                .iter()
                .position(|name| name.as_deref() == Some(item))
                .or_else(|| item.parse().ok().filter(|&position| position < names.len()));
            match (position, value.get_ref().as_table()) {
                (Some(position), Some(table)) => drop(found.insert(position, table)),
                (Some(_), None) => self.report.usage(&element, is_no_table()),
                (None, _) => {
                    let hint = advice(item, names.iter().flatten().map(String::as_str));
                    self.report.usage(&element, Complaint::new(format!("there is no such {key}")).hint(hint));
                }
            }
        }
        found
    }

    /// The file's tables below `[[key]]` with their positions.
    fn items(&self, key: &str) -> Vec<(usize, Range<usize>, &'a DeTable<'a>)> {
        let hint = || Some(format!("write [[{key}]]"));
        let expected = |what: &str, found: &DeValue<'_>| {
            Complaint::new(format!("expected {what}, found {}", found.type_str())).hint(hint())
        };
        let Some(value) = entry(self.table, key) else { return Vec::new() };
        let DeValue::Array(items) = value.get_ref() else {
            self.report.error(
                &value.span(),
                self.element(key),
                expected("a list of tables", value.get_ref()),
            );
            return Vec::new();
        };
        let mut found = Vec::new();
        for (index, item) in items.iter().enumerate() {
            match item.get_ref() {
                DeValue::Table(table) => found.push((index, item.span(), table)),
                other => {
                    let path = format!("{}[{index}]", self.element(key));
                    self.report.error(&item.span(), path, expected("a table", other));
                }
            }
        }
        found
    }

    /// All tables below this one, whatever their names, in the order of the file; those of the command line come last.
    pub fn named_tables(&mut self) -> Vec<(String, Keys<'a>)> {
        let mut found = Vec::new();
        for (table, changes) in [(self.table, None), (None, self.changes)] {
            let mut layer = self.below(self.path.clone(), self.span.clone(), table, changes);
            let mut entries: Vec<_> = table.or(changes).into_iter().flatten().collect();
            entries.sort_by_key(|(name, _)| name.span().start);
            for (name, _) in entries {
                let name = name.get_ref();
                self.know(name);
                if let Some(mut keys) = layer.table(name) {
                    keys.path = format!("{}.\"{}\"", self.path, name.escape_debug());
                    found.push((name.to_string(), keys));
                }
            }
        }
        found
    }

    /// All numbers of this table, whatever their names.
    pub fn numbers_by_name(mut self, range: impl RangeBounds<f64> + Clone) -> BTreeMap<String, f64> {
        let names: Vec<String> = [self.table, self.changes]
            .into_iter()
            .flatten()
            .flatten()
            .map(|(name, _)| name.get_ref().to_string())
            .collect();
        let value = |name: String| Some((name.clone(), self.optional(&name, number(range.clone()))?));
        names.into_iter().filter_map(value).collect()
    }

    /// Reports all keys that nothing read.
    pub fn finish(self) {
        let unknown = |table: Option<&'a DeTable<'a>>| {
            table
                .into_iter()
                .flatten()
                .map(|(name, _)| name)
                .filter(|name| !self.known.iter().any(|it| it == name.get_ref()))
        };
        let complaint = |name: &str| {
            Complaint::new("unknown key").hint(advice(name, self.known.iter().map(String::as_str)))
        };
        for name in unknown(self.table) {
            self.report.error(&name.span(), self.element(name.get_ref()), complaint(name.get_ref()));
        }
        for name in unknown(self.changes) {
            self.report.usage(&self.element(name.get_ref()), complaint(name.get_ref()));
        }
    }
}
