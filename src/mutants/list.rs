//! The faults that can be planted: names, what they do, and what has to notice: gates of the golden tests, hard
//! cases, or both.
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
    /// One step off surfaces for scenes of every size.
    FixedEpsilon,
    /// A triangle test that leaks.
    MoellerTrumbore,
    /// A sphere test that cancels.
    SpherePq,
    /// Reflectance as of the angle on the wrong side.
    SchlickInside,
    /// A film that forgets what is small beside its mean.
    RunningMean,
}

impl Mutant {
    /// All of them.
    pub const ALL: [Self; 22] = [
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
        Self::FixedEpsilon,
        Self::MoellerTrumbore,
        Self::SpherePq,
        Self::SchlickInside,
        Self::RunningMean,
    ];

    /// What the environment variable calls it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.row().name
    }

    /// What is wrong with it, a line for people.
    #[must_use]
    pub const fn what(self) -> &'static str {
        self.row().what
    }

    /// The gates of the golden tests of which at least one has to notice: each is the beginning of a gate's name.
    /// None where the golden tests need not notice, because hard cases do.
    #[must_use]
    pub const fn gates(self) -> &'static [&'static str] {
        self.row().gates
    }

    /// The hard cases that have to notice, each of them; none where golden tests do.
    #[must_use]
    pub const fn cases(self) -> &'static [&'static str] {
        self.row().cases
    }

    const fn row(self) -> Row {
        match self {
            Self::LightEnergy => row(
                "light-energy",
                "lights with an area emit 1 % more, sampled or met by chance",
                &["matched"],
                &[],
            ),
            Self::CosineDropped => row(
                "cosine-dropped",
                "no cosine at the surface that a sampled light shines on",
                &["tile"],
                &[],
            ),
            Self::BsdfPdf => row(
                "bsdf-pdf",
                "directions that a BSDF samples are divided by 0.97 of their density",
                &["matched"],
                &[],
            ),
            Self::MisMeasure => row(
                "mis-measure",
                "the density of a light met by chance is per area, that of a sampled one per solid angle",
                &["matched"],
                &["N55"],
            ),
            Self::LightDropped => row(
                "light-dropped",
                "the last of several lights is never sampled, and the others do not make up for it",
                &["tile"],
                &[],
            ),
            Self::RouletteUncompensated => row(
                "roulette-uncompensated",
                "paths that survive roulette are not divided by their probability",
                &["matched"],
                &["N56", "N58"],
            ),
            Self::EtaSquared => row(
                "eta-squared",
                "refraction does not divide radiance by eta squared",
                &["matched"],
                &["N34", "N44"],
            ),
            Self::FresnelAngle => row(
                "fresnel-angle",
                "light that enters a denser medium is totally reflected beyond the critical angle",
                &["tile"],
                &[],
            ),
            Self::OriginOffset => row(
                "origin-offset",
                "rays leave a surface from 0.04 m above it instead of from its error bound",
                &["tile"],
                &["N04", "N07"],
            ),
            Self::DepthOffByOne => {
                row("depth-off-by-one", "a limit of n scattering events lets n + 1 happen", &["image"], &[])
            }
            Self::NdfPdf => row(
                "ndf-pdf",
                "glossy reflection is divided by the density of all normals, but samples visible ones",
                &["matched"],
                &[],
            ),
            Self::SameSeed => row(
                "same-seed",
                "each even replication and the odd one after it draw the same random numbers",
                &["error", "noise"],
                &[],
            ),
            Self::Clamp => row(
                "clamp",
                "light that a path finds counts as 10 W sr^-1 m^-2 at most",
                &["matched", "peaks"],
                &[],
            ),
            Self::FilterShift => {
                row("filter-shift", "camera rays pass half a pixel to the right and below", &["tile"], &[])
            }
            Self::GammaTwice => {
                row("gamma-twice", "eight-bit pictures pass the sRGB curve twice", &["export"], &[])
            }
            Self::NanBlack => row(
                "nan-black",
                "the film counts a sample that is not a number as black",
                &["film"],
                &["N64"],
            ),
            Self::AreaSampling => row(
                "area-sampling",
                "rectangles are sampled by area, not by solid angle: more noise, the same mean",
                &["noise"],
                &[],
            ),
            Self::FixedEpsilon => row(
                "fixed-epsilon",
                "rays leave a surface from 1e-4 m above it instead of from its error bound",
                &[],
                &["N01", "N04", "N07"],
            ),
            Self::MoellerTrumbore => row(
                "moeller-trumbore",
                "triangles are tested by Moeller and Trumbore's method, in single precision",
                &[],
                &["N13"],
            ),
            Self::SpherePq => row(
                "sphere-pq",
                "spheres are tested by the pq formula, in single precision",
                &[],
                &["N22", "N24"],
            ),
            Self::SchlickInside => row(
                "schlick-inside",
                "light that leaves glass is reflected by Schlick's formula, with the angle inside of the glass",
                &[],
                &["N27", "N28"],
            ),
            Self::RunningMean => {
                row("running-mean", "the film keeps a running mean in single precision", &[], &["N62"])
            }
        }
    }
}

/// What is said of a mutant.
struct Row {
    name: &'static str,
    what: &'static str,
    gates: &'static [&'static str],
    cases: &'static [&'static str],
}

const fn row(
    name: &'static str,
    what: &'static str,
    gates: &'static [&'static str],
    cases: &'static [&'static str],
) -> Row {
    Row { name, what, gates, cases }
}
