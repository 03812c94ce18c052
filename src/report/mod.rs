//! Numbers about scenes and finished images: what a scene holds, how far two images are apart, and
//! whether that means anything.

mod compare;
mod explain;
mod flip;
mod heat;
mod inventory;

pub use compare::{Basis, Channel, CompareError, Comparison, Tiles, Verdict, compare, probability};
pub use explain::{Explanation, PlanFacts};
pub use flip::flip;
pub use heat::{difference_map, flip_map};
pub use inventory::{Inventory, inventory};
