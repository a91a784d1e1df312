//! Where robots are kept: the contract of every store.

use std::{fmt, sync::Arc};

use async_trait::async_trait;
use takt_proto::id::RobotId;

/// A revision: a hash of the description's content.
pub(crate) type Revision = Arc<str>;

/// One revision of one robot.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Record {
    pub(crate) revision: Revision,
    /// The encoded `takt.v1.RobotDescription`.
    pub(crate) description: Vec<u8>,
    /// The encoded `takt.v1.Robot`: what was found when the description was registered.
    pub(crate) summary: Vec<u8>,
}

/// The place of a revision in its robot's history: later registrations have higher ones.
pub(crate) type Sequence = i64;

/// What a store says instead of doing.
#[derive(Debug)]
pub(crate) enum StoreError {
    /// There is no such robot.
    NotFound,
    /// Another revision is current than the expected one; `None`: the robot does not exist.
    Conflict { current: Option<Revision> },
    /// It cannot be done now: no room, or the disk fails. Nothing has changed.
    Unavailable(BoxError),
    /// The store is broken.
    Broken(BoxError),
}

type BoxError = Box<dyn std::error::Error + Send + Sync>;

impl fmt::Display for StoreError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFound => f.write_str("no such robot"),
            Self::Conflict { current: Some(current) } => write!(f, "the current revision is {current}"),
            Self::Conflict { current: None } => f.write_str("the robot does not exist"),
            Self::Unavailable(cause) | Self::Broken(cause) => write!(f, "{cause}"),
        }
    }
}

impl std::error::Error for StoreError {}

/// Keeps every revision of every robot. Revisions are only ever added; a robot goes with all of them.
///
/// A write that returned `Ok` survives the end of the process and of the machine (in stores that outlive them), and is
/// seen by every read that begins after it returned. A write that returned an error has changed nothing. A write whose
/// future is dropped happens completely or not at all.
#[async_trait]
pub(crate) trait RobotStore: Send + Sync + fmt::Debug {
    /// The current revision of a robot; `None`: no such robot. Answered from memory.
    fn current(&self, id: &str) -> Option<Revision>;

    /// One revision of a robot; `None`: no such robot, or no such revision of it.
    async fn read(&self, id: &RobotId, revision: &str) -> Result<Option<Record>, StoreError>;

    /// Makes a revision the current one, and keeps it. The content of a revision that is there already is not touched:
    /// it is the same.
    ///
    /// # Errors
    /// [`StoreError::Conflict`] where another revision is current than `expected`; `Some("")` expects none.
    async fn write(&self, id: &RobotId, record: Record, expected: Option<String>) -> Result<(), StoreError>;

    /// The current summaries of up to `count` robots after `after`, in the order of their ids.
    async fn list(&self, after: Option<&str>, count: usize) -> Result<Vec<(String, Vec<u8>)>, StoreError>;

    /// Up to `count` revisions that became current before `before`, each once, at its latest time, newest first.
    ///
    /// # Errors
    /// [`StoreError::NotFound`].
    async fn revisions(
        &self,
        id: &RobotId,
        before: Option<Sequence>,
        count: usize,
    ) -> Result<Vec<(Sequence, String)>, StoreError>;

    /// Deletes a robot with all its revisions.
    ///
    /// # Errors
    /// [`StoreError::NotFound`]; [`StoreError::Conflict`] as for writing.
    async fn delete(&self, id: &RobotId, expected: Option<String>) -> Result<(), StoreError>;
}

/// Whether the expected revision, where one is expected, is the current one.
pub(crate) fn check_expected(current: Option<&Revision>, expected: Option<&str>) -> Result<(), StoreError> {
    let Some(expected) = expected else {
        return Ok(());
    };
    if current.map_or("", |current| current) == expected {
        return Ok(());
    }
    Err(StoreError::Conflict {
        current: current.cloned(),
    })
}
