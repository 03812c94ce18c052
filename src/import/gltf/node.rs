//! The node graph becomes objects, lights and cameras in world space.
//!
//! The graph is checked to be a forest first, and then walked with a stack of our own: chains of any
//! length are fine. Transforms are multiplied in 64 bits.

use std::collections::HashSet;
use std::path::Path;

use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3};
use gltf::json;
use json::validation::Checked;

use super::super::budget::Budget;
use super::super::error::Fault;
use super::super::names::Names;
use super::super::notes::Notes;
use super::super::{LightUnits, ReadOptions};
use super::accessor::{Reader, get};
use super::document::Document;
use super::light::Lights;
use super::mesh::Meshes;
use super::texture::Textures;
use super::{instancing, material, sphere, vendor};
use crate::scene::{
    Camera, FovAxis, Light, Material, MaterialId, MaterialKind, MeshId, NoteEffect, Object, Projection,
    Scene, Shape,
};

/// Builds the scene that `doc` describes.
pub(super) fn build(
    doc: &Document,
    mut reader: Reader<'_>,
    folder: &Path,
    options: &ReadOptions,
    notes: &mut Notes,
) -> Result<Scene, Fault> {
    check_forest(doc)?;
    charge_nodes(doc, reader.budget)?;
    let mut names = Names::default();
    let mut textures = Textures::new(doc, folder);
    let materials: Result<Vec<_>, Fault> = (0..doc.materials.len())
        .map(|i| {
            let name = doc.materials[i].name.as_deref().filter(|n| !n.is_empty());
            let name = names.unique(&name.map_or_else(|| format!("material {i}"), Into::into));
            let kind = material::convert(doc, i, &mut textures, &mut reader, notes)?;
            let kind = vendor::material(&doc.materials[i], kind, &format!("materials[{i}]"), notes);
            Ok(Material { name, kind })
        })
        .collect();
    let own = doc.is_own() && options.light_units == LightUnits::Auto;
    let units = if own { LightUnits::Unitless } else { options.light_units };
    let mut builder = Builder {
        doc,
        reader,
        notes,
        lights: Lights::new(units, doc.is_from_blender()),
        meshes: Meshes::default(),
        default_material: None,
        material_names: names,
        camera_names: Names::default(),
        looked_at: HashSet::new(),
        scene: Scene { title: doc.title.clone(), materials: materials?, ..Scene::default() },
    };
    let mut stack: Vec<(usize, DAffine3)> =
        doc.roots.iter().rev().map(|&r| (r, DAffine3::IDENTITY)).collect();
    while let Some((index, parent)) = stack.pop() {
        let node = &doc.nodes[index];
        let place = format!("nodes[{index}]");
        let ours = vendor::Node::read(node, &place, &doc.vendor, builder.notes);
        let local = match ours.matrix(builder.notes) {
            Some(exact) => exact,
            None => local_transform(node, &place)?,
        };
        let world = parent * local;
        if !world.is_finite() {
            return Err(Fault::invalid(place, "a transform that is not finite", "finite numbers"));
        }
        builder.node(index, node, &ours, world, &place)?;
        stack.extend(node.children.iter().flatten().rev().map(|c| (c.value(), world)));
    }
    let Builder { mut reader, meshes, scene, notes, .. } = builder;
    let mut scene = Scene { meshes: meshes.list, ..scene };
    vendor::scene(&doc.vendor, &mut scene, &mut textures, &mut reader, notes)?;
    Ok(Scene { images: textures.finish(), ..scene })
}

/// Charges for what stands at the nodes, before any of it is made: nodes times primitives, or nodes that
/// share a long name, can be far more than the file is long.
fn charge_nodes(doc: &Document, budget: &mut Budget) -> Result<(), Fault> {
    for (i, node) in doc.nodes.iter().enumerate() {
        let place = format!("nodes[{i}]");
        if let Some(mesh) = node.mesh.and_then(|m| doc.meshes.get(m.value())) {
            budget.charge_bytes(mesh.primitives.len() as u64, object_bytes(node, mesh), &place)?;
        }
        let name = |shared: Option<&String>| node.name.as_ref().or(shared).map_or(0, |n| n.len() as u64);
        if let Some(camera) = node.camera.and_then(|c| doc.cameras.get(c.value())) {
            // The list of names that are taken holds two more.
            let camera = size_of::<Camera>() as u64 + 3 * name(camera.name.as_ref());
            budget.charge_bytes(1, camera, &place)?;
        }
        let light = node.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
        if let Some(light) = light.and_then(|l| doc.lights.get(l.light.value())) {
            budget.charge_bytes(1, size_of::<Light>() as u64 + name(light.name.as_ref()), &place)?;
        }
    }
    Ok(())
}

/// What an object of `mesh` at `node` takes, with its name.
fn object_bytes(node: &json::Node, mesh: &json::Mesh) -> u64 {
    let name = node.name.as_ref().or(mesh.name.as_ref()).map_or(16, String::len);
    (size_of::<Object>() + name) as u64
}

/// Every node has at most one parent, the scene's roots have none, and nothing goes round in circles.
fn check_forest(doc: &Document) -> Result<(), Fault> {
    let nodes = &doc.nodes;
    let mut parent: Vec<Option<usize>> = vec![None; nodes.len()];
    for (i, node) in nodes.iter().enumerate() {
        for (k, child) in node.children.iter().flatten().enumerate() {
            let place = format!("nodes[{i}].children[{k}]");
            get(nodes, child.value(), &place)?;
            if let Some(first) = parent[child.value()].replace(i) {
                let found = format!("node {}, a child of node {first} already", child.value());
                return Err(Fault::invalid(place, found, "each node to have one parent at most"));
            }
        }
    }
    let mut is_root = vec![false; nodes.len()];
    for (k, &root) in doc.roots.iter().enumerate() {
        let place = format!("scene.nodes[{k}]");
        get(nodes, root, &place)?;
        if parent[root].is_some() || std::mem::replace(&mut is_root[root], true) {
            let found = format!("node {root}, which is a child or listed twice");
            return Err(Fault::invalid(place, found, "each root once, and nobody's child"));
        }
    }
    let mut stack: Vec<usize> = (0..nodes.len()).filter(|&i| parent[i].is_none()).collect();
    let mut is_reached = vec![false; nodes.len()];
    while let Some(i) = stack.pop() {
        is_reached[i] = true;
        stack.extend(nodes[i].children.iter().flatten().map(|c| c.value()));
    }
    match is_reached.iter().position(|&r| !r) {
        None => Ok(()),
        Some(i) => Err(Fault::invalid(format!("nodes[{i}].children"), "a circle of nodes", "a tree")),
    }
}

/// Own space of `node` to that of its parent.
fn local_transform(node: &json::Node, place: &str) -> Result<DAffine3, Fault> {
    let key = |key: &str| format!("{place}.{key}");
    let finite = |values: &[f32], name: &str| {
        if values.iter().all(|v| v.is_finite()) {
            Ok(())
        } else {
            Err(Fault::invalid(key(name), format!("{values:?}"), "finite numbers"))
        }
    };
    if let Some(matrix) = node.matrix {
        finite(&matrix, "matrix")?;
        let m = DMat4::from_cols_array(&matrix.map(f64::from));
        let row = m.row(3);
        if (row - glam::DVec4::W).abs().max_element() > 1e-5 {
            return Err(Fault::invalid(key("matrix"), format!("a last row of {row}"), "0, 0, 0, 1"));
        }
        return Ok(DAffine3 {
            matrix3: DMat3::from_cols(m.x_axis.truncate(), m.y_axis.truncate(), m.z_axis.truncate()),
            translation: m.w_axis.truncate(),
        });
    }
    let translation = node.translation.unwrap_or_default();
    let rotation = node.rotation.unwrap_or_default().0;
    let scale = node.scale.unwrap_or([1.0; 3]);
    finite(&translation, "translation")?;
    finite(&rotation, "rotation")?;
    finite(&scale, "scale")?;
    let vec = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
    let rotation = DQuat::from_array(rotation.map(f64::from));
    if rotation.length() < 1e-6 {
        return Err(Fault::invalid(key("rotation"), "a quaternion of length zero", "a unit quaternion"));
    }
    Ok(DAffine3::from_scale_rotation_translation(vec(scale), rotation.normalize(), vec(translation)))
}

struct Builder<'d> {
    doc: &'d Document,
    reader: Reader<'d>,
    notes: &'d mut Notes,
    lights: Lights,
    meshes: Meshes,
    default_material: Option<MaterialId>,
    material_names: Names,
    camera_names: Names,
    /// Meshes and materials that have been held against each other.
    looked_at: HashSet<(MeshId, MaterialId)>,
    scene: Scene,
}

impl Builder<'_> {
    /// Adds what stands at one node.
    fn node(
        &mut self,
        index: usize,
        node: &json::Node,
        ours: &vendor::Node,
        world: DAffine3,
        place: &str,
    ) -> Result<(), Fault> {
        let name = node.name.as_deref().filter(|n| !n.is_empty());
        if node.skin.is_some() {
            let message = "skins are not applied: the mesh is shown as modelled";
            self.notes.add("skin-ignored", NoteEffect::Differs, format!("{place}.skin"), message);
        }
        if let Some(camera) = node.camera {
            let camera_place = format!("{place}.camera");
            let source = get(&self.doc.cameras, camera.value(), &camera_place)?;
            let name = name.or(source.name.as_deref()).unwrap_or("camera");
            self.camera(source, name, world, &format!("cameras[{}]", camera.value()));
        }
        let reference = node.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
        let mut punctual = None;
        let mut light_name = name.unwrap_or("light").to_owned();
        if let Some(light) = reference {
            let i = light.light.value();
            let source = get(&self.doc.lights, i, &format!("{place}.extensions.KHR_lights_punctual.light"))?;
            light_name = name.or(source.name.as_deref()).unwrap_or("light").to_owned();
            let light_place = format!("extensions.KHR_lights_punctual.lights[{i}]");
            if !ours.has_whole_light() {
                let name = light_name.clone();
                punctual = Some(self.lights.convert(source, name, world, &light_place, self.notes)?);
            }
        }
        let light = ours.light(punctual, &light_name, world, self.lights.nits(), self.notes);
        let is_light = reference.is_some() || light.is_some();
        self.scene.lights.extend(light);
        if let Some(mesh) = node.mesh {
            let first = self.scene.objects.len();
            match instancing::read(node, place, &mut self.reader)? {
                None => self.mesh(mesh.value(), node, ours, name, world, place)?,
                Some(list) => {
                    let source = get(&self.doc.meshes, mesh.value(), &format!("{place}.mesh"))?;
                    let count = (list.len() as u64).saturating_mul(source.primitives.len() as u64);
                    self.reader.budget.charge_bytes(count, object_bytes(node, source), place)?;
                    for own in list {
                        self.mesh(mesh.value(), node, ours, name, world * own, place)?;
                    }
                }
            }
            if let Some(visible) = ours.visible_to_camera() {
                self.scene.objects[first..].iter_mut().for_each(|o| o.visible_to_camera = visible);
            }
        } else if node.camera.is_none() && !is_light {
            ours.sphere(false, self.notes);
            self.empty(index, node, place);
        }
        Ok(())
    }

    /// A node that shows nothing: perhaps an area light, which Blender's exporter drops.
    fn empty(&mut self, index: usize, node: &json::Node, place: &str) {
        let is_leaf = node.children.iter().all(Vec::is_empty);
        let is_plain = node.extensions.is_none() && node.extras.is_none();
        if self.doc.is_from_blender() && is_leaf && is_plain && !self.doc.joints.contains(&index) {
            let message = "an empty node: if it was an area light in Blender, its light is not in the file";
            self.notes.add("area-light-lost", NoteEffect::Missing, place, message);
        }
    }

    fn mesh(
        &mut self,
        index: usize,
        node: &json::Node,
        ours: &vendor::Node,
        name: Option<&str>,
        world: DAffine3,
        place: &str,
    ) -> Result<(), Fault> {
        let mesh = get(&self.doc.meshes, index, &format!("{place}.mesh"))?;
        let mesh_name = mesh.name.as_deref().filter(|n| !n.is_empty());
        let mesh_name = mesh_name.map_or_else(|| format!("mesh {index}"), Into::into);
        let name = name.unwrap_or(&mesh_name).to_owned();
        if !world.is_finite() {
            return Err(Fault::invalid(place, "a transform that is not finite", "finite numbers"));
        }
        if world.matrix3.determinant() == 0.0 {
            let message = "an object that its transform flattens is left out";
            self.notes.add("object-flattened", NoteEffect::Missing, place, message);
            return Ok(());
        }
        if let Some(radius) = ours.sphere(true, self.notes) {
            if let Some(transform) = sphere::placement(world) {
                let material = mesh.primitives.first().and_then(|p| p.material);
                let material =
                    self.material(material.map(|m| m.value()), &format!("meshes[{index}].primitives[0]"))?;
                self.object(name, Shape::Sphere { radius }, material, transform);
                return Ok(());
            }
            let message =
                "a sphere under a transform that is no rotation and uniform scale: the mesh is kept";
            self.notes.add("sphere-ignored", NoteEffect::Differs, place, message);
        }
        let weights = node.weights.as_ref().or(mesh.weights.as_ref()).map_or(&[][..], |w| w);
        for (k, primitive) in mesh.primitives.iter().enumerate() {
            let at = format!("meshes[{index}].primitives[{k}]");
            let part =
                if mesh.primitives.len() > 1 { format!("{mesh_name}[{k}]") } else { mesh_name.clone() };
            let id = self.meshes.get(primitive, weights, &part, &at, &mut self.reader, self.notes)?;
            if let Some(id) = id {
                let material = self.material(primitive.material.map(|m| m.value()), &at)?;
                self.note_idle_colors(id, material, &at);
                self.object(name.clone(), Shape::Mesh(id), material, world);
            }
        }
        Ok(())
    }

    /// Notes vertex colours that do nothing under this material; `place` is that of the primitive.
    fn note_idle_colors(&mut self, mesh: MeshId, material: MaterialId, place: &str) {
        let MaterialKind::Principled(p) = &self.scene.materials[material.0 as usize].kind else { return };
        if !self.looked_at.insert((mesh, material)) {
            return;
        }
        let mesh = &self.meshes.list[mesh.0 as usize];
        if !mesh.colors.is_empty() && p.base_color.is_black() && !p.emission.is_black() {
            let message = "vertex colours do not tint what a surface emits";
            let place = format!("{place}.attributes.COLOR_0");
            self.notes.add("vertex-colors-ignored", NoteEffect::Differs, place, message);
        }
    }

    fn object(&mut self, name: String, shape: Shape, material: MaterialId, transform: DAffine3) {
        self.scene.objects.push(Object { name, shape, material, transform, visible_to_camera: true });
    }

    /// The material of a primitive at `place`; glTF's default where it names none.
    fn material(&mut self, index: Option<usize>, place: &str) -> Result<MaterialId, Fault> {
        if let Some(index) = index {
            get(&self.doc.materials, index, &format!("{place}.material"))?;
            return Ok(MaterialId(index as u32));
        }
        if self.doc.is_from_blender() {
            let message = "no material: shown as white metal, glTF's default, though Blender shows it grey";
            self.notes.add("material-lost", NoteEffect::Differs, place, message);
        }
        if let Some(id) = self.default_material {
            return Ok(id);
        }
        let id = MaterialId(self.scene.materials.len() as u32);
        let name = self.material_names.unique("default");
        self.scene.materials.push(Material { name, kind: material::default_kind() });
        self.default_material = Some(id);
        Ok(id)
    }

    fn camera(&mut self, source: &json::Camera, name: &str, transform: DAffine3, place: &str) {
        let perspective = source.perspective.as_ref();
        let orthographic = source.orthographic.as_ref();
        let (projection, aspect) = match (source.type_, perspective, orthographic) {
            (Checked::Valid(json::camera::Type::Perspective), Some(p), _) => {
                let fov = f64::from(p.yfov);
                let is_good = fov > 0.0 && fov < std::f64::consts::PI;
                let projection = Projection::Perspective { fov, axis: FovAxis::Vertical };
                (is_good.then_some(projection), p.aspect_ratio.map(f64::from))
            }
            (Checked::Valid(json::camera::Type::Orthographic), _, Some(o)) => {
                let (x, y) = (f64::from(o.xmag).abs(), f64::from(o.ymag).abs());
                let is_good = x > 0.0 && y > 0.0 && x.is_finite() && y.is_finite();
                let projection = Projection::Orthographic { extent: 2.0 * y, axis: FovAxis::Vertical };
                (is_good.then_some(projection), Some(x / y))
            }
            _ => (None, None),
        };
        let Some(projection) = projection else {
            let message = "a camera without a usable projection is left out";
            self.notes.add("camera-ignored", NoteEffect::Missing, place, message);
            return;
        };
        let name = self.camera_names.unique(name);
        let aspect = aspect.filter(|a| a.is_finite() && *a > 0.0);
        let mut camera = Camera { name, transform, projection, shift: [0.0; 2], lens: None, aspect };
        vendor::camera(source, place, &mut camera, self.notes);
        self.scene.cameras.push(camera);
    }
}
