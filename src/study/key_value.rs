//! A value that a key of a TOML file can have.

use std::fmt;
use std::ops::Deref;

use schemars::JsonSchema;
use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// The key under which TOML hands a date to `serde`.
const DATE: &str = "$__toml_private_datetime";

/// A text, a truth value, a finite number, or a list or section of these. It cannot hold `nan`, `inf`, a date or nothing, none of which a key of
/// a study can have, so that it can be written as TOML again.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(transparent)]
#[schemars(with = "Value")]
pub struct KeyValue(Value);

impl From<KeyValue> for Value {
    fn from(value: KeyValue) -> Self {
        value.0
    }
}

impl Deref for KeyValue {
    type Target = Value;

    fn deref(&self) -> &Value {
        &self.0
    }
}

impl<'de> Deserialize<'de> for KeyValue {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Holdable).map(Self)
    }
}

struct Holdable;

impl<'de> Visitor<'de> for Holdable {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a text, true or false, a finite number, or a list or section of these")
    }

    fn visit_bool<E: Error>(self, value: bool) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Value, E> {
        // TOML has no larger whole numbers
        i64::try_from(value)
            .map(Value::from)
            .map_err(|_| E::custom(format!("{value}: a whole number above 2^63 - 1")))
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Value, E> {
        match value.is_finite() {
            true => Ok(value.into()),
            false => Err(E::custom(format!("{value}: expected a finite number"))),
        }
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Value, A::Error> {
        let mut values = Vec::new();
        while let Some(KeyValue(value)) = items.next_element()? {
            values.push(value);
        }
        Ok(values.into())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Value, A::Error> {
        let mut section = Map::new();
        while let Some(key) = entries.next_key::<String>()? {
            if key == DATE {
                let date: String = entries.next_value()?;
                return Err(A::Error::custom(format!("{date}: a date, which no key has")));
            }
            let KeyValue(value) = entries.next_value()?;
            section.insert(key, value);
        }
        Ok(section.into())
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    /// Goal: what TOML or JSON has and no key can have is refused wherever it stands; what is taken can be written as TOML again.
    #[test]
    fn what_no_key_has_is_not_held() {
        let toml = |value: &str| toml::from_str::<BTreeMap<String, KeyValue>>(&format!("x = {value}\n"));
        let date = ["2020-01-01", "[0.2, 2020-01-01]", "{ a = 12:00:00 }"];
        for value in ["nan", "inf", "-inf", "[0.2, nan]", "{ a = [{ b = inf }] }"].into_iter().chain(date) {
            assert!(toml(value).is_err(), "{value}");
        }
        for value in ["null", "[null]", "18446744073709551615"] {
            assert!(serde_json::from_str::<KeyValue>(value).is_err(), "{value}");
        }
        for value in ["1", "-2.5", "\"a\"", "true", "[1, 2]", "{ a = [{ b = 1e308 }], c = [] }"] {
            let held = toml(value).unwrap();
            assert_eq!(
                toml::from_str::<BTreeMap<String, KeyValue>>(&toml::to_string(&held).unwrap()).unwrap(),
                held
            );
        }
    }
}
