//! The robots: a store of their descriptions, and those in use compiled.
//!
//! Compiled robots are kept by revision, and a revision is a hash of the content: what is kept is never stale.

pub(crate) mod memory;
pub(crate) mod sqlite;
pub(crate) mod store;

#[cfg(test)]
pub(crate) mod conformance;

use std::{
    collections::{HashMap, HashSet},
    sync::{
        Arc, PoisonError, RwLock,
        atomic::{AtomicU64, Ordering},
    },
};

use futures::future::BoxFuture;
use takt_motion::robot::Robot;
use takt_proto::id::RobotId;
use tokio::sync::OnceCell;

use crate::{
    error::ServiceError,
    registry::store::{Record, Revision, RobotStore},
};

/// A robot that is ready to be used.
#[derive(Debug)]
pub(crate) struct Compiled {
    pub(crate) revision: Revision,
    pub(crate) robot: Robot,
}

/// The robots.
#[derive(Debug)]
pub(crate) struct Registry {
    store: Box<dyn RobotStore>,
    compiled: RwLock<HashMap<Revision, Entry>>,
    capacity: usize,
    /// Old revisions that are known to be some robot's.
    old: RwLock<HashMap<String, HashSet<Revision>>>,
    /// Counts uses, to tell which compiled robot was used last.
    clock: AtomicU64,
}

#[derive(Debug)]
struct Entry {
    robot: Arc<OnceCell<Arc<Compiled>>>,
    used: AtomicU64,
}

impl Registry {
    pub(crate) fn new(store: Box<dyn RobotStore>, capacity: usize) -> Self {
        Self {
            store,
            compiled: RwLock::default(),
            capacity,
            old: RwLock::default(),
            clock: AtomicU64::new(0),
        }
    }

    pub(crate) fn store(&self) -> &dyn RobotStore {
        &*self.store
    }

    /// A robot ready to be used: the wanted revision, or the current one. Many callers of a robot that is not compiled
    /// yet wait for one of them to `compile` it.
    pub(crate) async fn compiled<'a>(
        &self,
        id: &RobotId,
        wanted: Option<&str>,
        compile: impl FnOnce(Record) -> BoxFuture<'a, Result<Robot, ServiceError>>,
    ) -> Result<Arc<Compiled>, ServiceError> {
        let current = self.store.current(id.as_str()).ok_or_else(|| no_robot(id))?;
        let revision = match wanted {
            Some(wanted) if wanted != &*current => self.old_revision(id, wanted).await?,
            _ => current,
        };
        let cell = self.cell(&revision);
        if let Some(robot) = cell.get() {
            return Ok(Arc::clone(robot));
        }
        let compiling = cell.get_or_try_init(|| async {
            let record = self.store.read(id, &revision).await.map_err(unavailable)?;
            let record = record.ok_or_else(|| no_revision(id, &revision))?;
            let robot = compile(record).await?;
            let revision = Arc::clone(&revision);
            Ok::<_, ServiceError>(Arc::new(Compiled { revision, robot }))
        });
        compiling.await.cloned()
    }

    /// A revision that is not the current one, where it is one of the robot's.
    async fn old_revision(&self, id: &RobotId, wanted: &str) -> Result<Revision, ServiceError> {
        {
            let old = self.old.read().unwrap_or_else(PoisonError::into_inner);
            let known = old.get(id.as_str()).and_then(|revisions| revisions.get(wanted));
            if let Some(revision) = known {
                return Ok(Arc::clone(revision));
            }
        }
        let record = self.store.read(id, wanted).await.map_err(unavailable)?;
        let revision = record.ok_or_else(|| no_revision(id, wanted))?.revision;
        let mut old = self.old.write().unwrap_or_else(PoisonError::into_inner);
        if old.values().map(HashSet::len).sum::<usize>() >= self.capacity {
            old.clear();
        }
        old.entry(id.to_string()).or_default().insert(Arc::clone(&revision));
        Ok(revision)
    }

    /// Deletes a robot with all its revisions.
    pub(crate) async fn delete(&self, id: &RobotId, expected: Option<String>) -> Result<(), store::StoreError> {
        let deleted = self.store.delete(id, expected).await;
        let mut old = self.old.write().unwrap_or_else(PoisonError::into_inner);
        old.remove(id.as_str());
        deleted
    }

    /// Keeps a robot that has just been compiled.
    pub(crate) fn keep(&self, robot: Arc<Compiled>) {
        // Where it is there already, it is the same.
        let _ = self.cell(&Arc::clone(&robot.revision)).set(robot);
    }

    /// The place of a compiled robot, made where it is missing; the one unused for longest makes room.
    fn cell(&self, revision: &Revision) -> Arc<OnceCell<Arc<Compiled>>> {
        let now = self.clock.fetch_add(1, Ordering::Relaxed);
        {
            let compiled = self.compiled.read().unwrap_or_else(PoisonError::into_inner);
            if let Some(entry) = compiled.get(revision) {
                entry.used.store(now, Ordering::Relaxed);
                return Arc::clone(&entry.robot);
            }
        }
        let mut compiled = self.compiled.write().unwrap_or_else(PoisonError::into_inner);
        if compiled.len() >= self.capacity && !compiled.contains_key(revision) {
            let last_used = |entry: &Entry| entry.used.load(Ordering::Relaxed);
            let oldest = compiled.iter().min_by_key(|(_, entry)| last_used(entry));
            if let Some(oldest) = oldest.map(|(revision, _)| Arc::clone(revision)) {
                compiled.remove(&oldest);
            }
        }
        let entry = compiled.entry(Arc::clone(revision)).or_insert_with(|| Entry {
            robot: Arc::default(),
            used: AtomicU64::new(now),
        });
        Arc::clone(&entry.robot)
    }
}

pub(crate) fn no_robot(id: &RobotId) -> ServiceError {
    ServiceError::not_found(format!("there is no robot \"{id}\""))
}

pub(crate) fn no_revision(id: &RobotId, revision: &str) -> ServiceError {
    let revision = takt_proto::convert::quoted(revision);
    ServiceError::not_found(format!("robot \"{id}\" has no revision {revision}"))
}

/// What a failure of the store is to a caller.
pub(crate) fn unavailable(error: store::StoreError) -> ServiceError {
    use std::time::Duration;
    use takt_proto::error::{Error, ErrorCode};
    /// Disks are rarely emptied faster.
    const RETRY_AFTER: Duration = Duration::from_secs(1);
    match error {
        store::StoreError::NotFound => ServiceError::not_found("there is no such robot"),
        store::StoreError::Conflict { current } => {
            let message = match &current {
                Some(current) => format!("the current revision is {current}, not the expected one"),
                None => "the robot does not exist, but a revision of it was expected".to_owned(),
            };
            Error::conflict(current.as_deref().unwrap_or(""), message).into()
        }
        error @ store::StoreError::Unavailable(_) => {
            let message = format!("the store cannot do it now, nothing was changed: {error}");
            let wire = Error {
                retry_after: Some(RETRY_AFTER),
                ..Error::new(ErrorCode::Unavailable, message)
            };
            ServiceError::from(wire).caused_by(error)
        }
        error @ store::StoreError::Broken(_) => {
            ServiceError::internal("the store is broken: see the log of the service").caused_by(error)
        }
    }
}
