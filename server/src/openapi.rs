//! The OpenAPI document, made from the schema: its comments are the descriptions.

mod examples;
mod schema;

use std::sync::LazyLock;

use prost::Message;
use prost_types::FileDescriptorSet;
use serde_json::{Map, Value, json};
use takt_proto::{
    DESCRIPTOR,
    route::{HttpMethod, JSON_LINES, ROUTES, Route, Rpc},
};

use self::schema::{Schema, reference};

static DOCUMENT: LazyLock<String> = LazyLock::new(|| {
    // The descriptor is built in, and the tests read it.
    let files = FileDescriptorSet::decode(DESCRIPTOR).unwrap_or_default();
    let document = build(&files);
    serde_json::to_string(&document).unwrap_or_default()
});

/// The OpenAPI 3.1 document of the HTTP side, as JSON.
#[must_use]
pub fn document() -> &'static str {
    &DOCUMENT
}

fn build(files: &FileDescriptorSet) -> Value {
    let schema = Schema::of(files);
    let mut paths = Map::new();
    for route in ROUTES {
        let operations = paths.entry(route.path).or_insert_with(|| json!({}));
        operations[route.method.as_str().to_ascii_lowercase()] = operation(route, &schema);
    }
    for (path, summary, kind) in PAGES {
        paths.insert(path.to_owned(), page(path, summary, kind));
    }
    let mut schemas = schema.components();
    schemas.insert("Error".to_owned(), error_schema());
    json!({
        "openapi": "3.1.0",
        "info": {
            "title": "Takt",
            "version": crate::VERSION,
            "summary": "Motion planning for robot arms under torque limits",
            "description": DESCRIPTION,
            "license": {"name": "MIT OR Apache-2.0"},
        },
        "tags": schema.tags(),
        "paths": paths,
        "components": {"schemas": schemas, "responses": {"Error": error_response()}},
    })
}

const DESCRIPTION: &str = "Register an arm once, then ask for motions: every plan carries the torque margins that prove \
     it. The same messages travel over gRPC on the same port. Numbers are SI units and radians, finite always; unknown \
     fields are refused; camelCase names are accepted. `Request-Timeout` (seconds) says how long the caller will wait; \
     `X-Request-Id` comes back as it was sent; `Server-Timing` says how long the request waited and was computed.";

/// Paths that are no RPC.
const PAGES: [(&str, &str, &str); 4] = [
    ("/healthz", "The process lives", "text/plain"),
    (
        "/readyz",
        "The service takes requests; 503 while it stops",
        "text/plain",
    ),
    ("/openapi.json", "This document", "application/json"),
    ("/docs", "This document to read and to try", "text/html"),
];

fn page(path: &str, summary: &str, kind: &str) -> Value {
    let mut responses = json!({"200": {"description": "yes", "content": {kind: {}}}});
    if path == "/readyz" {
        responses["503"] = json!({"description": "no", "content": {kind: {}}});
    }
    let id = path.trim_start_matches('/').replace(".json", "");
    json!({"get": {"operationId": id, "summary": summary, "tags": ["Operations"], "responses": responses}})
}

fn operation(route: &Route, schema: &Schema<'_>) -> Value {
    let method = schema.method(route);
    let mut parameters = Vec::new();
    if route.path.contains("{robot_id}") {
        parameters.push(json!({
            "name": "robot_id", "in": "path", "required": true,
            "schema": {"type": "string", "pattern": "^[a-z0-9][a-z0-9._-]{0,62}$"}, "example": "ur5e",
        }));
    }
    if !route.method.has_body() {
        parameters.extend(schema.query(&method.input));
    }
    parameters.extend(headers(route));
    let mut operation = json!({
        "operationId": route.rpc.name(),
        "summary": method.summary,
        "tags": [method.service],
        "parameters": parameters,
        "responses": responses(route, &method.output),
    });
    if let Some(text) = method.description {
        operation["description"] = text.into();
    }
    if route.method.has_body() {
        let kind = kind(route.rpc.takes_stream());
        operation["requestBody"] = json!({"required": true, "content": {kind: {
            "schema": reference(&method.input), "example": examples::request(route.rpc),
        }}});
    }
    operation
}

/// A stream has one document of its schema a line.
fn kind(is_stream: bool) -> &'static str {
    if is_stream { JSON_LINES } else { "application/json" }
}

fn headers(route: &Route) -> Vec<Value> {
    let header = |name: &str, description: &str| json!({"name": name, "in": "header", "description": description, "schema": {"type": "string"}});
    let mut headers = vec![header("Request-Timeout", "Seconds that the caller will wait.")];
    match route.rpc {
        Rpc::RegisterRobot | Rpc::DeleteRobot => headers.push(header(
            "If-Match",
            "The revision that must be current, in double quotes: the same as `expected_revision`.",
        )),
        Rpc::GetRobot => headers.push(header(
            "If-None-Match",
            "Revisions in double quotes: 304 where one of them is the answer.",
        )),
        _ => {}
    }
    headers
}

fn responses(route: &Route, output: &str) -> Value {
    let (kind, description) = match route.rpc.gives_stream() {
        true => (
            kind(true),
            "The answers, one a line; an error after the first line is a line of the form of Error",
        ),
        false => (kind(false), "The answer"),
    };
    let mut found = json!({"description": description, "content": {kind: {"schema": reference(output)}}});
    if matches!(route.rpc, Rpc::RegisterRobot | Rpc::GetRobot) {
        found["headers"] =
            json!({"ETag": {"description": "The revision, in double quotes", "schema": {"type": "string"}}});
    }
    let mut responses = json!({"200": found, "default": {"$ref": "#/components/responses/Error"}});
    if route.rpc == Rpc::GetRobot {
        responses["304"] = json!({"description": "The caller has this revision already"});
    }
    if route.method == HttpMethod::Put {
        responses["409"] = json!({"$ref": "#/components/responses/Error"});
    }
    responses
}

fn error_response() -> Value {
    json!({
        "description": "The request is wrong, or the service could not. A motion that cannot be is an answer, not an error.",
        "content": {"application/json": {"schema": {"$ref": "#/components/schemas/Error"}}},
    })
}

fn error_schema() -> Value {
    let rows = takt_proto::error::TABLE.iter();
    let mut names: Vec<_> = rows.map(|row| row.name).collect();
    names.dedup();
    json!({
        "type": "object",
        "description": "The JSON of google.rpc.Status",
        "required": ["error"],
        "properties": {"error": {
            "type": "object",
            "required": ["code", "status", "message", "details"],
            "properties": {
                "code": {"type": "integer", "description": "The gRPC status code"},
                "status": {"type": "string", "enum": names},
                "message": {"type": "string"},
                "details": {"type": "array", "description": "google.rpc.BadRequest with the violations, RetryInfo, ErrorInfo", "items": {
                    "type": "object", "required": ["@type"], "properties": {
                        "@type": {"type": "string"},
                        "field_violations": {"type": "array", "items": {"type": "object", "properties": {
                            "field": {"type": "string"}, "description": {"type": "string"},
                        }}},
                        "retry_delay": {"type": "string"},
                        "reason": {"type": "string"},
                        "domain": {"type": "string"},
                        "metadata": {"type": "object", "additionalProperties": {"type": "string"}},
                    },
                }},
            },
        }},
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_route_and_every_reference_is_there() {
        let document: Value = serde_json::from_str(document()).unwrap();
        for route in ROUTES {
            let operation = &document["paths"][route.path][route.method.as_str().to_ascii_lowercase()];
            assert_eq!(operation["operationId"], route.rpc.name());
            assert!(
                operation["summary"].as_str().is_some_and(|text| !text.is_empty()),
                "{route:?}"
            );
        }
        let text = document.to_string();
        for part in text.split("\"$ref\":\"#/components/schemas/").skip(1) {
            let name = part.split('"').next().unwrap();
            assert!(document["components"]["schemas"][name].is_object(), "{name}");
        }
    }

    #[test]
    fn examples_can_be_read() {
        for route in ROUTES.iter().filter(|route| route.method.has_body()) {
            let example = examples::request(route.rpc).to_string();
            assert!(examples::reads(route.rpc, &example), "{route:?}");
        }
    }
}
