//! Tests of whole files: what is written is there, complete, and the same every time.

use std::fs;
use std::path::Path;

use super::*;
use crate::color::Rgb;
use crate::film::Layer;
use crate::scene::ToneCurve;

/// A crop of 3x2 pixels at (5, 7) of a 16x9 picture, with everything an image can know.
fn full_image() -> Image {
    let ramp = |start: f32| (0..6).map(|i| start + i as f32 * 0.25).collect::<Vec<_>>();
    let colours = |start: f32| ramp(start).into_iter().map(|v| Rgb::new(v, v * 0.5, v * 3.0)).collect();
    Image {
        width: 3,
        height: 2,
        origin: [5, 7],
        full_size: [16, 9],
        rgb: colours(0.1),
        alpha: Some(vec![0.0, 0.25, 0.5, 0.75, 1.0, 1.0]),
        variance: Some(vec![Rgb::grey(f32::INFINITY); 6]),
        count: Some(vec![16, 16, 15, 16, 16, 4_000_000_001]),
        layers: vec![
            Layer { channels: vec![("N.X".into(), ramp(-1.0)), ("N.Y".into(), ramp(0.5))] },
            Layer { channels: vec![("Z".into(), ramp(1e6))] },
            Layer { channels: vec![("albedo.B".into(), ramp(0.0)), ("albedo.R".into(), ramp(1.0))] },
        ],
        attributes: (0..20).map(|i| (format!("key{i:02}"), format!("värde {i} ε"))).collect(),
    }
}

/// EXR loses nothing: colours, alpha, infinite variances, large counts, layers, UTF-8 attributes, and
/// where the crop lies.
#[test]
fn exr_round_trips_everything() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let image = full_image();
    write(&image, &path, &WriteOptions::default()).unwrap();
    assert_eq!(read_exr(&path).unwrap(), image);
    assert_eq!(read(&path).unwrap(), image);
}

/// Equal images make equal bytes, in spite of the hash map in which the EXR crate keeps attributes.
#[test]
fn equal_images_make_equal_files() {
    let folder = tempfile::tempdir().unwrap();
    for format in Format::ALL {
        let bytes: Vec<_> = (0..4)
            .map(|i| {
                let path = folder.path().join(format!("{i}.{}", format.suffix()));
                write(&full_image(), &path, &WriteOptions::default()).unwrap();
                fs::read(path).unwrap()
            })
            .collect();
        assert!(bytes.iter().all(|b| *b == bytes[0]), "{format:?}");
    }
}

/// An opaque image has no alpha channel, and channel names are those that other programs look for.
#[test]
fn exr_channel_names() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    write(&Image { alpha: None, ..full_image() }, &path, &WriteOptions::default()).unwrap();
    let meta = ::exr::meta::MetaData::read_from_file(&path, true).unwrap();
    let names: Vec<_> = meta.headers[0].channels.list.iter().map(|c| c.name.to_string()).collect();
    assert_eq!(names.join(" "), "B G N.X N.Y R Z albedo.B albedo.R count variance.B variance.G variance.R");
    assert_eq!(read_exr(&path).unwrap().alpha, None);
}

/// PNG holds straight alpha and the attributes; a pixel of radiance 0.5 and alpha 0.5 is white.
#[test]
fn png_has_straight_alpha_and_attributes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    let image = Image {
        width: 2,
        height: 1,
        full_size: [2, 1],
        rgb: vec![Rgb::grey(0.5), Rgb::BLACK],
        alpha: Some(vec![0.5, 0.0]),
        attributes: vec![("seed".into(), "ε 1".into())],
        ..Image::default()
    };
    write(&image, &path, &WriteOptions::default()).unwrap();
    let decoder = png::Decoder::new(io::BufReader::new(fs::File::open(&path).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    assert_eq!(pixels, [255, 255, 255, 128, 0, 0, 0, 0]);
    let chunk = &reader.info().utf8_text[0];
    assert_eq!((chunk.keyword.as_str(), chunk.get_text().unwrap().as_str()), ("seed", "ε 1"));
    assert!(reader.info().srgb.is_some(), "tagged as sRGB");
}

/// What comes back from each format is the image, as closely as the format can hold it.
#[test]
fn formats_hold_the_colour() {
    let folder = tempfile::tempdir().unwrap();
    let rgb: Vec<_> = (0..64).map(|i| Rgb::new(i as f32 / 63.0, 0.5, 0.02)).collect();
    let image = Image { width: 8, height: 8, full_size: [8, 8], rgb, ..Image::default() };
    for (format, bound) in
        [(Format::Exr, 0.0), (Format::Hdr, 1.0 / 128.0), (Format::Png, 0.005), (Format::Bmp, 0.005)]
    {
        let path = folder.path().join(format!("a.{}", format.suffix().to_uppercase()));
        write(&image, &path, &WriteOptions::default()).unwrap();
        let back = read(&path).unwrap();
        assert_eq!((back.width, back.height, back.alpha), (8, 8, None));
        for (a, b) in image.rgb.iter().zip(&back.rgb) {
            assert!((*a - *b).map(f32::abs).max_channel() <= bound, "{format:?}: {a:?} came back as {b:?}");
        }
    }
}

/// Exposure and curve change pictures for a screen and leave radiance alone.
#[test]
fn tone_touches_pictures_only() {
    let folder = tempfile::tempdir().unwrap();
    let image =
        Image { width: 1, height: 1, full_size: [1, 1], rgb: vec![Rgb::grey(0.1)], ..Image::default() };
    let options = WriteOptions { tone: Tone { curve: ToneCurve::Sqrt, exposure: 1.0 } };
    for format in Format::ALL {
        let [plain, toned] = [("a", WriteOptions::default()), ("b", options)].map(|(name, options)| {
            let path = folder.path().join(format!("{name}.{}", format.suffix()));
            write(&image, &path, &options).unwrap();
            fs::read(path).unwrap()
        });
        assert_eq!(plain == toned, matches!(format, Format::Exr | Format::Hdr), "{format:?}");
    }
}

/// Each unusable path is refused before any work, with what was found and what was expected.
#[test]
fn unusable_paths_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("taken.png")).unwrap();
    let check = |name: &str, expected: &str| {
        let error = check_path(&folder.path().join(name)).unwrap_err().to_string();
        let error = error.replace(folder.path().to_str().unwrap(), "FOLDER");
        assert_eq!(error, expected);
    };
    check("a.jpg", "FOLDER/a.jpg: found .jpg, expected a name that ends in .exr, .png, .bmp or .hdr");
    check("a", "FOLDER/a: found no suffix, expected a name that ends in .exr, .png, .bmp or .hdr");
    check("no/a.png", "FOLDER/no/a.png: the folder FOLDER/no does not exist");
    check("taken.png", "FOLDER/taken.png: is a folder, expected a file name");
    assert!(check_path(&folder.path().join("a.PNG")).is_ok());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "checking leaves nothing behind");
}

/// N64: a value that is not a number stops the file, and the old file stays.
#[test]
fn not_a_number_never_reaches_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    write(&full_image(), &path, &WriteOptions::default()).unwrap();
    let before = fs::read(&path).unwrap();
    let spoil: [fn(&mut Image); 4] = [
        |i| i.rgb[4].g = f32::NAN,
        |i| i.alpha.as_mut().unwrap()[4] = f32::INFINITY,
        |i| i.layers[1].channels[0].1[4] = f32::NAN,
        |i| i.variance.as_mut().unwrap()[4].b = f32::NAN,
    ];
    for spoil in spoil {
        let mut image = full_image();
        spoil(&mut image);
        match write(&image, &path, &WriteOptions::default()) {
            Err(WriteError::NotFinite { count: 1, pixel: [1, 1], .. }) => {}
            other => panic!("{other:?}"),
        }
    }
    let short = Image { rgb: vec![Rgb::BLACK; 5], ..full_image() };
    assert!(matches!(
        write(&short, &path, &WriteOptions::default()),
        Err(WriteError::WrongLength { found: 5, expected: 6, .. })
    ));
    assert_eq!(fs::read(&path).unwrap(), before);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

/// Files that are no images end in an error with the file's name, not in a panic.
#[test]
fn bad_files_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    write(&full_image(), &path, &WriteOptions::default()).unwrap();
    let whole = fs::read(&path).unwrap();
    for cut in [0, 3, 8, 40, 300, whole.len() - 5] {
        fs::write(&path, &whole[..cut]).unwrap();
        let error = read(&path).unwrap_err().to_string();
        assert!(error.contains("a.exr: "), "{cut}: {error}");
    }
    assert!(matches!(read(Path::new("nowhere.exr")), Err(ReadImageError::Io { .. })));
}
