//! `epsilux quote`, and errors while a render runs.

use serde_json::Value;

use crate::command::{Folder, scene};

fn quote(folder: &Folder, more: &str) -> Value {
    let cornell = scene("cornell.toml");
    let line = format!("quote {} --size 24x24 --rays 100000 --json {more}", cornell.display());
    serde_json::from_str(&folder.done(&line).out).expect("JSON")
}

/// Guards that samples are a function of scene and settings, whatever threads and clocks do; that a smaller error takes
/// more of them; and that intervals hold their middle.
#[test]
fn quotes_repeat() {
    let folder = Folder::new();
    let (one, three) = (quote(&folder, "--threads 1"), quote(&folder, "--threads 3"));
    let list = |v: &Value| v["quotes"].as_array().expect("quotes").clone();
    assert_eq!(one["schema"], "epsilux.quote/1");
    assert_eq!(list(&one).len(), 5);
    let mut before = 0;
    for (a, b) in list(&one).iter().zip(list(&three)) {
        assert_eq!((&a["samples"], &a["samples_interval"]), (&b["samples"], &b["samples_interval"]));
        let samples = a["samples"].as_u64().expect("a number");
        let [low, high] = [0, 1].map(|i| a["samples_interval"][i].as_u64().expect("a number"));
        assert!(low <= samples && samples <= high && samples > before, "{a}");
        before = samples;
    }
    let light: f64 = one["parts"].as_array().expect("parts").iter().filter_map(|p| p["light"].as_f64()).sum();
    assert!((light - 1.0).abs() < 1e-6, "{light}");
    let photons = |a: &Value| a["flag"] == "--algorithm caustics=photon";
    assert!(!one["alternatives"].as_array().expect("a list").iter().any(photons), "nothing throws light");
}

/// Guards advice: where paths hardly find a caustic, photons are tried; where a part that is not most of the light has
/// the most noise, the picture without it; and neither where a flag asks for it. Lines say so.
#[test]
fn what_else_there_is_is_tried() {
    let folder = Folder::new();
    let caustic = scene("caustic.toml");
    let line = format!("quote {} --size 32x32 --rays 200000 --error 20%", caustic.display());
    let said = folder.done(&line).out;
    assert!(said.lines().any(|l| l.starts_with("caustic: ") && l.ends_with("; found by paths")), "{said}");
    assert!(said.lines().any(|l| l.contains("--algorithm caustics=photon would take")), "{said}");
    let flags = |line: &str, more: &str| -> (Vec<String>, Value) {
        let said = folder.done(&format!("{line} --json {more}")).out;
        let said: Value = serde_json::from_str(&said).expect("JSON");
        let list = said["alternatives"].as_array().expect("a list").clone();
        let flag = |a: &Value| a["flag"].as_str().expect("a flag").to_owned();
        (list.iter().map(flag).collect(), said)
    };
    let (tried, said) = flags(&line, "");
    assert!(tried.contains(&"--algorithm caustics=photon".to_owned()), "{said}");
    assert!(!flags(&line, "--algorithm caustics=photon").0.contains(&tried[0]));
    let (tried, said) = flags(&line, "--without caustics");
    assert!(tried.iter().all(|t| t != "--without caustics"), "{said}");
    let cornell = scene("cornell.toml");
    let line = format!("quote {} --size 128x128 --rays 3000000 --error 8%", cornell.display());
    assert_eq!(flags(&line, "").0, ["--without indirect"]);
    assert_eq!(flags(&line, "--without indirect").0, [""; 0]);
    let said = folder.done(&line).out;
    let lines: Vec<&str> = said.lines().collect();
    assert!(lines.iter().any(|l| l.starts_with("indirect: 2") && l.ends_with(" % of the noise")), "{said}");
    let (_, end) =
        lines.last().and_then(|l| l.split_once(" for 8 %, and lack ")).unwrap_or_else(|| panic!("{said}"));
    assert!(lines.last().is_some_and(|l| l.starts_with("--without indirect would take ")), "{said}");
    let lost: f64 = end.split(' ').next().and_then(|n| n.parse().ok()).expect("a number");
    assert!((15.0..25.0).contains(&lost), "{said}");
}

/// Guards what programs see of a render that asks for an error.
#[test]
fn progress_tells_the_error() {
    let folder = Folder::new();
    let cornell = scene("cornell.toml");
    let line = format!("render {} --size 32x32 --error 8% -q --progress json -o a.exr", cornell.display());
    let said = folder.done(&line);
    let last: Value = serde_json::from_str(said.err.lines().last().expect("a line")).expect("JSON");
    assert_eq!((&last["error"]["trusted"], &last["error_target"]), (&true.into(), &0.08.into()), "{last}");
    assert!(last["error"]["error"].as_f64().expect("a number") <= 0.08, "{last}");
    assert_eq!(last["passes"], last["error_passes"]);
    assert!(last["rays"].as_u64().expect("a number") > 0);
    let report: Value = serde_json::from_slice(&folder.read("a.report.json")).expect("JSON");
    assert_eq!(report["error"]["error"], last["error"]["error"]);
    assert!(report.as_object().expect("an object").contains_key("quoted"));
}

/// Guards what is said of light that few samples find: two in this picture meet the spot behind the keyhole.
#[test]
fn few_samples_are_told() {
    let folder = Folder::new();
    let keyhole = scene("../fixtures/misleading/keyhole.toml");
    let said = folder.done(&format!("render {} --spp 64 -o a.exr", keyhole.display())).err;
    let line = said.lines().find(|l| l.starts_with("error ")).unwrap_or_else(|| panic!("{said}"));
    assert_eq!(
        line,
        "error above 25.0 %, not trustworthy yet: 0.000763 % of the samples carry 9 % of the light"
    );
    // And of light that none finds.
    let pinhole = scene("../fixtures/misleading/pinhole.toml");
    let said = folder.done(&format!("render {} --spp 64 -o a.exr", pinhole.display())).err;
    let line = said.lines().find(|l| l.starts_with("error ")).unwrap_or_else(|| panic!("{said}"));
    assert!(line.contains("not trustworthy yet: nothing from light \"lamp\" arrived, of which so few samples may miss up to "), "{line}");
    assert!(line.ends_with(" times what is shown"), "{line}");
    let report: Value = serde_json::from_slice(&folder.read("a.report.json")).expect("JSON");
    assert_eq!(report["error"]["doubt"]["kind"], "light-not-reached");
}
