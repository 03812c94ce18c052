//! The faults that can be planted: names, what they do, and which gate has to notice.
//!
//! In: nothing. Out: a closed set. It depends on nothing, so that whoever builds and runs mutants can include
//! this file as a module and need not be built with them.

/// A fault that can be planted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mutant {
    /// Lights are brighter than they are said to be.
    LightEnergy,
    /// Lambert's cosine is missing where a light is sampled.
    CosineDropped,
    /// Directions weigh more than they should.
    BsdfPdf,
    /// A density is in the wrong measure, on one side of multiple importance sampling.
    MisMeasure,
    /// One light is not sampled.
    LightDropped,
    /// Paths that survive roulette do not stand for those that do not.
    RouletteUncompensated,
    /// Radiance passes refractions like importance.
    EtaSquared,
    /// Total reflection where there is none.
    FresnelAngle,
    /// Rays start too far from their surface.
    OriginOffset,
    /// Paths have one more scattering event than asked for.
    DepthOffByOne,
    /// A density does not belong to how directions are sampled.
    NdfPdf,
    /// Replications that are not independent.
    SameSeed,
    /// Light that is bright is cut.
    Clamp,
    /// Pixels show what is beside them.
    FilterShift,
    /// Pictures for a screen are encoded twice.
    GammaTwice,
    /// What is not a number counts as black.
    NanBlack,
    /// A sampler that is as right, and worse.
    AreaSampling,
}

impl Mutant {
    /// All of them.
    pub const ALL: [Self; 17] = [
        Self::LightEnergy,
        Self::CosineDropped,
        Self::BsdfPdf,
        Self::MisMeasure,
        Self::LightDropped,
        Self::RouletteUncompensated,
        Self::EtaSquared,
        Self::FresnelAngle,
        Self::OriginOffset,
        Self::DepthOffByOne,
        Self::NdfPdf,
        Self::SameSeed,
        Self::Clamp,
        Self::FilterShift,
        Self::GammaTwice,
        Self::NanBlack,
        Self::AreaSampling,
    ];

    /// What the environment variable calls it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.row().0
    }

    /// What is wrong with it, a line for people.
    #[must_use]
    pub const fn what(self) -> &'static str {
        self.row().1
    }

    /// The gates of which at least one has to notice: each is the beginning of a gate's name.
    #[must_use]
    pub const fn killed_by(self) -> &'static [&'static str] {
        self.row().2
    }

    const fn row(self) -> (&'static str, &'static str, &'static [&'static str]) {
        match self {
            Self::LightEnergy => {
                ("light-energy", "lights with an area emit 1 % more, sampled or met by chance", &["matched"])
            }
            Self::CosineDropped => {
                ("cosine-dropped", "no cosine at the surface that a sampled light shines on", &["tile"])
            }
            Self::BsdfPdf => (
                "bsdf-pdf",
                "directions that a BSDF samples are divided by 0.97 of their density",
                &["matched"],
            ),
            Self::MisMeasure => (
                "mis-measure",
                "the density of a light met by chance is per area, that of a sampled one per solid angle",
                &["matched"],
            ),
            Self::LightDropped => (
                "light-dropped",
                "the last of several lights is never sampled, and the others do not make up for it",
                &["tile"],
            ),
            Self::RouletteUncompensated => (
                "roulette-uncompensated",
                "paths that survive roulette are not divided by their probability",
                &["matched"],
            ),
            Self::EtaSquared => {
                ("eta-squared", "refraction does not divide radiance by eta squared", &["matched"])
            }
            Self::FresnelAngle => (
                "fresnel-angle",
                "light that enters a denser medium is totally reflected beyond the critical angle",
                &["tile"],
            ),
            Self::OriginOffset => (
                "origin-offset",
                "rays leave a surface from 0.04 m above it instead of from its error bound",
                &["tile"],
            ),
            Self::DepthOffByOne => {
                ("depth-off-by-one", "a limit of n scattering events lets n + 1 happen", &["image"])
            }
            Self::NdfPdf => (
                "ndf-pdf",
                "glossy reflection is divided by the density of all normals, but samples visible ones",
                &["matched"],
            ),
            Self::SameSeed => (
                "same-seed",
                "each even replication and the odd one after it draw the same random numbers",
                &["error", "noise"],
            ),
            Self::Clamp => {
                ("clamp", "light that a path finds counts as 10 W sr^-1 m^-2 at most", &["matched", "peaks"])
            }
            Self::FilterShift => {
                ("filter-shift", "camera rays pass half a pixel to the right and below", &["tile"])
            }
            Self::GammaTwice => ("gamma-twice", "eight-bit pictures pass the sRGB curve twice", &["export"]),
            Self::NanBlack => {
                ("nan-black", "the film counts a sample that is not a number as black", &["film"])
            }
            Self::AreaSampling => (
                "area-sampling",
                "rectangles are sampled by area, not by solid angle: more noise, the same mean",
                &["noise"],
            ),
        }
    }
}
