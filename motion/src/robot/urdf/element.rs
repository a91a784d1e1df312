//! XML elements as a URDF reader needs them: children by name, numbers with their line when they are none.

use nalgebra::{Isometry3, Vector3};
use roxmltree::{Document, Node};

use crate::robot::bounds::{ANGLE, Bound, LENGTH};
use crate::robot::findings::{Findings, quoted};
use crate::robot::rotation;

/// Byte offsets where lines begin, so that a line number costs a binary search and not a walk over the text.
pub(super) struct Lines {
    starts: Vec<usize>,
}

impl Lines {
    pub(super) fn of(document: &Document<'_>) -> Self {
        let newlines = document.input_text().match_indices('\n');
        Self {
            starts: newlines.map(|(offset, _)| offset + 1).collect(),
        }
    }

    /// Counted from 1.
    pub(super) fn line(&self, node: &Node<'_, '_>) -> usize {
        let offset = node.range().start;
        1 + self.starts.partition_point(|start| *start <= offset)
    }
}

/// An element inside a link or joint, and where it is for messages.
#[derive(Clone, Copy)]
pub(super) struct Element<'a, 'i> {
    pub(super) node: Node<'a, 'i>,
    pub(super) lines: &'a Lines,
    /// `link` or `joint`
    pub(super) what: &'static str,
    pub(super) owner: &'a str,
}

impl<'a, 'i: 'a> Element<'a, 'i> {
    pub(super) fn line(&self) -> usize {
        self.lines.line(&self.node)
    }

    /// The first child of that name, in the same namespace; a second one is warned of and not read, as the reference
    /// parser does.
    pub(super) fn child(&self, name: &str, findings: &mut Findings) -> Option<Self> {
        let namespace = self.node.tag_name().namespace();
        let mut children = self
            .node
            .children()
            .filter(|child| child.is_element())
            .filter(|child| child.tag_name().name() == name && child.tag_name().namespace() == namespace);
        let node = children.next()?;
        if let Some(second) = children.next() {
            let line = self.lines.line(&second);
            findings.warn(format!(
                "{} {} (line {line}): a second <{name}> is not read",
                self.what,
                quoted(self.owner),
            ));
        }
        Some(Self { node, ..*self })
    }

    pub(super) fn text(&self, attribute: &str) -> Option<&'a str> {
        self.node.attribute(attribute)
    }

    pub(super) fn error(&self, message: &str, findings: &mut Findings) {
        findings.error(
            "urdf",
            format!("{} {} (line {}): {message}", self.what, quoted(self.owner), self.line()),
        );
    }

    /// A number within its bound; `None` where it is not stated, or is wrong.
    pub(super) fn bounded(&self, attribute: &str, bound: &Bound, findings: &mut Findings) -> Option<f64> {
        let value = self.number(attribute, findings)?;
        self.check(attribute, value, bound, findings).then_some(value)
    }

    /// A finite number; `None` where it is not stated, or is none.
    pub(super) fn number(&self, attribute: &str, findings: &mut Findings) -> Option<f64> {
        let text = self.text(attribute)?;
        let parsed = parse(text);
        if parsed.is_none() {
            self.not_finite(attribute, text, findings);
        }
        parsed
    }

    /// A number that must be stated.
    pub(super) fn required(&self, attribute: &str, bound: &Bound, findings: &mut Findings) -> Option<f64> {
        if self.text(attribute).is_none() {
            let tag = self.node.tag_name().name();
            self.error(&format!("<{tag}> has no {attribute}"), findings);
            return None;
        }
        self.bounded(attribute, bound, findings)
    }

    /// Three numbers; `None` where they are not stated, or one is wrong.
    pub(super) fn vector(&self, attribute: &str, bound: &Bound, findings: &mut Findings) -> Option<Vector3<f64>> {
        let text = self.text(attribute)?;
        let mut vector = Vector3::zeros();
        let mut count = 0;
        for word in text.split_ascii_whitespace() {
            if let Some(slot) = vector.get_mut(count) {
                let Some(value) = parse(word) else {
                    self.not_finite(attribute, word, findings);
                    return None;
                };
                if !self.check(attribute, value, bound, findings) {
                    return None;
                }
                *slot = value;
            }
            count += 1;
        }
        if count != 3 {
            let tag = self.node.tag_name().name();
            self.error(
                &format!("{attribute} of <{tag}> has {count} numbers, it must have 3"),
                findings,
            );
            return None;
        }
        Some(vector)
    }

    /// The pose in `<origin>`: the identity where that, or a part of it, is not stated.
    pub(super) fn origin(&self, findings: &mut Findings) -> Isometry3<f64> {
        let Some(origin) = self.child("origin", findings) else {
            return Isometry3::identity();
        };
        let position = origin.vector("xyz", &LENGTH, findings).unwrap_or_default();
        let rpy = origin.vector("rpy", &ANGLE, findings).unwrap_or_default();
        rotation::pose(position, rotation::from_roll_pitch_yaw(&rpy))
    }

    fn check(&self, attribute: &str, value: f64, bound: &Bound, findings: &mut Findings) -> bool {
        let Some(fault) = bound.fault(value) else {
            return true;
        };
        let tag = self.node.tag_name().name();
        self.error(&format!("{attribute} of <{tag}>: {fault}"), findings);
        false
    }

    fn not_finite(&self, attribute: &str, text: &str, findings: &mut Findings) {
        let tag = self.node.tag_name().name();
        self.error(
            &format!("{attribute} of <{tag}> is {}, not a finite number", quoted(text)),
            findings,
        );
    }
}

/// A finite number in XML's spelling; overflow to infinity is none.
fn parse(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|value: &f64| value.is_finite())
}
