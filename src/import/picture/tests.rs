//! Every format in and out, broken streams, limits, and sharing.

use std::fs;

use image::{DynamicImage, Rgb32FImage, RgbaImage};

use super::super::ReadOptions;
use super::*;
use crate::scene::notes::Notes;

fn budget() -> Budget {
    Budget::new(&ReadOptions::default())
}

/// A picture in a format of the `image` package.
fn encoded(picture: &DynamicImage, format: image::ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// Red, green, blue and half-transparent grey, two by two.
fn four() -> DynamicImage {
    let texels = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [128, 128, 128, 64]];
    DynamicImage::ImageRgba8(RgbaImage::from_raw(2, 2, texels.concat()).unwrap())
}

/// An OpenEXR file of one pixel, with these channels.
fn openexr(channels: &[(&str, f32)]) -> Vec<u8> {
    use exr::prelude::{
        AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, WritableImage,
    };
    let channel = |&(name, v): &(&str, f32)| AnyChannel::new(name, FlatSamples::F32(vec![v]));
    let channels = AnyChannels::sort(channels.iter().map(channel).collect());
    let layer = Layer::new((1, 1), LayerAttributes::default(), Encoding::UNCOMPRESSED, channels);
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer).write().non_parallel().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

fn texels(bytes: &[u8], place: &str) -> (Texels, usize, ImageFormat) {
    let decoded = decode(bytes, place, &mut budget()).unwrap();
    (decoded.pixels.texels, decoded.repaired, decoded.format)
}

/// Bytes, shorts, palettes, grey, floats: each format gives the texels that went in.
#[test]
fn every_format_gives_the_texels_that_went_in() {
    let rgba = Texels::Byte(vec![[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [128, 128, 128, 64]]);
    let rgb = Texels::Byte(vec![[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [128, 128, 128, 255]]);
    let opaque = DynamicImage::ImageRgb8(four().to_rgb8());
    let check = |picture: &DynamicImage, format, expected: &Texels, as_what| {
        let (found, repaired, format) = texels(&encoded(picture, format), "a.tga");
        assert_eq!((&found, repaired, format), (expected, 0, as_what));
    };
    check(&four(), image::ImageFormat::Png, &rgba, ImageFormat::Png);
    check(&four(), image::ImageFormat::WebP, &rgba, ImageFormat::Webp);
    check(&four(), image::ImageFormat::Tga, &rgba, ImageFormat::Tga);
    check(&opaque, image::ImageFormat::Bmp, &rgb, ImageFormat::Bmp);
    check(&opaque, image::ImageFormat::Png, &rgb, ImageFormat::Png);
    let grey = DynamicImage::ImageLuma8(image::GrayImage::from_raw(2, 1, vec![7, 9]).unwrap());
    let both = Texels::Byte(vec![[7, 7, 7, 255], [9, 9, 9, 255]]);
    check(&grey, image::ImageFormat::Png, &both, ImageFormat::Png);
    let deep = image::ImageBuffer::from_raw(1, 1, vec![1_u16, 256, 65535, 3]).unwrap();
    let short = Texels::Short(vec![[1, 256, 65535, 3]]);
    check(&DynamicImage::ImageRgba16(deep), image::ImageFormat::Png, &short, ImageFormat::Png);
    let bright = Rgb32FImage::from_raw(1, 1, vec![0.5, 2.0, 16.0]).unwrap();
    let float = Texels::Float(vec![[0.5, 2.0, 16.0]]);
    check(&DynamicImage::ImageRgb32F(bright), image::ImageFormat::Hdr, &float, ImageFormat::Hdr);

    // JPEG loses some of it.
    let flat = DynamicImage::ImageRgb8(image::RgbImage::from_pixel(8, 8, image::Rgb([200, 100, 50])));
    let (Texels::Byte(found), _, ImageFormat::Jpeg) = texels(&encoded(&flat, image::ImageFormat::Jpeg), "")
    else {
        panic!("not a JPEG")
    };
    let near = |t: &[u8; 4]| t.iter().zip([200, 100, 50, 255]).all(|(&a, b)| a.abs_diff(b) <= 3);
    assert!(found.len() == 64 && found.iter().all(near), "{found:?}");
}

/// A palette with transparency, two texels in a byte, as paint programs write icons.
#[test]
fn palettes_are_undone() {
    let mut bytes = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut bytes, 3, 1);
    encoder.set_color(::png::ColorType::Indexed);
    encoder.set_depth(::png::BitDepth::Four);
    encoder.set_palette(vec![1, 2, 3, 40, 50, 60]);
    encoder.set_trns(vec![255, 9]);
    encoder.write_header().unwrap().write_image_data(&[0x01, 0x10]).unwrap();
    let expected = Texels::Byte(vec![[1, 2, 3, 255], [40, 50, 60, 9], [40, 50, 60, 9]]);
    assert_eq!(texels(&bytes, "").0, expected);
}

/// The first layer with colours counts, whatever it is called; what no picture can have is repaired.
#[test]
fn openexr_gives_the_first_layer_with_colours() {
    let check = |channels: &[(&str, f32)], expected, repaired| {
        let bytes = openexr(channels);
        assert_eq!(texels(&bytes, ""), (Texels::Float(vec![expected]), repaired, ImageFormat::Exr));
    };
    check(&[("R", 1.0), ("G", 2.0), ("B", 3.0), ("A", 0.5)], [1.0, 2.0, 3.0], 0);
    check(&[("Y", 4.0)], [4.0; 3], 0);
    check(&[("Sky.Combined.R", 1.0), ("Sky.Combined.G", 2.0), ("Sky.Combined.B", 3.0)], [1.0, 2.0, 3.0], 0);
    check(&[("Z.R", 1.0), ("R", 5.0), ("G", 6.0), ("B", 7.0), ("a.Y", 1.0)], [5.0, 6.0, 7.0], 0);
    check(&[("R", -1.0), ("G", f32::NAN), ("B", f32::INFINITY)], [0.0, 0.0, 65504.0], 1);
    let error = decode(&openexr(&[("Z", 1.0), ("N.X", 2.0)]), "here", &mut budget()).unwrap_err();
    let expected = "an OpenEXR picture with the channels N.X, Z";
    assert!(matches!(&error, Fault::Invalid { found, .. } if found == expected), "{error:?}");
}

/// What a fault says, for snapshots.
fn said(result: Result<Decoded, Fault>) -> String {
    result.map_or_else(|f| f.at(std::path::Path::new("FILE")).to_string(), |d| format!("{:?}", d.format))
}

/// Headers that promise what the bytes cannot hold, and bytes that are no picture, are refused by name.
#[test]
fn what_is_no_picture_is_refused() {
    let png = encoded(&four(), image::ImageFormat::Png);
    let mut bomb = png.clone();
    bomb[16..24].copy_from_slice(&[0, 0, 0xea, 0x60, 0, 0, 0xea, 0x60]);
    let crc = |bytes: &mut Vec<u8>| {
        let sum = bytes[12..29].iter().fold(!0_u32, |c, &b| {
            (0..8).fold(c ^ u32::from(b), |c, _| if c & 1 == 1 { c >> 1 ^ 0xedb8_8320 } else { c >> 1 })
        });
        bytes[29..33].copy_from_slice(&(!sum).to_be_bytes());
    };
    crc(&mut bomb);
    let mut small_bomb = png.clone();
    small_bomb[16..24].copy_from_slice(&[0, 0, 0x30, 0, 0, 0, 0x30, 0]);
    crc(&mut small_bomb);
    let jpeg = encoded(&DynamicImage::ImageRgb8(four().to_rgb8()), image::ImageFormat::Jpeg);
    let mut lines = String::new();
    for bytes in [
        &b""[..],
        b"hello, this is text",
        &png[..20],
        &png[..png.len() - 30],
        &bomb,
        &small_bomb,
        &jpeg[..100],
        b"RIFF\x10\0\0\0WEBPVP8L",
        b"#?RADIANCE\n\n-Y 70000 +X 1\n",
        b"\x76\x2f\x31\x01\x02\0\0\0",
        b"BM",
    ] {
        lines += &(said(decode(bytes, "images[0]", &mut budget())) + "\n");
    }
    let mut small = Budget::new(&ReadOptions { max_bytes: 15, ..ReadOptions::default() });
    lines += &said(decode(&png, "images[0]", &mut small));
    insta::assert_snapshot!(lines);
}

/// Bytes of every format, cut and changed at places drawn from a fixed sequence, never make it panic.
#[test]
fn broken_streams_are_faults() {
    let rgb = DynamicImage::ImageRgb8(image::RgbImage::from_fn(16, 16, |x, y| {
        image::Rgb([(x * 16) as u8, (y * 16) as u8, (x * y) as u8])
    }));
    let float = DynamicImage::ImageRgb32F(rgb.to_rgb32f());
    let all = [
        encoded(&rgb, image::ImageFormat::Png),
        encoded(&rgb, image::ImageFormat::Jpeg),
        encoded(&rgb, image::ImageFormat::WebP),
        encoded(&rgb, image::ImageFormat::Bmp),
        encoded(&rgb, image::ImageFormat::Tga),
        encoded(&float, image::ImageFormat::Hdr),
        openexr(&[("R", 1.0), ("G", 2.0), ("B", 3.0)]),
    ];
    // Memory for a big picture is refused here: it would only make the test slow.
    let budget = || Budget::new(&ReadOptions { max_bytes: 1 << 20, ..ReadOptions::default() });
    let mut state = 0x7069_6374_7572_6573_u64;
    let mut draw = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    for bytes in &all {
        for _ in 0..400 {
            let mut broken = bytes.clone();
            for _ in 0..=draw(4) {
                let at = draw(broken.len());
                broken[at] = draw(256) as u8;
            }
            broken.truncate(1 + draw(2 * bytes.len()));
            let place = if draw(2) == 0 { "a.tga" } else { "a" };
            let result = decode(&broken, place, &mut budget());
            let is_fault = |f: &Fault| format!("{f:?}").contains("(a fault)");
            assert!(!result.as_ref().is_err_and(is_fault), "a decoder panicked: {}", broken.escape_ascii());
        }
    }
}

/// A file is decoded once whatever it is called by, and never found outside the folder.
#[test]
fn pictures_are_shared() {
    let dir = tempfile::tempdir().unwrap();
    let scene = dir.path().join("scene");
    fs::create_dir_all(scene.join("maps")).unwrap();
    let png = encoded(&four(), image::ImageFormat::Png);
    fs::write(scene.join("maps/a b.png"), &png).unwrap();
    fs::write(scene.join("text.png"), "no picture").unwrap();
    fs::write(dir.path().join("outside.png"), &png).unwrap();
    let (mut pictures, mut budget, mut notes) = (Pictures::new(&scene), budget(), Notes::default());
    let first = pictures.file("maps/a b.png", "here", &mut budget, &mut notes).unwrap();
    for name in ["maps/a%20b.png", "maps/../maps/a%20b.png", "./maps/a b.png"] {
        assert_eq!(pictures.uri(name, "here", &mut budget, &mut notes), Ok(first), "{name}");
    }
    let inside = pictures.embedded("in", &png, "here", &mut budget, &mut notes).unwrap();
    assert_eq!(pictures.embedded("again", &png, "here", &mut budget, &mut notes), Ok(inside));
    let mut refused = |name: &str| {
        let fault = pictures.uri(name, "here", &mut budget, &mut notes).unwrap_err();
        fault.at(std::path::Path::new("FILE")).to_string().replace(&*dir.path().to_string_lossy(), "DIR")
    };
    let names = ["../outside.png", "missing.png", "text.png", "text.png", "maps", "http://a/b.png", ""];
    insta::assert_snapshot!(names.map(&mut refused).join("\n"));
    let images = pictures.finish();
    assert_eq!((images.len(), images[0].name.as_str()), (2, "a b"));
    assert_eq!(images[0].file.as_deref(), Some("maps/a b.png"));
    assert_eq!((images[1].name.as_str(), images[1].file.as_deref()), ("in", None));
    assert_eq!(*images[0].encoded.as_ref().unwrap().bytes, *png);
}
