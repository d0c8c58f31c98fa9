//! Checks a JSON value against the part of JSON Schema that this project's schemas use: `type`,
//! `properties`, `required`, `additionalProperties: false`, `items`, `enum`, `minItems`,
//! `minProperties`, `$ref` into `$defs`.

use serde_json::Value;

/// Everything that does not fit, as `place: what`.
pub(crate) fn misfits(schema: &Value, value: &Value) -> Vec<String> {
    let mut found = Vec::new();
    check(schema, schema, value, "$", &mut found);
    found
}

fn check(root: &Value, schema: &Value, value: &Value, place: &str, found: &mut Vec<String>) {
    if let Some(name) = schema["$ref"].as_str() {
        let target = name.trim_start_matches('#').to_owned();
        match root.pointer(&target) {
            Some(schema) => check(root, schema, value, place, found),
            None => found.push(format!("{place}: {name} is not in the schema")),
        }
        return;
    }
    let kinds: Vec<&str> = match &schema["type"] {
        Value::String(kind) => vec![kind],
        Value::Array(kinds) => kinds.iter().filter_map(Value::as_str).collect(),
        _ => Vec::new(),
    };
    let fits = |kind: &&str| match *kind {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        "integer" => value.is_u64() || value.is_i64(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        other => panic!("the checker does not know type {other}"),
    };
    if !kinds.is_empty() && !kinds.iter().any(fits) {
        found.push(format!("{place}: {value}, expected {}", kinds.join(" or ")));
        return;
    }
    if let Some(allowed) = schema["enum"].as_array()
        && !allowed.contains(value)
    {
        found.push(format!("{place}: {value} is none of {}", schema["enum"]));
    }
    if let Some(object) = value.as_object() {
        if (object.len() as u64) < schema["minProperties"].as_u64().unwrap_or(0) {
            found.push(format!("{place}: only {} properties", object.len()));
        }
        for name in schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str) {
            if !object.contains_key(name) {
                found.push(format!("{place}: {name} is missing"));
            }
        }
        for (name, value) in object {
            let place = format!("{place}.{name}");
            match schema["properties"].get(name) {
                Some(schema) => check(root, schema, value, &place, found),
                None if schema["additionalProperties"] == Value::Bool(false) => {
                    found.push(format!("{place}: not in the schema"));
                }
                None => {}
            }
        }
    }
    if let Some(items) = value.as_array() {
        if (items.len() as u64) < schema["minItems"].as_u64().unwrap_or(0) {
            found.push(format!("{place}: only {} items", items.len()));
        }
        for (index, item) in items.iter().enumerate() {
            if !schema["items"].is_null() {
                check(root, &schema["items"], item, &format!("{place}[{index}]"), found);
            }
        }
    }
}
