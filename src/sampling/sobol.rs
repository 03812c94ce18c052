//! The first four dimensions of Sobol's sequence, Owen-scrambled by hashing.
//!
//! Sources: Joe and Kuo, SIAM J. Sci. Comput. 30, 2008 (direction numbers); Burley, "Practical
//! Hash-based Owen Scrambling", JCGT 9(4), 2020 (shuffled indices and padding); the hash is of the
//! Laine-Karras kind (Eurographics 2011) in the variant of Vegdahl (2021). The hash works on bits in
//! reversed order, so the tables here hold points with their bits reversed.

/// Primitive polynomial's inner coefficients and initial direction numbers of dimensions 2 to 4.
const JOE_KUO: [(u32, &[u32]); 3] = [(0, &[1]), (1, &[1, 3]), (1, &[1, 3, 1])];

/// Bit-reversed points of the 16 values of each of the index's eight nibbles; a point is the XOR of
/// eight entries.
static TABLE: [[[u32; 4]; 16]; 8] = build_table();

const fn direction_numbers(dim: usize) -> [u32; 32] {
    let mut v = [0u32; 32];
    let mut i = 0;
    if dim == 0 {
        while i < 32 {
            v[i] = 1 << (31 - i);
            i += 1;
        }
        return v;
    }
    let (a, m) = JOE_KUO[dim - 1];
    let s = m.len();
    while i < 32 {
        if i < s {
            v[i] = m[i] << (31 - i);
        } else {
            v[i] = v[i - s] ^ (v[i - s] >> s);
            let mut k = 1;
            while k < s {
                if (a >> (s - 1 - k)) & 1 == 1 {
                    v[i] ^= v[i - k];
                }
                k += 1;
            }
        }
        i += 1;
    }
    v
}

const fn build_table() -> [[[u32; 4]; 16]; 8] {
    let mut table = [[[0u32; 4]; 16]; 8];
    let mut dim = 0;
    while dim < 4 {
        let v = direction_numbers(dim);
        let mut nibble = 0;
        while nibble < 8 {
            let mut value = 0;
            while value < 16 {
                let mut x = 0;
                let mut bit = 0;
                while bit < 4 {
                    if (value >> bit) & 1 == 1 {
                        x ^= v[nibble * 4 + bit];
                    }
                    bit += 1;
                }
                table[nibble][value][dim] = x.reverse_bits();
                value += 1;
            }
            nibble += 1;
        }
        dim += 1;
    }
    table
}

/// Point `index` of the unscrambled sequence, bits reversed (the first binary digit is bit 0).
#[inline]
fn sobol_reversed(index: u32) -> [u32; 4] {
    let mut x = [0u32; 4];
    for (nibble, row) in TABLE.iter().enumerate() {
        let entry = &row[(index >> (4 * nibble)) as usize & 15];
        for (x, e) in x.iter_mut().zip(entry) {
            *x ^= e;
        }
    }
    x
}

/// A hash in which each bit depends on lower bits only: on reversed digits it is an Owen scramble.
#[inline]
fn laine_karras(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

/// Point `index` of the sequence that `shuffle` reorders and `scramble` randomises, as 32-bit
/// fractions. Both are nested uniform scrambles, so any aligned power-of-two block of indices keeps
/// the sequence's stratification.
#[inline]
pub(super) fn shuffled_scrambled(index: u32, shuffle: u32, scramble: [u32; 4]) -> [u32; 4] {
    let shuffled = laine_karras(index.reverse_bits(), shuffle).reverse_bits();
    let mut x = sobol_reversed(shuffled);
    for (x, seed) in x.iter_mut().zip(scramble) {
        *x = laine_karras(*x, seed).reverse_bits();
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(points: &[[u32; 4]], a: usize, b: usize, bits_a: u32, bits_b: u32) -> Vec<u32> {
        let mut n = vec![0; 1 << (bits_a + bits_b)];
        for p in points {
            let ia = if bits_a == 0 { 0 } else { p[a] >> (32 - bits_a) };
            let ib = if bits_b == 0 { 0 } else { p[b] >> (32 - bits_b) };
            n[((ia << bits_b) | ib) as usize] += 1;
        }
        n
    }

    /// Sobol's first two dimensions are a (0, 2)-sequence: every elementary interval of a block of
    /// 2^m points holds exactly one, and scrambling keeps that.
    #[test]
    fn elementary_intervals_hold_one_point_each() {
        for seed in 0..20u32 {
            let h = |k: u32| (seed * 8 + k).wrapping_mul(0x9e37_79b9) ^ 0x5bd1_e995;
            let m = 8;
            for block in 0..3 {
                let points: Vec<_> = (block << m..(block + 1) << m)
                    .map(|i| shuffled_scrambled(i, h(0), [h(1), h(2), h(3), h(4)]))
                    .collect();
                for k in 0..=m {
                    assert!(counts(&points, 0, 1, k, m - k).iter().all(|&n| n == 1), "2^-{k}");
                }
                for dim in 0..4 {
                    assert!(counts(&points, dim, 0, m, 0).iter().all(|&n| n == 1), "dimension {dim}");
                }
            }
        }
    }

    #[test]
    fn first_points_are_the_published_ones() {
        let as_fraction = |i| sobol_reversed(i).map(|x| f64::from(x.reverse_bits()) / 4_294_967_296.0);
        assert_eq!(as_fraction(0), [0.0; 4]);
        assert_eq!(as_fraction(1), [0.5; 4]);
        assert_eq!(as_fraction(2), [0.25, 0.75, 0.75, 0.75]);
        assert_eq!(as_fraction(3), [0.75, 0.25, 0.25, 0.25]);
    }
}
