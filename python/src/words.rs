//! Dictionaries as the text of a file, and JSON as dictionaries.

use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyMapping, PyString};

use crate::error::argument;

/// So deep are no files.
const DEEPEST: usize = 8;

/// The text of a file that says what a dictionary says.
pub(crate) fn toml_of(name: &str, of: &Bound<'_, PyAny>) -> PyResult<String> {
    let value = value(name, of, 0)?;
    toml::to_string(&value).map_err(|error| {
        argument(
            of.py(),
            name,
            &error.to_string(),
            "it has the keys of the file: docs/reference.md",
        )
    })
}

fn value(path: &str, of: &Bound<'_, PyAny>, depth: usize) -> PyResult<toml::Value> {
    let refused = |what: &str| {
        argument(
            of.py(),
            path,
            what,
            "values are what TOML has: texts, numbers, lists and dictionaries of them",
        )
    };
    if depth > DEEPEST {
        return Err(refused("goes too deep"));
    }
    if of.is_instance_of::<PyBool>() {
        return Ok(toml::Value::Boolean(of.extract()?));
    }
    if of.is_instance_of::<PyInt>() {
        let number = of.extract::<i64>().map_err(|_| refused("is too large a number"))?;
        return Ok(toml::Value::Integer(number));
    }
    if of.is_instance_of::<PyFloat>() {
        return Ok(toml::Value::Float(of.extract()?));
    }
    if of.is_instance_of::<PyString>() {
        return Ok(toml::Value::String(of.extract()?));
    }
    if let Ok(mapping) = of.cast::<PyMapping>() {
        let mut table = toml::Table::new();
        for pair in mapping.items()? {
            let (key, inner): (Bound<'_, PyAny>, Bound<'_, PyAny>) = pair.extract()?;
            let key = key.extract::<String>().map_err(|_| refused("has a key that is no text"))?;
            // What is not given is left out.
            if !inner.is_none() {
                table.insert(key.clone(), value(&format!("{path}[{key:?}]"), &inner, depth + 1)?);
            }
        }
        return Ok(toml::Value::Table(table));
    }
    // A path, a day, an array or a number of `NumPy`, by what each says of itself.
    for method in ["__fspath__", "isoformat", "tolist"] {
        if of.hasattr(method)? {
            return value(path, &of.call_method0(method)?, depth + 1);
        }
    }
    let Ok(items) = of.try_iter() else {
        let kind = of.get_type().name()?;
        return Err(refused(&format!("is a {kind}")));
    };
    let items =
        items.enumerate().map(|(k, item)| value(&format!("{path}[{k}]"), &item?, depth + 1));
    Ok(toml::Value::Array(items.collect::<PyResult<_>>()?))
}

/// A dictionary of a text of JSON.
pub(crate) fn dictionary<'py>(py: Python<'py>, json: &str) -> PyResult<Bound<'py, PyDict>> {
    Ok(py.import("json")?.call_method1("loads", (json,))?.cast_into()?)
}
