//! URDF text to links and joints.
//!
//! Only direct children of `<robot>`, in its namespace, count: `<joint>` also stands inside `<ros2_control>` and
//! `<transmission>`. Elements and attributes that are not the specification's are passed over.

use nalgebra::{Matrix3, Vector3};
use roxmltree::{Document, Error, Node, ParsingOptions};

use super::element::{Element, Lines};
use super::limit;
use super::model::{Dynamics, Joint, Kind, Link, Mimic, Model};
use crate::robot::bounds::{Bound, INERTIA, LENGTH, MASS, MAX_LINKS, MAX_NAME_BYTES, MAX_XML_NODES, MIMIC, MIN_AXIS};
use crate::robot::findings::{Findings, quoted};
use crate::robot::spec::Inertial;

/// Characters of the XML parser's message that are passed on: it repeats names of the text in full.
const MAX_PARSER_MESSAGE_CHARS: usize = 300;

/// The document, or why it is not one, with line and column.
pub(super) fn parse(text: &str) -> Result<Document<'_>, String> {
    let options = ParsingOptions {
        nodes_limit: MAX_XML_NODES,
        ..ParsingOptions::default()
    };
    Document::parse_with_options(text, options).map_err(|error| match error {
        Error::DtdDetected => "a document type declaration (<!DOCTYPE>) is not accepted".to_owned(),
        Error::NodesLimitReached => {
            format!("its elements, texts and comments must be at most {MAX_XML_NODES}")
        }
        other => {
            let message: String = other.to_string().chars().take(MAX_PARSER_MESSAGE_CHARS).collect();
            format!("not well-formed XML: {message}")
        }
    })
}

/// The links and joints; `None` where something is wrong with them.
pub(super) fn model<'a>(document: &'a Document<'_>, lines: &'a Lines, findings: &mut Findings) -> Option<Model<'a>> {
    let root = document.root_element();
    let tag = root.tag_name();
    if tag.name() != "robot" {
        findings.error(
            "urdf",
            format!("the root element is {}, a URDF's is \"robot\"", quoted(tag.name())),
        );
        return None;
    }
    let mut model = Model::default();
    for node in root.children().filter(Node::is_element) {
        if is_xacro(&node) {
            let message = format!(
                "line {}: the macro element {} is left in the file: expand it with xacro first",
                lines.line(&node),
                quoted(node.tag_name().name())
            );
            findings.error("urdf", message);
            continue;
        }
        if node.tag_name().namespace() != tag.namespace() {
            continue;
        }
        match node.tag_name().name() {
            "link" => model.links.extend(link(node, lines, findings)),
            "joint" => model.joints.extend(joint(node, lines, findings)),
            _ => {}
        }
        if model.links.len() > MAX_LINKS || model.joints.len() > MAX_LINKS {
            findings.error(
                "urdf",
                format!("its links, and its joints, must be at most {MAX_LINKS}"),
            );
            return None;
        }
    }
    (!findings.has_errors()).then_some(model)
}

/// A macro language that is expanded before the file is a URDF; what its elements stand for would be missing.
fn is_xacro(node: &Node<'_, '_>) -> bool {
    let namespace = node.tag_name().namespace().unwrap_or_default();
    namespace.trim_end_matches('/').ends_with("xacro")
}

fn link<'a>(node: Node<'a, '_>, lines: &'a Lines, findings: &mut Findings) -> Option<Link<'a>> {
    let line = lines.line(&node);
    let name = name(node, line, findings)?;
    let element = Element {
        node,
        lines,
        what: "link",
        owner: name,
    };
    let inertial = element
        .child("inertial", findings)
        .and_then(|inertial| self::inertial(&inertial, findings));
    Some(Link { name, line, inertial })
}

/// `<inertial>`: mass and inertia stand in the axes of its own origin.
fn inertial(element: &Element<'_, '_>, findings: &mut Findings) -> Option<Inertial> {
    let link_from_body = element.origin(findings);
    let Some(mass) = element.child("mass", findings) else {
        element.error("<inertial> has no <mass>", findings);
        return None;
    };
    let mass = mass.required("value", &MASS, findings);
    // Without <inertia> it is a point mass, of which there is a warning.
    let inertia = match element.child("inertia", findings) {
        Some(inertia) => tensor(&inertia, findings),
        None => Some(Matrix3::zeros()),
    };
    let body = Inertial {
        mass: mass?,
        center_of_mass: Vector3::zeros(),
        inertia: inertia?,
    };
    Some(body.seen_from(&link_from_body))
}

fn tensor(element: &Element<'_, '_>, findings: &mut Findings) -> Option<Matrix3<f64>> {
    let [xx, xy, xz, yy, yz, zz] =
        ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"].map(|attribute| element.required(attribute, &INERTIA, findings));
    let (xx, xy, xz, yy, yz, zz) = (xx?, xy?, xz?, yy?, yz?, zz?);
    Some(Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz))
}

fn joint<'a>(node: Node<'a, '_>, lines: &'a Lines, findings: &mut Findings) -> Option<Joint<'a>> {
    let line = lines.line(&node);
    let name = name(node, line, findings)?;
    let element = Element {
        node,
        lines,
        what: "joint",
        owner: name,
    };
    let kind = kind(&element, findings);
    let parent = linked(&element, "parent", findings);
    let child = linked(&element, "child", findings);
    let kind = kind?;
    let parent_from_joint = element.origin(findings);
    let axis = axis(&element, kind, findings);
    let mut oddities = Vec::new();
    let (limits, effort) = limit::read(&element, kind, &mut oddities, findings);
    let dynamics = dynamics(&element, findings);
    let mimic = mimic(&element, kind, findings);
    Some(Joint {
        name,
        line,
        kind,
        parent: parent?,
        child: child?,
        parent_from_joint,
        axis: axis?,
        limits,
        effort,
        dynamics,
        mimic,
        oddities,
    })
}

fn name<'a>(node: Node<'a, '_>, line: usize, findings: &mut Findings) -> Option<&'a str> {
    let tag = node.tag_name().name();
    let name = node.attribute("name").unwrap_or_default();
    if name.is_empty() {
        findings.error("urdf", format!("<{tag}> (line {line}) has no name"));
        return None;
    }
    if name.len() > MAX_NAME_BYTES {
        let message = format!(
            "{tag} {} (line {line}): a name of {} bytes must have at most {MAX_NAME_BYTES}",
            quoted(name),
            name.len()
        );
        findings.error("urdf", message);
        return None;
    }
    Some(name)
}

fn kind(element: &Element<'_, '_>, findings: &mut Findings) -> Option<Kind> {
    let Some(text) = element.text("type") else {
        element.error("has no type", findings);
        return None;
    };
    let kind = Kind::named(text);
    if kind.is_none() {
        element.error(
            &format!(
                "type {} must be fixed, revolute, continuous, prismatic, floating or planar",
                quoted(text)
            ),
            findings,
        );
    }
    kind
}

/// The link that `<parent>` or `<child>` names.
fn linked<'a>(element: &Element<'a, '_>, tag: &str, findings: &mut Findings) -> Option<&'a str> {
    let link = element.child(tag, findings).and_then(|child| child.text("link"));
    if link.is_none() {
        element.error(&format!("has no <{tag} link=…>"), findings);
    }
    link
}

/// The axis as a unit vector. Joints without one may write anything there, so it is not read.
fn axis(element: &Element<'_, '_>, kind: Kind, findings: &mut Findings) -> Option<Vector3<f64>> {
    let default = Some(Vector3::x());
    if !kind.has_axis() {
        return default;
    }
    let Some(axis) = element.child("axis", findings) else {
        return default;
    };
    if axis.text("xyz").is_none() {
        return default;
    }
    let vector = axis.vector("xyz", &LENGTH, findings)?;
    let norm = vector.norm();
    if norm < MIN_AXIS {
        axis.error(
            &format!("xyz of <axis> has the length {norm:?}, it must be at least {MIN_AXIS:?}"),
            findings,
        );
        return None;
    }
    // A maker's −0.0 would print as such in every answer.
    Some(vector.map(|entry| entry / norm + 0.0))
}

/// Numbers are checked here, their sign only where they are used.
fn dynamics(element: &Element<'_, '_>, findings: &mut Findings) -> Dynamics {
    let Some(dynamics) = element.child("dynamics", findings) else {
        return Dynamics::default();
    };
    Dynamics {
        damping: dynamics.number("damping", findings).unwrap_or(0.0),
        friction: dynamics.number("friction", findings).unwrap_or(0.0),
    }
}

fn mimic<'a>(element: &Element<'a, '_>, kind: Kind, findings: &mut Findings) -> Option<Mimic<'a>> {
    let mimic = element.child("mimic", findings)?;
    if !kind.has_axis() {
        return None;
    }
    let Some(master) = mimic.text("joint") else {
        element.error("<mimic> has no joint", findings);
        return None;
    };
    let read = |attribute: &str, bound: &Bound, findings: &mut Findings| mimic.bounded(attribute, bound, findings);
    Some(Mimic {
        master,
        multiplier: read("multiplier", &MIMIC, findings).unwrap_or(1.0),
        offset: read("offset", &MIMIC, findings).unwrap_or(0.0),
    })
}
