//! Draws a shape by sphere tracing. All rays of an image advance together, one batch per step.

use glam::Vec3;

use super::field::SampledField;

pub const WIDTH: usize = 200;
pub const HEIGHT: usize = 150;
/// Samples along each side of a pixel.
const SAMPLES: usize = 3;
const STEPS: usize = 300;
/// A ray hits the surface when the distance is at most this.
const TOUCH: f32 = 8e-4;
/// Tangent of half the vertical field of view.
const LENS: f32 = 0.2;
/// Fraction of the image that a shape fills.
const FILL: f32 = 0.76;

/// Direction from the shape to the camera: front right, and above.
const TO_CAMERA: Vec3 = Vec3::new(0.47, 0.42, -0.78);
const TO_LIGHT: Vec3 = Vec3::new(-0.46, 0.74, -0.50);
const LIGHT: Vec3 = Vec3::new(2.9, 2.75, 2.5);
const COPPER: Vec3 = Vec3::new(0.72, 0.245, 0.062);
const BACKGROUND: Vec3 = Vec3::splat(0.023);
const GROUND: Vec3 = Vec3::splat(0.034);

struct Camera {
    eye: Vec3,
    forward: Vec3,
    right: Vec3,
    up: Vec3,
}

impl Camera {
    /// Returns a camera that sees all points.
    fn around(points: &[Vec3]) -> Self {
        let forward = -TO_CAMERA.normalize();
        // The axes are x to the right, y up, and z away from the camera.
        let right = Vec3::Y.cross(forward).normalize();
        let up = forward.cross(right);
        let range = |axis: Vec3| {
            let along = points.iter().map(|point| point.dot(axis));
            along.fold((f32::MAX, f32::MIN), |(low, high), at| (low.min(at), high.max(at)))
        };
        let (x, y, z) = (range(right), range(up), range(forward));
        let middle = right * ((x.0 + x.1) * 0.5) + up * ((y.0 + y.1) * 0.5) + forward * ((z.0 + z.1) * 0.5);
        let wide = (x.1 - x.0) * HEIGHT as f32 / WIDTH as f32;
        let distance = wide.max(y.1 - y.0) * 0.5 / (LENS * FILL) + 0.25 * (z.1 - z.0);
        Self { eye: middle - forward * distance, forward, right, up }
    }

    /// Returns the directions of the rays, row by row from the top left.
    fn rays(&self) -> Vec<Vec3> {
        let (columns, rows) = (WIDTH * SAMPLES, HEIGHT * SAMPLES);
        let half = rows as f32 * 0.5;
        (0..columns * rows)
            .map(|index| {
                let x = ((index % columns) as f32 + 0.5 - columns as f32 * 0.5) / half * LENS;
                let y = (half - (index / columns) as f32 - 0.5) / half * LENS;
                (self.forward + self.right * x + self.up * y).normalize()
            })
            .collect()
    }
}

/// Draws the shape. Returns RGB pixels row by row; `None` if there is no shape.
pub fn draw(field: &mut SampledField<'_>) -> Option<Vec<u8>> {
    let extent = field.extent()?;
    let camera = Camera::around(&extent.points);
    let middle = extent.points.iter().sum::<Vec3>() / extent.points.len() as f32;
    let size = extent.points.iter().map(|point| point.distance(middle)).fold(0.0, f32::max);
    let from = (camera.eye - middle).length() - size * 1.3;
    let rays = camera.rays();
    let ends = vec![(camera.eye - middle).length() + size * 1.5; rays.len()];
    let eyes = vec![camera.eye; rays.len()];
    let hits = march(field, &eyes, &rays, from.max(0.0), &ends);

    let floor = extent.floor;
    let mut colors = vec![BACKGROUND; rays.len()];
    // Collect the points where rays first meet the shape (true) or the ground (false).
    let mut places: Vec<(usize, Vec3, bool)> = Vec::new();
    for (index, (ray, hit)) in rays.iter().zip(&hits).enumerate() {
        let down = (floor - camera.eye.y) / ray.y;
        let on_ground = ray.y < 0.0 && hit.is_none_or(|distance| down < distance);
        match hit {
            _ if on_ground => places.push((index, camera.eye + ray * down, false)),
            Some(distance) => places.push((index, camera.eye + ray * *distance, true)),
            None => {}
        }
    }
    let points: Vec<Vec3> = places.iter().map(|place| place.1).collect();
    let mut normals = field.gradients(&points, 6e-4);
    for (normal, place) in normals.iter_mut().zip(&places) {
        *normal = if place.2 { normal.normalize_or(Vec3::Y) } else { Vec3::Y };
    }
    let light = shadows(field, &points, &normals);
    let open = openness(field, &points, &normals, size);
    for (index, &(pixel, point, of_shape)) in places.iter().enumerate() {
        colors[pixel] = if of_shape {
            copper(normals[index], -rays[pixel], light[index], open[index])
        } else {
            let away = (point - middle).with_y(0.0).length() / (2.2 * size);
            let lit = GROUND * (LIGHT.y * TO_LIGHT.normalize().y * light[index] + 0.55) * open[index];
            BACKGROUND.lerp(lit, (-away * away).exp())
        };
    }
    Some(develop(&colors))
}

/// Returns the distance along each ray to the shape; `None` if the ray reaches its end.
fn march(
    field: &mut SampledField<'_>,
    starts: &[Vec3],
    rays: &[Vec3],
    from: f32,
    ends: &[f32],
) -> Vec<Option<f32>> {
    let mut hits = vec![None; rays.len()];
    let mut under_way: Vec<(usize, f32)> = (0..rays.len()).map(|index| (index, from)).collect();
    for _ in 0..STEPS {
        let points: Vec<Vec3> =
            under_way.iter().map(|&(index, at)| starts[index] + rays[index] * at).collect();
        let distances = field.distances(&points);
        let mut still = Vec::with_capacity(under_way.len());
        for (&(index, at), distance) in under_way.iter().zip(distances) {
            let next = at + distance * field.step;
            if distance < TOUCH {
                hits[index] = Some(at);
            } else if next < ends[index] {
                still.push((index, next));
            }
        }
        under_way = still;
        if under_way.is_empty() {
            break;
        }
    }
    // A ray that has used up all steps grazes the surface. Count the ray as a hit.
    for (index, at) in under_way {
        hits[index] = Some(at);
    }
    hits
}

/// Returns the fraction of the key light that reaches each point, with a soft edge.
fn shadows(field: &mut SampledField<'_>, points: &[Vec3], normals: &[Vec3]) -> Vec<f32> {
    let ray = TO_LIGHT.normalize();
    let mut light = vec![1.0_f32; points.len()];
    let mut under_way: Vec<(usize, f32)> = (0..points.len())
        .filter(|&index| normals[index].dot(ray) > 0.0)
        .map(|index| (index, 0.012))
        .collect();
    for _ in 0..STEPS {
        let at: Vec<Vec3> = under_way
            .iter()
            .map(|&(index, style)| points[index] + normals[index] * 0.006 + ray * style)
            .collect();
        let distances = field.distances(&at);
        let mut still = Vec::with_capacity(under_way.len());
        for (&(index, style), distance) in under_way.iter().zip(distances) {
            let near = distance * field.scale;
            light[index] = light[index].min(0.5 + 0.5 * near / (0.07 * style));
            if near > -0.07 * style && style < 5.0 {
                still.push((index, style + (distance * field.step).clamp(0.008, 0.12)));
            }
        }
        under_way = still;
        if under_way.is_empty() {
            break;
        }
    }
    light
        .into_iter()
        .map(|part| {
            let part = part.clamp(0.0, 1.0);
            part * part * (3.0 - 2.0 * part)
        })
        .collect()
}

/// Returns the ambient occlusion factor of each point, 0..1, from distances along the point's normal.
fn openness(field: &mut SampledField<'_>, points: &[Vec3], normals: &[Vec3], size: f32) -> Vec<f32> {
    let mut closed = vec![0.0_f32; points.len()];
    for (tap, weight) in [(0.04, 0.30), (0.09, 0.26), (0.16, 0.24), (0.26, 0.20), (0.40, 0.18)] {
        let reach = tap * size;
        let at: Vec<Vec3> =
            points.iter().zip(normals).map(|(point, normal)| point + normal * reach).collect();
        for (closed, distance) in closed.iter_mut().zip(field.distances(&at)) {
            *closed += weight * (1.0 - (distance * field.scale / reach).clamp(0.0, 1.0));
        }
    }
    closed.into_iter().map(|closed| (1.0 - 0.85 * closed).clamp(0.12, 1.0)).collect()
}

/// Returns the light from a point of the shape to the camera.
fn copper(normal: Vec3, to_eye: Vec3, light: f32, open: f32) -> Vec3 {
    let to_light = TO_LIGHT.normalize();
    let facing = normal.dot(to_light).max(0.0) * light;
    let half = (to_light + to_eye).normalize();
    let glint = normal.dot(half).max(0.0).powf(48.0) * facing;
    let sky = Vec3::new(0.20, 0.24, 0.32) * (0.5 + 0.5 * normal.y) + Vec3::new(0.16, 0.10, 0.07);
    let rim = (1.0 - normal.dot(to_eye).clamp(0.0, 1.0)).powf(3.5);
    COPPER * (LIGHT * facing * 0.44 + sky * open * 0.85)
        + LIGHT * glint * 0.16
        + Vec3::new(0.50, 0.55, 0.66) * rim * open * 0.35
}

/// Averages the samples and converts light to bytes. Quantizes the bytes for smaller files.
fn develop(colors: &[Vec3]) -> Vec<u8> {
    let columns = WIDTH * SAMPLES;
    let mut pixels = Vec::with_capacity(WIDTH * HEIGHT * 3);
    for row in 0..HEIGHT {
        for column in 0..WIDTH {
            let mut sum = Vec3::ZERO;
            for sample in 0..SAMPLES * SAMPLES {
                let (x, y) = (column * SAMPLES + sample % SAMPLES, row * SAMPLES + sample / SAMPLES);
                let color = colors[y * columns + x];
                sum += Vec3::ONE - (-1.35 * color).exp();
            }
            let color = (sum / (SAMPLES * SAMPLES) as f32).powf(1.0 / 2.2) * 255.0;
            // Quantize brightness in steps of 2, and the differences of red and blue from the brightness in steps of
            // 4.
            let bright = (color.dot(Vec3::new(0.25, 0.5, 0.25)) / 2.0).round() * 2.0;
            let red = ((color.x - bright) / 4.0).round() * 4.0;
            let blue = ((color.z - bright) / 4.0).round() * 4.0;
            let green = bright - 0.5 * (red + blue);
            pixels.extend(
                [bright + red, green, bright + blue].map(|part| part.round().clamp(0.0, 255.0) as u8),
            );
        }
    }
    pixels
}
