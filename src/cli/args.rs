//! Flags as typed.
//!
//! Help is part of this file, since it is what people read first: every default is said, every example
//! runs as it stands.

use std::path::PathBuf;
use std::time::Duration;

use clap::builder::styling::{AnsiColor, Styles};
use clap::{Args, Parser, Subcommand, ValueEnum};

use super::algorithm::AlgorithmArgs;
use super::shortcuts::ShortcutArgs;
use super::units;
use crate::import::LightUnits;
use crate::integrate::report::Slips;
use crate::prepare::EffectsMode;
use crate::scene::ToneCurve;

const STYLES: Styles = Styles::styled()
    .header(AnsiColor::Green.on_default().bold())
    .usage(AnsiColor::Green.on_default().bold())
    .literal(AnsiColor::Cyan.on_default())
    .placeholder(AnsiColor::Cyan.on_default());

#[derive(Debug, Parser)]
#[command(
    name = "epsilux",
    version,
    styles = STYLES,
    about = "Renders and converts glTF, OBJ and TOML scenes, and says what a picture rests on",
    after_help = "\
Examples:
  epsilux demo                                       a picture without any file: hexroom.png
  epsilux render scenes/hexroom.toml -o room.png     render a scene
  epsilux explain scenes/hexroom.toml                what would be simulated, and why
  epsilux convert scenes/hexroom.toml room.obj       the same scene in another format
  epsilux compare room.exr reference.exr             is the difference more than noise?

Exit codes:
  0 done   1 compared and differs   2 wrong usage   3 ended before --error was reached
  4 cannot load   5 refused by --strict   6 cannot write
  130 or 143 stopped by a signal, picture saved"
)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub(super) command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    Render(RenderArgs),
    Explain(ExplainArgs),
    Info(InfoArgs),
    Convert(ConvertArgs),
    Compare(CompareArgs),
    Merge(MergeArgs),
    Quote(super::quote::QuoteArgs),
    Check(CheckArgs),
    Cost(super::cost::CostArgs),
    Golden(super::golden::GoldenArgs),
    Demo(DemoArgs),
    /// Print the JSON Schema of the scene's text form, for editors
    #[command(after_help = "\
Examples:
  epsilux schema > epsilux.schema.json

An editor that knows TOML or JSON schemas then completes and checks scenes whose first line is
  #:schema epsilux.schema.json")]
    Schema(SchemaArgs),
}

/// Join parts of a render
///
/// Parts are the files that `render --checkpoint` keeps: of some passes each (--passes), made at another time or
/// on another machine. The pictures are those of one uninterrupted render, byte for byte. Parts of
/// different scenes, settings or plans are refused, and passes that are there twice; gaps are listed.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  epsilux render room.toml --passes 0..64 --checkpoint a.part -o a.exr
  epsilux render room.toml --passes 64..128 --checkpoint b.part -o b.exr
  epsilux merge a.part b.part -o room.exr -o room.png")]
pub(super) struct MergeArgs {
    /// Files of parts, in any order
    #[arg(required = true, value_name = "PART")]
    pub(super) parts: Vec<PathBuf>,

    /// Image file to write, by suffix .exr, .png, .bmp or .hdr; may repeat
    #[arg(short, long, value_name = "FILE", required = true)]
    pub(super) output: Vec<PathBuf>,

    /// Keep the joined part in this file
    #[arg(long, value_name = "FILE")]
    pub(super) checkpoint: Option<PathBuf>,

    /// Brighten .png and .bmp by this many stops, may be negative [default: as the parts were rendered]
    #[arg(long, value_name = "EV", value_parser = units::stops, allow_hyphen_values = true)]
    pub(super) exposure: Option<f32>,

    /// Tone curve of .png and .bmp [default: as the parts were rendered]
    #[arg(long, value_enum, value_name = "CURVE")]
    pub(super) tone: Option<ToneArg>,
}

/// Which schema.
#[derive(Args, Debug)]
pub(super) struct SchemaArgs {
    /// Print that of the glTF extension EPSILUX_scene instead
    #[arg(long)]
    pub(super) extension: bool,
}

/// Where the scene is, and how to read it.
#[derive(Args, Debug)]
pub(super) struct SceneArgs {
    /// The scene: .gltf, .glb (glTF 2.0), .obj, .toml or .json (epsilux's own form)
    pub(super) scene: PathBuf,

    /// What the intensities of glTF's point, spot and sun lights mean
    #[arg(long, value_enum, default_value_t, value_name = "UNITS")]
    pub(super) light_units: LightUnitsArg,
}

/// Render a scene to image files
///
/// Writes one file for each -o, and beside it NAME.report.json with what the run took: seconds, rays,
/// machine, notes, plan. Equal scenes, settings and samples make equal image files, whatever the number
/// of threads.
#[derive(Args, Debug)]
#[command(after_help = "\
What is written:
  .exr  everything: linear colour, variance and sample count per pixel, the layers of --aov
  .png  8 bit sRGB for a screen, after --exposure and --tone
  .bmp  the same, without alpha
  .hdr  linear colour

Examples:
  epsilux render scenes/hexroom.toml
      hexroom.png and hexroom.exr in the current folder, 64 samples per pixel
  epsilux render scenes/hexroom.toml -o room.png --spp 256 --size 400x400
  epsilux render scenes/hexroom.toml -o room.png --time 30s
      as many samples as 30 seconds allow; the number is printed, so that --spp can repeat it
  epsilux render scenes/hexroom.toml -o room.exr --camera far --aov albedo,normal,depth
  epsilux render scenes/hexroom.toml -o part.png --crop 300,300,200,200
      exactly that part of the whole picture")]
pub(super) struct RenderArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,

    /// Image file to write, by suffix .exr, .png, .bmp or .hdr; may repeat [default: the scene's name
    /// .png and .exr, in the current folder]
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Vec<PathBuf>,

    /// Samples per pixel [default: the scene's, else 64; without limit where --error or --time is given]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SAMPLES)))]
    pub(super) spp: Option<u32>,

    /// Stop once the error is at most this (1%, 0.5%): the root of the mean squared relative error, as estimated
    /// from the picture itself. Exit code 3 where --spp or --time ends before
    #[arg(long, value_name = "E", value_parser = units::share)]
    pub(super) error: Option<f64>,

    /// Stop after this long (30s, 5min, 2h); samples for which only a part of the picture is done are dropped
    #[arg(long, value_name = "TIME", value_parser = units::time)]
    pub(super) time: Option<Duration>,

    /// Render only passes A to B - 1 of the picture (half open): a part, which --checkpoint keeps and `merge`
    /// joins with others
    #[arg(long, value_name = "A..B", value_parser = units::passes, conflicts_with_all = ["spp", "time", "error"])]
    pub(super) passes: Option<std::ops::Range<u32>>,

    /// Keep the exact state in this file, now and then and at the end, and go on from it where it exists
    /// (FILE.old is the one before)
    #[arg(long, value_name = "FILE")]
    pub(super) checkpoint: Option<PathBuf>,

    /// Time between two checkpoints
    #[arg(long, value_name = "TIME", value_parser = units::time, default_value = "30s", requires = "checkpoint")]
    pub(super) checkpoint_every: Duration,

    /// Trace one sample alone and print its radiance: that of pass PASS at pixel X,Y, as the render with the same
    /// settings takes it. No picture is written
    #[arg(long, value_name = "X,Y,PASS", value_parser = units::sample)]
    pub(super) replay: Option<[u32; 3]>,

    /// Width and height of the picture in pixels [default: the scene's, else 800 wide in the camera's
    /// aspect, else 800x600]
    #[arg(long, value_name = "WxH", value_parser = units::size)]
    pub(super) size: Option<[u32; 2]>,

    /// Camera by name [default: the scene's first]
    #[arg(long, value_name = "NAME")]
    pub(super) camera: Option<String>,

    /// Render only this part of the picture: left, top, width and height in pixels
    #[arg(long, value_name = "X,Y,W,H", value_parser = units::crop)]
    pub(super) crop: Option<[u32; 4]>,

    /// Brighten .png and .bmp by this many stops, may be negative [default: the scene's, else 0]
    #[arg(long, value_name = "EV", value_parser = units::stops, allow_hyphen_values = true)]
    pub(super) exposure: Option<f32>,

    /// Tone curve of .png and .bmp [default: the scene's, else srgb]
    #[arg(long, value_enum, value_name = "CURVE")]
    pub(super) tone: Option<ToneArg>,

    /// Leave the background transparent: alpha in .exr and .png
    #[arg(long)]
    pub(super) transparent: bool,

    /// Further layers for .exr
    #[arg(long, value_enum, value_name = "LIST", value_delimiter = ',')]
    pub(super) aov: Vec<Aov>,

    /// Which transport loop runs; the picture is the same, bit for bit
    #[arg(long, value_enum, default_value_t, value_name = "SET")]
    pub(super) effects: EffectsArg,

    #[command(flatten)]
    pub(super) algorithms: AlgorithmArgs,

    /// How light is simulated
    #[arg(long, value_enum, default_value_t)]
    pub(super) method: Method,

    /// With --method report: with the report's slips, all of them or those listed; the guide's page "The
    /// report, formula by formula" says what each does
    #[arg(long, value_enum, value_name = "SLIPS", value_delimiter = ',', num_args = 0.., require_equals = true)]
    pub(super) as_printed: Option<Vec<SlipArg>>,

    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(super) seed: u64,

    /// Threads; 0 is one for each core. They never change the picture
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(super) threads: usize,

    /// Refuse (exit code 5) where something in the scene was ignored or assumed that changes the picture
    #[arg(long)]
    pub(super) strict: bool,

    /// How progress is shown, on standard error
    #[arg(long, value_enum, default_value_t, value_name = "KIND")]
    pub(super) progress: ProgressArg,

    /// Say nothing but errors
    #[arg(short, long, conflicts_with = "verbose")]
    pub(super) quiet: bool,

    /// Say more: all notes, the plan
    #[arg(short, long)]
    pub(super) verbose: bool,

    #[command(flatten)]
    pub(super) shortcuts: ShortcutArgs,
}

/// Most samples per pixel of one render.
pub(super) const MAX_SAMPLES: u32 = 1 << 24;

/// Say what would be simulated, what is left out, what is not modelled, and why
///
/// No picture is written. From 64 samples on a pilot of at most a twentieth of their work decides what pays. The same
/// is in the files that `render` writes with the same flags, as the attribute `plan`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  epsilux explain scenes/hexroom.toml
  epsilux explain scenes/hexroom.toml --camera far --json
  epsilux explain scenes/hexroom.toml --without caustics --max-depth 4 --price
  epsilux explain scenes/hexroom.toml --price      what every shortcut would cost")]
pub(super) struct ExplainArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,

    /// Camera by name [default: the scene's first]
    #[arg(long, value_name = "NAME")]
    pub(super) camera: Option<String>,

    /// Samples per pixel of the render [default: the scene's, else 64; without limit where --error is given]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SAMPLES)))]
    pub(super) spp: Option<u32>,

    /// The error at which the render would stop (1%, 0.5%)
    #[arg(long, value_name = "E", value_parser = units::share)]
    pub(super) error: Option<f64>,

    /// Width and height of the picture in pixels [default: as for render]
    #[arg(long, value_name = "WxH", value_parser = units::size)]
    pub(super) size: Option<[u32; 2]>,

    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(super) seed: u64,

    /// Which transport loop would run
    #[arg(long, value_enum, default_value_t, value_name = "SET")]
    pub(super) effects: EffectsArg,

    #[command(flatten)]
    pub(super) algorithms: AlgorithmArgs,

    /// Print JSON (epsilux.explain/1)
    #[arg(long)]
    pub(super) json: bool,

    #[command(flatten)]
    pub(super) shortcuts: ShortcutArgs,

    /// Measure what each shortcut costs, or where none is asked for, what each would that makes sense for the scene:
    /// small pictures are rendered with it and without it
    #[arg(long)]
    pub(super) price: bool,
}

/// Say what a scene holds: triangles, spheres, lights, materials, bounds, area, notes
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  epsilux info scenes/hexroom.toml
  epsilux info scenes/hexroom.toml --json")]
pub(super) struct InfoArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,

    /// Print JSON (epsilux.info/1)
    #[arg(long)]
    pub(super) json: bool,
}

/// Convert a scene into another format, chosen by the suffix of OUT
///
/// Notes say what was not understood of IN, and what OUT cannot hold. Pictures are copied into the folder
/// NAME.images beside OUT. Files that are there are replaced, but never the scene that is read.
#[derive(Args, Debug)]
#[command(after_help = "\
What is written:
  .toml  epsilux's own form: everything, for people
  .json  the same, for programs
  .glb   glTF 2.0 in one file, for other programs; what glTF has no words for is in the
         extension EPSILUX_scene, which they pass over
  .gltf  the same as JSON, with NAME.bin beside it
  .obj   triangles; NAME.mtl with the materials as far as MTL goes, and NAME.epsilux.toml
         with all the rest: cameras, lights, spheres, environment, other materials

Examples:
  epsilux convert scenes/hexroom.toml room.glb
  epsilux convert scenes/hexroom.toml room.obj --strict
      nothing is written if anything would be lost")]
pub(super) struct ConvertArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,

    /// The file to write
    #[arg(value_name = "OUT")]
    pub(super) output: PathBuf,

    /// Write nothing (exit code 5) where something would be lost or changed
    #[arg(long)]
    pub(super) strict: bool,
}

/// Compare two images, and say whether their difference is more than noise
///
/// Where both carry variance (.exr files of this program), the verdict is a statistical test with a false
/// alarm rate of 0.001: over the whole image and over tiles of 16x16 pixels. Otherwise any difference
/// counts. Exit code 0: identical or no significant difference; 1: differs.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  epsilux render scenes/hexroom.toml -o a.exr --seed 1 --size 200x200
  epsilux render scenes/hexroom.toml -o b.exr --seed 2 --size 200x200
  epsilux compare a.exr b.exr                 no significant difference: only noise
  epsilux compare a.png b.png --map map.png   where the eye sees a difference")]
pub(super) struct CompareArgs {
    /// The image: .exr, .hdr, .png, .bmp, .jpg or .webp
    #[arg(value_name = "A")]
    pub(super) image: PathBuf,

    /// The reference that it is compared with
    #[arg(value_name = "B")]
    pub(super) reference: PathBuf,

    /// Write a picture of the difference
    #[arg(long, value_name = "FILE")]
    pub(super) map: Option<PathBuf>,

    /// What the picture of the difference shows
    #[arg(long, value_enum, default_value_t, value_name = "KIND", requires = "map")]
    pub(super) map_kind: MapKind,

    /// Print JSON (epsilux.compare/1)
    #[arg(long)]
    pub(super) json: bool,
}

/// Run the catalogue of hard cases: what breaks renderers, proved on this build and machine
///
/// Each case measures figures against a closed form, an invariance, or a slower and simpler computation, and holds
/// them beside their bounds. Exit code 0: all hold; 1: some do not.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  epsilux check                      a line for each case
  epsilux check N13 --figures        rays at vertices and edges: leaks, with all figures
  epsilux check --nightly            a hundred times the rays
  epsilux check --scene room.glb     on a scene of one's own
  epsilux check --prices             what numerical accuracy costs")]
pub(super) struct CheckArgs {
    /// Cases, such as N13 [default: all]
    #[arg(value_name = "ID")]
    pub(super) cases: Vec<String>,

    /// Instead of the catalogue, what must hold of any scene, measured on this one: threads, kernels, scale, brute
    /// force; and what is often wrong with scenes
    #[arg(long, value_name = "SCENE", conflicts_with_all = ["cases", "nightly", "figures"])]
    pub(super) scene: Option<PathBuf>,

    /// Camera by name, with --scene [default: the scene's first]
    #[arg(long, value_name = "NAME", requires = "scene")]
    pub(super) camera: Option<String>,

    /// Show every figure, not only those out of their bounds
    #[arg(long)]
    pub(super) figures: bool,

    /// A hundred times the rays where rare accidents are counted
    #[arg(long)]
    pub(super) nightly: bool,

    /// Instead of the catalogue, what accuracy costs: each robust choice beside its cheap twin, in nanoseconds on this
    /// machine and in what the twin loses
    #[arg(long, conflicts_with_all = ["cases", "nightly", "figures", "scene"])]
    pub(super) prices: bool,

    /// Print JSON (epsilux.check/1)
    #[arg(long)]
    pub(super) json: bool,
}

/// Render the built-in hexagonal room, to see that everything works
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  epsilux demo
  epsilux demo -o room.png --spp 64")]
pub(super) struct DemoArgs {
    /// Image file to write
    #[arg(short, long, value_name = "FILE", default_value = "hexroom.png")]
    pub(super) output: PathBuf,

    /// Samples per pixel
    #[arg(long, value_name = "N", default_value_t = 32, value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SAMPLES)))]
    pub(super) spp: u32,

    /// Width and height of the picture in pixels
    #[arg(long, value_name = "WxH", default_value = "400x400", value_parser = units::size)]
    pub(super) size: Size,
}

/// Named, since a list after an option would mean several values.
pub(super) type Size = [u32; 2];

#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub(super) enum LightUnitsArg {
    /// `standard` for files of Blender's exporter, else `unitless`
    #[default]
    Auto,
    /// Candela and lux at 683 lm/W, as Blender's exporter writes them by default
    Standard,
    /// W/sr and W/m^2
    Unitless,
    /// Watts over the whole sphere
    Raw,
}

impl From<LightUnitsArg> for LightUnits {
    fn from(arg: LightUnitsArg) -> Self {
        match arg {
            LightUnitsArg::Auto => Self::Auto,
            LightUnitsArg::Standard => Self::BlenderSpec,
            LightUnitsArg::Unitless => Self::Unitless,
            LightUnitsArg::Raw => Self::Raw,
        }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum ToneArg {
    /// sRGB; what is brighter than one clips
    #[default]
    Srgb,
    /// AgX: highlights roll off and lose saturation
    Agx,
    /// Khronos PBR Neutral: keeps base colours, rolls off highlights only
    Neutral,
    /// Square root of the value
    Sqrt,
    /// The value itself
    Linear,
}

impl From<ToneArg> for ToneCurve {
    fn from(arg: ToneArg) -> Self {
        match arg {
            ToneArg::Srgb => Self::Srgb,
            ToneArg::Agx => Self::Agx,
            ToneArg::Neutral => Self::Neutral,
            ToneArg::Sqrt => Self::Sqrt,
            ToneArg::Linear => Self::Linear,
        }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum EffectsArg {
    /// The smallest that covers the scene
    #[default]
    Auto,
    /// The one that simulates everything, with every table built; the picture is the same, bit for bit
    All,
}

impl From<EffectsArg> for EffectsMode {
    fn from(arg: EffectsArg) -> Self {
        match arg {
            EffectsArg::Auto => Self::Auto,
            EffectsArg::All => Self::All,
        }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum Method {
    /// Path tracing that aims at lights
    #[default]
    Default,
    /// Slow and obvious brute force in double precision, to check the default against
    Reference,
    /// As in the report "Monte Carlo Ray Tracing" (2021), corrected: one ray in each quarter of the pixel
    /// (--spp is rounded up to 1 or a multiple of 4), a tree of at most 12 events (--max-depth)
    Report,
}

/// A slip of the report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum SlipArg {
    /// 2.4: the wrong edge in Q; no triangle is hit
    QVector,
    /// 3.1: without the area of the light
    Area,
    /// 3.1: without 1/pi
    InversePi,
    /// 3.1: divided by the number of lights
    LightCount,
    /// 3.1: "larger than one"; no direct light
    ShadowComparison,
    /// 3.3: a pi too many
    ExtraPi,
    /// 3.4: roulette the wrong way round
    RouletteSign,
    /// 3.5, 3.6: the angle inside of the glass; a line in it
    Schlick,
}

impl SlipArg {
    /// The slips of a list; all of them where it is empty.
    pub(super) fn slips(list: &[Self]) -> Slips {
        let has = |slip| list.is_empty() || list.contains(&slip);
        Slips {
            q_vector: has(Self::QVector),
            area: has(Self::Area),
            inverse_pi: has(Self::InversePi),
            light_count: has(Self::LightCount),
            shadow_comparison: has(Self::ShadowComparison),
            extra_pi: has(Self::ExtraPi),
            roulette_sign: has(Self::RouletteSign),
            schlick_inside_angle: has(Self::Schlick),
        }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum ProgressArg {
    /// A bar where standard error is a terminal and NO_COLOR is not set, else nothing
    #[default]
    Auto,
    /// One JSON object a line (epsilux.progress/1)
    Json,
    /// Nothing
    None,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum MapKind {
    /// What an eye sees that flips between the two: black none, white most
    #[default]
    Flip,
    /// Relative difference of luminance: red where A is brighter, blue where it is darker
    Difference,
}

/// Layers that an EXR file may hold besides the colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Aov {
    /// Reflectance of the first surface: albedo.R, .G, .B
    Albedo,
    /// Its shading normal in world space: N.X, .Y, .Z
    Normal,
    /// Its distance along the view axis in metres: Z
    Depth,
    /// Its place in world space in metres: P.X, .Y, .Z
    Position,
    /// Number of the object from one, 0 for the background: objectId
    Object,
    /// Number of the material from one, 0 for the background: materialId
    Material,
    /// What the light consists of, in parts that add up to the picture: direct.R, .G, .B, indirect, caustic, glass
    /// (what is seen in mirrors and through glass) and emitted; and each pixel's brightest sample: brightest
    Layers,
}

impl Aov {
    /// The channels' names up to the dot.
    pub(super) fn groups(self) -> &'static [&'static str] {
        match self {
            Self::Albedo => &["albedo"],
            Self::Normal => &["N"],
            Self::Depth => &["Z"],
            Self::Position => &["P"],
            Self::Object => &["objectId"],
            Self::Material => &["materialId"],
            Self::Layers => &["direct", "indirect", "caustic", "glass", "emitted", "brightest"],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// clap's own check of the definitions: clashing flags, bad defaults.
    #[test]
    fn definitions_are_sound() {
        <Arguments as clap::CommandFactory>::command().debug_assert();
    }
}
