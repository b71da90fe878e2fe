//! Schemas of requests and responses for the OpenAPI description.

use schemars::JsonSchema;
use schemars::generate::{SchemaGenerator, SchemaSettings};
use serde_json::{Value, json};

/// Schemas of one endpoint.
#[derive(Default)]
pub(super) struct Described {
    pub(super) query: Option<Value>,
    pub(super) body: Option<Value>,
    pub(super) gives: Value,
}

/// Request without a body.
pub(super) struct EmptyBody;

impl JsonSchema for EmptyBody {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "EmptyBody".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({ "type": "object" })
    }
}

/// Generator of the schemas of responses, and of requests: the latter without references, as a type may differ when
/// read.
pub(super) struct Maker {
    pub(super) gives: SchemaGenerator,
    takes: SchemaGenerator,
}

impl Maker {
    pub(super) fn new() -> Self {
        Self {
            gives: SchemaSettings::draft2020_12()
                .for_serialize()
                .with(|settings| {
                    settings.definitions_path = "/components/schemas".into();
                    settings.meta_schema = None;
                })
                .into_generator(),
            takes: SchemaSettings::draft2020_12()
                .for_deserialize()
                .with(|settings| {
                    settings.inline_subschemas = true;
                    settings.meta_schema = None;
                })
                .into_generator(),
        }
    }

    /// Describes a JSON response.
    pub(super) fn json<T: JsonSchema>(&mut self) -> Described {
        let schema = self.gives.subschema_for::<T>();
        Described {
            gives: json!({ "application/json": { "schema": schema } }),
            ..Described::default()
        }
    }

    /// Describes a response of another media type.
    pub(super) fn media(&self, kind: &str) -> Described {
        Described {
            gives: json!({ kind: {} }),
            ..Described::default()
        }
    }

    pub(super) fn takes<T: JsonSchema>(&mut self) -> Option<Value> {
        Some(self.takes.subschema_for::<T>().to_value())
    }
}
