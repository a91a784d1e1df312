//! JSON schemas of the messages, as the JSON mapping of protobuf has them.

use std::collections::HashMap;

use prost_types::{
    DescriptorProto, EnumDescriptorProto, FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet,
    field_descriptor_proto::{Label, Type},
};
use serde_json::{Map, Value, json};
use takt_proto::route::Route;

const PACKAGE: &str = "takt.v1";

/// Field numbers of descriptors, from which the paths of comments are made.
mod number {
    pub(super) const FILE_MESSAGE: i32 = 4;
    pub(super) const FILE_ENUM: i32 = 5;
    pub(super) const FILE_SERVICE: i32 = 6;
    pub(super) const MESSAGE_FIELD: i32 = 2;
    pub(super) const MESSAGE_NESTED: i32 = 3;
    pub(super) const MESSAGE_ENUM: i32 = 4;
    pub(super) const ENUM_VALUE: i32 = 2;
    pub(super) const SERVICE_METHOD: i32 = 2;
}

/// The messages of our package.
pub(super) struct Schema<'a> {
    files: Vec<File<'a>>,
}

struct File<'a> {
    descriptor: &'a FileDescriptorProto,
    comments: HashMap<&'a [i32], &'a str>,
}

/// One RPC, as its operation needs it.
pub(super) struct Method {
    pub(super) service: String,
    pub(super) summary: String,
    pub(super) description: Option<String>,
    /// Names of components.
    pub(super) input: String,
    pub(super) output: String,
}

/// A reference to a component.
pub(super) fn reference(name: &str) -> Value {
    json!({"$ref": format!("#/components/schemas/{name}")})
}

impl<'a> Schema<'a> {
    pub(super) fn of(files: &'a FileDescriptorSet) -> Self {
        let ours = files.file.iter().filter(|file| file.package() == PACKAGE);
        let files = ours.map(|descriptor| {
            let locations = descriptor.source_code_info.iter().flat_map(|info| &info.location);
            let comments = locations
                .filter_map(|location| Some((location.path.as_slice(), location.leading_comments.as_deref()?)));
            File {
                descriptor,
                comments: comments.collect(),
            }
        });
        Self { files: files.collect() }
    }

    /// Every message and enum.
    pub(super) fn components(&self) -> Map<String, Value> {
        let mut components = Map::new();
        for file in &self.files {
            for (index, message) in enumerated(&file.descriptor.message_type) {
                file.add_message(&mut components, "", message, &[number::FILE_MESSAGE, index]);
            }
            for (index, list) in enumerated(&file.descriptor.enum_type) {
                file.add_enum(&mut components, "", list, &[number::FILE_ENUM, index]);
            }
        }
        components
    }

    /// The services.
    pub(super) fn tags(&self) -> Value {
        let mut tags = vec![];
        for file in &self.files {
            for (index, service) in enumerated(&file.descriptor.service) {
                let text = file.comment(&[number::FILE_SERVICE, index]);
                tags.push(json!({"name": service.name(), "description": text}));
            }
        }
        tags.push(json!({"name": "Operations", "description": "For those who run the service."}));
        tags.into()
    }

    pub(super) fn method(&self, route: &Route) -> Method {
        let mut found = Method {
            service: String::new(),
            summary: String::new(),
            description: None,
            input: String::new(),
            output: String::new(),
        };
        for file in &self.files {
            for (index, service) in enumerated(&file.descriptor.service) {
                let methods = enumerated(&service.method).filter(|(_, method)| method.name() == route.rpc.name());
                for (place, method) in methods {
                    let text = file.comment(&[number::FILE_SERVICE, index, number::SERVICE_METHOD, place]);
                    let (summary, description) = summarized(&text);
                    found.service = service.name().to_owned();
                    found.summary = if summary.is_empty() {
                        method.name().to_owned()
                    } else {
                        summary
                    };
                    found.description = description;
                    found.input = component_name(method.input_type());
                    found.output = component_name(method.output_type());
                }
            }
        }
        found
    }

    /// The fields of a message as parameters of a query, but for the robot's id.
    pub(super) fn query(&self, message: &str) -> Vec<Value> {
        let mut parameters = Vec::new();
        for file in &self.files {
            let messages = enumerated(&file.descriptor.message_type);
            for (index, message) in messages.filter(|(_, found)| found.name() == message) {
                for (place, field) in enumerated(&message.field).filter(|(_, field)| field.name() != "robot_id") {
                    let path = [number::FILE_MESSAGE, index, number::MESSAGE_FIELD, place];
                    let text = file.comment(&path);
                    parameters.push(json!({
                        "name": field.name(), "in": "query", "description": text, "schema": kind(field),
                    }));
                }
            }
        }
        parameters
    }
}

impl File<'_> {
    /// A comment as one paragraph after the other.
    fn comment(&self, path: &[i32]) -> String {
        let text = self.comments.get(path).copied().unwrap_or("");
        let paragraphs = text.split("\n\n").map(|paragraph| {
            let lines = paragraph.lines().map(str::trim);
            lines.collect::<Vec<_>>().join(" ").trim().to_owned()
        });
        paragraphs.collect::<Vec<_>>().join("\n\n")
    }

    fn add_message(&self, components: &mut Map<String, Value>, parent: &str, message: &DescriptorProto, path: &[i32]) {
        let name = format!("{parent}{}", message.name());
        let mut properties = Map::new();
        for (index, field) in enumerated(&message.field) {
            let text = self.comment(&[path, &[number::MESSAGE_FIELD, index]].concat());
            properties.insert(field.name().to_owned(), described(kind(field), text));
        }
        let schema = json!({"type": "object", "properties": properties, "additionalProperties": false});
        components.insert(name.clone(), described(schema, self.comment(path)));
        let parent = format!("{name}.");
        for (index, nested) in enumerated(&message.nested_type) {
            self.add_message(
                components,
                &parent,
                nested,
                &[path, &[number::MESSAGE_NESTED, index]].concat(),
            );
        }
        for (index, nested) in enumerated(&message.enum_type) {
            self.add_enum(
                components,
                &parent,
                nested,
                &[path, &[number::MESSAGE_ENUM, index]].concat(),
            );
        }
    }

    /// The names, without the one that says nothing: it is refused.
    fn add_enum(&self, components: &mut Map<String, Value>, parent: &str, list: &EnumDescriptorProto, path: &[i32]) {
        let mut names = Vec::new();
        let mut text = self.comment(path);
        for (index, value) in enumerated(&list.value).filter(|(_, value)| value.number() != 0) {
            names.push(value.name());
            let meaning = self.comment(&[path, &[number::ENUM_VALUE, index]].concat());
            if !meaning.is_empty() {
                text.push_str(&format!("\n\n`{}`: {meaning}", value.name()));
            }
        }
        let schema = json!({"type": "string", "enum": names});
        components.insert(
            format!("{parent}{}", list.name()),
            described(schema, text.trim().to_owned()),
        );
    }
}

/// Entries with their indexes, as descriptors count them.
fn enumerated<T>(list: &[T]) -> impl Iterator<Item = (i32, &T)> {
    (0..).zip(list)
}

fn described(mut schema: Value, text: String) -> Value {
    if !text.is_empty() {
        schema["description"] = text.into();
    }
    schema
}

/// The first sentence, and all of it where there is more.
fn summarized(text: &str) -> (String, Option<String>) {
    match text.split_once(". ") {
        Some((first, _)) => (first.to_owned(), Some(text.to_owned())),
        None => (text.trim_end_matches('.').to_owned(), None),
    }
}

/// `.takt.v1.DhTable.Convention` → `DhTable.Convention`.
fn component_name(full: &str) -> String {
    let name = full.trim_start_matches('.');
    name.strip_prefix(PACKAGE)
        .unwrap_or(name)
        .trim_start_matches('.')
        .to_owned()
}

fn kind(field: &FieldDescriptorProto) -> Value {
    let one = match field.r#type() {
        Type::Double => json!({"type": "number", "format": "double"}),
        Type::Float => json!({"type": "number", "format": "float"}),
        Type::Bool => json!({"type": "boolean"}),
        Type::String => json!({"type": "string"}),
        Type::Bytes => json!({"type": "string", "contentEncoding": "base64"}),
        Type::Uint32 | Type::Fixed32 => json!({"type": "integer", "minimum": 0, "maximum": u32::MAX}),
        Type::Int32 | Type::Sint32 | Type::Sfixed32 => json!({"type": "integer", "format": "int32"}),
        Type::Int64 | Type::Sint64 | Type::Sfixed64 | Type::Uint64 | Type::Fixed64 => {
            json!({"type": "string", "pattern": "^-?[0-9]+$"})
        }
        Type::Message | Type::Enum | Type::Group => reference(&component_name(field.type_name())),
    };
    match field.label() {
        Label::Repeated => json!({"type": "array", "items": one}),
        Label::Optional | Label::Required => one,
    }
}
