//! `EXT_mesh_gpu_instancing`: one node that places its mesh many times.

use glam::{DAffine3, DQuat, DVec3};
use gltf::json;
use json::accessor::Type;
use serde_json::Value;

use super::super::error::Fault;
use super::accessor::Reader;

const NAME: &str = "EXT_mesh_gpu_instancing";

/// Where the node's mesh stands in its own space; `None` where the extension is absent or says nothing.
pub(super) fn read(
    node: &json::Node,
    place: &str,
    reader: &mut Reader<'_>,
) -> Result<Option<Vec<DAffine3>>, Fault> {
    let extension = node.extensions.as_ref().and_then(|e| e.others.get(NAME));
    let Some(attributes) = extension.and_then(|e| e.get("attributes")).and_then(Value::as_object) else {
        return Ok(None);
    };
    let place = format!("{place}.extensions.{NAME}.attributes");
    let mut count = None;
    let mut accessor = |key: &str, reader: &Reader<'_>| -> Result<Option<(usize, String)>, Fault> {
        let Some(value) = attributes.get(key) else { return Ok(None) };
        let place = format!("{place}.{key}");
        let Some(index) = value.as_u64() else {
            return Err(Fault::invalid(place, value.to_string(), "an index"));
        };
        let n = reader.count(index as usize, &place)?;
        if let Some(first) = count.replace(n).filter(|&first| first != n) {
            return Err(Fault::invalid(place, format!("{n} elements"), format!("{first}, as before")));
        }
        Ok(Some((index as usize, place)))
    };
    let [moved, turned, scaled] = ["TRANSLATION", "ROTATION", "SCALE"].map(|key| accessor(key, reader));
    let (moved, turned, scaled) = (moved?, turned?, scaled?);
    let Some(count) = count else { return Ok(None) };
    reader.budget.charge_bytes(count, size_of::<DAffine3>() as u64, &place)?;

    let mut floats3 = |at: Option<(usize, String)>| {
        at.map(|(index, place)| reader.floats::<3>(index, &[Type::Vec3], 0.0, &place)).transpose()
    };
    let (moved, scaled) = (floats3(moved)?, floats3(scaled)?);
    let turned =
        turned.map(|(index, place)| reader.floats::<4>(index, &[Type::Vec4], 0.0, &place)).transpose()?;
    let vec = |list: &Option<Vec<[f32; 3]>>, i: usize, absent: DVec3| {
        list.as_ref().map_or(absent, |list| DVec3::from_array(list[i].map(f64::from)))
    };
    let instance = |i: usize| {
        let turn = turned.as_ref().map_or(DQuat::IDENTITY, |q| DQuat::from_array(q[i].map(f64::from)));
        let transform = DAffine3::from_scale_rotation_translation(
            vec(&scaled, i, DVec3::ONE),
            turn.normalize(),
            vec(&moved, i, DVec3::ZERO),
        );
        // A quaternion of length zero ends here as well.
        if transform.is_finite() {
            return Ok(transform);
        }
        Err(Fault::invalid(
            &*place,
            format!("no transform as element {i}"),
            "finite numbers, unit quaternions",
        ))
    };
    (0..count as usize).map(instance).collect::<Result<_, _>>().map(Some)
}
