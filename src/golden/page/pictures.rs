//! Pictures inside a page.
//!
//! In: images and z-values. Out: `figure` elements that hold their pictures. The invariants: a picture of
//! radiance is exposed by the reference alone, so that reference and render can be compared by eye; a value
//! that is not a number is magenta, and nothing else is.

use super::text::{Text, change, percent, signed};
use crate::color::{Rgb, srgb_to_linear};
use crate::film::{Image, LightLayer};
use crate::page::picture::{ODD, exposure_of_part, img, layer, raised, total};

/// Deviations at the ends of the colour scale.
const MOST: f64 = 4.0;
/// The colour scale, encoded sRGB, from the most negative to the most positive: blue, near white, orange. The
/// two sides differ in hue and are alike in lightness, for every kind of colour vision.
const SCALE: [[f32; 3]; 5] = [
    [0.031, 0.235, 0.482],
    [0.384, 0.639, 0.855],
    [0.957, 0.957, 0.945],
    [0.945, 0.624, 0.32],
    [0.612, 0.227, 0.0],
];
/// Side of a block of the coarse map, pixels.
const BLOCK: usize = 8;
/// A layer that holds less of the light of both pictures is not shown.
const NEXT_TO_NOTHING: f64 = 1e-6;

fn figure(picture: &str, name: &str, detail: &str) -> String {
    format!(
        "<figure><div class=\"picture\">{picture}</div><figcaption><b>{}</b> {}</figcaption></figure>\n",
        Text(name),
        Text(detail)
    )
}

/// Radiance, exposed by `stops`.
pub(super) fn radiance(image: &Image, stops: f32, name: &str, detail: &str, alt: &str) -> String {
    let [w, h] = [image.width as usize, image.height as usize];
    figure(&img([w, h], image.rgb.clone(), raised(stops), alt), name, detail)
}

/// Where nothing could be rendered.
pub(super) fn missing(name: &str, why: &str) -> String {
    figure(&format!("<p class=\"missing\">{}</p>", Text(why)), name, "")
}

/// A square that stands out: left, top, side.
pub(super) type Square = [usize; 3];

/// The signed difference, pixel by pixel and block by block, with `squares` drawn around; empty where `z` has
/// not one value for each pixel.
pub(super) fn differences(z: &[f32], width: usize, squares: &[Square], scene: &str) -> String {
    if width == 0 || z.is_empty() || !z.len().is_multiple_of(width) {
        return String::new();
    }
    let height = z.len() / width;
    let map = |w: usize, h: usize, z: &[f64], kind: &str| {
        let alt = format!("{scene}: {kind} of render and reference, in deviations");
        let pixels = z.iter().map(|&z| deviation_colour(z)).collect();
        img([w, h], pixels, raised(0.0), &alt) + &frames(width, height, squares)
    };
    let fine: Vec<f64> = z.iter().map(|&z| f64::from(z)).collect();
    let (w, h, coarse) = blocks(&fine, width);
    let pixels = figure(
        &map(width, height, &fine, "signed difference"),
        "Difference",
        "in luminance, over its standard error",
    );
    // Blocks of a picture whose sides they do not divide would be drawn too large at its edges.
    if !width.is_multiple_of(BLOCK) || !height.is_multiple_of(BLOCK) {
        return pixels;
    }
    let name = format!("{BLOCK}\u{d7}{BLOCK} blocks");
    pixels
        + &figure(
            &map(w, h, &coarse, "signed difference of blocks"),
            &name,
            "sums of it, over their standard error",
        )
}

/// Deviations summed over blocks, over the square root of the number of pixels: deviations again, where pixels
/// are independent.
fn blocks(z: &[f64], width: usize) -> (usize, usize, Vec<f64>) {
    let (w, h) = (width.div_ceil(BLOCK), (z.len() / width).div_ceil(BLOCK));
    let mut sums = vec![(0.0, 0.0); w * h];
    for (i, &z) in z.iter().enumerate() {
        let (sum, n) = &mut sums[i / width / BLOCK * w + i % width / BLOCK];
        *sum += z;
        *n += 1.0;
    }
    (w, h, sums.into_iter().map(|(sum, n): (f64, f64)| sum / n.max(1.0).sqrt()).collect())
}

/// Outlines over a picture.
fn frames(width: usize, height: usize, squares: &[Square]) -> String {
    if squares.is_empty() {
        return String::new();
    }
    let square = |class: &str, [x, y, side]: &Square| {
        format!("<rect class=\"{class}\" x=\"{x}\" y=\"{y}\" width=\"{side}\" height=\"{side}\"/>")
    };
    let all = |class: &str| squares.iter().map(|s| square(class, s)).collect::<String>();
    format!(
        "<svg class=\"frames\" viewBox=\"0 0 {width} {height}\" preserveAspectRatio=\"none\" \
         aria-hidden=\"true\">{}{}</svg>",
        all("halo"),
        all("frame")
    )
}

/// Encoded sRGB of a number of deviations that is not NaN.
fn scale(z: f64) -> Rgb {
    let steps = SCALE.len() - 1;
    let at = ((z / MOST).clamp(-1.0, 1.0) + 1.0) * 0.5 * steps as f64;
    let k = (at as usize).min(steps - 1);
    Rgb::from(SCALE[k]).lerp(Rgb::from(SCALE[k + 1]), (at - k as f64) as f32)
}

/// Linear, as pictures want it.
fn deviation_colour(z: f64) -> Rgb {
    if z.is_nan() { ODD } else { scale(z).map(srgb_to_linear) }
}

/// What the colours of differences mean, and their outlines where there are some.
pub(super) fn legend(outlined: bool) -> String {
    const SWATCHES: usize = 33;
    let note =
        if outlined { "<span class=\"outlined\">Outlined: tiles beyond the threshold</span> " } else { "" };
    let mut svg = format!("<div class=\"legend\">{note}");
    svg += "<span>darker than the reference</span> <svg role=\"img\" viewBox=\"0 0 264 34\">\
         <title>Colour scale from 4 deviations darker (blue) to 4 deviations brighter (orange)</title>";
    for i in 0..SWATCHES {
        let z = (2.0 * i as f64 / (SWATCHES - 1) as f64 - 1.0) * MOST;
        let [r, g, b] = scale(z).to_array().map(|v| (v * 255.0 + 0.5) as u8);
        let x = 8.0 * i as f64;
        svg +=
            &format!("<rect x=\"{x}\" y=\"0\" width=\"8.2\" height=\"14\" fill=\"#{r:02x}{g:02x}{b:02x}\"/>");
    }
    for z in [-4, -2, 0, 2, 4] {
        let x = 132.0 + f64::from(z) * 31.0;
        let number = signed(f64::from(z), 0);
        svg += &format!("<text x=\"{x}\" y=\"29\" text-anchor=\"middle\">{number}</text>");
    }
    svg + "</svg> <span>brighter</span></div>\n"
}

/// The parts that the light consists of, side by side, where they are not black; empty where an image has none.
pub(super) fn layers(reference: &Image, image: Option<&Image>, scene: &str) -> String {
    let [w, h] = [reference.width as usize, reference.height as usize];
    let whole = total(&reference.rgb);
    let mut strips = String::new();
    for name in LightLayer::ALL.map(LightLayer::name) {
        let Some(before) = layer(reference, name) else { continue };
        let after = image.and_then(|i| layer(i, name)).filter(|a| a.len() == before.len());
        let (was, is) = (total(&before), after.as_ref().map(|a| total(a)));
        if was.max(is.unwrap_or(0.0)) <= NEXT_TO_NOTHING * whole {
            continue;
        }
        let stops = exposure_of_part(if was > 0.0 { &before } else { after.as_ref().unwrap_or(&before) });
        let share = if whole > 0.0 { percent(was / whole) + " of the light" } else { String::new() };
        let pair = img([w, h], before, raised(stops), &format!("{scene}: {name} light of the reference"));
        let (other, moved) = match (after, is) {
            (Some(after), Some(is)) => (
                img([w, h], after, raised(stops), &format!("{scene}: {name} light of the render")),
                if was > 0.0 { change(is / was - 1.0) } else { "not in the reference".into() },
            ),
            _ => ("<p class=\"missing\">no layer</p>".into(), String::new()),
        };
        strips += &format!(
            "<figure><div class=\"pair\">{pair}{other}</div><figcaption><b>{name}</b> {share}<br>\
             <span class=\"moved\">{moved}</span></figcaption></figure>\n"
        );
    }
    strips
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The scale is blue below, orange above, near white between, and ends at four deviations.
    #[test]
    fn deviations_have_colours() {
        let [low, zero, high] = [-4.0, 0.0, 4.0].map(deviation_colour);
        assert!(low.b > 2.0 * low.r && high.r > 2.0 * high.b && zero.min_channel() > 0.8);
        assert_eq!(deviation_colour(-1e9), low);
        assert_eq!(deviation_colour(f64::INFINITY), high);
        assert_eq!(deviation_colour(f64::NAN), ODD);
    }

    /// Independent deviations stay what they are, and a common shift adds up.
    #[test]
    fn blocks_are_deviations() {
        let mut z = vec![0.5; 16 * 8];
        z[0] = 8.5;
        assert_eq!(blocks(&z, 16), (2, 1, vec![5.0, 4.0]));
        let (w, h, z) = blocks(&[1.0; 9 * 9], 9);
        assert_eq!((w, h, z[0], z[3]), (2, 2, 8.0, 1.0), "an edge block has fewer pixels");
    }

    /// Wrong sizes make no picture, and no panic.
    #[test]
    fn wrong_sizes_are_left_out() {
        assert_eq!(differences(&[0.0; 5], 2, &[], "x"), "");
        assert_eq!(differences(&[], 0, &[], "x"), "");
    }
}
