//! Shards that are stopped, locked, changed and merged.

use super::*;
use std::sync::atomic::AtomicUsize;

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Square {
    index: usize,
    value: f64,
    seconds: f64,
}

impl Item for Square {
    const SINGULAR: &'static str = "square";
    const PLURAL: &'static str = "squares";

    fn index(&self) -> usize {
        self.index
    }

    fn work(&self) -> String {
        "squares".to_owned()
    }

    fn lasting(&self) -> Self {
        Self { seconds: 0.0, ..self.clone() }
    }
}

fn square(index: usize) -> Square {
    Square { index, value: 0.1 * (index * index) as f64, seconds: index as f64 }
}

fn identity(program: &str, profile: &[u8]) -> Identity {
    let hash = files::identity::content_hash(profile);
    let inputs = BTreeMap::from([("wheel profile".to_owned(), hash)]);
    Identity::new(&"squares", inputs, program).unwrap()
}

fn place(name: &str) -> PathBuf {
    let place = std::env::temp_dir().join(format!("signal-shards-{}-{name}", std::process::id()));
    let _ = std::fs::remove_dir_all(&place);
    place
}

fn folder(place: &Path, identity: &Identity) -> ResultFolder {
    let (mut folder, changed) =
        ResultFolder::for_identity(Some(place), "squares", "squares", identity).unwrap();
    assert_eq!(changed, None);
    folder.create().unwrap();
    folder
}

fn compute(
    place: &Path,
    identity: &Identity,
    shard: &str,
) -> Result<(Computed, usize), SignalError> {
    let began = AtomicUsize::new(0);
    let item = |index| -> Result<Option<Square>, SignalError> {
        began.fetch_add(1, Ordering::Relaxed);
        Ok(Some(square(index)))
    };
    let work = Work { items: 7, name: "squares".to_owned(), identity };
    let (shard, folder) = (shard.parse().unwrap(), folder(place, identity));
    let computed = run(&work, shard, &folder, &AtomicBool::new(false), &item, &|_, _, _| {})?;
    Ok((computed, began.load(Ordering::Relaxed)))
}

#[test]
fn items_are_computed_once_and_merge_in_order() {
    let (place, identity) = (place("once"), identity("a", b"1"));
    let (whole, began) = compute(&place, &identity, "1/1").unwrap();
    assert_eq!((whole.done, whole.of, whole.is_stopped(), began), (7, 7, false, 7));
    assert_eq!(compute(&place, &identity, "1/1").unwrap().1, 0);
    let parts = ["2/2", "1/2"].map(|shard| compute(&place, &identity, shard).unwrap().0.path);
    let merged: Vec<Square> = merge(&parts, Some(&identity)).unwrap();
    assert_eq!(merged, (0..7).map(square).collect::<Vec<_>>());
    assert_eq!(merged, merge(&[whole.path], None).unwrap());
    std::fs::remove_dir_all(&place).unwrap();
}

#[test]
fn a_stop_leaves_what_was_done_and_the_rest_is_computed_later() {
    let (place, identity) = (place("stop"), identity("a", b"1"));
    let stop = AtomicBool::new(false);
    let item = |index| -> Result<Option<Square>, SignalError> {
        stop.store(true, Ordering::Relaxed);
        Ok(Some(square(index)))
    };
    let work = Work { items: 100, name: "squares".to_owned(), identity: &identity };
    let folder = folder(&place, &identity);
    let stopped = run(&work, Shard::WHOLE, &folder, &stop, &item, &|_, _, _| {}).unwrap();
    assert!(stopped.is_stopped() && stopped.done >= 1, "{stopped:?}");
    let kept: Vec<Square> = merge(&[stopped.path], Some(&identity)).unwrap();
    assert_eq!(kept.len(), stopped.done);
    let go = AtomicBool::new(false);
    let item = |index| -> Result<Option<Square>, SignalError> { Ok(Some(square(index))) };
    let whole = run(&work, Shard::WHOLE, &folder, &go, &item, &|_, _, _| {}).unwrap();
    assert_eq!((whole.done, whole.is_stopped()), (100, false));
    std::fs::remove_dir_all(&place).unwrap();
}

#[test]
fn an_item_at_work_that_sees_the_stop_is_left_for_the_next_process() {
    let (place, identity) = (place("at-work"), identity("a", b"1"));
    let stop = AtomicBool::new(false);
    // Items 0 to 2 are done; those at work when the third is done see the flag.
    let item = |index| -> Result<Option<Square>, SignalError> {
        if stop.load(Ordering::Relaxed) {
            return Ok(None);
        }
        Ok((index < 3).then(|| square(index)))
    };
    let set = |_: &Square, done, _| stop.store(done == 3, Ordering::Relaxed);
    let work = Work { items: 50, name: "squares".to_owned(), identity: &identity };
    let folder = folder(&place, &identity);
    let stopped = run(&work, Shard::WHOLE, &folder, &stop, &item, &set).unwrap();
    assert!(stopped.is_stopped() && stopped.done <= 3, "{stopped:?}");
    let kept: Vec<Square> = merge(&[stopped.path], Some(&identity)).unwrap_or_default();
    assert_eq!(kept.len(), stopped.done);
    std::fs::remove_dir_all(&place).unwrap();
}

#[test]
fn an_incomplete_last_line_is_reported_and_its_item_computed_again() {
    let (place, identity) = (place("killed"), identity("a", b"1"));
    let (whole, _) = compute(&place, &identity, "1/1").unwrap();
    assert!(!whole.cut_off);
    let text = std::fs::read_to_string(&whole.path).unwrap();
    std::fs::write(&whole.path, &text[..text.len() - 4]).unwrap();
    let (again, began) = compute(&place, &identity, "1/1").unwrap();
    assert_eq!((again.cut_off, again.done, began), (true, 7, 1));
    let (third, began) = compute(&place, &identity, "1/1").unwrap();
    assert_eq!((third.cut_off, began), (false, 0));
    std::fs::remove_dir_all(&place).unwrap();
}

#[test]
fn a_second_process_at_the_same_shard_is_refused() {
    let (place, identity) = (place("locked"), identity("a", b"1"));
    let held = compute(&place, &identity, "1/1").unwrap().0.path;
    // Locks belong to open files: another opening is as good as another process.
    let _other = locked(&held).unwrap();
    let why = compute(&place, &identity, "1/1").unwrap_err();
    assert!(matches!(why, SignalError::InUse(_)), "{why}");
    assert_eq!(why.to_string().lines().count(), 1);
    // Other shards of the same work are free.
    assert!(compute(&place, &identity, "1/2").is_ok());
    std::fs::remove_dir_all(&place).unwrap();
}

#[test]
fn lines_of_another_origin_are_refused_with_what_differs_and_the_fix() {
    let (place, now) = (place("origin"), identity("a", b"1"));
    let path = compute(&place, &now, "1/1").unwrap().0.path;
    let said = |identity: &Identity| {
        let merged: Result<Vec<Square>, _> = merge(std::slice::from_ref(&path), Some(identity));
        merged.unwrap_err().to_string()
    };
    let program = said(&identity("b", b"1"));
    assert!(program.contains("by another version of the program"), "{program}");
    assert!(program.ends_with("run the shards again"), "{program}");
    let profile = said(&identity("a", b"2"));
    assert!(profile.contains("with another content of the wheel profile"), "{profile}");
    std::fs::remove_dir_all(&place).unwrap();
}

#[test]
fn lines_without_an_identity_merge_only_among_themselves() {
    let (place, now) = (place("old"), identity("a", b"1"));
    let path = compute(&place, &now, "1/2").unwrap().0.path;
    let old = |name: &str, indices: &[usize]| {
        let lines = indices.iter().map(|index| serde_json::to_string(&square(*index)).unwrap());
        let path = place.join(name);
        std::fs::write(&path, lines.map(|line| line + "\n").collect::<String>()).unwrap();
        path
    };
    let (first, second) = (old("old-1.jsonl", &[0, 2]), old("old-2.jsonl", &[1]));
    let merged: Vec<Square> = merge(&[first.clone(), second], None).unwrap();
    assert_eq!(merged, [0, 1, 2].map(square));
    assert!(merge::<Square>(&[first.clone(), path.clone()], None).is_err());
    assert!(merge::<Square>(&[path, first.clone()], None).is_err());
    assert!(merge::<Square>(&[first], Some(&now)).is_err());
    std::fs::remove_dir_all(&place).unwrap();
}

#[test]
fn an_item_that_fails_ends_the_work_and_keeps_what_was_done() {
    let (place, identity) = (place("failed"), identity("a", b"1"));
    let item = |index| match index {
        0 => Ok(Some(square(0))),
        _ => Err(SignalError::NotFinite(index)),
    };
    let work = Work { items: 2, name: "squares".to_owned(), identity: &identity };
    let (go, folder) = (AtomicBool::new(false), folder(&place, &identity));
    let run = || run(&work, Shard::WHOLE, &folder, &go, &item, &|_, _, _| {});
    assert!(matches!(run(), Err(SignalError::NotFinite(1))));
    std::fs::remove_dir_all(&place).unwrap();
}
