//! `mariana mesh`: the surfaces of a moment as triangles, in a file for other programs and for printing.

use std::path::Path;

use super::error::{ExportError, refuse};
use super::output::refuse_the_song;
use super::painter::{held_of, require_inputs};
use super::song_features::SongFeatures;
use crate::atomic_file::AtomicFile;
use crate::frame::held_inputs::Setting;
use crate::frame::{Frame, FrameOptions};
use crate::scenes::SceneSource;
use crate::srgb::encoded;
use mariana_field::world::{Mesh, Vertex};
use mariana_music::Gain;
use mariana_player::song::Song;

/// Writes the mesh of a scene at `at` seconds of a song, with the inputs that `set` holds, and with `detail` cells
/// along its longest side. The extension of `output` selects glTF, STL or OBJ. Returns the number of triangles.
///
/// # Errors
/// Fails if the song or the scene cannot be read, the scene has no mesh, or the file cannot be written.
pub fn write_mesh(
    song: &Song,
    at: f64,
    gain: Gain,
    scene: &SceneSource,
    set: &[Setting],
    detail: usize,
    output: &Path,
) -> Result<usize, ExportError> {
    let format = format_of(output)?;
    refuse_the_song(song, output)?;
    // Create the file first, so that an unwritable file is reported before the work.
    let file = AtomicFile::create(output)?;
    let ready = scene.ready()?;
    let (world, scene) = (&ready.world, &ready.world.scene);
    require_inputs(&[scene], set)?;
    let held = held_of(scene, set)?;
    let mut song = SongFeatures::open_with(song, at, gain)?;
    let sound = song.require(at)?;
    song.know_for(&scene.graph);
    let sound = song.placed(at, sound);
    let options = FrameOptions { params: &[], held: &held, camera: None };
    let frame = Frame::staged(world, at, sound, (1, 1), &options);
    let mesh = world.mesh(&frame.inputs, detail)?;
    file.write(&format(&mesh))?;
    Ok(mesh.triangles.len())
}

/// Writes a mesh as the bytes of a file.
type Format = fn(&Mesh) -> Vec<u8>;

fn format_of(path: &Path) -> Result<Format, ExportError> {
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    match ending.as_str() {
        "glb" => Ok(glb),
        "stl" => Ok(stl),
        "obj" => Ok(obj),
        _ => refuse(format!(
            "{} cannot be written: meshes are glTF, STL or OBJ, so give -o a name that ends in .glb, .stl or .obj",
            path.display()
        )),
    }
}

fn bytes_of<const N: usize>(numbers: impl IntoIterator<Item = [f32; N]>) -> Vec<u8> {
    numbers.into_iter().flatten().flat_map(f32::to_le_bytes).collect()
}

/// Binary STL. It has no colours, and z is up, as programs for printing expect.
fn stl(mesh: &Mesh) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend((mesh.triangles.len() as u32).to_le_bytes());
    let upright = |[x, y, z]: [f32; 3]| [x, -z, y];
    for triangle in &mesh.triangles {
        let places = triangle
            .map(|vertex| mesh.vertices.get(vertex as usize).map_or([0.0; 3], |one| upright(one.position)));
        // Programs compute the normal from the vertices.
        bytes.extend(bytes_of([[0.0; 3]].into_iter().chain(places)));
        bytes.extend([0, 0]);
    }
    bytes
}

/// Wavefront OBJ with the colour of each vertex behind its position.
fn obj(mesh: &Mesh) -> Vec<u8> {
    let mut text = String::from("# A mesh of Mariana\n");
    for Vertex { position: [x, y, z], color, .. } in &mesh.vertices {
        let [r, g, b] = color.map(encoded);
        text += &format!("v {x} {y} {z} {r:.4} {g:.4} {b:.4}\n");
    }
    for Vertex { normal: [x, y, z], .. } in &mesh.vertices {
        text += &format!("vn {x:.4} {y:.4} {z:.4}\n");
    }
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|vertex| vertex + 1);
        text += &format!("f {a}//{a} {b}//{b} {c}//{c}\n");
    }
    text.into_bytes()
}

// Numbers of glTF, which are OpenGL's.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// Binary glTF 2.0 with positions, normals and linear colours.
fn glb(mesh: &Mesh) -> Vec<u8> {
    let vertices = || mesh.vertices.iter();
    let parts = [
        bytes_of(vertices().map(|vertex| vertex.position)),
        bytes_of(vertices().map(|vertex| vertex.normal)),
        bytes_of(vertices().map(|vertex| vertex.color)),
        mesh.triangles.iter().flatten().flat_map(|vertex| vertex.to_le_bytes()).collect(),
    ];
    let mut views = Vec::new();
    let mut accessors = Vec::new();
    let mut start = 0;
    for (number, part) in parts.iter().enumerate() {
        let (target, kind, of, count) = match number {
            3 => (ELEMENT_ARRAY_BUFFER, UNSIGNED_INT, "SCALAR", 3 * mesh.triangles.len()),
            _ => (ARRAY_BUFFER, FLOAT, "VEC3", mesh.vertices.len()),
        };
        views.push(serde_json::json!({
            "buffer": 0, "byteOffset": start, "byteLength": part.len(), "target": target
        }));
        accessors.push(serde_json::json!({
            "bufferView": number, "componentType": kind, "count": count, "type": of
        }));
        start += part.len();
    }
    if let Some(positions) = accessors.first_mut() {
        let bound = |pick: fn(f32, f32) -> f32, from: f32| {
            [0, 1, 2].map(|axis| vertices().map(|vertex| vertex.position[axis]).fold(from, pick))
        };
        positions["min"] = serde_json::json!(bound(f32::min, f32::INFINITY));
        positions["max"] = serde_json::json!(bound(f32::max, f32::NEG_INFINITY));
    }
    let attributes = serde_json::json!({ "POSITION": 0, "NORMAL": 1, "COLOR_0": 2 });
    let head = serde_json::json!({
        "asset": { "version": "2.0", "generator": "Mariana" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": attributes, "indices": 3, "material": 0 }] }],
        "materials": [{ "pbrMetallicRoughness": { "metallicFactor": 0.0, "roughnessFactor": 0.7 } }],
        "buffers": [{ "byteLength": start }],
        "bufferViews": views,
        "accessors": accessors,
    });
    let mut head = head.to_string().into_bytes();
    head.resize(head.len().next_multiple_of(4), b' ');
    let chunk =
        |kind: &[u8; 4], bytes: &[u8]| [&(bytes.len() as u32).to_le_bytes()[..], kind, bytes].concat();
    let chunks = [chunk(b"JSON", &head), chunk(b"BIN\0", &parts.concat())].concat();
    let total = (12 + chunks.len()) as u32;
    [b"glTF", &2_u32.to_le_bytes()[..], &total.to_le_bytes(), &chunks].concat()
}
