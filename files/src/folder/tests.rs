use super::*;
use serde_json::json;
use std::collections::BTreeMap;
use std::os::unix::fs::symlink;

fn place(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("files-folder-{}-{name}", std::process::id()));
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).unwrap();
    path
}

fn fresh(path: &Path, overwrite: bool) -> Result<ResultFolder, FolderError> {
    ResultFolder::fresh(Some(path), "run", "run", overwrite)
}

fn asked(seeds: u32) -> Identity {
    Identity::new(&json!({ "seeds": seeds }), BTreeMap::default(), "1").unwrap()
}

fn read(path: PathBuf) -> String {
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn a_result_is_replaced_only_when_asked_and_only_its_own_files() {
    let at = place("overwrite");
    let out = at.join("out");
    let mut first = fresh(&out, false).unwrap();
    first.create().unwrap();
    first.write("report.html", "1").unwrap();
    first.write("predictions/sine.csv", "1").unwrap();
    std::fs::write(out.join("notes.txt"), "mine").unwrap();
    std::fs::write(out.join("predictions/mine.csv"), "mine").unwrap();
    let refused = fresh(&out, false).unwrap_err().to_string();
    assert!(
        refused
            .ends_with("holds a result of `run`, expected a new folder; --overwrite replaces it")
    );
    let mut second = fresh(&out, true).unwrap();
    second.check(&["report.html"]).unwrap();
    second.create().unwrap();
    assert!(!out.join("report.html").exists() && !out.join("predictions/sine.csv").exists());
    assert_eq!(read(out.join("notes.txt")), "mine");
    assert_eq!(read(out.join("predictions/mine.csv")), "mine");
    let stopped = second.write("notes.txt", "2").unwrap_err();
    assert!(matches!(stopped, FolderError::Occupied(_)), "{stopped}");
    std::fs::remove_dir_all(&at).unwrap();
}

#[test]
fn a_file_of_the_users_is_in_the_way_and_stays() {
    let at = place("occupied");
    std::fs::write(at.join("scenario.toml"), "mine").unwrap();
    let mut folder = fresh(&at, true).unwrap();
    let said = folder.check(&["scenario.toml"]).unwrap_err().to_string();
    assert!(said.contains("scenario.toml: is there already and was not written by this program"));
    folder.create().unwrap();
    assert!(folder.write("scenario.toml", "ours").is_err());
    assert!(folder.create_file("scenario.toml").is_err());
    assert_eq!(read(at.join("scenario.toml")), "mine");
    std::fs::remove_dir_all(&at).unwrap();
}

#[test]
fn the_folder_may_be_a_link_but_no_entry_is_followed() {
    let at = place("links");
    let (real, out, secret) = (at.join("real"), at.join("out"), at.join("secret"));
    std::fs::create_dir(&real).unwrap();
    std::fs::write(&secret, "mine").unwrap();
    symlink(&real, &out).unwrap();
    let mut folder = fresh(&out, false).unwrap();
    folder.create().unwrap();
    symlink(&secret, real.join("report.html")).unwrap();
    assert!(folder.write("report.html", "ours").is_err());
    folder.write("a.json", "1").unwrap();
    std::fs::remove_file(real.join("a.json")).unwrap();
    symlink(&secret, real.join("a.json")).unwrap();
    folder.write("a.json", "2").unwrap();
    folder.create_file("a.json").unwrap();
    assert_eq!(read(secret), "mine");
    symlink(&at, real.join("predictions")).unwrap();
    assert!(folder.write("predictions/secret", "ours").is_err());
    std::fs::remove_dir_all(&at).unwrap();
}

#[test]
fn an_overwrite_that_is_refused_leaves_the_result_whole() {
    let at = place("whole");
    let out = at.join("out");
    let mut first = fresh(&out, false).unwrap();
    first.create().unwrap();
    first.write("a.json", "1").unwrap();
    first.write("b.json", "1").unwrap();
    std::fs::remove_file(out.join("b.json")).unwrap();
    std::fs::create_dir(out.join("b.json")).unwrap();
    let mut second = fresh(&out, true).unwrap();
    assert!(matches!(second.check(&[]), Err(FolderError::Occupied(_))));
    assert!(second.create().is_err());
    assert_eq!(read(out.join("a.json")), "1");
    std::fs::remove_dir_all(&at).unwrap();
}

#[test]
fn a_result_that_the_command_reads_is_not_replaced() {
    let at = place("input");
    let out = at.join("out");
    let mut folder = fresh(&out, false).unwrap();
    folder.create().unwrap();
    folder.write("sine.csv", "1").unwrap();
    std::fs::write(out.join("mine.csv"), "mine").unwrap();
    std::fs::hard_link(out.join("sine.csv"), at.join("other-name.csv")).unwrap();
    let again = fresh(&out, true).unwrap();
    for input in [out.join("sine.csv"), at.join("other-name.csv")] {
        let refused = again.refuse_inputs([input.as_path()]).unwrap_err().to_string();
        assert!(refused.contains("is an input of this command"), "{refused}");
    }
    again.refuse_inputs([out.join("mine.csv").as_path(), at.join("none").as_path()]).unwrap();
    std::fs::remove_dir_all(&at).unwrap();
}

#[test]
fn a_manifest_that_names_what_is_outside_is_not_believed() {
    let at = place("outside");
    std::fs::write(at.join("mine"), "mine").unwrap();
    let out = at.join("out");
    std::fs::create_dir(&out).unwrap();
    for name in ["../mine", "/etc/passwd", "a/b/c", ".", "", "x\0y"] {
        let manifest = json!({"format": 1, "command": "run", "identity": null, "files": [name]});
        std::fs::write(out.join("manifest.json"), manifest.to_string()).unwrap();
        let said = fresh(&out, true).unwrap_err().to_string();
        assert!(said.ends_with("expected names inside the folder"), "{said}");
    }
    assert_eq!(read(at.join("mine")), "mine");
    std::fs::remove_dir_all(&at).unwrap();
}

#[test]
fn a_question_goes_on_in_its_own_folder_and_in_no_other() {
    let at = place("identity");
    let open = |seeds| ResultFolder::for_identity(Some(&at), "ride", "ride", &asked(seeds));
    let (mut folder, said) = open(5).unwrap();
    assert_eq!(said, None);
    folder.create().unwrap();
    folder.write("ride.json", "1").unwrap();
    let (mut again, _) = open(5).unwrap();
    again.check(&["ride.json"]).unwrap();
    again.create().unwrap();
    again.write("ride.json", "2").unwrap();
    assert_eq!(read(at.join("ride.json")), "2");
    let refused = open(6).unwrap_err().to_string();
    let (five, six) = (asked(5).name(), asked(6).name());
    let end =
        format!(": holds {five}, expected {six} or a new folder; changed: seeds: 6, before 5");
    assert!(refused.ends_with(&end), "{refused}");
    std::fs::remove_dir_all(&at).unwrap();
}

#[test]
fn a_folder_that_cannot_be_made_is_refused_before_the_work() {
    let at = place("no-place");
    std::fs::write(at.join("file"), "mine").unwrap();
    let refused = fresh(&at.join("file/out"), false).unwrap().check(&[]).unwrap_err();
    assert!(matches!(refused, FolderError::NoPlace(..)), "{refused}");
    let free = fresh(&at.join("a/b"), false).unwrap();
    free.check(&["x"]).unwrap();
    assert!(!at.join("a").exists());
    std::fs::remove_dir_all(&at).unwrap();
}

#[test]
fn names_count_on() {
    assert_eq!(next(Path::new("/none/ss9-160kmh-3")), Path::new("runs/ss9-160kmh-4"));
}

#[test]
fn a_result_of_another_command_is_never_replaced() {
    let at = place("other-command");
    let out = at.join("out");
    let (mut campaign, _) =
        ResultFolder::for_identity(Some(&out), "campaign", "campaign", &asked(1)).unwrap();
    campaign.create().unwrap();
    campaign.write("table.json", "1").unwrap();
    for overwrite in [false, true] {
        let refused = fresh(&out, overwrite).unwrap_err();
        assert!(refused.is_bad_input());
        let expected = "holds a result of `campaign`, expected one of `run` or a new folder; \
                        --overwrite replaces results of the same command only";
        assert!(refused.to_string().ends_with(expected), "{refused}");
    }
    assert_eq!(read(out.join("table.json")), "1");
    std::fs::remove_dir_all(&at).unwrap();
}
