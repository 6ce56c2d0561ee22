//! A standing mallard drake, seen from the side, facing left.
//!
//! Painted from back to front: far leg, near leg, tail, body with its coat of feathers, wing, curled tail feathers,
//! mantle, neck and head, bill, eye. Units are pixels of the finished image, x to the right, y down.

use super::canvas::{Canvas, Color, Grid, Relief, rgb, scale};
use super::feather::{Feather, scatter};
use super::noise::{free_turbulence, mix, mix3, random, smoothstep};
use super::shape::{Point, Shape};

pub const SIDE: usize = 1024;

/// Paints the image as rows of sRGB bytes with straight alpha, `SIDE * SIDE * 4` bytes.
pub fn paint() -> Vec<u8> {
    let mut canvas = Canvas::new(SIDE);
    leg(&mut canvas, [112.0, -22.0], 0.68);
    leg(&mut canvas, [0.0, 0.0], 1.0);
    tail(&mut canvas);
    let body = Body::new();
    body.thighs(&mut canvas);
    body.coat(&mut canvas);
    body.wing(&mut canvas);
    curls(&mut canvas);
    body.mantle(&mut canvas);
    head(&mut canvas);
    canvas.into_bytes()
}

const PLAIN: Feather = Feather {
    root: [0.0, 0.0],
    angle: 0.0,
    length: 40.0,
    width: 24.0,
    point: 0.0,
    fringe: [0.0; 3],
    fringe_strength: 0.0,
    vermiculation: 0.0,
    shaft: 0.5,
    shadow: 0.25,
    seed: 0,
};

/// Paints a leg with its webbed foot, moved by `shift`. The far leg has less `light`.
fn leg(canvas: &mut Canvas, shift: Point, light: f32) {
    let at = |points: &[Point]| points.iter().map(|p| [p[0] + shift[0], p[1] + shift[1]]).collect::<Vec<_>>();
    let orange = scale(rgb(0xf08a1c), light);
    let deep = scale(rgb(0xc25a10), light);
    let shade = |p: Point, d: f32, round: f32| {
        // Scales make a faint grid on the skin.
        let net = (p[0] * 0.9 + p[1] * 0.5).sin() * (p[1] * 0.8 - p[0] * 0.35).sin();
        let c = mix3(deep, orange, smoothstep(0.0, -round, d));
        (scale(c, 1.0 + 0.07 * net), 1.0)
    };

    let hind = Shape::stroke(&at(&[[476.0, 914.0], [497.0, 922.0], [512.0, 934.0]]), &[12.0, 11.0, 4.0]);
    canvas.fill(&hind, None, 0.0, |p, d| shade(p, d, 6.0));

    let web = Shape::joined(&[
        &at(&[[478.0, 898.0], [425.0, 912.0], [352.0, 936.0]]),
        &at(&[[352.0, 936.0], [372.0, 944.0], [386.0, 966.0]]),
        &at(&[[386.0, 966.0], [420.0, 960.0], [456.0, 976.0]]),
        &at(&[[456.0, 976.0], [474.0, 944.0], [486.0, 908.0]]),
    ]);
    canvas.fill(&web, None, 0.0, |p, d| {
        let folds = (((p[0] - 478.0 - shift[0]) / (p[1] - 880.0 - shift[1])) * 16.0).sin();
        let c = mix3(scale(rgb(0xa84a0c), light), scale(rgb(0xe07a1a), light), smoothstep(0.0, -12.0, d));
        (scale(c, 1.0 + 0.08 * folds), 1.0)
    });
    let toes: [[Point; 3]; 3] = [
        [[474.0, 902.0], [420.0, 918.0], [350.0, 937.0]],
        [[474.0, 904.0], [432.0, 934.0], [384.0, 967.0]],
        [[478.0, 902.0], [472.0, 938.0], [455.0, 977.0]],
    ];
    for toe in toes {
        canvas.fill(&Shape::stroke(&at(&toe), &[17.0, 13.0, 10.0]), None, 0.0, |p, d| shade(p, d, 6.0));
        let [_, b, c] = toe;
        let (dx, dy) = (c[0] - b[0], c[1] - b[1]);
        let length = dx.hypot(dy);
        let out = |k: f32, drop: f32| [c[0] + dx / length * k, c[1] + dy / length * k + drop];
        let claw = Shape::stroke(&at(&[out(-3.0, 0.0), out(6.0, 0.0), out(13.0, 3.5)]), &[9.0, 7.0, 1.5]);
        canvas.fill(&claw, None, 0.0, |_, _| (scale(rgb(0x2b1c12), light), 1.0));
    }
    let shank = Shape::stroke(
        &at(&[[520.0, 735.0], [512.0, 790.0], [492.0, 838.0], [480.0, 880.0], [478.0, 908.0]]),
        &[44.0, 34.0, 25.0, 21.0, 22.0],
    );
    canvas.fill(&shank, None, 0.0, |p, d| {
        let side =
            smoothstep(18.0, -16.0, p[0] - shift[0] - mix(520.0, 476.0, (p[1] - shift[1] - 735.0) / 173.0));
        let rings = ((p[1] - shift[1]) * 0.55).sin() * smoothstep(-1.0, -6.0, d);
        let c = mix3(deep, orange, (0.25 + 0.75 * side) * smoothstep(1.0, -5.0, d).max(0.35));
        // The shadow of the body on the upper leg.
        let shadow = mix(0.45, 1.0, smoothstep(752.0, 815.0, p[1] - shift[1]));
        (scale(c, (1.0 + 0.06 * rings) * shadow), 1.0)
    });
}

fn tail(canvas: &mut Canvas) {
    let vanes: [(f32, f32, u32); 7] = [
        (0.26, 172.0, 0xc9c4ba),
        (0.18, 186.0, 0xd6d2c9),
        (0.10, 196.0, 0xe0ddd5),
        (0.02, 202.0, 0xe8e5de),
        (-0.06, 200.0, 0xefede8),
        (-0.14, 190.0, 0xf4f2ee),
        (-0.22, 170.0, 0xe6e0d6),
    ];
    for (i, (angle, length, color)) in vanes.into_iter().enumerate() {
        let root = [772.0, 566.0 - 6.0 * i as f32];
        let base = rgb(color);
        let brown = rgb(0x9b8a76);
        Feather {
            root,
            angle,
            length,
            width: 42.0,
            point: 0.7,
            fringe: rgb(0xfbfaf6),
            fringe_strength: 0.6,
            shaft: 0.55,
            shadow: 0.35,
            seed: 900 + i as u32,
            ..PLAIN
        }
        .paint(canvas, None, |p| {
            let u = ((p[0] - root[0]) / length).clamp(0.0, 1.0);
            mix3(mix3(brown, base, smoothstep(0.25, 0.7, u)), base, 0.45)
        });
    }
}

struct Body {
    cover: Grid,
    relief: Relief,
    breast: Grid,
    rump: Grid,
    wing: Grid,
}

impl Body {
    fn new() -> Self {
        let outline = Shape::smooth(&[
            [346.0, 330.0],
            [384.0, 386.0],
            [434.0, 419.0],
            [520.0, 428.0],
            [610.0, 438.0],
            [700.0, 460.0],
            [785.0, 490.0],
            [858.0, 518.0],
            [880.0, 548.0],
            [866.0, 592.0],
            [815.0, 646.0],
            [740.0, 702.0],
            [650.0, 746.0],
            [550.0, 766.0],
            [450.0, 758.0],
            [355.0, 722.0],
            [275.0, 660.0],
            [224.0, 584.0],
            [206.0, 508.0],
            [210.0, 448.0],
            [228.0, 398.0],
            [237.0, 364.0],
            [258.0, 330.0],
        ]);
        let breast = Shape::smooth(&[
            [150.0, 350.0],
            [300.0, 340.0],
            [400.0, 385.0],
            [432.0, 450.0],
            [418.0, 540.0],
            [372.0, 640.0],
            [322.0, 740.0],
            [150.0, 720.0],
        ]);
        let rump = Shape::smooth(&[
            [730.0, 440.0],
            [820.0, 470.0],
            [920.0, 520.0],
            [910.0, 620.0],
            [830.0, 690.0],
            [716.0, 770.0],
            [724.0, 706.0],
            [758.0, 640.0],
            [790.0, 576.0],
            [776.0, 520.0],
        ]);
        let wing = Shape::smooth(&[
            [395.0, 470.0],
            [470.0, 448.0],
            [600.0, 450.0],
            [730.0, 480.0],
            [840.0, 515.0],
            [760.0, 560.0],
            [680.0, 612.0],
            [580.0, 628.0],
            [470.0, 590.0],
            [405.0, 530.0],
        ]);
        let cover = Grid::distance(SIDE, &outline, 4.0).coverage();
        let relief = Relief::new(&cover, &[40.0, 90.0, 150.0]);
        let region = |shape: &Shape| Grid::distance(SIDE, shape, 80.0);
        Self { relief, breast: region(&breast), rump: region(&rump), wing: region(&wing), cover }
    }

    /// Returns the colour of the plumage at `p`, without lighting.
    fn plumage(&self, p: Point) -> Color {
        let ragged = 9.0 * free_turbulence(p[0] * 0.05, p[1] * 0.05, 2, 61);
        let flank = mix3(rgb(0xc4c0b8), rgb(0xe4e0d8), smoothstep(620.0, 740.0, p[1]));
        let mottle = free_turbulence(p[0] * 0.02, p[1] * 0.02, 3, 62);
        let chestnut = mix3(rgb(0x7c3a1c), rgb(0x5a2412), smoothstep(0.5, -0.6, mottle));
        let chestnut = mix3(chestnut, rgb(0x8e4a28), smoothstep(560.0, 690.0, p[1]));
        let rump = self.rump.at(p) + 0.6 * ragged;
        let c = mix3(flank, chestnut, smoothstep(12.0, -10.0, self.breast.at(p) + ragged));
        // A white band separates the flank from the black rump.
        let c = mix3(c, rgb(0xfaf8f4), smoothstep(50.0, 26.0, rump));
        mix3(c, rgb(0x14161a), smoothstep(5.0, -5.0, rump))
    }

    /// Returns the light at `p`, with the shadow of the wing on the flank.
    fn light(&self, p: Point) -> f32 {
        let under_wing = smoothstep(0.0, 42.0, self.wing.at([p[0] - 4.0, p[1] - 10.0]));
        self.relief.light(p) * mix(0.72, 1.0, under_wing)
    }

    /// Paints the body and its coat of small feathers, from the tail to the breast.
    fn coat(&self, canvas: &mut Canvas) {
        let everywhere = Shape::polygon(vec![[190.0, 280.0], [900.0, 280.0], [900.0, 780.0], [190.0, 780.0]]);
        let clip = Some(&self.cover);
        canvas.fill(&everywhere, clip, 0.0, |p, _| (scale(self.plumage(p), 0.8 * self.light(p)), 1.0));
        for (root, seed) in scatter([196.0, 360.0], [900.0, 790.0], [15.0, 17.0], 300) {
            let breast = smoothstep(40.0, -10.0, self.breast.at(root));
            let black = smoothstep(25.0, 0.0, self.rump.at(root));
            // The flank has fewer and longer feathers than the breast.
            let size = mix(mix(84.0, 26.0, breast), 46.0, black);
            if self.wing.at(root) < -60.0 || random(seed as i32, 3, 301) > 26.0 / size + 0.25 {
                continue;
            }
            let down = smoothstep(430.0, 230.0, root[0]) * 0.95;
            let lift = smoothstep(600.0, 760.0, root[1]) * smoothstep(330.0, 640.0, root[0]);
            let angle = 0.16 + down - 0.62 * lift + 0.22 * (random(seed as i32, 1, 302) - 0.5);
            let tint = mix(0.88, 1.12, random(seed as i32, 2, 303));
            // Near the rump, black and white must not blend.
            let apart = smoothstep(58.0, 79.0, self.rump.at(root));
            let blend = 0.3 * apart;
            let base = self.plumage([root[0] + 0.5 * size * angle.cos(), root[1] + 0.5 * size * angle.sin()]);
            Feather {
                root,
                angle,
                length: size,
                width: size * mix(mix(0.34, 0.78, breast), 0.5, black),
                point: 0.7 * (1.0 - breast),
                fringe: mix3(mix3(scale(base, 1.25), rgb(0xb06a40), 0.6 * breast), rgb(0x24463f), black),
                fringe_strength: mix(0.10, 0.34, breast).max(0.34 * black) * mix(apart, 1.0, black),
                vermiculation: (1.0 - breast) * (1.0 - black) * 0.55,
                shaft: mix(0.16, 0.5, breast),
                shadow: mix(mix(0.06, 0.32, breast), 0.3, black),
                seed,
            }
            .paint(canvas, clip, |p| scale(mix3(self.plumage(p), base, blend), tint * self.light(p)));
        }
    }

    /// Paints the downy feathers around the tops of the legs.
    fn thighs(&self, canvas: &mut Canvas) {
        for (root, light) in [([632.0, 722.0], 0.62), ([522.0, 736.0], 0.9)] {
            for i in 0..13 {
                // Paint from the outer feathers to the middle, so that the middle is on top.
                let k = if i % 2 == 0 { 12 - i } else { i - 12 } as f32 / 12.0;
                Feather {
                    root: [root[0] + 25.0 * k, root[1] - 4.0],
                    angle: 1.66 - 0.28 * k,
                    length: 66.0 - 22.0 * k * k + 8.0 * random(i, 0, 401),
                    width: 19.0,
                    point: 1.0,
                    vermiculation: 0.2,
                    shaft: 0.3,
                    shadow: 0.16,
                    seed: 400 + i as u32,
                    ..PLAIN
                }
                .paint(canvas, None, |p| {
                    let shade =
                        mix(0.45, 0.85, smoothstep(745.0, 800.0, p[1])) * mix(1.0, 0.8, 0.5 + 0.5 * k);
                    scale(rgb(0xcfcac0), light * shade)
                });
            }
        }
    }

    /// Paints the folded wing from bottom to top: primaries, speculum, coverts and scapulars.
    fn wing(&self, canvas: &mut Canvas) {
        let light = |p: Point| self.relief.light(p);
        for i in 0..5 {
            let k = i as f32;
            let feather = Feather {
                root: [600.0 - 4.0 * k, 540.0 - 5.0 * k],
                angle: -0.055 - 0.035 * k,
                length: 236.0 + 17.0 * k,
                width: 40.0,
                point: 1.0,
                fringe: rgb(0xb9a88f),
                fringe_strength: 0.75,
                shaft: 0.6,
                shadow: 0.5,
                seed: 700 + i,
                ..PLAIN
            };
            feather.paint(canvas, None, |p| scale(rgb(0x5b4c3f), light(p).max(0.75)));
        }
        self.speculum(canvas);

        // Coverts are rows of scallops above the speculum. Paint the last row first.
        let rows: [(f32, f32, f32); 4] =
            [(600.0, 66.0, 0.0), (568.0, 60.0, 0.5), (536.0, 58.0, 0.0), (504.0, 58.0, 0.5)];
        for (row, (x, size, shift)) in rows.into_iter().enumerate() {
            for i in 0..6 {
                let k = i as f32 + shift;
                let root = [x - 62.0 - 10.0 * k, 592.0 - 23.0 * k];
                if self.wing.at(root) > -2.0 {
                    continue;
                }
                let seed = 720 + (row * 10 + i) as u32;
                let tint = mix(0.9, 1.1, random(seed as i32, 0, 720));
                Feather {
                    root,
                    angle: 0.10 - 0.03 * k,
                    length: size,
                    width: 40.0,
                    fringe: rgb(0xc9bba6),
                    fringe_strength: 0.55,
                    shaft: 0.6,
                    shadow: 0.4,
                    seed,
                    ..PLAIN
                }
                .paint(canvas, None, |p| scale(rgb(0x85776a), tint * light(p)));
            }
        }
        self.scapulars(canvas);
    }

    /// Paints tertials and scapulars: long and pale, drooping from the shoulder over the wing.
    fn scapulars(&self, canvas: &mut Canvas) {
        let long: [(Point, f32, f32, f32); 11] = [
            ([560.0, 516.0], 0.115, 196.0, 50.0),
            ([560.0, 492.0], 0.105, 246.0, 54.0),
            ([540.0, 474.0], 0.115, 242.0, 54.0),
            ([462.0, 546.0], 0.180, 138.0, 46.0),
            ([452.0, 522.0], 0.165, 176.0, 48.0),
            ([470.0, 498.0], 0.130, 196.0, 48.0),
            ([462.0, 474.0], 0.105, 232.0, 48.0),
            ([398.0, 536.0], 0.235, 112.0, 42.0),
            ([392.0, 514.0], 0.195, 142.0, 44.0),
            ([394.0, 490.0], 0.150, 168.0, 44.0),
            ([400.0, 468.0], 0.105, 184.0, 44.0),
        ];
        for (i, (root, angle, length, width)) in long.into_iter().enumerate() {
            let (sin, cos) = f32::sin_cos(angle);
            Feather {
                root,
                angle,
                length,
                width,
                point: 0.85,
                fringe: rgb(0xe6ded0),
                fringe_strength: 0.42,
                vermiculation: 0.16,
                shaft: 0.8,
                shadow: 0.5,
                seed: 780 + i as u32,
            }
            .paint(canvas, None, |p| {
                let v = ((p[1] - root[1]) * cos - (p[0] - root[0]) * sin) / (0.5 * width);
                let brown = smoothstep(-0.35, 0.55, v);
                scale(mix3(rgb(0xbdb4a8), rgb(0x7e6a58), brown), self.relief.light(p))
            });
        }
    }

    /// Paints the speculum: the blue patch on the wing, between two black and two white bars.
    fn speculum(&self, canvas: &mut Canvas) {
        for i in 0..7 {
            let k = i as f32;
            let root = [556.0 - 6.0 * k, 606.0 - 9.0 * k];
            let angle: f32 = -0.10 - 0.015 * k;
            let (sin, cos) = angle.sin_cos();
            let feather = Feather {
                root,
                angle,
                length: 186.0 - 3.0 * k,
                width: 34.0,
                point: 0.15,
                fringe: rgb(0xffffff),
                fringe_strength: 0.0,
                shaft: 0.45,
                shadow: 0.4,
                seed: 740 + i,
                ..PLAIN
            };
            feather.paint(canvas, None, |p| {
                let u = (p[0] - root[0]) * cos + (p[1] - root[1]) * sin;
                let s = u - 5.0 * k + 7.0 * (k - 3.0);
                let sheen = smoothstep(-0.5, 0.6, free_turbulence(s * 0.018, k * 0.3, 2, 63));
                let blue = mix3(rgb(0x2a2f9c), rgb(0x3f74e0), sheen);
                let blue = mix3(blue, rgb(0x6a3fb0), smoothstep(112.0, 146.0, s));
                let mut c = rgb(0xf4f2ec);
                c = mix3(c, rgb(0x101014), smoothstep(62.0, 65.0, s));
                c = mix3(c, blue, smoothstep(73.0, 80.0, s));
                c = mix3(c, rgb(0x101014), smoothstep(145.0, 150.0, s));
                c = mix3(c, rgb(0xf7f5f0), smoothstep(159.0, 162.0, s));
                scale(c, 1.1 * self.relief.light(p).max(0.8))
            });
        }
    }

    /// Paints the scalloped back, from the tail to the neck.
    fn mantle(&self, canvas: &mut Canvas) {
        for (root, seed) in scatter([372.0, 396.0], [770.0, 520.0], [15.0, 14.0], 500) {
            let spine = mix(420.0, 500.0, smoothstep(400.0, 800.0, root[0]));
            let depth = root[1] - spine;
            let reach = mix(48.0, 8.0, smoothstep(380.0, 760.0, root[0]));
            if depth < -34.0 || depth > reach || self.breast.at(root) < -6.0 {
                continue;
            }
            let tint = mix(0.86, 1.12, random(seed as i32, 0, 501));
            let size = mix(34.0, 52.0, smoothstep(400.0, 700.0, root[0]));
            Feather {
                root,
                angle: 0.14 + 0.1 * (random(seed as i32, 1, 502) - 0.5),
                length: size,
                width: 0.62 * size,
                fringe: rgb(0xb7a48c),
                fringe_strength: 0.5,
                shaft: 0.5,
                shadow: 0.35,
                seed,
                ..PLAIN
            }
            .paint(canvas, Some(&self.cover), |p| {
                let grey = mix3(rgb(0x7d6f62), rgb(0x5a4a3e), smoothstep(420.0, 740.0, p[0]));
                scale(grey, tint * self.light(p))
            });
        }
    }
}

/// Paints the two black feathers that curl up over the tail.
fn curls(canvas: &mut Canvas) {
    let long: [Point; 7] = [
        [790.0, 508.0],
        [850.0, 494.0],
        [896.0, 466.0],
        [908.0, 424.0],
        [880.0, 398.0],
        [850.0, 412.0],
        [856.0, 436.0],
    ];
    let short: [Point; 6] =
        [[770.0, 500.0], [822.0, 482.0], [852.0, 452.0], [846.0, 420.0], [818.0, 412.0], [806.0, 430.0]];
    for (knots, widths) in [
        (&long[..], &[26.0, 30.0, 27.0, 23.0, 18.0, 11.0, 3.0][..]),
        (&short, &[24.0, 26.0, 23.0, 18.0, 12.0, 3.0]),
    ] {
        canvas.fill(&Shape::stroke(knots, widths), None, 0.0, |p, d| {
            let sheen = smoothstep(-3.0, -10.0, d) * (0.6 + 0.4 * (p[0] * 0.05 + p[1] * 0.09).sin());
            let c = mix3(rgb(0x0c0d10), rgb(0x2c4a4c), 0.75 * sheen);
            (mix3(c, rgb(0x55606a), smoothstep(-3.5, -0.5, d) * 0.45), 1.0)
        });
    }
}

fn head(canvas: &mut Canvas) {
    let outline = Shape::smooth(&[
        [188.0, 214.0],
        [194.0, 158.0],
        [228.0, 110.0],
        [282.0, 88.0],
        [338.0, 100.0],
        [376.0, 142.0],
        [388.0, 196.0],
        [380.0, 250.0],
        [366.0, 300.0],
        [368.0, 344.0],
        [378.0, 392.0],
        [368.0, 424.0],
        [300.0, 432.0],
        [236.0, 420.0],
        [231.0, 390.0],
        [239.0, 346.0],
        [242.0, 304.0],
        [222.0, 276.0],
        [196.0, 254.0],
    ]);
    let cover = Grid::distance(SIDE, &outline, 4.0).coverage();
    let relief = Relief::new(&cover, &[22.0, 55.0, 90.0]);
    bill(canvas);
    canvas.fill(&outline, None, 0.0, |p, _| {
        // Tiny feathers: noise stretched along the line from the bill over the cheek down the neck.
        let turn = smoothstep(230.0, 330.0, p[1]);
        let (along, across) = (mix(p[0], p[1], turn), mix(p[1], p[0], turn));
        let hair = free_turbulence(along * 0.07, across * 0.33, 3, 71);
        let n = relief.normal(p);
        let facing = -0.42 * n[0] - 0.62 * n[1] + 0.66 * n[2] + 0.10 * hair;
        // Iridescence: the hue depends on the angle between light and plumage.
        let mut c = mix3(rgb(0x071713), rgb(0x0b4a32), smoothstep(-0.2, 0.45, facing));
        c = mix3(c, rgb(0x128057), smoothstep(0.40, 0.80, facing));
        c = mix3(c, rgb(0x4fc98a), 0.75 * smoothstep(0.80, 1.02, facing));
        let violet = smoothstep(0.15, 1.0, n[0] + 0.12 * hair)
            + 0.5 * smoothstep(255.0, 340.0, p[1]) * smoothstep(-0.5, 0.3, n[0]);
        c = mix3(c, rgb(0x2c2a78), (0.62 * violet).min(0.6) * smoothstep(0.85, 0.45, facing));
        // A sheen from the cheek down the side of the neck.
        let sheen = ((p[0] - mix(322.0, 296.0, smoothstep(200.0, 330.0, p[1]))) / 42.0).powi(2)
            + ((p[1] - 236.0) / 78.0).powi(2);
        c = mix3(c, rgb(0x1fa06e), 0.34 * (-1.4 * sheen).exp() * (1.0 + hair));
        c = scale(c, 1.0 + 0.35 * hair);
        // Add the white ring with a ragged edge, then chestnut that fades into the breast.
        let sag = 14.0 * (1.0 - ((p[0] - 302.0) / 80.0).powi(2));
        let rag = 5.0 * free_turbulence(p[0] * 0.16, p[1] * 0.04, 2, 72);
        let below = p[1] - 346.0 - sag + rag;
        let white = scale(rgb(0xf6f4ef), (0.12 + relief.light(p)).min(1.05) * (1.0 + 0.05 * hair));
        c = mix3(c, white, smoothstep(-2.0, 2.0, below));
        let chestnut = scale(rgb(0x74351a), relief.light(p).max(0.75) * (1.0 + 0.25 * hair));
        c = mix3(c, chestnut, smoothstep(21.0, 26.0, below + 0.5 * rag));
        (c, smoothstep(56.0, 27.0, below + 2.0 * rag))
    });
    eye(canvas);
}

fn bill(canvas: &mut Canvas) {
    let lower = Shape::joined(&[
        &[[214.0, 258.0], [160.0, 276.0], [106.0, 290.0], [84.0, 288.0]],
        &[[84.0, 288.0], [104.0, 300.0], [160.0, 292.0], [222.0, 276.0]],
    ]);
    canvas.fill(&lower, None, 0.0, |p, d| {
        let c = mix3(rgb(0x8e6a14), rgb(0xc9981f), smoothstep(0.0, -7.0, d) * smoothstep(300.0, 280.0, p[1]));
        (c, 1.0)
    });
    let upper = Shape::smooth(&[
        [214.0, 190.0],
        [188.0, 204.0],
        [160.0, 228.0],
        [124.0, 246.0],
        [88.0, 256.0],
        [64.0, 268.0],
        [58.0, 282.0],
        [72.0, 292.0],
        [104.0, 290.0],
        [150.0, 280.0],
        [190.0, 270.0],
        [222.0, 262.0],
        [232.0, 226.0],
    ]);
    let cover = Grid::distance(SIDE, &upper, 4.0).coverage();
    let relief = Relief::new(&cover, &[9.0, 22.0]);
    canvas.fill(&upper, None, 0.0, |p, d| {
        let grain = free_turbulence(p[0] * 0.05, p[1] * 0.09, 3, 81);
        let light = relief.light(p);
        let mut c = mix3(rgb(0xd8b31e), rgb(0xb9a527), smoothstep(-0.4, 0.7, grain));
        c = scale(c, light * (1.0 + 0.05 * grain));
        // A wet highlight along the ridge.
        let n = relief.normal(p);
        let shine = (-0.45 * n[0] - 0.70 * n[1] + 0.55 * n[2]).max(0.0).powi(10);
        c = mix3(c, rgb(0xfff4b0), 0.7 * shine);
        let nail = ((p[0] - 60.0) / 22.0).hypot((p[1] - 278.0) / 13.0);
        c = mix3(c, rgb(0x1d1a12), 0.92 * smoothstep(1.05, 0.75, nail));
        (mix3(c, rgb(0x6b5412), 0.55 * smoothstep(-4.0, 0.0, d) * smoothstep(262.0, 284.0, p[1])), 1.0)
    });
    let nostril = Shape::ellipse([158.0, 238.0], [11.0, 4.6], -0.42);
    canvas.fill(&nostril, None, 2.0, |_, _| (rgb(0x6d5a14), 0.7));
    canvas.fill(&nostril, None, 0.0, |_, _| (rgb(0x241c08), 1.0));
    let smile = Shape::stroke(
        &[[76.0, 289.0], [112.0, 286.0], [160.0, 275.0], [204.0, 262.0], [224.0, 250.0]],
        &[2.0, 4.0, 4.0, 4.5, 2.0],
    );
    canvas.fill(&smile, None, 0.3, |_, _| (rgb(0x4a380c), 0.9));
}

fn eye(canvas: &mut Canvas) {
    let center = [258.0, 176.0];
    let disc = |c: Point, r: f32| Shape::ellipse(c, [r, r], 0.0);
    canvas.fill(&Shape::ellipse(center, [21.0, 19.0], -0.2), None, 2.5, |_, _| (rgb(0x04100c), 0.85));
    canvas.fill(&disc(center, 15.5), None, 0.0, |p, d| {
        let glow = smoothstep(-6.0, 12.0, (p[1] - center[1]) + 0.4 * (p[0] - center[0]));
        (mix3(rgb(0x1c0d06), mix3(rgb(0x4a230e), rgb(0x9a5a26), glow), smoothstep(0.0, -3.0, d)), 1.0)
    });
    canvas.fill(&disc(center, 9.5), None, 0.3, |_, _| (rgb(0x030303), 1.0));
    canvas.fill(&disc([252.5, 169.5], 4.6), None, 0.3, |_, _| (rgb(0xffffff), 1.0));
    canvas.fill(&disc([264.5, 183.5], 2.2), None, 0.3, |_, _| (rgb(0xcfe6ee), 0.8));
}
