//! OpenEXR: the first layer that has R, G and B, or Y, under any name before the last dot.

use std::cell::Cell;
use std::io::Cursor;

use exr::meta::MetaData;
use exr::prelude::{ReadChannels, ReadLayers, ReadSpecificChannel, Text, Vec2};

use super::super::budget::{Budget, filled};
use super::super::error::Fault;
use super::{broken, check_size};
use crate::scene::{ImageFormat, Pixels, Texels};

/// Which channels are read.
enum Channels {
    Rgb([Text; 3]),
    Grey(Text),
}

/// Decodes an OpenEXR file; texels come out as the file has them.
pub(super) fn decode(bytes: &[u8], place: &str, budget: &mut Budget) -> Result<Pixels, Fault> {
    let fault = |e: exr::error::Error| broken(ImageFormat::Exr, &e.to_string(), place);
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(fault)?;
    let flat = meta.headers.iter().filter(|h| !h.deep);
    let Some((Vec2(width, height), channels)) = flat.clone().find_map(|h| {
        let names: Vec<&Text> = h.channels.list.iter().map(|c| &c.name).collect();
        Some((h.layer_size, pick(&names)?))
    }) else {
        let names: Vec<_> = flat.flat_map(|h| &h.channels.list).map(|c| c.name.to_string()).collect();
        let found = format!("an OpenEXR picture with the channels {}", names.join(", "));
        return Err(Fault::invalid(place, found, "R, G and B, or Y, in a layer that is not deep"));
    };
    check_size([width as u64, height as u64], 12, ImageFormat::Exr, place, budget)?;
    let store = Cell::new(filled(width * height, [0.0_f32; 3], place)?);
    // The first layer with these channels is the one that was measured; a texel outside is not stored.
    let at = move |p: Vec2<usize>| p.1 * width + p.0;
    let create = move |_: Vec2<usize>| store.take();
    let set = move |list: &mut Vec<[f32; 3]>, p, texel| {
        if let Some(slot) = list.get_mut(at(p)) {
            *slot = texel;
        }
    };
    let reader = exr::prelude::read().no_deep_data().largest_resolution_level();
    let texels = match channels {
        Channels::Rgb([r, g, b]) => {
            let reader = reader.specific_channels().required(r).required(g).required(b).collect_pixels(
                move |size, _| create(size),
                move |list, p, (r, g, b)| set(list, p, [r, g, b]),
            );
            let reader = reader.first_valid_layer().all_attributes().non_parallel();
            reader.from_buffered(Cursor::new(bytes)).map_err(fault)?.layer_data.channel_data.pixels
        }
        Channels::Grey(y) => {
            let reader = reader.specific_channels().required(y).collect_pixels(
                move |size, _| create(size),
                move |list, p, (y,): (f32,)| set(list, p, [y; 3]),
            );
            let reader = reader.first_valid_layer().all_attributes().non_parallel();
            reader.from_buffered(Cursor::new(bytes)).map_err(fault)?.layer_data.channel_data.pixels
        }
    };
    if texels.len() != width * height {
        return Err(broken(ImageFormat::Exr, "layers of different sizes", place));
    }
    Ok(Pixels { width: width as u32, height: height as u32, texels: Texels::Float(texels) })
}

/// R, G and B without a prefix, else those with the first prefix that has all three; then Y likewise.
fn pick(names: &[&Text]) -> Option<Channels> {
    let find = |prefix: &[u8], channel: u8| {
        let is_it = |n: &&&Text| n.bytes().strip_prefix(prefix) == Some(&[channel]);
        names.iter().find(is_it).map(|&n| n.clone())
    };
    let bytes = names.iter().map(|n| n.bytes());
    let prefixes = || {
        let dotted = bytes.clone().filter(|n| n.len() >= 2 && n[n.len() - 2] == b'.');
        std::iter::once(&b""[..]).chain(dotted.map(|n| &n[..n.len() - 1]))
    };
    let rgb = |p: &[u8]| Some(Channels::Rgb([find(p, b'R')?, find(p, b'G')?, find(p, b'B')?]));
    prefixes().find_map(rgb).or_else(|| prefixes().find_map(|p| find(p, b'Y').map(Channels::Grey)))
}
