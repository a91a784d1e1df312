//! Robots in an SQLite file: the store that needs nothing installed.
//!
//! One connection writes and waits for the disk (write-ahead log, `synchronous = FULL`); others read. Revisions are
//! only added. The current revision of every robot is in memory too, changed after the commit; where another process
//! writes to the same file, its changes are seen within [`REFRESH`].

use std::{
    collections::HashMap,
    path::Path,
    sync::{Arc, PoisonError, RwLock, Weak},
    time::Duration,
};

use async_trait::async_trait;
use sqlx::{
    Connection, Row, SqliteConnection, SqlitePool,
    sqlite::{SqliteConnectOptions, SqliteJournalMode, SqlitePoolOptions, SqliteSynchronous},
};
use takt_proto::id::RobotId;
use tokio::sync::Mutex;

use super::store::{Record, Revision, RobotStore, Sequence, StoreError, check_expected};

/// The schema. Versions of it are counted in `user_version`; a newer one than ours is refused.
const SCHEMA: &str = include_str!("schema.sql");
const SCHEMA_VERSION: i64 = 1;

/// How often the file is looked at for the changes of other processes.
const REFRESH: Duration = Duration::from_secs(1);

/// How long a statement waits for another process's write.
const BUSY_TIMEOUT: Duration = Duration::from_secs(5);

/// Page cache of each connection, KiB: descriptions are read once and then compiled.
const CACHE_KIB: &str = "-512";

/// Connections that read.
const READERS: u32 = 2;

/// Robots in a file.
#[derive(Debug, Clone)]
pub(crate) struct Sqlite(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    writer: Mutex<Writer>,
    readers: SqlitePool,
    current: RwLock<HashMap<String, Revision>>,
}

#[derive(Debug)]
struct Writer {
    connection: SqliteConnection,
    /// SQLite's count of the changes that others made to the file.
    data_version: i64,
}

impl Sqlite {
    /// Opens the file, or makes it.
    pub(crate) async fn open(path: &Path) -> Result<Self, StoreError> {
        let options = SqliteConnectOptions::new()
            .filename(path)
            .create_if_missing(true)
            .journal_mode(SqliteJournalMode::Wal)
            .synchronous(SqliteSynchronous::Full)
            .foreign_keys(true)
            .busy_timeout(BUSY_TIMEOUT)
            .pragma("cache_size", CACHE_KIB);
        let mut connection = SqliteConnection::connect_with(&options).await.map_err(failed)?;
        migrate(&mut connection).await?;
        let readers = SqlitePoolOptions::new()
            .min_connections(0)
            .max_connections(READERS)
            .connect_lazy_with(options.create_if_missing(false).read_only(true));
        let mut writer = Writer {
            data_version: data_version(&mut connection).await?,
            connection,
        };
        let current = read_current(&mut writer.connection).await?;
        let inner = Arc::new(Inner {
            writer: Mutex::new(writer),
            readers,
            current: RwLock::new(current),
        });
        tokio::spawn(follow(Arc::downgrade(&inner)));
        Ok(Self(inner))
    }
}

impl Inner {
    // No code panics while it holds the lock.
    fn set_current(&self, change: impl FnOnce(&mut HashMap<String, Revision>)) {
        change(&mut self.current.write().unwrap_or_else(PoisonError::into_inner));
    }

    /// Reads the current revisions again where another process changed them, or `always`.
    async fn refresh(&self, writer: &mut Writer, always: bool) -> Result<(), StoreError> {
        let version = data_version(&mut writer.connection).await?;
        if always || version != writer.data_version {
            let current = read_current(&mut writer.connection).await?;
            self.set_current(|map| *map = current);
            writer.data_version = version;
        }
        Ok(())
    }

    async fn write(&self, id: &RobotId, record: Record, expected: Option<&str>) -> Result<(), StoreError> {
        let mut writer = self.writer.lock().await;
        let written = write(&mut writer.connection, id, &record, expected).await;
        match written {
            Ok(()) => {
                self.set_current(|map| {
                    map.insert(id.to_string(), record.revision);
                });
                Ok(())
            }
            Err(error) => Err(self.after_failure(&mut writer, error).await),
        }
    }

    async fn delete(&self, id: &RobotId, expected: Option<&str>) -> Result<(), StoreError> {
        let mut writer = self.writer.lock().await;
        match delete(&mut writer.connection, id, expected).await {
            Ok(()) => {
                self.set_current(|map| {
                    map.remove(id.as_str());
                });
                Ok(())
            }
            Err(error) => Err(self.after_failure(&mut writer, error).await),
        }
    }

    /// What is current after a failed write is what the file says.
    async fn after_failure(&self, writer: &mut Writer, error: StoreError) -> StoreError {
        if matches!(error, StoreError::Unavailable(_) | StoreError::Broken(_))
            && let Err(error) = self.refresh(writer, true).await
        {
            tracing::error!(%error, "the store could not be read after a failed write");
        }
        error
    }
}

/// Sees the changes of other processes, as long as the store is there.
async fn follow(inner: Weak<Inner>) {
    loop {
        tokio::time::sleep(REFRESH).await;
        let Some(inner) = inner.upgrade() else { return };
        let mut writer = inner.writer.lock().await;
        if let Err(error) = inner.refresh(&mut writer, false).await {
            tracing::warn!(%error, "the store could not be looked at for changes");
        }
    }
}

#[async_trait]
impl RobotStore for Sqlite {
    fn current(&self, id: &str) -> Option<Revision> {
        let current = self.0.current.read().unwrap_or_else(PoisonError::into_inner);
        current.get(id).cloned()
    }

    async fn read(&self, id: &RobotId, revision: &str) -> Result<Option<Record>, StoreError> {
        let row = sqlx::query("SELECT description, summary FROM revision WHERE robot_id = ? AND revision = ?")
            .bind(id.as_str())
            .bind(revision)
            .fetch_optional(&self.0.readers)
            .await
            .map_err(failed)?;
        let record = row.map(|row| {
            Ok(Record {
                revision: revision.into(),
                description: row.try_get(0)?,
                summary: row.try_get(1)?,
            })
        });
        record.transpose().map_err(failed)
    }

    async fn write(&self, id: &RobotId, record: Record, expected: Option<String>) -> Result<(), StoreError> {
        let (inner, id) = (Arc::clone(&self.0), id.clone());
        finished(tokio::spawn(async move {
            inner.write(&id, record, expected.as_deref()).await
        }))
        .await
    }

    async fn list(&self, after: Option<&str>, count: usize) -> Result<Vec<(String, Vec<u8>)>, StoreError> {
        const LIST: &str = "SELECT robot.robot_id, revision.summary FROM robot JOIN revision \
             ON revision.robot_id = robot.robot_id AND revision.revision = robot.revision \
             WHERE robot.robot_id > ? ORDER BY robot.robot_id LIMIT ?";
        let rows = sqlx::query_as(LIST)
            .bind(after.unwrap_or(""))
            .bind(limit(count))
            .fetch_all(&self.0.readers);
        rows.await.map_err(failed)
    }

    async fn revisions(
        &self,
        id: &RobotId,
        before: Option<Sequence>,
        count: usize,
    ) -> Result<Vec<(Sequence, String)>, StoreError> {
        if self.current(id.as_str()).is_none() {
            return Err(StoreError::NotFound);
        }
        const REVISIONS: &str = "SELECT MAX(sequence) AS latest, revision FROM registration WHERE robot_id = ? \
             GROUP BY revision HAVING latest < ? ORDER BY latest DESC LIMIT ?";
        let rows = sqlx::query_as(REVISIONS)
            .bind(id.as_str())
            .bind(before.unwrap_or(Sequence::MAX))
            .bind(limit(count))
            .fetch_all(&self.0.readers);
        rows.await.map_err(failed)
    }

    async fn delete(&self, id: &RobotId, expected: Option<String>) -> Result<(), StoreError> {
        let (inner, id) = (Arc::clone(&self.0), id.clone());
        finished(tokio::spawn(
            async move { inner.delete(&id, expected.as_deref()).await },
        ))
        .await
    }
}

/// A write goes on where its caller goes away: it runs as a task of its own.
async fn finished(task: tokio::task::JoinHandle<Result<(), StoreError>>) -> Result<(), StoreError> {
    task.await
        .unwrap_or_else(|error| Err(StoreError::Unavailable(Box::new(error))))
}

fn limit(count: usize) -> i64 {
    i64::try_from(count).unwrap_or(i64::MAX)
}

async fn write(
    connection: &mut SqliteConnection,
    id: &RobotId,
    record: &Record,
    expected: Option<&str>,
) -> Result<(), StoreError> {
    begin(connection).await?;
    let written = write_within(connection, id, record, expected).await;
    end(connection, written).await
}

async fn write_within(
    connection: &mut SqliteConnection,
    id: &RobotId,
    record: &Record,
    expected: Option<&str>,
) -> Result<(), StoreError> {
    let current = read_one(connection, id).await?;
    check_expected(current.as_ref(), expected)?;
    if current.as_ref() == Some(&record.revision) {
        return Ok(());
    }
    let statements = [
        sqlx::query(
            "INSERT INTO revision (robot_id, revision, description, summary) VALUES (?, ?, ?, ?) \
             ON CONFLICT DO NOTHING",
        )
        .bind(id.as_str())
        .bind(&*record.revision)
        .bind(record.description.as_slice())
        .bind(record.summary.as_slice()),
        sqlx::query("INSERT INTO registration (robot_id, revision) VALUES (?, ?)")
            .bind(id.as_str())
            .bind(&*record.revision),
        sqlx::query(
            "INSERT INTO robot (robot_id, revision) VALUES (?, ?) \
             ON CONFLICT (robot_id) DO UPDATE SET revision = excluded.revision",
        )
        .bind(id.as_str())
        .bind(&*record.revision),
    ];
    for statement in statements {
        statement.execute(&mut *connection).await.map_err(failed)?;
    }
    Ok(())
}

async fn delete(connection: &mut SqliteConnection, id: &RobotId, expected: Option<&str>) -> Result<(), StoreError> {
    begin(connection).await?;
    let deleted = delete_within(connection, id, expected).await;
    end(connection, deleted).await
}

async fn delete_within(
    connection: &mut SqliteConnection,
    id: &RobotId,
    expected: Option<&str>,
) -> Result<(), StoreError> {
    let current = read_one(connection, id).await?;
    if current.is_none() {
        return Err(StoreError::NotFound);
    }
    check_expected(current.as_ref(), expected)?;
    let statements = [
        sqlx::query("DELETE FROM robot WHERE robot_id = ?"),
        sqlx::query("DELETE FROM registration WHERE robot_id = ?"),
        sqlx::query("DELETE FROM revision WHERE robot_id = ?"),
    ];
    for statement in statements {
        let statement = statement.bind(id.as_str());
        statement.execute(&mut *connection).await.map_err(failed)?;
    }
    Ok(())
}

/// Begins a transaction that writes. By hand: SQLite itself rolls back where the disk is full, which the library's
/// transactions do not expect.
async fn begin(connection: &mut SqliteConnection) -> Result<(), StoreError> {
    let begun = sqlx::query("BEGIN IMMEDIATE").execute(connection);
    begun.await.map(drop).map_err(failed)
}

/// Commits what went well, and takes back what did not.
async fn end(connection: &mut SqliteConnection, result: Result<(), StoreError>) -> Result<(), StoreError> {
    let ended = match result {
        Ok(()) => sqlx::query("COMMIT")
            .execute(&mut *connection)
            .await
            .map(drop)
            .map_err(failed),
        Err(error) => Err(error),
    };
    if ended.is_err() {
        // Fails where SQLite has rolled back already.
        let _ = sqlx::query("ROLLBACK").execute(connection).await;
    }
    ended
}

async fn read_one(connection: &mut SqliteConnection, id: &RobotId) -> Result<Option<Revision>, StoreError> {
    let current: Option<String> = sqlx::query_scalar("SELECT revision FROM robot WHERE robot_id = ?")
        .bind(id.as_str())
        .fetch_optional(connection)
        .await
        .map_err(failed)?;
    Ok(current.map(Into::into))
}

async fn read_current(connection: &mut SqliteConnection) -> Result<HashMap<String, Revision>, StoreError> {
    let rows: Vec<(String, String)> = sqlx::query_as("SELECT robot_id, revision FROM robot")
        .fetch_all(connection)
        .await
        .map_err(failed)?;
    Ok(rows.into_iter().map(|(id, revision)| (id, revision.into())).collect())
}

async fn data_version(connection: &mut SqliteConnection) -> Result<i64, StoreError> {
    let version = sqlx::query_scalar("PRAGMA data_version").fetch_one(connection);
    version.await.map_err(failed)
}

/// Makes the tables where they are missing.
async fn migrate(connection: &mut SqliteConnection) -> Result<(), StoreError> {
    let mut transaction = connection.begin_with("BEGIN IMMEDIATE").await.map_err(failed)?;
    let version: i64 = sqlx::query_scalar("PRAGMA user_version")
        .fetch_one(&mut *transaction)
        .await
        .map_err(failed)?;
    if version > SCHEMA_VERSION {
        let message =
            format!("the file has schema {version}, written by a newer version; this one knows {SCHEMA_VERSION}");
        return Err(StoreError::Broken(message.into()));
    }
    if version < SCHEMA_VERSION {
        sqlx::raw_sql(SCHEMA).execute(&mut *transaction).await.map_err(failed)?;
    }
    transaction.commit().await.map_err(failed)
}

/// What an error of SQLite means to a caller, by its primary result code.
fn failed(error: sqlx::Error) -> StoreError {
    const CORRUPT: i32 = 11;
    const NOT_A_DATABASE: i32 = 26;
    let code = error.as_database_error().and_then(|error| error.code());
    let code = code.and_then(|code| code.parse::<i32>().ok()).map(|code| code & 0xff);
    match (&error, code) {
        (_, Some(CORRUPT | NOT_A_DATABASE)) => StoreError::Broken(Box::new(error)),
        (sqlx::Error::Database(_) | sqlx::Error::Io(_) | sqlx::Error::PoolTimedOut, _) => {
            StoreError::Unavailable(Box::new(error))
        }
        _ => StoreError::Broken(Box::new(error)),
    }
}

#[cfg(test)]
mod tests;
