//! OpenEXR, through the `exr` crate.
//!
//! One flat layer of scan lines, ZIP-compressed in blocks of 16 lines, one thread; channels by the names
//! that Blender, Nuke and tev read. Colour is multiplied by alpha, as OpenEXR has it. Attributes are UTF-8
//! strings named `epsilux.NAME`. The data window is the part that was rendered, the display window the
//! whole picture.

use std::io::Cursor;

use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Blocks, Compression, Encoding, FlatSamples, ImageAttributes,
    IntegerBounds, LayerAttributes, LineOrder, ReadChannels, ReadLayers, Text, Vec2, WritableImage,
};

use crate::color::Rgb;
use crate::film::{Image, Layer};

/// What every attribute's name begins with, so that none collides with a standard one.
const PREFIX: &str = "epsilux.";

pub(super) fn encode(image: &Image) -> Result<Vec<u8>, String> {
    let [x, y] = image.origin.map(|v| v as i32);
    let size = Vec2(image.width as usize, image.height as usize);
    let full = Vec2(image.full_size[0] as usize, image.full_size[1] as usize);
    let mut attributes = ImageAttributes::new(IntegerBounds::new(Vec2(0, 0), full));
    for (name, value) in &image.attributes {
        attributes.other.insert(text(&format!("{PREFIX}{name}")), AttributeValue::Text(text(value)));
    }
    let layer_attributes = LayerAttributes { layer_position: Vec2(x, y), ..LayerAttributes::default() };
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let channels = AnyChannels::sort(channels(image).into());
    let layer = exr::prelude::Layer::new(size, layer_attributes, encoding, channels);
    let picture = exr::prelude::Image::new(attributes, layer);
    let mut bytes = Cursor::new(Vec::new());
    picture.write().non_parallel().to_buffered(&mut bytes).map_err(|e| e.to_string())?;
    let mut bytes = bytes.into_inner();
    sort_attributes(&mut bytes).ok_or("the header is not as expected")?;
    Ok(bytes)
}

fn channels(image: &Image) -> Vec<AnyChannel<FlatSamples>> {
    let float = |name: &str, values: Vec<f32>| AnyChannel::new(text(name), FlatSamples::F32(values));
    let pick = |pixels: &[Rgb], c: usize| pixels.iter().map(|p| p[c]).collect::<Vec<f32>>();
    let mut channels = Vec::new();
    for (c, name) in ["R", "G", "B"].into_iter().enumerate() {
        channels.push(float(name, pick(&image.rgb, c)));
        if let Some(variance) = &image.variance {
            channels.push(float(&format!("variance.{name}"), pick(variance, c)));
        }
    }
    if let Some(alpha) = &image.alpha {
        channels.push(float("A", alpha.clone()));
    }
    if let Some(count) = &image.count {
        channels.push(AnyChannel::new(text("count"), FlatSamples::U32(count.clone())));
    }
    for (name, values) in image.layers.iter().flat_map(|l| &l.channels) {
        channels.push(float(name, values.clone()));
    }
    channels
}

/// EXR texts are byte strings; ours are UTF-8.
fn text(s: &str) -> Text {
    Text::from_bytes_unchecked(s.bytes().collect())
}

fn untext(text: &Text) -> String {
    String::from_utf8_lossy(text.bytes()).into_owned()
}

/// Puts the attributes of a single-part file's header in the order of their names.
///
/// The `exr` crate writes them in the order of a hash map, which differs from run to run. Their total
/// length stays, so that every offset in the file does too. `None` where the header is cut short.
fn sort_attributes(file: &mut [u8]) -> Option<()> {
    const START: usize = 8; // after the magic number and the version
    let end_of_string = |from: usize| Some(from + file.get(from..)?.iter().position(|&b| b == 0)? + 1);
    let mut spans = Vec::new();
    let mut at = START;
    while *file.get(at)? != 0 {
        let name_end = end_of_string(at)?;
        let kind_end = end_of_string(name_end)?;
        let length = u32::from_le_bytes(file.get(kind_end..kind_end + 4)?.try_into().ok()?);
        let end = kind_end + 4 + length as usize;
        spans.push(file.get(at..end)?.to_vec());
        at = end;
    }
    // Names end in a zero byte, which sorts before all others: comparing whole spans compares names.
    spans.sort();
    file[START..at].copy_from_slice(&spans.concat());
    Some(())
}

/// Reads the first layer of an EXR file; the message says what is wrong with it.
pub(super) fn decode(bytes: &[u8]) -> Result<Image, String> {
    let file = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(|e| e.to_string())?;
    let window = file.attributes.display_window;
    let layer = &file.layer_data;
    let relative = |at: i32, start: i32| u32::try_from(i64::from(at) - i64::from(start)).unwrap_or(0);
    let mut image = Image {
        width: layer.size.0 as u32,
        height: layer.size.1 as u32,
        origin: [
            relative(layer.attributes.layer_position.0, window.position.0),
            relative(layer.attributes.layer_position.1, window.position.1),
        ],
        full_size: [window.size.0 as u32, window.size.1 as u32],
        ..Image::default()
    };
    let mut channels: Vec<(String, &FlatSamples)> =
        layer.channel_data.list.iter().map(|c| (untext(&c.name), &c.sample_data)).collect();
    let names = channels.iter().map(|(n, _)| n.as_str()).collect::<Vec<_>>().join(", ");
    let mut take = |name: &str| {
        let i = channels.iter().position(|(n, _)| n == name)?;
        Some(channels.remove(i).1)
    };
    let mut take_rgb = |prefix: &str| {
        let [r, g, b] =
            ["R", "G", "B"].map(|c| take(&format!("{prefix}{c}")).map(FlatSamples::values_as_f32));
        Some(r?.zip(g?).zip(b?).map(|((r, g), b)| Rgb::new(r, g, b)).collect::<Vec<_>>())
    };
    let rgb = take_rgb("");
    image.variance = take_rgb("variance.");
    image.rgb = match rgb {
        Some(rgb) => rgb,
        None => match take("Y") {
            Some(grey) => grey.values_as_f32().map(Rgb::grey).collect(),
            None => return Err(format!("found the channels {names}, expected R, G and B, or Y")),
        },
    };
    image.alpha = take("A").map(|a| a.values_as_f32().collect());
    image.count = take("count").map(|c| match c {
        FlatSamples::U32(counts) => counts.clone(),
        other => other.values_as_f32().map(|v| v as u32).collect(),
    });
    let group = |name: &str| name.rsplit_once('.').map_or(name.to_owned(), |(group, _)| group.to_owned());
    for (name, values) in channels {
        let values = values.values_as_f32().collect();
        match image.layers.last_mut() {
            Some(last) if group(&last.channels[0].0) == group(&name) => last.channels.push((name, values)),
            _ => image.layers.push(Layer { channels: vec![(name, values)] }),
        }
    }
    for (name, value) in file.attributes.other.iter().chain(&layer.attributes.other) {
        if let (Some(name), AttributeValue::Text(value)) = (untext(name).strip_prefix(PREFIX), value) {
            image.attributes.push((name.to_owned(), untext(value)));
        }
    }
    image.attributes.sort();
    Ok(image)
}
