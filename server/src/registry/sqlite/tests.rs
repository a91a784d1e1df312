use tempfile::TempDir;

use super::*;
use crate::registry::conformance::{self, record};

/// A store in a directory that lasts as long as the test.
async fn open(directory: &TempDir) -> Sqlite {
    Sqlite::open(&directory.path().join("takt.db")).await.unwrap()
}

fn arm() -> RobotId {
    RobotId::parse("arm").unwrap()
}

#[tokio::test]
async fn conforms() {
    let directory = TempDir::new().unwrap();
    let counter = std::sync::atomic::AtomicU32::new(0);
    conformance::check_all(|| {
        let number = counter.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        let path = directory.path().join(format!("{number}.db"));
        async move { Sqlite::open(&path).await.unwrap() }
    })
    .await;
}

#[tokio::test]
async fn robots_are_there_after_a_restart() {
    let directory = TempDir::new().unwrap();
    let store = open(&directory).await;
    store.write(&arm(), record("r1"), None).await.unwrap();
    store.write(&arm(), record("r2"), None).await.unwrap();
    drop(store);
    let store = open(&directory).await;
    assert_eq!(store.current("arm").as_deref(), Some("r2"));
    assert_eq!(store.read(&arm(), "r1").await.unwrap(), Some(record("r1")));
    assert_eq!(store.revisions(&arm(), None, 9).await.unwrap().len(), 2);
}

#[tokio::test]
async fn a_full_disk_refuses_writes_and_loses_nothing() {
    let directory = TempDir::new().unwrap();
    let store = open(&directory).await;
    store.write(&arm(), record("r1"), None).await.unwrap();
    set_room(&store, 0).await;
    let large = Record {
        description: vec![1; 1 << 20],
        ..record("r2")
    };
    let refused = store.write(&arm(), large.clone(), None).await;
    assert!(matches!(refused, Err(StoreError::Unavailable(_))), "{refused:?}");
    assert_eq!(store.current("arm").as_deref(), Some("r1"));
    assert_eq!(store.read(&arm(), "r1").await.unwrap(), Some(record("r1")));
    assert_eq!(store.read(&arm(), "r2").await.unwrap(), None);
    set_room(&store, 1 << 20).await;
    store.write(&arm(), large.clone(), None).await.unwrap();
    assert_eq!(store.read(&arm(), "r2").await.unwrap(), Some(large));
}

/// Lets the file grow by so many pages.
async fn set_room(store: &Sqlite, pages: i64) {
    let mut writer = store.0.writer.lock().await;
    let count: i64 = sqlx::query_scalar("PRAGMA page_count")
        .fetch_one(&mut writer.connection)
        .await
        .unwrap();
    let most = count + pages;
    sqlx::raw_sql(sqlx::AssertSqlSafe(format!("PRAGMA max_page_count = {most}")))
        .execute(&mut writer.connection)
        .await
        .unwrap();
}

#[tokio::test]
async fn another_process_is_seen() {
    let directory = TempDir::new().unwrap();
    let (one, two) = (open(&directory).await, open(&directory).await);
    one.write(&arm(), record("r1"), None).await.unwrap();
    let mut writer = two.0.writer.lock().await;
    two.0.refresh(&mut writer, false).await.unwrap();
    drop(writer);
    assert_eq!(two.current("arm").as_deref(), Some("r1"));
}

#[tokio::test]
async fn a_newer_schema_is_refused() {
    let directory = TempDir::new().unwrap();
    let store = open(&directory).await;
    let mut writer = store.0.writer.lock().await;
    sqlx::raw_sql("PRAGMA user_version = 99")
        .execute(&mut writer.connection)
        .await
        .unwrap();
    drop(writer);
    let again = Sqlite::open(&directory.path().join("takt.db")).await;
    assert!(matches!(again, Err(StoreError::Broken(_))));
}
