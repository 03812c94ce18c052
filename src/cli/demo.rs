//! `epsilux demo`

use std::ffi::OsString;
use std::time::Instant;

use super::args::DemoArgs;
use super::console::Console;
use super::failure::Failure;
use super::render::{self, Job};
use super::{Code, load};

/// The report's room, as it is in `scenes`.
const HEXROOM: &str = include_str!("../../scenes/hexroom.toml");

pub(super) fn run(args: &DemoArgs, arguments: &[OsString], console: &Console) -> Result<Code, Failure> {
    let begin = Instant::now();
    render::check_outputs(std::slice::from_ref(&args.output))?;
    let loaded = load::parse("hexroom.toml (built in)", HEXROOM)?;
    let camera = render::camera(&loaded.scene, None)?;
    let mut job = Job::new("hexroom (built in)", &loaded.scene, camera, args.size);
    job.outputs = vec![args.output.clone()];
    job.passes = args.spp;
    job.run(loaded, begin, arguments, console)
}
