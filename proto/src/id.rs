//! Names of things: robots and their revisions.

use std::fmt;

use sha2::{Digest, Sha256};

use crate::convert::quoted;

/// Longest robot id, in bytes.
const LONGEST_ID: usize = 63;

/// Hexadecimal digits of a revision or a request hash: 128 bits.
const HASH_DIGITS: usize = 32;

/// The id of a robot: `[a-z0-9][a-z0-9._-]{0,62}`.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RobotId(String);

impl RobotId {
    /// Checks an id.
    ///
    /// # Errors
    /// A sentence that names the id and what ids look like.
    pub fn parse(id: &str) -> Result<Self, String> {
        if id.is_empty() {
            return Err("must be given".to_owned());
        }
        let starts = |byte: u8| byte.is_ascii_lowercase() || byte.is_ascii_digit();
        let continues = |byte: u8| starts(byte) || matches!(byte, b'.' | b'_' | b'-');
        let bytes = id.as_bytes();
        if bytes.len() > LONGEST_ID || !starts(bytes[0]) || !bytes.iter().all(|&byte| continues(byte)) {
            return Err(format!("{} does not match [a-z0-9][a-z0-9._-]{{0,62}}", quoted(id)));
        }
        Ok(Self(id.to_owned()))
    }

    /// The id as text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for RobotId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::borrow::Borrow<str> for RobotId {
    fn borrow(&self) -> &str {
        &self.0
    }
}

/// The hash of a message: lower-case hexadecimal digits of the first half of the SHA-256 of its name and its canonical
/// encoding (fields in order of their numbers, defaults left out). Only the decoded content counts: the same message
/// as protobuf and as JSON has the same hash.
#[must_use]
pub fn content_hash<M: prost::Message>(name: &str, message: &M) -> String {
    let mut hash = Sha256::new();
    hash.update(name.as_bytes());
    hash.update([0]);
    hash.update(message.encode_to_vec());
    let digest = hash.finalize();
    let mut text = String::with_capacity(HASH_DIGITS);
    for byte in &digest[..HASH_DIGITS / 2] {
        for digit in [byte >> 4, byte & 15] {
            text.push(char::from(b"0123456789abcdef"[usize::from(digit)]));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::v1;

    #[test]
    fn ids_are_checked() {
        for good in ["a", "0", "ur5e", "cell-3.arm_2", &"x".repeat(63)] {
            assert_eq!(RobotId::parse(good).map(|id| id.to_string()), Ok(good.to_owned()));
        }
        for bad in ["", "A", ".a", "-a", "a b", "a/b", "a:b", "é", "..", &"x".repeat(64)] {
            assert!(RobotId::parse(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn the_hash_depends_on_the_content_alone() {
        const NAME: &str = "RobotDescription";
        let robot = v1::RobotDescription {
            urdf: "<robot/>".to_owned(),
            ..Default::default()
        };
        let hash = content_hash(NAME, &robot);
        assert_eq!(hash.len(), HASH_DIGITS);
        assert_eq!(hash, content_hash(NAME, &robot));
        assert_ne!(hash, content_hash(NAME, &v1::RobotDescription::default()));
        let json = r#"{"urdf": "<robot/>", "joints": []}"#;
        let from_json: v1::RobotDescription = serde_json::from_str(json).unwrap();
        assert_eq!(hash, content_hash(NAME, &from_json));
    }
}
