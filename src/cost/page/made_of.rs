//! What the picture is made of: its layers, each with its share of light, noise and rays.

use super::prices::bar;
use crate::cost::pictures::{LayerPicture, Pictures};
use crate::cost::report::{CostReport, LayerShare};
use crate::page::picture::{exposure_of_part, img, raised};
use crate::page::text::{Text, percent};

/// What each layer is, for people.
fn means(layer: &str) -> &'static str {
    match layer {
        "direct" => "from lamps onto a surface, and to the eye",
        "indirect" => "scattered at least twice",
        "caustic" => "thrown onto something by mirrors and glass",
        "glass" => "seen in mirrors and through glass",
        "emitted" => "lamps and the sky themselves",
        _ => "",
    }
}

/// A figure for each layer.
pub(super) fn layers(report: &CostReport, pictures: &Pictures) -> String {
    let size = pictures.size.map(|v| v as usize);
    let figure = |(share, layer): (&LayerShare, &LayerPicture)| {
        // As the whole picture is exposed, unless there would be nothing to see.
        let own = exposure_of_part(&layer.rgb);
        let stops = own.max(pictures.tone.exposure);
        let more = stops - pictures.tone.exposure;
        let said = if more > 0.05 { format!(", {more:.1} stops brighter here") } else { String::new() };
        let alt = format!("{}: {} light", report.scene, layer.name);
        let mut shares = row("light", share.light, "blue");
        if let Some(noise) = share.noise {
            shares += &row("noise", noise, "orange");
        }
        if let Some(rays) = share.rays {
            shares += &row("rays", rays, "grey");
        }
        format!(
            "<figure>{}<figcaption><b>{}</b> {}{}</figcaption><ul class=\"bars\">\n{shares}</ul></figure>\n",
            img(size, layer.rgb.clone(), raised(stops), &alt),
            layer.name,
            Text(means(layer.name)),
            Text(&said),
        )
    };
    let whole = format!(
        "<figure>{}<figcaption><b>Whole</b> all of them, {} samples a pixel</figcaption></figure>\n",
        img(size, pictures.whole.clone(), pictures.tone, &format!("{}: the whole picture", report.scene)),
        pictures.spp,
    );
    let figures: String = report.layers.iter().zip(&pictures.layers).map(figure).collect();
    if figures.is_empty() {
        return figures;
    }
    format!(
        "<p class=\"note\">Each bit of light is in exactly one of these; together they are the picture. The shares are those \
         of all light, of the noise, and of the rays.</p>\n<div class=\"layers\">\n{whole}{figures}</div>\n"
    )
}

fn row(name: &str, share: f64, class: &str) -> String {
    format!(
        "<li><span class=\"name\">{name}</span> <span class=\"number\">{}</span>{}</li>\n",
        Text(&percent(share)),
        bar(share, class)
    )
}
