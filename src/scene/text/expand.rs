//! From the tables of a file to a scene: constructors become meshes, names become numbers.
//!
//! In: a [`Document`]. Out: a [`Scene`] in +Y up, not yet validated, and its [`Origins`]: where in the
//! file each of its parts comes from, so that an error found in the scene can point at the text.

use std::collections::HashMap;

use glam::{DAffine3, DMat3, DVec3, Vec2, Vec3, Vec4};

use super::error::{Fault, TextErrorKind, one_of};
use super::model::{
    AbsorptionTable, AreaTable, CameraTable, Document, EnvironmentTable, GlassTable, LightTable,
    MaterialTable, MeshTable, ObjectTable, PointTable, PrincipledTable, PrismTable, SpotTable, SunTable,
};
use super::place::{Place, Step};
use super::shapes::{self, Surface};
use super::texture::{self, Pictures};
use super::up::Up;
use super::value::{NameOr, Placement};
use crate::color::Rgb;
use crate::scene::{
    Absorption, Camera, Environment, EnvironmentImage, Glass, Lens, Light, LightKind, Material, MaterialId,
    MaterialKind, Mesh, MeshId, Object, Principled, Projection, Scene, Settings, Shape,
};

/// Where in a file the parts of a scene come from.
#[derive(Clone, Debug, Default)]
pub(super) struct Origins {
    pub(super) images: Vec<Place>,
    materials: Vec<Place>,
    meshes: Vec<Place>,
    objects: Vec<Place>,
    lights: Vec<Place>,
    cameras: Vec<Place>,
}

impl Origins {
    /// The place in the file of a path in the scene, such as `materials[2].glass.ior`.
    pub(super) fn find(&self, path: &str) -> Place {
        let path = Place::parse(path);
        let list = match path.0.first() {
            Some(Step::Key(key)) => match key.as_str() {
                "images" => &self.images,
                "materials" => &self.materials,
                "meshes" => &self.meshes,
                "objects" => &self.objects,
                "lights" => &self.lights,
                "cameras" => &self.cameras,
                "settings" => return Place::top("render").join(&path.0[1..]),
                _ => return path,
            },
            _ => return path,
        };
        match path.0.get(1) {
            Some(&Step::Index(i)) if i < list.len() => list[i].join(&path.0[2..]),
            _ => path,
        }
    }
}

/// The scene that a document describes.
pub(super) fn expand(document: Document) -> Result<(Scene, Origins), Fault> {
    let up = document.up.0;
    let mut builder = Builder { up, ..Builder::default() };
    builder.scene.title = document.title;
    let r = document.render;
    builder.scene.settings = Settings {
        size: r.size,
        spp: r.spp,
        exposure: r.exposure,
        tone: r.tone.map(|w| w.0),
        max_depth: r.max_depth,
        indirect_gain: r.indirect_gain,
    };
    for (name, table) in document.camera.0 {
        let place = Place::top("camera").key(&name);
        let camera = camera(name, &table, up, &place)?;
        builder.scene.cameras.push(camera);
        builder.origins.cameras.push(place);
    }
    for (name, entry) in document.image.0 {
        builder.pictures.define(name, entry)?;
    }
    for (name, table) in document.material.0 {
        let place = Place::top("material").key(&name);
        let kind = material(&table, &mut builder.pictures, &place)?;
        builder.materials.insert(name.clone(), MaterialId(builder.scene.materials.len() as u32));
        builder.scene.materials.push(Material { name, kind });
        builder.origins.materials.push(place);
    }
    for (name, table) in document.mesh.0 {
        let place = Place::top("mesh").key(&name);
        let id = builder.add_mesh(mesh(&name, table, up), place);
        builder.meshes.insert(name, id);
    }
    for (i, table) in document.object.into_iter().enumerate() {
        builder.object(i, table)?;
    }
    for (i, table) in document.light.into_iter().enumerate() {
        let place = Place::top("light").index(i);
        builder.scene.lights.push(light(table, i, up, &place)?);
        builder.origins.lights.push(place);
    }
    if let Some(table) = document.environment {
        builder.scene.environment = Some(environment(table, &mut builder.pictures)?);
    }
    builder.scene.images = builder.pictures.images;
    builder.origins.images = builder.pictures.places;
    Ok((builder.scene, builder.origins))
}

#[derive(Default)]
struct Builder {
    up: Up,
    scene: Scene,
    origins: Origins,
    pictures: Pictures,
    materials: HashMap<String, MaterialId>,
    meshes: HashMap<String, MeshId>,
}

impl Builder {
    fn add_mesh(&mut self, mesh: Mesh, place: Place) -> MeshId {
        let id = MeshId(self.scene.meshes.len() as u32);
        self.scene.meshes.push(mesh);
        self.origins.meshes.push(place);
        id
    }

    fn material(&self, name: &str, place: Place) -> Result<MaterialId, Fault> {
        self.materials.get(name).copied().ok_or_else(|| {
            let names: Vec<&str> = self.scene.materials.iter().map(|m| m.name.as_str()).collect();
            Fault::unknown_name(place, "material", name, &names)
        })
    }

    fn object(&mut self, index: usize, table: ObjectTable) -> Result<(), Fault> {
        let place = Place::top("object").index(index);
        let kinds = [
            ("sphere", table.sphere.is_some()),
            ("box", table.cuboid.is_some()),
            ("rect", table.rect.is_some()),
            ("polygon", table.polygon.is_some()),
            ("prism", table.prism.is_some()),
            ("mesh", table.mesh.is_some()),
        ];
        let kind = exactly_one("an object", &kinds, &place)?;
        let name = table.name.unwrap_or_else(|| format!("{kind} {}", index + 1));
        let own = match &table.material {
            Some(material) => Some(self.material(material, place.key("material"))?),
            None => None,
        };
        let given = table.transform.map(|t| t.affine(self.up));
        let mut object = Object {
            name: name.clone(),
            shape: Shape::Sphere { radius: 1.0 },
            material: MaterialId(0),
            transform: given.map_or(DAffine3::IDENTITY, |t| self.up.conjugate(t)),
            visible_to_camera: table.visible_to_camera.unwrap_or(true),
        };
        let shape = place.key(kind);
        if let Some(prism) = table.prism {
            return self.prism(&object, &prism, own, &place);
        }
        object.material = own.ok_or_else(|| {
            Fault::new(TextErrorKind::MissingKey, place.clone(), "missing key `material`")
                .expecting("the name of a material")
        })?;
        let fault = |message| Fault::value(shape.clone(), message);
        let surface = if let Some(sphere) = table.sphere {
            object.shape = Shape::Sphere { radius: sphere.radius };
            if let Some(center) = sphere.center {
                let at = DAffine3::from_translation(self.up.to_scene(center.into()));
                object.transform = given.map_or(at, |_| object.transform * at);
            }
            None
        } else if let Some(cuboid) = table.cuboid {
            Some(shapes::cuboid(&cuboid, self.up).map_err(fault)?)
        } else if let Some(rect) = table.rect {
            Some(shapes::rect(&rect).map_err(fault)?)
        } else if let Some(p) = table.polygon {
            Some(shapes::polygon(&p.corners, &p.holes, p.facing).map_err(fault)?)
        } else {
            object.shape = Shape::Mesh(match table.mesh {
                Some(NameOr::Name(name)) => self.meshes.get(&name).copied().ok_or_else(|| {
                    let names: Vec<&str> = self.meshes.keys().map(String::as_str).collect();
                    Fault::unknown_name(shape.clone(), "mesh", &name, &names)
                })?,
                Some(NameOr::Inline(table)) => self.add_mesh(mesh(&name, table, self.up), shape.clone()),
                None => return Err(fault("missing".to_owned())),
            });
            None
        };
        if let Some(surface) = surface {
            object.shape = Shape::Mesh(self.add_surface(&name, &surface, shape));
        }
        self.scene.objects.push(object);
        self.origins.objects.push(place);
        Ok(())
    }

    /// One object for the whole prism where it has one material, else one for each part.
    fn prism(
        &mut self,
        base: &Object,
        prism: &PrismTable,
        own: Option<MaterialId>,
        place: &Place,
    ) -> Result<(), Fault> {
        let shape = place.key("prism");
        let parts = shapes::prism(prism, self.up).map_err(|m| Fault::value(shape.clone(), m))?;
        let of = |name: &Option<String>, key: &str| match name {
            Some(name) => self.material(name, shape.key(key)).map(Some),
            None => Ok(own),
        };
        let (floor, ceiling) = (of(&prism.floor, "floor")?, of(&prism.ceiling, "ceiling")?);
        let walls: Vec<Option<MaterialId>> = match &prism.walls {
            None => vec![own; parts.walls.len()],
            Some(NameOr::Name(name)) => {
                vec![Some(self.material(name, shape.key("walls"))?); parts.walls.len()]
            }
            Some(NameOr::Inline(names)) if names.len() != parts.walls.len() => {
                let message = format!("{} walls for {} corners", names.len(), parts.walls.len());
                return Err(Fault::value(shape.key("walls"), message).expecting("one wall for each corner"));
            }
            Some(NameOr::Inline(names)) => {
                let wall = |(i, name): (usize, &String)| match name.as_str() {
                    "" => Ok(None),
                    _ => self.material(name, shape.key("walls").index(i)).map(Some),
                };
                names.iter().enumerate().map(wall).collect::<Result<_, _>>()?
            }
        };

        let mut faces: Vec<(String, MaterialId, Surface)> = Vec::new();
        let mut face = |part: &str, material: Option<MaterialId>, surface: Surface| {
            if let Some(material) = material {
                faces.push((format!("{} {part}", base.name), material, surface));
            }
        };
        face("floor", floor, parts.floor);
        face("ceiling", ceiling, parts.ceiling);
        for (i, (material, wall)) in walls.into_iter().zip(parts.walls).enumerate() {
            face(&format!("wall {}", i + 1), material, wall);
        }
        let Some((_, first, _)) = faces.first() else {
            let missing =
                Fault::new(TextErrorKind::MissingKey, place.clone(), "no part of the prism has a material");
            return Err(missing.expecting("`material`, or any of `walls`, `floor`, `ceiling`"));
        };
        let first = *first;
        if prism.walls.is_none() && prism.floor.is_none() && prism.ceiling.is_none() {
            let mut whole = Surface::default();
            faces.iter().for_each(|(_, _, surface)| whole.append(surface));
            faces = vec![(base.name.clone(), first, whole)];
        }
        for (name, material, surface) in faces {
            let mesh = self.add_surface(&name, &surface, shape.clone());
            self.scene.objects.push(Object { name, shape: Shape::Mesh(mesh), material, ..base.clone() });
            self.origins.objects.push(place.clone());
        }
        Ok(())
    }

    fn add_surface(&mut self, name: &str, surface: &Surface, place: Place) -> MeshId {
        let mesh = Mesh {
            name: name.to_owned(),
            positions: surface.positions.iter().map(|&p| self.up.to_scene(p).as_vec3()).collect(),
            triangles: surface.triangles.clone(),
            ..Mesh::default()
        };
        self.add_mesh(mesh, place)
    }
}

/// The one kind that is given, or an error that says which there are.
fn exactly_one<'a>(what: &str, kinds: &[(&'a str, bool)], place: &Place) -> Result<&'a str, Fault> {
    let given: Vec<&str> = kinds.iter().filter(|k| k.1).map(|k| k.0).collect();
    match given[..] {
        [kind] => Ok(kind),
        [] => {
            let names: Vec<&str> = kinds.iter().map(|k| k.0).collect();
            let fault =
                Fault::new(TextErrorKind::MissingKey, place.clone(), format!("{what} without a kind"));
            Err(fault.expecting(one_of(&names)))
        }
        [_, second, ..] => {
            let message = format!("{what} with more than one kind: `{}`", given.join("`, `"));
            Err(Fault::value(place.key(second), message).expecting("exactly one"))
        }
    }
}

fn camera(name: String, table: &CameraTable, up: Up, place: &Place) -> Result<Camera, Fault> {
    let transform = match (table.transform, table.eye, table.target) {
        (Some(t), None, None) if table.up.is_none() => t.affine(up),
        (None, Some(eye), Some(target)) => {
            let above = table.up.map_or(up.axis(), DVec3::from);
            look_along(eye.into(), DVec3::from(target) - DVec3::from(eye), above).ok_or_else(|| {
                Fault::value(place.clone(), "eye and target coincide, or it looks along `up`")
            })?
        }
        (Some(_), ..) => {
            let message = "a camera with both `transform` and `eye`, `target` or `up`";
            return Err(Fault::value(place.key("transform"), message).expecting("one way of placing it"));
        }
        (None, eye, _) => {
            let missing = if eye.is_none() { "missing key `eye`" } else { "missing key `target`" };
            let fault = Fault::new(TextErrorKind::MissingKey, place.clone(), missing);
            return Err(fault.expecting("`eye` and `target`, or `transform`"));
        }
    };
    let kinds = [("fov", table.fov.is_some()), ("orthographic", table.orthographic.is_some())];
    exactly_one("a camera", &kinds, place)?;
    let axis = table.fov_axis.0;
    let projection = match (table.fov, table.orthographic) {
        (Some(fov), _) => Projection::Perspective { fov: fov.radians, axis },
        (None, extent) => Projection::Orthographic { extent: extent.unwrap_or_default(), axis },
    };
    Ok(Camera {
        name,
        transform: up.place(transform),
        projection,
        shift: table.shift,
        lens: table.lens.as_ref().map(|l| Lens { radius: l.radius, focus_distance: l.focus }),
        aspect: table.aspect,
    })
}

/// The transform of something at `position` that looks along `direction`; none where that is along `above`.
pub(in crate::scene) fn look_along(position: DVec3, direction: DVec3, above: DVec3) -> Option<DAffine3> {
    let z = (-direction).try_normalize()?;
    let x = above.try_normalize()?.cross(z);
    // Within a millionth of a degree of `above`, the roll would be noise.
    let x = (x.length() > 1e-8).then(|| x.normalize())?;
    // Adding zero turns negative zeros, which help nobody who reads them, into zeros.
    Some(DAffine3 { matrix3: DMat3::from_cols(x, z.cross(x), z) + DMat3::ZERO, translation: position })
}

fn material(table: &MaterialTable, pictures: &mut Pictures, place: &Place) -> Result<MaterialKind, Fault> {
    let kinds = [
        ("diffuse", table.diffuse.is_some()),
        ("mirror", table.mirror.is_some()),
        ("glass", table.glass.is_some()),
        ("light", table.light.is_some()),
        ("principled", table.principled.is_some()),
    ];
    let kind = exactly_one("a material", &kinds, place)?;
    if let (Some(_), false) = (table.sides, kind == "light") {
        let message = format!("`sides` says which sides of a light emit, and this is `{kind}`");
        return Err(Fault::value(place.key("sides"), message));
    }
    Ok(match table {
        MaterialTable { diffuse: Some(c), .. } => MaterialKind::Diffuse { color: c.0 },
        MaterialTable { mirror: Some(c), .. } => MaterialKind::Mirror { color: c.0 },
        MaterialTable { light: Some(c), .. } => {
            MaterialKind::Light { radiance: c.0, sides: table.sides.unwrap_or_default().0 }
        }
        MaterialTable { glass: Some(glass), .. } => MaterialKind::Glass(glass_of(glass)),
        MaterialTable { principled: Some(table), .. } => {
            MaterialKind::Principled(Box::new(principled(table, pictures, &place.key("principled"))?))
        }
        _ => return Err(Fault::value(place.clone(), "a material without a kind")),
    })
}

fn glass_of(g: &GlassTable) -> Glass {
    Glass {
        ior: g.ior.unwrap_or(1.5),
        tint: g.tint.map_or(Rgb::WHITE, |c| c.0),
        absorption: g.absorption.as_ref().map(absorption_of),
        priority: g.priority,
    }
}

fn absorption_of(a: &AbsorptionTable) -> Absorption {
    Absorption { color: a.color.0, distance: a.distance }
}

fn principled(p: &PrincipledTable, pictures: &mut Pictures, place: &Place) -> Result<Principled, Fault> {
    let default = Principled::default();
    Ok(Principled {
        base_color: p.base_color.map_or(default.base_color, |c| c.0),
        metallic: p.metallic.unwrap_or(default.metallic),
        roughness: p.roughness.unwrap_or(default.roughness),
        ior: p.ior.unwrap_or(default.ior),
        specular: p.specular.unwrap_or(default.specular),
        specular_color: p.specular_color.map_or(default.specular_color, |c| c.0),
        transmission: p.transmission.unwrap_or(default.transmission),
        transmission_tint: p.transmission_tint.map_or(default.transmission_tint, |c| c.0),
        thin: p.thin.unwrap_or(default.thin),
        absorption: p.absorption.as_ref().map(absorption_of),
        priority: p.priority,
        emission: p.emission.map_or(default.emission, |c| c.0),
        alpha: p.alpha.unwrap_or(default.alpha),
        alpha_mode: texture::alpha_mode(p, place)?,
        coat: p.coat.unwrap_or(default.coat),
        coat_roughness: p.coat_roughness.unwrap_or(default.coat_roughness),
        coat_ior: p.coat_ior.unwrap_or(default.coat_ior),
        sheen_color: p.sheen_color.map_or(default.sheen_color, |c| c.0),
        sheen_roughness: p.sheen_roughness.unwrap_or(default.sheen_roughness),
        textures: pictures.textures(p, place)?,
    })
}

fn environment(e: EnvironmentTable, pictures: &mut Pictures) -> Result<Environment, Fault> {
    let place = Place::top("environment");
    if e.radiance.is_none() && e.image.is_none() {
        let fault = Fault::new(TextErrorKind::MissingKey, place, "missing key `radiance`");
        return Err(fault.expecting("`radiance` or `image`"));
    }
    if e.rotation.is_some() && e.image.is_none() {
        let message = "`rotation` turns the environment's image, and there is none";
        return Err(Fault::value(place.key("rotation"), message));
    }
    let image = match e.image {
        Some(given) => Some(EnvironmentImage {
            image: pictures.of_environment(given, &place.key("image"))?,
            rotation: e.rotation.map_or(0.0, |a| a.radians),
        }),
        None => None,
    };
    Ok(Environment {
        name: e.name.unwrap_or_else(|| "environment".to_owned()),
        radiance: e.radiance.map_or(Rgb::WHITE, |c| c.0),
        image,
        visible_to_camera: e.visible_to_camera.unwrap_or(true),
    })
}

fn mesh(name: &str, table: MeshTable, up: Up) -> Mesh {
    let turned = |list: Vec<[f32; 3]>| list.into_iter().map(|v| up.to_scene_f32(Vec3::from(v))).collect();
    Mesh {
        name: table.name.unwrap_or_else(|| name.to_owned()),
        positions: turned(table.positions),
        normals: turned(table.normals),
        tangents: table
            .tangents
            .into_iter()
            .map(|[x, y, z, w]| up.to_scene_f32(Vec3::new(x, y, z)).extend(w))
            .collect(),
        uvs: [table.uvs, table.uvs2].map(|set| set.into_iter().map(Vec2::from).collect()),
        colors: table.colors.into_iter().map(Vec4::from).collect(),
        triangles: table.triangles,
    }
}

fn light(table: LightTable, index: usize, up: Up, place: &Place) -> Result<Light, Fault> {
    let kinds = [
        ("point", table.point.is_some()),
        ("spot", table.spot.is_some()),
        ("sun", table.sun.is_some()),
        ("area", table.area.is_some()),
    ];
    let kind_name = exactly_one("a light", &kinds, place)?;
    let transform = match table.transform {
        Some(t) => placed_by_transform(&table, t, up, place)?,
        None => {
            let position = table.position.map_or(DVec3::ZERO, DVec3::from);
            let direction = match (table.direction, table.target) {
                (Some(_), Some(_)) => {
                    let fault =
                        Fault::value(place.key("target"), "a light with both `direction` and `target`");
                    return Err(fault.expecting("one of them"));
                }
                (Some(direction), None) => direction.into(),
                (None, Some(target)) => DVec3::from(target) - position,
                (None, None) => -up.axis(),
            };
            let above = table.up.map_or(up.axis(), DVec3::from);
            // Straight up and down have no roll of their own: any will do, so take the axis before.
            let aside = DVec3::AXES[(up.axis_index() + 2) % 3];
            let fallback = if table.up.is_none() { look_along(position, direction, aside) } else { None };
            look_along(position, direction, above).or(fallback).ok_or_else(|| {
                Fault::value(place.clone(), "the light's direction is zero, or along its `up`")
            })?
        }
    };
    let kind = match table {
        LightTable { point: Some(PointTable { intensity, radius }), .. } => {
            LightKind::Point { intensity: intensity.0, radius }
        }
        LightTable { spot: Some(SpotTable { intensity, inner, outer, falloff, radius }), .. } => {
            LightKind::Spot {
                intensity: intensity.0,
                inner: inner.map_or(0.0, |a| a.radians),
                outer: outer.radians,
                falloff: falloff.0,
                radius,
            }
        }
        LightTable { sun: Some(SunTable { irradiance, angle }), .. } => {
            LightKind::Sun { irradiance: irradiance.0, angle: angle.map_or(0.0, |a| a.radians) }
        }
        LightTable { area: Some(AreaTable { shape, size, radiance }), .. } => {
            LightKind::Area { shape: shape.0, size, radiance: radiance.0 }
        }
        _ => return Err(Fault::value(place.clone(), "a light without a kind")),
    };
    Ok(Light {
        name: table.name.unwrap_or_else(|| format!("{kind_name} {}", index + 1)),
        kind,
        transform: up.place(transform),
        visible_to_camera: table.visible_to_camera.unwrap_or(true),
    })
}

fn placed_by_transform(table: &LightTable, t: Placement, up: Up, place: &Place) -> Result<DAffine3, Fault> {
    if table.position.is_some() || table.direction.is_some() || table.target.is_some() || table.up.is_some() {
        let message = "a light with both `transform` and `position`, `direction`, `target` or `up`";
        return Err(Fault::value(place.key("transform"), message).expecting("one way of placing it"));
    }
    Ok(t.affine(up))
}
