//! Values that can be written in more than one way: colours, angles, placements, named tables.
//!
//! In: what serde hands over. Out: the value itself. Each is a visitor instead of an untagged enum, so
//! that an error keeps its line and column and says what was expected.

use std::fmt;
use std::marker::PhantomData;

use glam::{DAffine3, DMat3, DMat4, DVec3};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{self, Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor};

use super::names::{Vocabulary, Word};
use super::up::Up;
use crate::color::{Rgb, blackbody, srgb_to_linear};
use crate::scene::Wrap;

/// Implements `JsonSchema` by hand for values with several spellings.
macro_rules! schema {
    ($type:ty, $name:literal, |$generator:ident| $schema:expr) => {
        impl JsonSchema for $type {
            fn schema_name() -> std::borrow::Cow<'static, str> {
                $name.into()
            }
            fn json_schema($generator: &mut SchemaGenerator) -> Schema {
                $schema
            }
        }
    };
}

/// The visits of a visitor that takes any number.
macro_rules! visit_numbers {
    ($value:ty, |$v:ident| $made:expr) => {
        fn visit_f64<E: Error>(self, $v: f64) -> Result<$value, E> {
            Ok($made)
        }
        fn visit_i64<E: Error>(self, v: i64) -> Result<$value, E> {
            self.visit_f64(v as f64)
        }
        fn visit_u64<E: Error>(self, v: u64) -> Result<$value, E> {
            self.visit_f64(v as f64)
        }
    };
}

/// A list of `count` items, and not one more.
fn exactly<'de, T: Deserialize<'de>, A: SeqAccess<'de>>(
    mut seq: A,
    count: usize,
    expected: &dyn de::Expected,
) -> Result<T, A::Error> {
    let list = T::deserialize(SeqAccessDeserializer::new(&mut seq))?;
    let mut more = 0;
    while seq.next_element::<de::IgnoredAny>()?.is_some() {
        more += 1;
    }
    if more == 0 { Ok(list) } else { Err(A::Error::invalid_length(count + more, expected)) }
}

/// Reads lists of a fixed length, wherever they are, as [`exactly`] does.
pub(super) fn fixed<'de, D: Deserializer<'de>, F: Fixed>(d: D) -> Result<F, D::Error> {
    F::Wire::deserialize(d).map(F::of)
}

/// What [`fixed`] reads: lists of a fixed length, and what is made of them.
pub(super) trait Fixed: Sized {
    /// The same with lists that know how long they are.
    type Wire: for<'de> Deserialize<'de>;
    /// From that.
    fn of(wire: Self::Wire) -> Self;
}

impl<T: for<'de> Deserialize<'de>, const N: usize> Fixed for [T; N]
where
    [T; N]: for<'de> Deserialize<'de>,
{
    type Wire = Exactly<[T; N], N>;
    fn of(wire: Self::Wire) -> Self {
        wire.0
    }
}

impl<F: Fixed> Fixed for Option<F> {
    type Wire = Option<F::Wire>;
    fn of(wire: Self::Wire) -> Self {
        wire.map(F::of)
    }
}

impl<F: Fixed> Fixed for Vec<F> {
    type Wire = Vec<F::Wire>;
    fn of(wire: Self::Wire) -> Self {
        wire.into_iter().map(F::of).collect()
    }
}

/// A list of `N` items.
pub(super) struct Exactly<L, const N: usize>(L);

impl<'de, L: Deserialize<'de>, const N: usize> Deserialize<'de> for Exactly<L, N> {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        struct V<L, const N: usize>(PhantomData<L>);
        impl<'de, L: Deserialize<'de>, const N: usize> Visitor<'de> for V<L, N> {
            type Value = Exactly<L, N>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "an array of length {N}")
            }
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Self::Value, A::Error> {
                exactly(seq, N, &self).map(Exactly)
            }
        }
        d.deserialize_any(V(PhantomData))
    }
}

/// A colour: `[r, g, b]` linear, `"#rrggbb"` in sRGB, or a temperature.
#[derive(Clone, Copy, Debug)]
pub(super) struct Color(pub(super) Rgb);

/// The colour of a black body.
#[derive(serde::Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Temperature {
    /// Kelvin, 1667 to 25000.
    #[schemars(range(min = 1667, max = 25000))]
    kelvin: f32,
    /// Its luminance; 1 where left out.
    luminance: Option<f32>,
}

impl<'de> Deserialize<'de> for Color {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        struct V;
        impl<'de> Visitor<'de> for V {
            type Value = Color;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a colour: [r, g, b], \"#rrggbb\" or { kelvin = .., luminance = .. }")
            }
            fn visit_str<E: Error>(self, s: &str) -> Result<Color, E> {
                parse_hex(s).ok_or_else(|| E::invalid_value(de::Unexpected::Str(s), &self))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Color, A::Error> {
                Ok(Color(exactly::<[f32; 3], _>(seq, 3, &self)?.into()))
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Color, A::Error> {
                let t = Temperature::deserialize(MapAccessDeserializer::new(map))?;
                if !(1667.0..=25_000.0).contains(&t.kelvin) {
                    let found = de::Unexpected::Float(f64::from(t.kelvin));
                    return Err(A::Error::invalid_value(found, &"a temperature from 1667 to 25000 kelvin"));
                }
                Ok(Color(blackbody(t.kelvin) * t.luminance.unwrap_or(1.0)))
            }
        }
        d.deserialize_any(V)
    }
}

fn parse_hex(s: &str) -> Option<Color> {
    let digits = s.strip_prefix('#').filter(|d| d.len() == 6 && d.bytes().all(|b| b.is_ascii_hexdigit()))?;
    let channel = |i: usize| {
        let byte = u8::from_str_radix(&digits[i..i + 2], 16).ok()?;
        Some(srgb_to_linear(f32::from(byte) / 255.0))
    };
    Some(Color(Rgb::new(channel(0)?, channel(2)?, channel(4)?)))
}

schema!(Color, "Color", |g| json_schema!({
    "description": "A colour: [r, g, b] linear Rec. 709, \"#rrggbb\" in sRGB, or a black body's temperature.",
    "anyOf": [
        { "type": "array", "items": { "type": "number" }, "minItems": 3, "maxItems": 3 },
        { "type": "string", "pattern": "^#[0-9a-fA-F]{6}$" },
        g.subschema_for::<Temperature>(),
    ],
}));

/// An angle: a number of degrees, or `{ radians = .. }`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Angle {
    /// Radians.
    pub(super) radians: f64,
}

/// An angle in radians.
#[derive(serde::Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Radians {
    /// Radians.
    radians: f64,
}

impl<'de> Deserialize<'de> for Angle {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        struct V;
        impl<'de> Visitor<'de> for V {
            type Value = Angle;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an angle: degrees, or { radians = .. }")
            }
            visit_numbers!(Angle, |v| Angle { radians: v.to_radians() });
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Angle, A::Error> {
                let Radians { radians } = Radians::deserialize(MapAccessDeserializer::new(map))?;
                Ok(Angle { radians })
            }
        }
        d.deserialize_any(V)
    }
}

schema!(Angle, "Angle", |g| json_schema!({
    "description": "An angle: degrees, or { radians = .. }.",
    "anyOf": [{ "type": "number" }, g.subschema_for::<Radians>()],
}));

/// A rotation: one angle about the up axis, or three about x, then y, then z.
#[derive(Clone, Copy, Debug)]
pub(super) enum Rotation {
    /// About the scene's up axis, counter-clockwise seen from above.
    Turn(Angle),
    /// About the fixed x axis, then y, then z.
    Euler([Angle; 3]),
}

impl Rotation {
    /// The rotation as a matrix in the file's own axes.
    pub(super) fn matrix(self, up: Up) -> DMat3 {
        let about = |axis: usize, angle: Angle| {
            let (s, c) = (libm::sin(angle.radians), libm::cos(angle.radians));
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let mut columns = [[0.0; 3]; 3];
            columns[axis][axis] = 1.0;
            columns[u][u] = c;
            columns[u][v] = s;
            columns[v][u] = -s;
            columns[v][v] = c;
            DMat3::from_cols_array_2d(&columns)
        };
        match self {
            Self::Turn(angle) => about(up.axis_index(), angle),
            Self::Euler([x, y, z]) => about(2, z) * about(1, y) * about(0, x),
        }
    }
}

impl<'de> Deserialize<'de> for Rotation {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        struct V;
        impl<'de> Visitor<'de> for V {
            type Value = Rotation;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a rotation: an angle about the up axis, or [x, y, z]")
            }
            visit_numbers!(Rotation, |v| Rotation::Turn(Angle { radians: v.to_radians() }));
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Rotation, A::Error> {
                Ok(Rotation::Turn(Angle::deserialize(MapAccessDeserializer::new(map))?))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Rotation, A::Error> {
                Ok(Rotation::Euler(exactly(seq, 3, &self)?))
            }
        }
        d.deserialize_any(V)
    }
}

schema!(Rotation, "Rotation", |g| json_schema!({
    "description": "A rotation: one angle about the up axis, or three about the fixed x, then y, then z axis.",
    "anyOf": [
        g.subschema_for::<Angle>(),
        { "type": "array", "items": g.subschema_for::<Angle>(), "minItems": 3, "maxItems": 3 },
    ],
}));

/// A factor along all axes, or one for each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale(pub(super) [f64; 3]);

impl<'de> Deserialize<'de> for Scale {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        struct V;
        impl<'de> Visitor<'de> for V {
            type Value = Scale;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a factor, or [x, y, z]")
            }
            visit_numbers!(Scale, |v| Scale([v; 3]));
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Scale, A::Error> {
                Ok(Scale(exactly(seq, 3, &self)?))
            }
        }
        d.deserialize_any(V)
    }
}

schema!(Scale, "Scale", |_g| json_schema!({
    "description": "A factor along all axes, or one for each.",
    "anyOf": [
        { "type": "number" },
        { "type": "array", "items": { "type": "number" }, "minItems": 3, "maxItems": 3 },
    ],
}));

/// One value for both, or a list of two.
#[derive(Clone, Copy, Debug)]
pub(super) struct OneOrTwo<T>(pub(super) [T; 2]);

/// What a [`OneOrTwo`] is made of.
pub(super) trait Single: Sized + Copy {
    /// "a .., or a list of two".
    const EXPECTED: &'static str;
    /// From a number, where it is one.
    fn from_number(v: f64) -> Option<Self>;
    /// From a word, where words are what it is; else that text is the wrong type.
    fn from_word(word: &str) -> Option<Option<Self>>;
}

impl Single for f32 {
    const EXPECTED: &'static str = "a factor, or [u, v]";
    fn from_number(v: f64) -> Option<Self> {
        Some(v as Self)
    }
    fn from_word(_: &str) -> Option<Option<Self>> {
        None
    }
}

impl Single for Word<Wrap> {
    const EXPECTED: &'static str = "`repeat`, `mirror` or `clamp`, or a list of two of them";
    fn from_number(_: f64) -> Option<Self> {
        None
    }
    fn from_word(word: &str) -> Option<Option<Self>> {
        Some(Wrap::WORDS.iter().find(|(w, _)| *w == word).map(|&(_, value)| Self(value)))
    }
}

impl<'de, T: Deserialize<'de> + Single> Deserialize<'de> for OneOrTwo<T> {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        struct V<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de> + Single> Visitor<'de> for V<T> {
            type Value = OneOrTwo<T>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(T::EXPECTED)
            }
            fn visit_f64<E: Error>(self, v: f64) -> Result<OneOrTwo<T>, E> {
                let both = T::from_number(v).map(|v| OneOrTwo([v; 2]));
                both.ok_or_else(|| E::invalid_type(de::Unexpected::Float(v), &self))
            }
            fn visit_i64<E: Error>(self, v: i64) -> Result<OneOrTwo<T>, E> {
                self.visit_f64(v as f64)
            }
            fn visit_u64<E: Error>(self, v: u64) -> Result<OneOrTwo<T>, E> {
                self.visit_f64(v as f64)
            }
            fn visit_str<E: Error>(self, s: &str) -> Result<OneOrTwo<T>, E> {
                match T::from_word(s) {
                    Some(Some(v)) => Ok(OneOrTwo([v; 2])),
                    Some(None) => {
                        Err(E::custom(format_args!("unknown variant `{s}`, expected {}", T::EXPECTED)))
                    }
                    None => Err(E::invalid_type(de::Unexpected::Str(s), &self)),
                }
            }
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<OneOrTwo<T>, A::Error> {
                Ok(OneOrTwo(exactly(seq, 2, &self)?))
            }
        }
        d.deserialize_any(V(PhantomData))
    }
}

impl<T: JsonSchema> JsonSchema for OneOrTwo<T> {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        format!("OneOrTwo_{}", T::schema_name()).into()
    }
    fn inline_schema() -> bool {
        true
    }
    fn json_schema(g: &mut SchemaGenerator) -> Schema {
        let one = g.subschema_for::<T>();
        json_schema!({ "anyOf": [
            one, { "type": "array", "items": one, "minItems": 2, "maxItems": 2 },
        ] })
    }
}

/// A transform: sixteen numbers column by column, or scale, rotation and translation in that order.
#[derive(Clone, Copy, Debug)]
pub(super) enum Placement {
    /// Last row 0 0 0 1.
    Matrix(DAffine3),
    /// Parts.
    Parts(PlacementParts),
}

/// Scale, then rotation, then translation.
#[derive(Clone, Copy, Debug, serde::Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "{ translate, rotate, scale }")]
pub(super) struct PlacementParts {
    /// Metres.
    translate: Option<[f64; 3]>,
    /// One angle about the up axis, or three about x, then y, then z.
    rotate: Option<Rotation>,
    /// A factor, or one along each axis.
    scale: Option<Scale>,
}

impl Placement {
    /// The transform in the file's own axes.
    pub(super) fn affine(self, up: Up) -> DAffine3 {
        match self {
            Self::Matrix(m) => m,
            Self::Parts(parts) => {
                let rotation = parts.rotate.map_or(DMat3::IDENTITY, |r| r.matrix(up));
                let scale = parts.scale.map_or(DVec3::ONE, |s| s.0.into());
                DAffine3 {
                    matrix3: rotation * DMat3::from_diagonal(scale),
                    translation: parts.translate.map_or(DVec3::ZERO, DVec3::from),
                }
            }
        }
    }
}

impl<'de> Deserialize<'de> for Placement {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        struct V;
        impl<'de> Visitor<'de> for V {
            type Value = Placement;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a transform: 16 numbers column by column, or { translate, rotate, scale }")
            }
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Placement, A::Error> {
                let m: [f64; 16] = exactly(seq, 16, &self)?;
                if [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0] {
                    let found = de::Unexpected::Other("a matrix with perspective");
                    return Err(A::Error::invalid_value(found, &"a last row of 0, 0, 0, 1"));
                }
                Ok(Placement::Matrix(DAffine3::from_mat4(DMat4::from_cols_array(&m))))
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Placement, A::Error> {
                Ok(Placement::Parts(PlacementParts::deserialize(MapAccessDeserializer::new(map))?))
            }
        }
        d.deserialize_any(V)
    }
}

schema!(Placement, "Placement", |g| json_schema!({
    "description": "A transform: 16 numbers column by column, or { translate, rotate, scale }, scaled first.",
    "anyOf": [
        { "type": "array", "items": { "type": "number" }, "minItems": 16, "maxItems": 16 },
        g.subschema_for::<PlacementParts>(),
    ],
}));

/// A name, or the thing itself: `mesh = "tree"`, `mesh = { positions = .. }`.
#[derive(Clone, Debug)]
pub(super) enum NameOr<T> {
    /// The name of something defined elsewhere in the file.
    Name(String),
    /// The thing.
    Inline(T),
}

impl<'de, T: Deserialize<'de> + Expected> Deserialize<'de> for NameOr<T> {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        struct V<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de> + Expected> Visitor<'de> for V<T> {
            type Value = NameOr<T>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(T::EXPECTED)
            }
            fn visit_str<E: Error>(self, s: &str) -> Result<NameOr<T>, E> {
                Ok(NameOr::Name(s.to_owned()))
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<NameOr<T>, A::Error> {
                Ok(NameOr::Inline(T::deserialize(MapAccessDeserializer::new(map))?))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<NameOr<T>, A::Error> {
                Ok(NameOr::Inline(T::deserialize(SeqAccessDeserializer::new(seq))?))
            }
        }
        d.deserialize_any(V(PhantomData))
    }
}

/// What a [`NameOr`] says when it meets something else.
pub(super) trait Expected {
    /// "a name, or ..".
    const EXPECTED: &'static str;
}

impl Expected for Vec<String> {
    const EXPECTED: &'static str = "a material, or a list with one for each side";
}

impl<T: JsonSchema> JsonSchema for NameOr<T> {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        format!("NameOr_{}", T::schema_name()).into()
    }
    fn json_schema(g: &mut SchemaGenerator) -> Schema {
        json_schema!({ "anyOf": [{ "type": "string" }, g.subschema_for::<T>()] })
    }
}

/// A table whose keys are names, in the order of the file.
#[derive(Clone, Debug)]
pub(super) struct Named<T>(pub(super) Vec<(String, T)>);

impl<T> Default for Named<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Named<T> {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        struct V<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for V<T> {
            type Value = Named<T>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a table of names")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Named<T>, A::Error> {
                let mut list: Vec<(String, T)> = Vec::new();
                let mut seen = std::collections::HashSet::new();
                while let Some(name) = map.next_key::<String>()? {
                    if !seen.insert(name.clone()) {
                        return Err(A::Error::custom(format_args!("the name `{name}` is used twice")));
                    }
                    list.push((name, map.next_value()?));
                }
                Ok(Named(list))
            }
        }
        d.deserialize_map(V(PhantomData))
    }
}

impl<T: JsonSchema> JsonSchema for Named<T> {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        format!("Named_{}", T::schema_name()).into()
    }
    fn inline_schema() -> bool {
        true
    }
    fn json_schema(g: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "object", "additionalProperties": g.subschema_for::<T>() })
    }
}

impl<'de, T: Vocabulary> Deserialize<'de> for Word<T> {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        struct V<T>(PhantomData<T>);
        impl<T: Vocabulary> Visitor<'_> for V<T> {
            type Value = Word<T>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(&super::error::one_of(&T::words()))
            }
            fn visit_str<E: Error>(self, s: &str) -> Result<Word<T>, E> {
                T::WORDS.iter().find(|(word, _)| *word == s).map(|&(_, value)| Word(value)).ok_or_else(|| {
                    let expected = super::error::one_of(&T::words());
                    E::custom(format_args!("unknown variant `{s}`, expected {expected}"))
                })
            }
        }
        d.deserialize_str(V(PhantomData))
    }
}

impl<T: Vocabulary> serde::Serialize for Word<T> {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(self.0.word())
    }
}

impl<T: Vocabulary> JsonSchema for Word<T> {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        T::NAME.into()
    }
    fn inline_schema() -> bool {
        true
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "enum": T::words() })
    }
}
