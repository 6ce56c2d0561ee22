//! Reads and changes a settings file that may contain entries of a newer version. Unknown entries are kept.

use serde::Serialize;
use serde::de::DeserializeOwned;
use toml::{Table, Value};

/// Returns the part of `table` that can be read as a `T`, and the names of the other keys, such as `last_show.mood`.
pub(super) fn understood<T: DeserializeOwned + Default>(table: &Table) -> (T, Vec<String>) {
    if let Ok(all) = table.clone().try_into::<T>() {
        return (all, Vec::new());
    }
    let mut strange = Vec::new();
    let part = part_that(&|table: Table| table.try_into::<T>().is_ok(), "", table, &mut strange);
    (part.try_into().unwrap_or_default(), strange)
}

/// Returns the entries of `table` that `fits` accepts. If `fits` rejects an inner table, keeps the accepted entries of
/// that table. `path` is the key prefix of `table`.
fn part_that(fits: &dyn Fn(Table) -> bool, path: &str, table: &Table, strange: &mut Vec<String>) -> Table {
    let mut part = Table::new();
    for (key, value) in table {
        let path = format!("{path}{key}");
        let alone = |value: Value| fits([(key.clone(), value)].into_iter().collect());
        if alone(value.clone()) {
            part.insert(key.clone(), value.clone());
        } else if let Value::Table(inner) = value
            && alone(Value::Table(Table::new()))
        {
            let fits = |table| alone(Value::Table(table));
            let inner = part_that(&fits, &format!("{path}."), inner, strange);
            part.insert(key.clone(), Value::Table(inner));
        } else {
            strange.push(path);
        }
    }
    part
}

/// Applies the differences between `before` and `after` to `table`, without values that are the default. Fails if a
/// value cannot be serialized.
pub(super) fn rewrite<T: Serialize + Default>(
    table: &mut Table,
    before: &T,
    after: &T,
) -> Result<(), toml::ser::Error> {
    let default = Table::try_from(T::default())?;
    let chosen = |all: &T| Table::try_from(all).map(|all| beyond(&default, all));
    merge(table, &chosen(before)?, &chosen(after)?);
    Ok(())
}

/// Returns the entries of `table` that differ from those of `default`.
fn beyond(default: &Table, table: Table) -> Table {
    let differing = table.into_iter().filter(|(key, value)| default.get(key) != Some(value));
    let inner = |(key, value)| match (default.get(&key), value) {
        (Some(Value::Table(default)), Value::Table(table)) => (key, Value::Table(beyond(default, table))),
        (_, value) => (key, value),
    };
    differing.map(inner).collect()
}

fn merge(table: &mut Table, before: &Table, after: &Table) {
    for key in before.keys().filter(|key| !after.contains_key(*key)) {
        match (table.get_mut(key), before.get(key)) {
            // Keep unknown entries of a removed table.
            (Some(Value::Table(there)), Some(Value::Table(before))) => {
                merge(there, before, &Table::new());
                if there.is_empty() {
                    table.remove(key);
                }
            }
            _ => drop(table.remove(key)),
        }
    }
    for (key, value) in after.iter().filter(|(key, value)| before.get(*key) != Some(*value)) {
        match (table.get_mut(key), before.get(key), value) {
            (Some(Value::Table(there)), before, Value::Table(after)) => {
                let none = Table::new();
                merge(there, before.and_then(Value::as_table).unwrap_or(&none), after);
            }
            _ => drop(table.insert(key.clone(), value.clone())),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use serde::Deserialize;

    use super::*;

    #[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
    #[serde(default, deny_unknown_fields)]
    struct Inner {
        #[serde(skip_serializing_if = "Option::is_none")]
        size: Option<u8>,
        #[serde(skip_serializing_if = "BTreeMap::is_empty")]
        values: BTreeMap<String, f64>,
    }

    #[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
    #[serde(default, deny_unknown_fields)]
    struct Outer {
        #[serde(skip_serializing_if = "Option::is_none")]
        name: Option<String>,
        #[serde(skip_serializing_if = "Option::is_none")]
        inner: Option<Inner>,
    }

    const NEWER: &str = "name = \"a\"\nmood = \"blue\"\n[inner]\nsize = 3\nshape = [1, 2]\n\
                         [inner.values]\na = 1.5\nb = \"much\"\n[other]\nx = 1\n";

    fn read(text: &str) -> (Table, Outer, Vec<String>) {
        let table: Table = text.parse().unwrap();
        let (known, strange) = understood(&table);
        (table, known, strange)
    }

    #[test]
    fn known_entries_are_read_and_unknown_ones_named() {
        let (_, known, mut strange) = read(NEWER);
        assert_eq!(known.name.as_deref(), Some("a"));
        let inner = known.inner.unwrap();
        assert_eq!((inner.size, inner.values), (Some(3), [("a".to_owned(), 1.5)].into()));
        strange.sort();
        assert_eq!(strange, ["inner.shape", "inner.values.b", "mood", "other"]);
        let (_, known, strange) = read("name = 3\n[inner]\nsize = 4000\n");
        assert_eq!((known.name, known.inner), (None, Some(Inner::default())));
        assert_eq!(strange, ["inner.size", "name"]);
        assert_eq!(read("name = \"a\"").2, [""; 0]);
    }

    #[test]
    fn a_change_keeps_unknown_entries_and_removes_deleted_ones() {
        let (mut table, before, _) = read(NEWER);
        let mut after = before.clone();
        after.name = None;
        let inner = after.inner.as_mut().unwrap();
        (inner.size, inner.values) = (Some(5), [("b".to_owned(), 2.0)].into());
        rewrite(&mut table, &before, &after).unwrap();
        let expected =
            "mood = \"blue\"\n[inner]\nsize = 5\nshape = [1, 2]\n[inner.values]\nb = 2.0\n[other]\nx = 1\n";
        assert_eq!(table, expected.parse().unwrap());
        // Removing a table removes only the known entries.
        let (mut table, before, _) = read(NEWER);
        rewrite(&mut table, &before, &Outer::default()).unwrap();
        let expected =
            "mood = \"blue\"\n[inner]\nshape = [1, 2]\n[inner.values]\nb = \"much\"\n[other]\nx = 1\n";
        assert_eq!(table, expected.parse().unwrap());
        let (mut table, before, _) = read("");
        let inner = Some(Inner { size: Some(1), ..Inner::default() });
        rewrite(&mut table, &before, &Outer { inner, ..Outer::default() }).unwrap();
        assert_eq!(table, "[inner]\nsize = 1\n".parse().unwrap());
    }
}
