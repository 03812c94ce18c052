//! What people read first.

use crate::command::Folder;

/// Help of every command, as a pipe receives it.
#[test]
fn help_teaches() {
    let folder = Folder::new();
    for command in [
        "",
        "render",
        "explain",
        "info",
        "convert",
        "compare",
        "quote",
        "check",
        "cost",
        "golden",
        "golden record",
        "golden verify",
        "golden bless",
        "golden report",
        "golden power",
        "demo",
        "schema",
    ] {
        let said = folder.done(&format!("{command} --help"));
        assert_eq!(said.err, "");
        let name = if command.is_empty() { "epsilux".to_owned() } else { command.replace(' ', "_") };
        insta::assert_snapshot!(format!("help_{name}"), said.out);
    }
}

/// Without a command there is help too, and a mistake.
#[test]
fn no_command_is_wrong_usage() {
    let said = Folder::new().run("");
    assert_eq!((said.code, said.out.as_str()), (Some(2), ""));
    assert!(said.err.contains("Usage: epsilux <COMMAND>"), "{}", said.err);
}

/// The schema is JSON, and is the file that scenes name in their first line.
#[test]
fn schema_is_the_one_in_scenes() {
    let said = Folder::new().done("schema");
    let printed: serde_json::Value = serde_json::from_str(&said.out).unwrap();
    let kept = std::fs::read(crate::command::scene("epsilux.schema.json")).unwrap();
    assert_eq!(printed, serde_json::from_slice::<serde_json::Value>(&kept).unwrap());
}
