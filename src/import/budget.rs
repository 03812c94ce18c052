//! What a file may ask for in all: every reader charges before it allocates.

use super::ReadOptions;
use super::error::Fault;

/// What is left of the limits in [`ReadOptions`] while one file is read.
pub(crate) struct Budget {
    bytes: u64,
    triangles: u64,
    limits: ReadOptions,
}

impl Budget {
    /// The whole of `limits`.
    pub(crate) fn new(limits: &ReadOptions) -> Self {
        Self { bytes: limits.max_bytes, triangles: limits.max_triangles, limits: *limits }
    }

    /// Takes `count * size` bytes, or refuses.
    pub(crate) fn charge_bytes(&mut self, count: u64, size: u64, place: &str) -> Result<(), Fault> {
        match count.checked_mul(size).and_then(|bytes| self.bytes.checked_sub(bytes)) {
            Some(left) => {
                self.bytes = left;
                Ok(())
            }
            None => Err(Fault::Unsupported {
                place: place.into(),
                feature: format!("a file that needs more than {} bytes", self.limits.max_bytes),
                help: "raise the limit if the file is trusted".into(),
            }),
        }
    }

    /// Takes `count` triangles, or refuses.
    pub(crate) fn charge_triangles(&mut self, count: u64, place: &str) -> Result<(), Fault> {
        match self.triangles.checked_sub(count) {
            Some(left) => {
                self.triangles = left;
                Ok(())
            }
            None => Err(Fault::Unsupported {
                place: place.into(),
                feature: format!("a file of more than {} triangles", self.limits.max_triangles),
                help: "raise the limit if the file is trusted".into(),
            }),
        }
    }
}

/// `count` copies of `value`, which have been charged, or a fault where there is no memory for them.
pub(crate) fn filled<T: Clone>(count: usize, value: T, place: &str) -> Result<Vec<T>, Fault> {
    let mut list = Vec::new();
    list.try_reserve_exact(count).map_err(|_| Fault::Unsupported {
        place: place.into(),
        feature: format!("a list that takes {} bytes of memory", count.saturating_mul(size_of::<T>())),
        help: "there is not as much free".into(),
    })?;
    list.resize(count, value);
    Ok(list)
}
