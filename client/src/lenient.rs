//! Reads replies of newer servers: a field that this client does not know is passed over.
//!
//! The generated readers refuse unknown fields, which is right for requests. They do name the fields that they know
//! when they ask for a struct, so a reader underneath can leave the others out.

use serde::{
    Deserializer,
    de::{DeserializeOwned, DeserializeSeed, MapAccess, SeqAccess, Visitor, value::StrDeserializer},
    forward_to_deserialize_any,
};
use serde_json::{Error, Map, Value};

/// Reads a message, unknown fields or not.
pub(crate) fn from_slice<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, Error> {
    match serde_json::from_slice(bytes) {
        Ok(message) => Ok(message),
        Err(error) if error.is_data() => T::deserialize(Lenient(serde_json::from_slice(bytes)?)),
        Err(error) => Err(error),
    }
}

struct Lenient(Value);

impl<'de> Deserializer<'de> for Lenient {
    type Error = Error;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.0 {
            Value::Array(items) => visitor.visit_seq(Items(items.into_iter())),
            Value::Object(fields) => visitor.visit_map(Fields::of(fields, |_| true)),
            scalar => scalar.deserialize_any(visitor),
        }
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        known: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        match self.0 {
            Value::Object(fields) => visitor.visit_map(Fields::of(fields, |name| known.contains(&name))),
            other => Self(other).deserialize_any(visitor),
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.0 {
            Value::Null => visitor.visit_none(),
            other => visitor.visit_some(Self(other)),
        }
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf unit unit_struct
        newtype_struct seq tuple tuple_struct map enum identifier ignored_any
    }
}

struct Items(std::vec::IntoIter<Value>);

impl<'de> SeqAccess<'de> for Items {
    type Error = Error;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, Error> {
        self.0.next().map(|item| seed.deserialize(Lenient(item))).transpose()
    }
}

struct Fields {
    rest: std::vec::IntoIter<(String, Value)>,
    value: Option<Value>,
}

impl Fields {
    fn of(fields: Map<String, Value>, keep: impl Fn(&str) -> bool) -> Self {
        let kept: Vec<_> = fields.into_iter().filter(|(name, _)| keep(name)).collect();
        Self {
            rest: kept.into_iter(),
            value: None,
        }
    }
}

impl<'de> MapAccess<'de> for Fields {
    type Error = Error;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, Error> {
        let Some((name, value)) = self.rest.next() else {
            return Ok(None);
        };
        self.value = Some(value);
        seed.deserialize(StrDeserializer::new(&name)).map(Some)
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, Error> {
        seed.deserialize(Lenient(self.value.take().unwrap_or(Value::Null)))
    }
}

#[cfg(test)]
mod tests {
    use takt_proto::v1;

    use super::*;

    #[test]
    fn fields_of_a_newer_server_are_passed_over() {
        let reply: v1::PlanMoveResponse = from_slice(
            br#"{"plan": {"duration_s": 1.25, "energy_j": {"total": 7}, "method": "VERIFIED",
                 "setpoints": {"time_s": [0, 0.5], "colour": "red"}},
                "provenance": {"revision": "r", "planet": "Mars"}, "hints": [1]}"#,
        )
        .unwrap();
        let Some(v1::plan_move_response::Outcome::Plan(plan)) = reply.outcome else {
            panic!("no plan");
        };
        assert_eq!(plan.method(), v1::Method::Verified);
        assert_eq!(plan.setpoints.unwrap().time_s, [0.0, 0.5]);
        assert_eq!(reply.provenance.unwrap().revision, "r");
    }

    #[test]
    fn what_is_wrong_stays_wrong() {
        assert!(from_slice::<v1::PlanMoveResponse>(br#"{"plan": {"duration_s": "long"}}"#).is_err());
        assert!(from_slice::<v1::PlanMoveResponse>(b"{").is_err());
    }
}
