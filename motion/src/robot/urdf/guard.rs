//! Refuses documents whose shape would cost more than their size: before they are parsed, in one pass over the text.

use crate::robot::bounds::{MAX_URDF_BYTES, MAX_XML_ATTRIBUTES, MAX_XML_DEPTH, MAX_XML_NAMESPACES};

/// Says what about the shape of `text` is beyond its cap. Malformed text passes: the parser says better why.
pub(super) fn check(text: &str) -> Result<(), String> {
    if text.len() > MAX_URDF_BYTES {
        return Err(format!("{} bytes of text must be at most {MAX_URDF_BYTES}", text.len()));
    }
    let namespaces = text.matches("xmlns").count();
    if namespaces > MAX_XML_NAMESPACES {
        return Err(format!(
            "{namespaces} namespace declarations must be at most {MAX_XML_NAMESPACES}"
        ));
    }
    let mut depth = 0_usize;
    let mut at = 0;
    while let Some(offset) = text[at..].find('<') {
        let start = at + offset;
        let Some(markup) = Markup::at(&text[start..]) else {
            return Ok(());
        };
        match markup.kind {
            Kind::Open => depth += 1,
            Kind::Close => depth = depth.saturating_sub(1),
            Kind::Empty | Kind::Other => {}
        }
        if depth > MAX_XML_DEPTH {
            let line = line_of(text, start);
            return Err(format!(
                "line {line}: elements nested {depth} deep must be at most {MAX_XML_DEPTH} deep"
            ));
        }
        if markup.attributes > MAX_XML_ATTRIBUTES {
            let line = line_of(text, start);
            return Err(format!(
                "line {line}: {} attributes of one element must be at most {MAX_XML_ATTRIBUTES}",
                markup.attributes
            ));
        }
        at = start + markup.length;
    }
    Ok(())
}

/// One piece of text from `<` to its end.
struct Markup {
    kind: Kind,
    attributes: usize,
    length: usize,
}

enum Kind {
    Open,
    Close,
    Empty,
    Other,
}

impl Markup {
    /// The markup that `text` begins with; `None` where it does not end, or where a document type begins.
    fn at(text: &str) -> Option<Self> {
        if text.starts_with("<!--") {
            return Self::other(text, 4, "-->");
        }
        if text.starts_with("<![CDATA[") {
            return Self::other(text, 9, "]]>");
        }
        if text.starts_with("<?") {
            return Self::other(text, 2, "?>");
        }
        if text.starts_with("<!") {
            return None;
        }
        if text.starts_with("</") {
            let length = text.find('>')? + 1;
            return Some(Self {
                kind: Kind::Close,
                attributes: 0,
                length,
            });
        }
        Self::tag(text)
    }

    fn other(text: &str, skip: usize, end: &str) -> Option<Self> {
        let length = skip + text[skip..].find(end)? + end.len();
        Some(Self {
            kind: Kind::Other,
            attributes: 0,
            length,
        })
    }

    /// A start tag: `>` inside a quoted value does not end it.
    fn tag(text: &str) -> Option<Self> {
        let mut quote = None;
        let mut attributes = 0;
        let bytes = text.as_bytes();
        for (index, byte) in bytes.iter().enumerate() {
            match (quote, byte) {
                (Some(open), _) if open == *byte => {
                    quote = None;
                    attributes += 1;
                }
                (Some(_), _) => {}
                (None, b'"' | b'\'') => quote = Some(*byte),
                (None, b'>') => {
                    let is_empty = bytes[index - 1] == b'/';
                    return Some(Self {
                        kind: if is_empty { Kind::Empty } else { Kind::Open },
                        attributes,
                        length: index + 1,
                    });
                }
                (None, _) => {}
            }
        }
        None
    }
}

fn line_of(text: &str, offset: usize) -> usize {
    1 + text.as_bytes()[..offset].iter().filter(|byte| **byte == b'\n').count()
}
