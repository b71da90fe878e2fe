//! Results as JSON documents that name their schema.

use serde::Serialize;

/// JSON document that a command prints: SI values, units in the keys.
pub trait JsonDocument: Serialize {
    /// Name and number of the schema, such as `sinew/estimate/2`. The number increases if a key is removed or changes
    /// its meaning; a new key does not change it. `docs/schema/` contains the schemas.
    const SCHEMA: &'static str;

    /// Formats the document as indented JSON with a line end, its key `schema` first.
    ///
    /// # Errors
    /// Returns an error for a map key that JSON cannot represent.
    fn to_json(&self) -> Result<String, serde_json::Error> {
        #[derive(Serialize)]
        struct Named<'a, D: ?Sized> {
            schema: &'static str,
            #[serde(flatten)]
            document: &'a D,
        }
        let named = Named {
            schema: Self::SCHEMA,
            document: self,
        };
        Ok(serde_json::to_string_pretty(&named)? + "\n")
    }
}

/// Returns the `kind` of an internally tagged value in JSON, such as `few-poses`; empty without one.
pub fn json_kind<T: Serialize>(value: &T) -> String {
    let json = serde_json::to_value(value).ok();
    let kind = json.as_ref().and_then(|json| json.get("kind")?.as_str());
    kind.unwrap_or_default().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Serialize)]
    struct Length {
        length_m: f64,
    }

    impl JsonDocument for Length {
        const SCHEMA: &'static str = "sinew/length/1";
    }

    #[test]
    fn json_schema_is_first_key() {
        let text = Length { length_m: 0.1 }.to_json().unwrap();
        assert_eq!(
            text,
            "{\n  \"schema\": \"sinew/length/1\",\n  \"length_m\": 0.1\n}\n"
        );
    }
}
