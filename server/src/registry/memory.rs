//! Robots in memory.

use std::{
    collections::BTreeMap,
    ops::Bound,
    sync::{PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard},
};

use async_trait::async_trait;
use takt_proto::id::RobotId;

use super::store::{Record, Revision, RobotStore, Sequence, StoreError, check_expected};

/// Robots that are gone when the process ends.
#[derive(Debug, Default)]
pub(crate) struct Memory {
    robots: RwLock<BTreeMap<RobotId, Robot>>,
}

#[derive(Debug, Default)]
struct Robot {
    /// In the order in which they became current; each revision once, at its latest time.
    history: Vec<(Sequence, Record)>,
    next: Sequence,
}

impl Robot {
    fn current(&self) -> Option<&Record> {
        self.history.last().map(|(_, record)| record)
    }
}

impl Memory {
    // No code panics while it holds the lock; what a panic elsewhere left is whole.
    fn reading(&self) -> RwLockReadGuard<'_, BTreeMap<RobotId, Robot>> {
        self.robots.read().unwrap_or_else(PoisonError::into_inner)
    }

    fn writing(&self) -> RwLockWriteGuard<'_, BTreeMap<RobotId, Robot>> {
        self.robots.write().unwrap_or_else(PoisonError::into_inner)
    }
}

#[async_trait]
impl RobotStore for Memory {
    fn current(&self, id: &str) -> Option<Revision> {
        let robots = self.reading();
        Some(robots.get(id)?.current()?.revision.clone())
    }

    async fn read(&self, id: &RobotId, revision: &str) -> Result<Option<Record>, StoreError> {
        let robots = self.reading();
        let robot = robots.get(id);
        let found = robot.and_then(|robot| {
            let mut history = robot.history.iter();
            history.find(|(_, record)| &*record.revision == revision)
        });
        Ok(found.map(|(_, record)| record.clone()))
    }

    async fn write(&self, id: &RobotId, record: Record, expected: Option<String>) -> Result<(), StoreError> {
        let mut robots = self.writing();
        let robot = robots.get(id);
        let current = robot.and_then(Robot::current).map(|record| &record.revision);
        check_expected(current, expected.as_deref())?;
        let robot = robots.entry(id.clone()).or_default();
        if robot
            .current()
            .is_some_and(|current| current.revision == record.revision)
        {
            return Ok(());
        }
        robot.history.retain(|(_, other)| other.revision != record.revision);
        robot.next += 1;
        robot.history.push((robot.next, record));
        Ok(())
    }

    async fn list(&self, after: Option<&str>, count: usize) -> Result<Vec<(String, Vec<u8>)>, StoreError> {
        let robots = self.reading();
        let after = after.map_or(Bound::Unbounded, Bound::Excluded);
        let range = robots.range::<str, _>((after, Bound::Unbounded));
        let robots = range.filter_map(|(id, robot)| {
            let current = robot.current()?;
            Some((id.to_string(), current.summary.clone()))
        });
        Ok(robots.take(count).collect())
    }

    async fn revisions(
        &self,
        id: &RobotId,
        before: Option<Sequence>,
        count: usize,
    ) -> Result<Vec<(Sequence, String)>, StoreError> {
        let robots = self.reading();
        let robot = robots.get(id).ok_or(StoreError::NotFound)?;
        let newest_first = robot.history.iter().rev();
        let older = newest_first.filter(|(sequence, _)| before.is_none_or(|before| *sequence < before));
        let revisions = older.map(|(sequence, record)| (*sequence, record.revision.to_string()));
        Ok(revisions.take(count).collect())
    }

    async fn delete(&self, id: &RobotId, expected: Option<String>) -> Result<(), StoreError> {
        let mut robots = self.writing();
        let robot = robots.get(id).ok_or(StoreError::NotFound)?;
        check_expected(robot.current().map(|record| &record.revision), expected.as_deref())?;
        robots.remove(id);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::registry::conformance;

    #[tokio::test]
    async fn conforms() {
        conformance::check_all(|| async { Memory::default() }).await;
    }
}
