//! Albedos of rough lobes: rows for constant materials, and tables over the parameters that textures vary.
//!
//! A table holds what [`crate::bsdf::tables`] computes at nodes of roughness and of the square root of F0,
//! and is interpolated linearly over both and over the cosine. Its rows are computed in parallel, each alone,
//! so that threads change nothing. The tests bound its error.

use std::collections::BTreeMap;
use std::sync::Arc;

use rayon::prelude::*;

use crate::bsdf::Charlie;
use crate::bsdf::fresnel::Fresnel;
use crate::bsdf::tables::{self, Albedo, AlbedoRow};

/// Where lobes get their albedos from. `alpha` is the GGX width, `eta` a ratio of indices.
pub(super) trait Albedos {
    /// Of white reflection.
    fn white(&mut self, alpha: f32) -> Albedo;
    /// Of reflection and transmission together, from outside (index `ior`) and from inside.
    fn dielectric(&mut self, alpha: f32, ior: f32) -> [Albedo; 2];
    /// Of the grazing share of the Fresnel term of `eta`, which is `f0` at normal incidence.
    fn grazing(&mut self, alpha: f32, eta: f32, f0: f32) -> Albedo;
    /// The average of that share over the hemisphere.
    fn grazing_average(&mut self, eta: f32, f0: f32) -> f32;
    /// Of a coat of index `ior`.
    fn coat(&mut self, alpha: f32, ior: f32) -> Albedo;
    /// Of white sheen.
    fn sheen(&mut self, roughness: f32) -> Albedo;
}

/// Rows, each computed once for the parameters that define it.
#[derive(Default)]
pub(super) struct Rows {
    fresnel: Fresnel,
    rows: BTreeMap<(u8, u32, u32), Arc<AlbedoRow>>,
}

impl Rows {
    pub(super) fn new(fresnel: Fresnel) -> Self {
        Self { fresnel, rows: BTreeMap::new() }
    }

    fn get(&mut self, kind: u8, alpha: f32, eta: f32, albedo: impl Fn(f32) -> f32) -> Albedo {
        let key = (kind, alpha.to_bits(), eta.to_bits());
        let row = self.rows.entry(key).or_insert_with(|| Arc::new(AlbedoRow::new(albedo)));
        Albedo::Row(Arc::clone(row))
    }
}

impl Albedos for Rows {
    fn white(&mut self, alpha: f32) -> Albedo {
        self.get(0, alpha, 0.0, |mu| tables::reflected(mu, alpha, |_| 1.0))
    }

    fn dielectric(&mut self, alpha: f32, ior: f32) -> [Albedo; 2] {
        let fresnel = self.fresnel;
        let total = move |mu, eta| tables::dielectric_total(mu, alpha, eta, fresnel);
        [ior, 1.0 / ior].map(|eta| self.get(1, alpha, eta, |mu| total(mu, eta)))
    }

    fn grazing(&mut self, alpha: f32, eta: f32, f0: f32) -> Albedo {
        let fresnel = self.fresnel;
        self.get(2, alpha, eta, |mu| tables::reflected(mu, alpha, |cos| fresnel.grazing_share(cos, eta, f0)))
    }

    fn grazing_average(&mut self, eta: f32, f0: f32) -> f32 {
        AlbedoRow::new(|mu| self.fresnel.grazing_share(mu, eta, f0)).average()
    }

    fn coat(&mut self, alpha: f32, ior: f32) -> Albedo {
        let fresnel = self.fresnel;
        self.get(3, alpha, ior, |mu| tables::reflected(mu, alpha, |cos| fresnel.dielectric(cos, ior).0))
    }

    fn sheen(&mut self, roughness: f32) -> Albedo {
        let lobe = Charlie::new(roughness);
        self.get(4, roughness, 0.0, |mu| lobe.albedo(mu))
    }
}

/// Intervals of a table over the cosine, as [`place_of_cosine`] has it.
const COSINES: usize = 112;
/// Intervals over the root of roughness.
const ROUGHNESSES: usize = 32;
/// Intervals over the fourth root of F0 where it varies alone, and where roughness varies too: then each of
/// them is a table of its own.
const REFLECTANCES: [usize; 2] = [32, 12];
/// The smallest roughness that is not smooth.
const LEAST: f32 = 0.01;

/// About the cosine at which a lobe of width `alpha` that is seen under `mu` meets its microfacets.
#[inline]
fn microfacet_cosine(mu: f32, alpha: f32) -> f32 {
    let sin2 = (1.0 - mu) * (1.0 + mu);
    (mu * mu + 0.5 * alpha * alpha * sin2.max(0.0)).sqrt().min(1.0)
}

/// Nodes of a parameter, evenly spaced; one where it does not vary.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Axis {
    from: f32,
    to: f32,
    intervals: usize,
}

impl Axis {
    fn nodes(self) -> impl Iterator<Item = f32> {
        (0..=self.intervals).map(move |i| {
            let t = i as f32 / self.intervals.max(1) as f32;
            self.from * (1.0 - t) + self.to * t
        })
    }

    /// The node below `x`, and how far it is to the next.
    #[inline]
    fn place(self, x: f32) -> (usize, f32) {
        if self.intervals == 0 {
            return (0, 0.0);
        }
        let n = self.intervals as f32;
        let t = ((x - self.from) / (self.to - self.from) * n).clamp(0.0, n);
        let i = (t as usize).min(self.intervals - 1);
        (i, t - i as f32)
    }
}

/// Albedos over roughness and cosine.
#[derive(Debug)]
struct Table {
    /// Nodes of the root of roughness.
    roughness: Axis,
    /// A row of cosines for each node.
    values: Vec<f32>,
    /// The average of each row.
    averages: Vec<f32>,
}

/// Where the cosine `mu` stands in a row of width `alpha`, [0, 1]. Half of the way goes with the root of the
/// cosine, half with the cosine in units of the width, by which narrow lobes are alike near grazing.
#[inline]
fn place_of_cosine(mu: f32, alpha: f32) -> f32 {
    0.5 * (mu.sqrt() + mu * (1.0 + alpha) / (mu + alpha))
}

/// The cosine that stands at `place`, by bisection.
fn cosine_at(place: f32, alpha: f32) -> f32 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if place_of_cosine(middle, alpha) < place { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// The roughness at a node: dense where lobes are narrow.
fn roughness_at(node: f32) -> f32 {
    LEAST + (1.0 - LEAST) * node * node
}

impl Table {
    fn new(roughness: Axis, albedo: impl Fn(f32, f32) -> f32 + Sync) -> Self {
        let rows: Vec<(Vec<f32>, f32)> = roughness
            .nodes()
            .collect::<Vec<f32>>()
            .into_par_iter()
            .map(|node| {
                let r = roughness_at(node);
                let alpha = r * r;
                let cosine = |i: f32| cosine_at(i / COSINES as f32, alpha);
                // At mu = 0 the lobe degenerates.
                let row = (0..=COSINES).map(|i| albedo(cosine((i as f32).max(0.5)), alpha));
                let row: Vec<f32> = row.collect();
                let points = (0..=COSINES).map(|i| (f64::from(cosine(i as f32)), f64::from(row[i])));
                let average = average(&points.collect::<Vec<_>>());
                (row, average)
            })
            .collect();
        let averages = rows.iter().map(|(_, average)| *average).collect();
        Self { roughness, values: rows.into_iter().flat_map(|(row, _)| row).collect(), averages }
    }

    /// The albedo and its average at a width and a cosine.
    #[inline]
    fn at(&self, alpha: f32, mu: f32) -> (f32, f32) {
        let node = ((alpha.sqrt() - LEAST) / (1.0 - LEAST)).max(0.0).sqrt();
        let (i, t) = self.roughness.place(node);
        let place = (place_of_cosine(mu, alpha) * COSINES as f32).min(COSINES as f32);
        let k = (place as usize).min(COSINES - 1);
        let s = place - k as f32;
        let row = |i: usize| {
            let at = i * (COSINES + 1) + k;
            self.values[at] * (1.0 - s) + self.values[at + 1] * s
        };
        if self.roughness.intervals == 0 {
            return (row(0), self.averages[0]);
        }
        let mix = |a: f32, b: f32| a * (1.0 - t) + b * t;
        (mix(row(i), row(i + 1)), mix(self.averages[i], self.averages[i + 1]))
    }
}

/// 2 int E mu dmu of what is linear between points.
fn average(points: &[(f64, f64)]) -> f32 {
    let segment = |w: &[(f64, f64)]| {
        let ((x0, y0), (x1, y1)) = (w[0], w[1]);
        (x1 - x0) / 3.0 * (y0 * (2.0 * x0 + x1) + y1 * (x0 + 2.0 * x1))
    };
    points.windows(2).map(segment).sum::<f64>() as f32
}

/// What a material's textures vary, and between which bounds: the key of its tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Span {
    /// Bits of the constant roughness; `None` where it varies.
    roughness: Option<u32>,
    /// Bits of the least and the largest root of F0.
    root: [u32; 2],
    /// Bits of the index where transmission may need it.
    ior: Option<u32>,
    /// Of the coat: bits of its index, and of its roughness where that is constant.
    coat: Option<(u32, Option<u32>)>,
    /// Of the sheen: bits of its roughness where that is constant.
    sheen: Option<Option<u32>>,
}

impl Span {
    /// `roughness` is `None` where it varies; the root of F0 lies between the two of `root`.
    pub(super) fn new(roughness: Option<f32>, root: [f32; 2], ior: Option<f32>) -> Self {
        let bits = f32::to_bits;
        Self {
            roughness: roughness.map(bits),
            root: root.map(bits),
            ior: ior.map(bits),
            coat: None,
            sheen: None,
        }
    }

    /// With a coat of this index, and of this roughness where it is constant.
    pub(super) fn coat(self, ior: f32, roughness: Option<f32>) -> Self {
        Self { coat: Some((ior.to_bits(), roughness.map(f32::to_bits))), ..self }
    }

    /// With a sheen, and of this roughness where it is constant.
    pub(super) fn sheen(self, roughness: Option<f32>) -> Self {
        Self { sheen: Some(roughness.map(f32::to_bits)), ..self }
    }
}

/// The tables of materials that share what varies.
#[derive(Debug)]
pub(super) struct Tables {
    fresnel: Fresnel,
    white: Table,
    dielectric: Option<[Table; 2]>,
    root: Axis,
    /// One for each node of the root of F0.
    grazing: Vec<Table>,
    grazing_average: Vec<f32>,
    coat: Option<Table>,
    sheen: Option<Table>,
}

impl Tables {
    fn new(span: Span, fresnel: Fresnel) -> Self {
        let nodes = |roughness: Option<u32>| match roughness.map(f32::from_bits) {
            Some(r) => {
                let node = ((r - LEAST) / (1.0 - LEAST)).max(0.0).sqrt();
                Axis { from: node, to: node, intervals: 0 }
            }
            None => Axis { from: 0.0, to: 1.0, intervals: ROUGHNESSES },
        };
        let roughness = nodes(span.roughness);
        let [from, to] = span.root.map(f32::from_bits);
        let intervals = match (from == to, span.roughness) {
            (true, _) => 0,
            (false, Some(_)) => REFLECTANCES[0],
            (false, None) => REFLECTANCES[1],
        };
        let root = Axis { from: from.sqrt(), to: to.sqrt(), intervals };
        let of_root = |node: f32| {
            let s = node * node;
            ((1.0 + s) / (1.0 - s), s * s)
        };
        let share = move |cos, eta, f0| fresnel.grazing_share(cos, eta, f0);
        let total =
            |eta| Table::new(roughness, move |mu, alpha| tables::dielectric_total(mu, alpha, eta, fresnel));
        // What is left when the white lobe times the share at one cosine is taken off: small and even, where
        // the whole rises too steeply towards grazing to be interpolated.
        let grazing = |node| {
            let (eta, f0) = of_root(node);
            Table::new(roughness, move |mu, alpha| {
                if f0 == 0.0 {
                    return 0.0;
                }
                let whole = tables::reflected(mu, alpha, |cos| share(cos, eta, f0));
                let white = tables::reflected(mu, alpha, |_| 1.0);
                whole - white * share(microfacet_cosine(mu, alpha), eta, f0)
            })
        };
        let grazing_average = |s| {
            let (eta, f0) = of_root(s);
            if f0 == 0.0 { 0.0 } else { AlbedoRow::new(|mu| share(mu, eta, f0)).average() }
        };
        Self {
            fresnel,
            white: Table::new(roughness, |mu, alpha| tables::reflected(mu, alpha, |_| 1.0)),
            dielectric: span.ior.map(f32::from_bits).map(|ior| [ior, 1.0 / ior].map(total)),
            root,
            grazing: if to == 0.0 { Vec::new() } else { root.nodes().map(grazing).collect() },
            grazing_average: root.nodes().map(grazing_average).collect(),
            coat: span.coat.map(|(ior, roughness)| {
                let ior = f32::from_bits(ior);
                let reflected =
                    move |mu, alpha| tables::reflected(mu, alpha, |cos| fresnel.dielectric(cos, ior).0);
                Table::new(nodes(roughness), reflected)
            }),
            sheen: span.sheen.map(|roughness| {
                Table::new(nodes(roughness), |mu, alpha| Charlie::new(alpha.sqrt()).albedo(mu))
            }),
        }
    }
}

/// Tables, each computed once for what varies.
#[derive(Default)]
pub(super) struct AllTables {
    /// The curve that all of them are for.
    pub(super) fresnel: Fresnel,
    tables: BTreeMap<Span, Arc<Tables>>,
}

impl AllTables {
    pub(super) fn new(fresnel: Fresnel) -> Self {
        Self { fresnel, tables: BTreeMap::new() }
    }

    pub(super) fn get(&mut self, span: Span) -> Arc<Tables> {
        let made = || Arc::new(Tables::new(span, self.fresnel));
        Arc::clone(self.tables.entry(span).or_insert_with(made))
    }
}

/// Tables read at the cosine of one hit.
pub(super) struct AtHit<'a> {
    pub(super) tables: &'a Tables,
    /// Cosine between the viewing direction and the shading normal, [0, 1].
    pub(super) mu: f32,
}

impl AtHit<'_> {
    #[inline]
    fn read(&self, table: &Table, alpha: f32) -> Albedo {
        let (at, average) = table.at(alpha, self.mu);
        Albedo::Value { at, average }
    }
}

impl Albedos for AtHit<'_> {
    fn white(&mut self, alpha: f32) -> Albedo {
        self.read(&self.tables.white, alpha)
    }

    fn dielectric(&mut self, alpha: f32, _: f32) -> [Albedo; 2] {
        match &self.tables.dielectric {
            Some(sides) => [self.read(&sides[0], alpha), self.read(&sides[1], alpha)],
            None => [self.white(alpha), self.white(alpha)],
        }
    }

    fn grazing(&mut self, alpha: f32, eta: f32, f0: f32) -> Albedo {
        let (i, t) = self.tables.root.place(f0.sqrt().sqrt());
        let Some(low) = self.tables.grazing.get(i) else { return Albedo::Value { at: 0.0, average: 0.0 } };
        let (mut rest, _) = low.at(alpha, self.mu);
        if let Some(high) = self.tables.grazing.get(i + 1).filter(|_| t > 0.0) {
            rest = rest * (1.0 - t) + high.at(alpha, self.mu).0 * t;
        }
        let (white, _) = self.tables.white.at(alpha, self.mu);
        let share = self.tables.fresnel.grazing_share(microfacet_cosine(self.mu, alpha), eta, f0);
        let at = rest + white * share;
        // Nothing asks for the average of this row.
        Albedo::Value { at: at.clamp(0.0, white), average: 0.0 }
    }

    fn grazing_average(&mut self, _: f32, f0: f32) -> f32 {
        let (i, t) = self.tables.root.place(f0.sqrt().sqrt());
        let averages = &self.tables.grazing_average;
        averages[i] * (1.0 - t) + averages.get(i + 1).copied().unwrap_or(0.0) * t
    }

    fn coat(&mut self, alpha: f32, _: f32) -> Albedo {
        self.read(self.tables.coat.as_ref().unwrap_or(&self.tables.white), alpha)
    }

    fn sheen(&mut self, roughness: f32) -> Albedo {
        let table = self.tables.sheen.as_ref().unwrap_or(&self.tables.white);
        self.read(table, roughness * roughness)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROUGHNESS: [f32; 8] = [0.012, 0.037, 0.09, 0.16, 0.33, 0.52, 0.78, 0.96];
    const MU: [f32; 8] = [0.004, 0.02, 0.08, 0.15, 0.4, 0.77, 0.98, 1.0];

    /// The largest difference between tables and the rows of constant materials, over roughness, cosine and
    /// roots of F0: of white, of a dielectric from outside, of the coat; of the grazing share; of averages;
    /// and of a dielectric from inside, whose albedo has a kink where total reflection sets in.
    fn worst(tables: &Tables, roughness: &[f32], roots: &[f32]) -> [f32; 4] {
        let mut rows = Rows::default();
        let mut worst = [0.0f32; 4];
        let mut note = |i: usize, off: f32| worst[i] = worst[i].max(off.abs());
        for &alpha in &roughness.iter().map(|r| r * r).collect::<Vec<_>>() {
            for mu in MU {
                let mut hit = AtHit { tables, mu };
                let (white, exact) = (hit.white(alpha), rows.white(alpha));
                note(0, white.at(mu) - exact.at(mu));
                note(2, white.average() - exact.average());
                let ([a, b], [c, d]) = (hit.dielectric(alpha, 1.5), rows.dielectric(alpha, 1.5));
                note(0, a.at(mu) - c.at(mu));
                note(3, b.at(mu) - d.at(mu));
                note(0, hit.coat(alpha, 1.5).at(mu) - rows.coat(alpha, 1.5).at(mu));
                for s in roots {
                    let (eta, f0) = ((1.0 + s) / (1.0 - s), s * s);
                    note(1, hit.grazing(alpha, eta, f0).at(mu) - rows.grazing(alpha, eta, f0).at(mu));
                    note(2, hit.grazing_average(eta, f0) - rows.grazing_average(eta, f0));
                }
            }
        }
        worst
    }

    /// Guards interpolation over roughness: within 1e-3 (inside of a dielectric 3e-3) of what a constant material of the same
    /// parameters gets (the rows themselves are within 4e-4 of the truth).
    #[test]
    fn tables_follow_the_rows_over_roughness() {
        let span = Span::new(None, [0.2, 0.2], Some(1.5)).coat(1.5, None);
        let worst = worst(&Tables::new(span, Fresnel::Exact), &ROUGHNESS, &[0.2]);
        assert!(worst[..3].iter().all(|w| *w < 1e-3) && worst[3] < 3e-3, "{worst:?}");
    }

    /// Guards interpolation over F0 at a constant roughness.
    #[test]
    fn tables_follow_the_rows_over_reflectance() {
        for roughness in [0.037, 0.3, 0.8] {
            let span = Span::new(Some(roughness), [0.0, 0.4], Some(1.5)).coat(1.5, Some(roughness));
            let worst =
                worst(&Tables::new(span, Fresnel::Exact), &[roughness], &[0.03, 0.05, 0.13, 0.2, 0.37]);
            assert!(worst.iter().all(|w| *w < 2e-3), "{roughness} {worst:?}");
        }
    }
}
