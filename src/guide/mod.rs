//! The guide for users, page by page.
//!
//! What stands in these pages is tested: every scene in them is read, every key of the scene form is
//! named in them, and the notes that they explain are those that exist.

#[doc = include_str!("start.md")]
pub mod start {}

#[doc = include_str!("scene-format.md")]
pub mod scene_format {}

#[doc = include_str!("from-blender.md")]
pub mod from_blender {}

#[doc = include_str!("extension.md")]
pub mod extension {}

#[doc = include_str!("convert.md")]
pub mod convert {}

#[doc = include_str!("from-obj.md")]
pub mod from_obj {}

#[doc = include_str!("golden.md")]
pub mod golden {}

#[doc = include_str!("hard-cases.md")]
pub mod hard_cases {}

#[doc = include_str!("plan.md")]
pub mod plan {}

#[doc = include_str!("shortcuts.md")]
pub mod shortcuts {}

#[doc = include_str!("numbers.md")]
pub mod numbers {}

#[doc = include_str!("long-renders.md")]
pub mod long_renders {}

#[doc = include_str!("accuracy.md")]
pub mod accuracy {}
#[doc = include_str!("cost.md")]
pub mod cost {}

#[doc = include_str!("report.md")]
pub mod report {}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use crate::scene::text;

    const PAGES: &[(&str, &str)] = &[
        ("start.md", include_str!("start.md")),
        ("scene-format.md", include_str!("scene-format.md")),
        ("from-blender.md", include_str!("from-blender.md")),
        ("convert.md", include_str!("convert.md")),
        ("from-obj.md", include_str!("from-obj.md")),
        ("golden.md", include_str!("golden.md")),
        ("hard-cases.md", include_str!("hard-cases.md")),
        ("plan.md", include_str!("plan.md")),
        ("shortcuts.md", include_str!("shortcuts.md")),
        ("numbers.md", include_str!("numbers.md")),
        ("long-renders.md", include_str!("long-renders.md")),
        ("accuracy.md", include_str!("accuracy.md")),
        ("cost.md", include_str!("cost.md")),
        ("report.md", include_str!("report.md")),
        ("README.md", include_str!("../../README.md")),
    ];

    /// The blocks of a page in one language, each with its line.
    fn blocks(page: &str, language: &str) -> Vec<(usize, String)> {
        let (mut found, mut open): (Vec<(usize, String)>, bool) = (Vec::new(), false);
        for (line, number) in page.lines().zip(1..) {
            match line.strip_prefix("```") {
                Some(name) if !open && name == language => {
                    found.push((number, String::new()));
                    open = true;
                }
                Some(_) => open = false,
                None if open => {
                    if let Some((_, text)) = found.last_mut() {
                        *text += &format!("{line}\n");
                    }
                }
                None => {}
            }
        }
        found
    }

    /// A reader can paste any example; where it is a part, it lacks only the mark of a scene.
    #[test]
    fn every_scene_in_the_guide_is_read() {
        let mut count = 0;
        for &(name, page) in PAGES {
            for (line, block) in blocks(page, "toml") {
                let marked = block.lines().any(|l| l.starts_with("epsilux ="));
                let scene = if marked { block } else { format!("epsilux = 1\n{block}") };
                if let Err(e) = text::parse_toml(&scene) {
                    panic!("{name}:{line}: {e}\n{scene}");
                }
                count += 1;
            }
        }
        assert!(count >= 12, "{count} examples were found");
    }

    /// The page about the scene form leaves no key and no word out.
    #[test]
    fn every_key_of_the_form_is_named() {
        let page = PAGES[1].1;
        let named =
            |key: &str| page.split(|c: char| !c.is_alphanumeric() && c != '_' && c != '$').any(|w| w == key);
        let mut keys = BTreeSet::new();
        collect(&text::schema(), &mut keys);
        assert!(keys.len() > 80 && keys.contains("fov_axis") && keys.contains("agx"), "{keys:?}");
        let missing: Vec<_> = keys.into_iter().filter(|k| !named(k)).collect();
        assert_eq!(missing, [""; 0]);
    }

    /// The suite in the page about golden tests is read, and its table has every key.
    #[test]
    fn the_suite_in_the_guide_is_read() {
        let page = include_str!("golden.md");
        let blocks = blocks(page, "text");
        let suite = crate::golden::Suite::parse(&blocks[0].1).expect("the page's first example");
        assert_eq!(suite.scenes.len(), 2);
        let keys =
            ["name", "file", "camera", "size", "spp", "max_depth", "reference", "guards", "truth", "accept"];
        let missing: Vec<_> = keys.into_iter().filter(|k| !page.contains(&format!("| `{k}` |"))).collect();
        assert_eq!(missing, [""; 0]);
    }

    /// Names of properties and values of enums, anywhere in a JSON Schema.
    fn collect(schema: &serde_json::Value, keys: &mut BTreeSet<String>) {
        match schema {
            serde_json::Value::Object(map) => {
                for (key, value) in map {
                    match (key.as_str(), value) {
                        ("properties", serde_json::Value::Object(p)) => keys.extend(p.keys().cloned()),
                        ("enum", serde_json::Value::Array(words)) => {
                            keys.extend(words.iter().filter_map(|w| w.as_str().map(str::to_owned)));
                        }
                        _ => {}
                    }
                    collect(value, keys);
                }
            }
            serde_json::Value::Array(list) => list.iter().for_each(|v| collect(v, keys)),
            _ => {}
        }
    }

    /// Where the guide explains a note by its code, there is such a note.
    #[test]
    fn notes_in_the_guide_exist() {
        let sources = [
            include_str!("../export/obj/mod.rs"),
            include_str!("../import/gltf/extension.rs"),
            include_str!("../import/gltf/light.rs"),
            include_str!("../import/gltf/material.rs"),
            include_str!("../import/gltf/mesh.rs"),
            include_str!("../import/gltf/mod.rs"),
            include_str!("../import/gltf/node.rs"),
            include_str!("../import/obj/clean.rs"),
            include_str!("../import/obj/material.rs"),
            include_str!("../import/obj/mod.rs"),
            include_str!("../import/obj/parse.rs"),
            include_str!("../import/obj/sidecar.rs"),
            include_str!("../import/obj/texture.rs"),
            include_str!("../scene/defaults.rs"),
            include_str!("../scene/pictures.rs"),
        ];
        let mut count = 0;
        for &(name, page) in PAGES {
            for row in page.lines().filter_map(|l| l.strip_prefix("| note `")) {
                let code = row.split('`').next().unwrap_or_default();
                let quoted = format!("\"{code}\"");
                assert!(sources.iter().any(|s| s.contains(&quoted)), "{name}: {code}");
                count += 1;
            }
        }
        assert!(count >= 10, "{count} notes were found");
    }
}
