//! A part as bytes, and back.
//!
//! A magic, the length of a header, the header as JSON, the film, and the SHA-256 of all that. The checksum is
//! looked at before anything else is believed.

use std::ops::Range;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::{Identity, Part, PartError, join};
use crate::film::{Film, FilmLayout, FixedPoint};

const MAGIC: &[u8; 8] = b"epsilux\n";
const SCHEMA: &str = "epsilux.part/2";
const CHECKSUM: usize = 32;

#[derive(Serialize)]
struct Header {
    schema: String,
    #[serde(flatten)]
    body: Body,
}

#[derive(Serialize, Deserialize)]
struct Body {
    identity: Identity,
    tone: String,
    exposure: f32,
    passes: Vec<Range<u32>>,
    rays: u64,
    capped: u64,
    crop: [u32; 4],
    size: [u32; 2],
    replications: u32,
    /// Powers of two that the formats are made for, by their bits.
    radiance: u32,
    length: u32,
    features: bool,
    layers: bool,
    #[serde(default)]
    layer_noise: bool,
    transparent: bool,
    cross: bool,
    widening: bool,
}

impl Part {
    /// The part as a file holds it.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let layout = self.film.layout();
        let body = Body {
            identity: self.identity.clone(),
            tone: self.screen.0.clone(),
            exposure: self.screen.1,
            passes: self.passes.clone(),
            rays: self.rays,
            capped: self.capped,
            crop: layout.crop,
            size: layout.full_size,
            replications: layout.replications,
            radiance: layout.radiance.scale().to_bits(),
            length: layout.length.scale().to_bits(),
            features: layout.features,
            layers: layout.layers,
            layer_noise: layout.layer_noise,
            transparent: layout.transparent,
            cross: layout.cross,
            widening: layout.widening,
        };
        // Strings, numbers and lists of them: nothing that JSON could not hold.
        let header = serde_json::to_vec(&Header { schema: SCHEMA.into(), body }).unwrap_or_default();
        let mut bytes = MAGIC.to_vec();
        bytes.extend_from_slice(&(header.len() as u64).to_le_bytes());
        bytes.extend_from_slice(&header);
        bytes.extend_from_slice(&self.film.to_bytes());
        let checksum = Sha256::digest(&bytes);
        bytes.extend_from_slice(&checksum);
        bytes
    }

    /// The part that a file holds.
    ///
    /// # Errors
    /// It is none, a newer one, cut short, or changed.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, PartError> {
        if !bytes.starts_with(MAGIC) {
            return Err(PartError::NotAPart);
        }
        let (content, checksum) =
            bytes.len().checked_sub(CHECKSUM).map(|n| bytes.split_at(n)).ok_or(PartError::Damaged)?;
        if Sha256::digest(content).as_slice() != checksum {
            return Err(PartError::Damaged);
        }
        let rest = content.get(MAGIC.len()..).ok_or(PartError::Damaged)?;
        let (length, rest) = rest.split_first_chunk::<8>().ok_or(PartError::Damaged)?;
        let length = usize::try_from(u64::from_le_bytes(*length)).map_err(|_| PartError::Damaged)?;
        let (header, film) = rest.split_at_checked(length).ok_or(PartError::Damaged)?;
        let body = read_header(header)?;
        let layout = FilmLayout {
            crop: body.crop,
            full_size: body.size,
            replications: body.replications,
            radiance: FixedPoint::around(f32::from_bits(body.radiance)),
            length: FixedPoint::around(f32::from_bits(body.length)),
            features: body.features,
            layers: body.layers,
            layer_noise: body.layer_noise,
            transparent: body.transparent,
            cross: body.cross,
            widening: body.widening,
        };
        let [x, y, width, height] = layout.crop;
        let inside = |at: u32, extent: u32, size: u32| at.checked_add(extent).is_some_and(|end| end <= size);
        let [w, h] = layout.full_size;
        if layout.replications == 0 || !inside(x, width, w) || !inside(y, height, h) {
            let found = format!("{} replications of {:?} in {w}x{h}", layout.replications, layout.crop);
            return Err(PartError::Header(found));
        }
        let film = Film::from_bytes(layout, film)?;
        let passes = join(body.passes)?;
        let screen = (body.tone, body.exposure);
        Ok(Self { identity: body.identity, screen, passes, film, rays: body.rays, capped: body.capped })
    }
}

fn read_header(header: &[u8]) -> Result<Body, PartError> {
    #[derive(Deserialize)]
    struct Named {
        schema: String,
    }
    let fault = |e: serde_json::Error| PartError::Header(e.to_string());
    let Named { schema } = serde_json::from_slice(header).map_err(fault)?;
    if schema != SCHEMA {
        return Err(PartError::Version { found: schema, expected: SCHEMA });
    }
    serde_json::from_slice(header).map_err(fault)
}
