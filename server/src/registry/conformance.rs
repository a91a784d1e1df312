//! The suite that every store must pass.

use std::future::Future;

use takt_proto::id::RobotId;

use super::store::{Record, RobotStore, StoreError};

/// Runs everything, each part on an empty store.
pub(crate) async fn check_all<S, F>(empty: impl Fn() -> F)
where
    S: RobotStore,
    F: Future<Output = S>,
{
    what_is_written_is_read(&empty().await).await;
    the_same_content_again_changes_nothing(&empty().await).await;
    an_old_revision_becomes_current_again(&empty().await).await;
    expectations_are_checked(&empty().await).await;
    robots_are_listed_in_pages(&empty().await).await;
    revisions_are_listed_newest_first(&empty().await).await;
    deleting_takes_all_revisions(&empty().await).await;
    one_of_two_racing_writers_wins(&empty().await).await;
}

fn id(text: &str) -> RobotId {
    RobotId::parse(text).unwrap()
}

pub(crate) fn record(revision: &str) -> Record {
    Record {
        revision: revision.into(),
        description: format!("description {revision}").into_bytes(),
        summary: format!("summary {revision}").into_bytes(),
    }
}

async fn write(store: &impl RobotStore, robot: &str, revision: &str) {
    store.write(&id(robot), record(revision), None).await.unwrap();
}

async fn history(store: &impl RobotStore, robot: &str) -> Vec<String> {
    let revisions = store.revisions(&id(robot), None, 100).await.unwrap();
    revisions.into_iter().map(|(_, revision)| revision).collect()
}

async fn what_is_written_is_read(store: &impl RobotStore) {
    assert_eq!(store.current("arm"), None);
    assert_eq!(store.read(&id("arm"), "r1").await.unwrap(), None);
    write(store, "arm", "r1").await;
    write(store, "arm", "r2").await;
    assert_eq!(store.current("arm").as_deref(), Some("r2"));
    for revision in ["r1", "r2"] {
        let read = store.read(&id("arm"), revision).await.unwrap();
        assert_eq!(read, Some(record(revision)));
    }
    assert_eq!(store.read(&id("arm"), "r3").await.unwrap(), None);
    assert_eq!(store.read(&id("other"), "r1").await.unwrap(), None);
}

async fn the_same_content_again_changes_nothing(store: &impl RobotStore) {
    write(store, "arm", "r1").await;
    let before = store.revisions(&id("arm"), None, 100).await.unwrap();
    write(store, "arm", "r1").await;
    assert_eq!(store.revisions(&id("arm"), None, 100).await.unwrap(), before);
}

async fn an_old_revision_becomes_current_again(store: &impl RobotStore) {
    for revision in ["r1", "r2", "r1"] {
        write(store, "arm", revision).await;
    }
    assert_eq!(store.current("arm").as_deref(), Some("r1"));
    assert_eq!(history(store, "arm").await, ["r1", "r2"]);
}

async fn expectations_are_checked(store: &impl RobotStore) {
    let arm = id("arm");
    let expect = |revision: &str| Some(revision.to_owned());
    let conflict = store.write(&arm, record("r1"), expect("r0")).await;
    assert!(matches!(conflict, Err(StoreError::Conflict { current: None })));
    assert_eq!(store.current("arm"), None);
    store.write(&arm, record("r1"), expect("")).await.unwrap();
    for wrong in ["", "r0"] {
        let conflict = store.write(&arm, record("r2"), expect(wrong)).await;
        let Err(StoreError::Conflict { current }) = conflict else {
            panic!("{conflict:?}");
        };
        assert_eq!(current.as_deref(), Some("r1"));
    }
    assert_eq!(store.read(&arm, "r2").await.unwrap(), None);
    store.write(&arm, record("r2"), expect("r1")).await.unwrap();
    let conflict = store.delete(&arm, expect("r1")).await;
    assert!(matches!(conflict, Err(StoreError::Conflict { .. })));
    store.delete(&arm, expect("r2")).await.unwrap();
}

async fn robots_are_listed_in_pages(store: &impl RobotStore) {
    for robot in ["c", "a", "b-2", "b.1", "b_3"] {
        write(store, robot, "r1").await;
    }
    write(store, "a", "r2").await;
    let first = store.list(None, 2).await.unwrap();
    let ids: Vec<_> = first.iter().map(|(id, _)| id.as_str()).collect();
    assert_eq!(ids, ["a", "b-2"]);
    assert_eq!(first[0].1, record("r2").summary);
    let rest = store.list(Some("b-2"), 100).await.unwrap();
    let ids: Vec<_> = rest.iter().map(|(id, _)| id.as_str()).collect();
    assert_eq!(ids, ["b.1", "b_3", "c"]);
    assert_eq!(store.list(Some("c"), 100).await.unwrap(), []);
}

async fn revisions_are_listed_newest_first(store: &impl RobotStore) {
    let missing = store.revisions(&id("arm"), None, 1).await;
    assert!(matches!(missing, Err(StoreError::NotFound)));
    for revision in ["r1", "r2", "r3"] {
        write(store, "arm", revision).await;
        write(store, "other", revision).await;
    }
    let first = store.revisions(&id("arm"), None, 2).await.unwrap();
    let names: Vec<_> = first.iter().map(|(_, revision)| revision.as_str()).collect();
    assert_eq!(names, ["r3", "r2"]);
    let rest = store.revisions(&id("arm"), Some(first[1].0), 2).await.unwrap();
    let names: Vec<_> = rest.iter().map(|(_, revision)| revision.as_str()).collect();
    assert_eq!(names, ["r1"]);
}

async fn deleting_takes_all_revisions(store: &impl RobotStore) {
    let missing = store.delete(&id("arm"), None).await;
    assert!(matches!(missing, Err(StoreError::NotFound)));
    write(store, "arm", "r1").await;
    write(store, "arm", "r2").await;
    write(store, "other", "r1").await;
    store.delete(&id("arm"), None).await.unwrap();
    assert_eq!(store.current("arm"), None);
    assert_eq!(store.read(&id("arm"), "r1").await.unwrap(), None);
    assert_eq!(store.current("other").as_deref(), Some("r1"));
    write(store, "arm", "r3").await;
    assert_eq!(history(store, "arm").await, ["r3"]);
}

async fn one_of_two_racing_writers_wins(store: &impl RobotStore) {
    let arm = id("arm");
    let expected = || Some(String::new());
    let (one, two) = futures::future::join(
        store.write(&arm, record("r1"), expected()),
        store.write(&arm, record("r2"), expected()),
    )
    .await;
    assert!(one.is_ok() != two.is_ok());
    assert_eq!(history(store, "arm").await.len(), 1);
}
