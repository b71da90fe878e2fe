//! A result as a JSON document that says by which schema to read it.

use serde::Serialize;

/// What a command prints as JSON: SI values, units in the keys.
pub trait JsonDocument: Serialize {
    /// Name and number of the schema, such as `sinew/estimate/1`. The number rises when a key goes
    /// or changes its meaning; a new key does not raise it. `docs/schema/` has the schemas.
    const SCHEMA: &'static str;

    /// The document as indented JSON with a line end, its key `schema` first.
    ///
    /// # Errors
    /// A key of a map that JSON can't hold.
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
    fn the_schema_stands_first() {
        let text = Length { length_m: 0.1 }.to_json().unwrap();
        assert_eq!(
            text,
            "{\n  \"schema\": \"sinew/length/1\",\n  \"length_m\": 0.1\n}\n"
        );
    }
}
