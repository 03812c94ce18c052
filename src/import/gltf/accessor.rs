//! Checked reading of accessors: buffers, views, strides, sparse values, normalised integers.
//!
//! In: indices from the document. Out: vectors of numbers. Every range is checked in 64-bit arithmetic
//! against the bytes that are there, and every vector is charged to the budget before it is allocated.
//! Source: glTF 2.0, section 3.6.

use std::borrow::Cow;
use std::path::Path;

use gltf::json;
use json::accessor::{ComponentType, Type};
use json::validation::Checked;

use super::super::budget::{Budget, filled};
use super::super::error::Fault;
use super::super::file;
use super::document::Document;

/// Reads accessors of one document.
pub(super) struct Reader<'a> {
    doc: &'a Document,
    buffers: Vec<Option<Cow<'a, [u8]>>>,
    pub(super) budget: &'a mut Budget,
}

/// Elements within a buffer, all known to lie inside it.
struct Elements<'b> {
    bytes: &'b [u8],
    stride: usize,
    count: usize,
    component: ComponentType,
    width: usize,
}

impl<'a> Reader<'a> {
    /// Loads the buffers: the binary chunk of a GLB file, data URIs, and files below `folder`.
    pub(super) fn new(
        doc: &'a Document,
        bin: Option<&'a [u8]>,
        folder: &Path,
        budget: &'a mut Budget,
    ) -> Result<Self, Fault> {
        let mut buffers = Vec::with_capacity(doc.buffers.len());
        for (i, buffer) in doc.buffers.iter().enumerate() {
            let place = format!("buffers[{i}]");
            let bytes: Option<Cow<'a, [u8]>> = match &buffer.uri {
                None if i == 0 => bin.map(Cow::Borrowed),
                None => None,
                Some(uri) => Some(Cow::Owned(load(uri, &place, folder, budget)?)),
            };
            let length = buffer.byte_length.0;
            if let Some(there) = bytes.as_ref().map(|b| b.len() as u64).filter(|&there| there < length) {
                let expected = format!("{length} (byteLength)");
                return Err(Fault::invalid(place, format!("{there} bytes of data"), expected));
            }
            buffers.push(bytes);
        }
        Ok(Self { doc, buffers, budget })
    }

    /// Number of elements of accessor `index`.
    pub(super) fn count(&self, index: usize, place: &str) -> Result<u64, Fault> {
        Ok(get(&self.doc.accessors, index, place)?.count.0)
    }

    /// A float or integer accessor as vectors of `N` floats; `fill` stands for missing components.
    ///
    /// `widths` are the accepted numbers of components.
    pub(super) fn floats<const N: usize>(
        &mut self,
        index: usize,
        widths: &[Type],
        fill: f32,
        place: &str,
    ) -> Result<Vec<[f32; N]>, Fault> {
        let accessor = get(&self.doc.accessors, index, place)?;
        let place = format!("accessors[{index}]");
        match accessor.type_ {
            Checked::Valid(t) if widths.contains(&t) => {}
            _ => {
                let found = type_name(accessor.type_);
                let expected = widths.iter().map(|&t| type_name(Checked::Valid(t))).collect::<Vec<_>>();
                return Err(Fault::invalid(format!("{place}.type"), found, expected.join(" or ")));
            }
        }
        let (component, width) = layout(accessor, &place)?;
        self.base(accessor, component, width, &place)?;
        self.budget.charge_bytes(accessor.count.0, size_of::<[f32; N]>() as u64, &place)?;
        let mut out = filled(accessor.count.0 as usize, [fill; N], &place)?;
        let normalized = accessor.normalized;
        let mut write = |to: usize, bytes: &[u8]| {
            for (slot, bytes) in out[to].iter_mut().zip(bytes.chunks_exact(component.size())) {
                *slot = float(bytes, component, normalized);
            }
        };
        match self.base(accessor, component, width, &place)? {
            Some(elements) => (0..elements.count).for_each(|i| write(i, elements.get(i))),
            None => {
                let zeros = [0; 16];
                let size = component.size() * width;
                (0..accessor.count.0 as usize).for_each(|i| write(i, &zeros[..size]));
            }
        }
        if let Some((indices, values)) = self.sparse(accessor, component, width, &place)? {
            for (i, &to) in indices.iter().enumerate() {
                write(to as usize, values.get(i));
            }
        }
        Ok(out)
    }

    /// An accessor of unsigned integers, each below `bound`.
    pub(super) fn indices(&mut self, index: usize, bound: u64, place: &str) -> Result<Vec<u32>, Fault> {
        let accessor = get(&self.doc.accessors, index, place)?;
        let place = format!("accessors[{index}]");
        let (component, width) = layout(accessor, &place)?;
        let unsigned = matches!(component, ComponentType::U8 | ComponentType::U16 | ComponentType::U32);
        if !unsigned || width != 1 {
            let found = format!("{} of {component:?}", type_name(accessor.type_));
            return Err(Fault::invalid(place, found, "SCALAR of an unsigned integer type, for indices"));
        }
        self.base(accessor, component, width, &place)?;
        self.budget.charge_bytes(accessor.count.0, 4, &place)?;
        let mut out = filled(accessor.count.0 as usize, 0, &place)?;
        if let Some(elements) = self.base(accessor, component, width, &place)? {
            out.iter_mut().enumerate().for_each(|(i, out)| *out = integer(elements.get(i)));
        }
        if let Some((indices, values)) = self.sparse(accessor, component, width, &place)? {
            for (i, &to) in indices.iter().enumerate() {
                out[to as usize] = integer(values.get(i));
            }
        }
        check_bound(&out, bound, &place)?;
        Ok(out)
    }

    /// The elements in the accessor's own view; `None` means zeros.
    fn base(
        &self,
        accessor: &json::Accessor,
        component: ComponentType,
        width: usize,
        place: &str,
    ) -> Result<Option<Elements<'_>>, Fault> {
        let Some(view) = accessor.buffer_view else {
            return Ok(None);
        };
        let offset = accessor.byte_offset.map_or(0, |o| o.0);
        self.elements(view.value(), offset, accessor.count.0, component, width, place).map(Some)
    }

    /// The places and values of a sparse accessor.
    fn sparse(
        &self,
        accessor: &json::Accessor,
        component: ComponentType,
        width: usize,
        place: &str,
    ) -> Result<Option<(Vec<u32>, Elements<'_>)>, Fault> {
        let Some(sparse) = &accessor.sparse else {
            return Ok(None);
        };
        let place = format!("{place}.sparse");
        let Checked::Valid(kind) = sparse.indices.component_type else {
            return Err(Fault::invalid(
                format!("{place}.indices.componentType"),
                "an unknown value",
                "5121, 5123 or 5125",
            ));
        };
        let count = sparse.count.0;
        if count > accessor.count.0 {
            let expected = format!("at most {}", accessor.count.0);
            return Err(Fault::invalid(format!("{place}.count"), count.to_string(), expected));
        }
        let (view, offset) = (sparse.indices.buffer_view.value(), sparse.indices.byte_offset.0);
        let list = self.elements(view, offset, count, kind.0, 1, &format!("{place}.indices"))?;
        let indices: Vec<u32> = (0..list.count).map(|i| integer(list.get(i))).collect();
        check_bound(&indices, accessor.count.0, &format!("{place}.indices"))?;
        let (view, offset) = (sparse.values.buffer_view.value(), sparse.values.byte_offset.0);
        let values = self.elements(view, offset, count, component, width, &format!("{place}.values"))?;
        Ok(Some((indices, values)))
    }

    /// The bytes of view `index`, which `place` names.
    pub(super) fn view(&self, index: usize, place: &str) -> Result<&[u8], Fault> {
        let v = get(&self.doc.views, index, place)?;
        let place = format!("bufferViews[{index}]");
        let buffer_index = v.buffer.value();
        let Some(buffer) = get(&self.buffers, buffer_index, &format!("{place}.buffer"))? else {
            let place = format!("buffers[{buffer_index}]");
            return Err(Fault::invalid(place, "neither a uri nor a binary chunk", "data"));
        };
        let start = v.byte_offset.map_or(0, |o| o.0);
        let there = buffer.len() as u64;
        let Some(end) = start.checked_add(v.byte_length.0).filter(|&end| end <= there) else {
            let found = format!("{} bytes from byte {start}", v.byte_length.0);
            return Err(Fault::invalid(place, found, format!("at most the buffer's {there}")));
        };
        Ok(&buffer[start as usize..end as usize])
    }

    /// `count` elements that begin `offset` bytes into view `view`, once all of them are known to be there.
    fn elements(
        &self,
        view: usize,
        offset: u64,
        count: u64,
        component: ComponentType,
        width: usize,
        place: &str,
    ) -> Result<Elements<'_>, Fault> {
        let view_place = format!("bufferViews[{view}]");
        let bytes = self.view(view, &format!("{place}.bufferView"))?;
        let there = bytes.len() as u64;
        let size = (component.size() * width) as u64;
        let stride = self.doc.views[view].byte_stride.map_or(size, |s| s.0 as u64);
        if stride < size {
            let expected = format!("at least {size}, the size of an element of {place}");
            return Err(Fault::invalid(format!("{view_place}.byteStride"), stride.to_string(), expected));
        }
        let needed = match count.checked_sub(1) {
            None => Some(0),
            Some(last) => last.checked_mul(stride).and_then(|n| n.checked_add(size)?.checked_add(offset)),
        };
        let Some(needed) = needed.filter(|&needed| needed <= there) else {
            let found = format!("{count} elements of {size} bytes, {stride} apart, from byte {offset}");
            let expected = format!("elements within the {there} bytes of {view_place}");
            return Err(Fault::invalid(place, found, expected));
        };
        let bytes = &bytes[if needed == 0 { 0 } else { offset as usize }..];
        Ok(Elements { bytes, stride: stride as usize, count: count as usize, component, width })
    }
}

impl Elements<'_> {
    /// The bytes of element `i`.
    fn get(&self, i: usize) -> &[u8] {
        let start = i * self.stride;
        &self.bytes[start..start + self.component.size() * self.width]
    }
}

/// The bytes that a buffer's `uri` stands for.
fn load(uri: &str, place: &str, folder: &Path, budget: &mut Budget) -> Result<Vec<u8>, Fault> {
    let place = format!("{place}.uri");
    if let Some(bytes) = file::data_uri(uri, &place) {
        // No longer than its text, which was charged with the file.
        return bytes;
    }
    file::read_named(&file::resolve(folder, uri, &place)?, &place, budget)
}

/// Element `index` of `list`, or a fault at `place`.
pub(super) fn get<'t, T>(list: &'t [T], index: usize, place: &str) -> Result<&'t T, Fault> {
    list.get(index)
        .ok_or_else(|| Fault::invalid(place, format!("index {index}"), format!("below {}", list.len())))
}

/// Component type and number of components; matrices are never read.
fn layout(accessor: &json::Accessor, place: &str) -> Result<(ComponentType, usize), Fault> {
    let Checked::Valid(component) = accessor.component_type else {
        return Err(Fault::invalid(
            format!("{place}.componentType"),
            "an unknown value",
            "5120 to 5126 without 5124",
        ));
    };
    match accessor.type_ {
        Checked::Valid(t @ (Type::Scalar | Type::Vec2 | Type::Vec3 | Type::Vec4)) => {
            Ok((component.0, t.multiplicity()))
        }
        t => Err(Fault::invalid(format!("{place}.type"), type_name(t), "SCALAR, VEC2, VEC3 or VEC4")),
    }
}

fn type_name(t: Checked<Type>) -> String {
    match t {
        Checked::Valid(t) => format!("{t:?}").to_uppercase(),
        Checked::Invalid => "an unknown type".into(),
    }
}

fn check_bound(indices: &[u32], bound: u64, place: &str) -> Result<(), Fault> {
    match indices.iter().position(|&i| u64::from(i) >= bound) {
        None => Ok(()),
        Some(at) => {
            let found = format!("index {} as element {at}", indices[at]);
            Err(Fault::invalid(place, found, format!("below {bound}")))
        }
    }
}

/// One little-endian unsigned integer of 1, 2 or 4 bytes.
fn integer(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |n, &b| n << 8 | u32::from(b))
}

/// One component as a float (glTF 2.0, section 3.6.2.2, for the normalised ones).
fn float(bytes: &[u8], component: ComponentType, normalized: bool) -> f32 {
    let n = integer(bytes);
    let (value, max) = match component {
        ComponentType::F32 => return f32::from_bits(n),
        ComponentType::I8 => (f64::from(n as u8 as i8), 127.0),
        ComponentType::U8 => (f64::from(n as u8), 255.0),
        ComponentType::I16 => (f64::from(n as u16 as i16), 32767.0),
        ComponentType::U16 => (f64::from(n as u16), 65535.0),
        ComponentType::U32 => (f64::from(n), 4_294_967_295.0),
    };
    (if normalized { (value / max).max(-1.0) } else { value }) as f32
}
