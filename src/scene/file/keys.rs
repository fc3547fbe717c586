//! Reads a table key by key. Reading a key is what makes it known: whatever is left unread at the end is an unknown key,
//! so the readers are the one definition of the file's keys.

use std::ops::Range;

use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

use super::report::{Complaint, Report, advice};

/// One table, with the keys asked for so far.
pub(super) struct Keys<'a> {
    pub report: &'a Report<'a>,
    path: String,
    span: Range<usize>,
    table: &'a DeTable<'a>,
    known: Vec<String>,
}

impl<'a> Keys<'a> {
    /// A reader of `table`, whose key path is `path` (empty for the document).
    pub fn new(report: &'a Report<'a>, path: String, span: Range<usize>, table: &'a DeTable<'a>) -> Self {
        Self { report, path, span, table, known: Vec::new() }
    }

    /// Where a key is, in the file's own terms.
    fn element(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }

    /// Where the table starts.
    pub fn span(&self) -> Range<usize> {
        self.span.clone()
    }

    /// Key path of the table.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// Whether the table has this key; does not count as reading it.
    pub fn has(&self, key: &str) -> bool {
        self.find(key).is_some()
    }

    /// Whether the value of this key is a table; does not count as reading it.
    pub fn is_table(&self, key: &str) -> bool {
        self.find(key).is_some_and(|value| value.get_ref().is_table())
    }

    fn find(&self, key: &str) -> Option<&'a Spanned<DeValue<'a>>> {
        self.table.iter().find_map(|(name, value)| (name.get_ref() == key).then_some(value))
    }

    fn know(&mut self, key: &str) -> Option<&'a Spanned<DeValue<'a>>> {
        if !self.known.iter().any(|known| known == key) {
            self.known.push(key.to_owned());
        }
        self.find(key)
    }

    /// Reports what is wrong with the value of `key`, or with the table where it is absent.
    pub fn complain(&self, key: &str, complaint: Complaint) {
        let span = self.find(key).map_or(self.span(), Spanned::span);
        self.report.error(&span, self.element(key), complaint);
    }

    /// The value of `key` as `read` understands it; absent or, after a report, wrong: `None`.
    pub fn optional<T>(
        &mut self,
        key: &str,
        read: impl FnOnce(&DeValue<'_>) -> Result<T, Complaint>,
    ) -> Option<T> {
        let value = self.know(key)?;
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
        let value = self.know(key)?;
        match value.get_ref() {
            DeValue::Table(table) => Some(Keys::new(self.report, self.element(key), value.span(), table)),
            other => {
                let message = format!("expected a table, found {}", other.type_str());
                self.complain(key, Complaint::new(message).hint(Some(format!("write [{key}]"))));
                None
            }
        }
    }

    /// The tables of `[[key]]`.
    pub fn tables(&mut self, key: &str) -> Vec<Keys<'a>> {
        let Some(value) = self.know(key) else { return Vec::new() };
        let hint = || Some(format!("write [[{key}]]"));
        let DeValue::Array(items) = value.get_ref() else {
            let message = format!("expected a list of tables, found {}", value.get_ref().type_str());
            self.complain(key, Complaint::new(message).hint(hint()));
            return Vec::new();
        };
        let mut found = Vec::new();
        for (index, item) in items.iter().enumerate() {
            let path = format!("{}[{index}]", self.element(key));
            match item.get_ref() {
                DeValue::Table(table) => found.push(Keys::new(self.report, path, item.span(), table)),
                other => {
                    let message = format!("expected a table, found {}", other.type_str());
                    self.report.error(&item.span(), path, Complaint::new(message).hint(hint()));
                }
            }
        }
        found
    }

    /// All tables below this one, whatever their names, in the order of the file.
    pub fn named_tables(&mut self) -> Vec<(String, Keys<'a>)> {
        let mut entries: Vec<_> = self.table.iter().collect();
        entries.sort_by_key(|(name, _)| name.span().start);
        let mut found = Vec::new();
        for (name, _) in entries {
            let name = name.get_ref();
            if let Some(mut keys) = self.table(name) {
                keys.path = format!("{}.\"{}\"", self.path, name.escape_debug());
                found.push((name.to_string(), keys));
            }
        }
        found
    }

    /// Reports all keys that nothing read.
    pub fn finish(self) {
        for name in self.table.keys().filter(|name| !self.known.iter().any(|known| known == name.get_ref())) {
            let complaint = Complaint::new("unknown key")
                .hint(advice(name.get_ref(), self.known.iter().map(String::as_str)));
            self.report.error(&name.span(), self.element(name.get_ref()), complaint);
        }
    }
}
