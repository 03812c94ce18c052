//! The white furnace: under a uniform sky, whatever absorbs nothing is invisible.

use epsilux::color::Rgb;
use epsilux::glam::DVec3;
use epsilux::scene::{MaterialKind, Scene};

use super::{Build, Case, diffuse, glass, mirror, principled, probe, sky};

pub(super) fn cases() -> Vec<Case> {
    let mut materials: Vec<(String, MaterialKind)> = vec![
        ("diffuse".into(), diffuse(1.0)),
        ("mirror".into(), mirror(1.0)),
        ("glass".into(), glass(1.5)),
        ("bubble".into(), glass(0.7)),
    ];
    for roughness in [0.0, 0.1, 0.3, 0.6, 1.0] {
        let mut add = |name: &str, change: fn(&mut epsilux::scene::Principled)| {
            let kind = principled(|p| {
                p.roughness = roughness;
                change(p);
            });
            materials.push((format!("{name}, roughness {roughness}"), kind));
        };
        add("metal", |p| p.metallic = 1.0);
        add("layer over white", |_| ());
        add("strong layer", |p| {
            p.ior = 1.8;
            p.specular_color = Rgb::grey(3.0);
        });
        add("rough glass", |p| p.transmission = 1.0);
        add("glass of index one", |p| {
            p.transmission = 1.0;
            p.ior = 1.0;
        });
        add("thin sheet", |p| {
            p.transmission = 1.0;
            p.thin = true;
        });
        add("coat over white", |p| p.coat = 0.8);
        add("rough coat over white", |p| (p.coat, p.coat_ior, p.coat_roughness) = (1.0, 1.8, p.roughness));
        add("white sheen over white", |p| (p.sheen_color, p.sheen_roughness) = (Rgb::WHITE, p.roughness));
        add("a bit of everything", |p| {
            p.metallic = 0.3;
            p.transmission = 0.6;
            p.specular = 0.5;
        });
    }
    materials.into_iter().map(|(name, kind)| furnace(&name, kind)).collect()
}

/// A ball, seen in its middle and near its edge.
fn furnace(name: &str, kind: MaterialKind) -> Case {
    let mut scene = Scene { environment: sky(1.0), ..Scene::default() };
    scene.sphere(DVec3::ZERO, 1.0, kind);
    let ray = |b: f64| probe(DVec3::new(b, 0.0, 3.0), -DVec3::Z);
    let case = Case::new(format!("furnace: {name}"), scene, ray(0.0), 1.0).samples(40_000);
    // Many reflections inside a rough ball multiply many weights.
    let case =
        case.tolerance(if name.contains("rough glass") || name.contains("everything") { 0.03 } else { 0.01 });
    Case { probes: [0.0, 0.5, 0.85, 0.98, 0.999].map(ray).to_vec(), ..case }
}
