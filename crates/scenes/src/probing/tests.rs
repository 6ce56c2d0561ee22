//! Tests of probes.

use std::sync::mpsc::channel;

use mariana_music::Features;

use super::*;

const BALLS: &str = "\
object near {
  shape = sphere(p - vec3(0, 0, 5), 1)
}
object floor { shape = y + 1 }
camera { position = vec3(0)  target = vec3(0, 0, 5)  fov = 90 }";

/// Returns a frame of a scene after a second of silence. The frame is twice as wide as high.
fn scenery(text: &str) -> Scenery {
    let source = SceneSource::Formula(text.to_owned());
    let ready = source.ready().unwrap();
    let frame = Frame::new(&ready.world, 1.0, Features::SILENCE, (200, 100));
    Scenery::new(source, ready, frame)
}

fn asked(scenery: &Scenery, ask: impl Fn(&Prober, Scenery)) -> Answer {
    let (woken, wakes) = channel();
    let prober = Prober::start(move || woken.send(()).unwrap_or_default()).unwrap();
    ask(&prober, scenery.clone());
    wakes.recv_timeout(Duration::from_secs(20)).unwrap();
    prober.answers().pop().unwrap()
}

#[test]
fn a_probed_point_has_an_object_a_position_and_a_source_range() {
    let scenery = scenery(BALLS);
    let surface = |at: [f64; 2]| match asked(&scenery, |prober, scenery| prober.request_point(scenery, at)) {
        Answer::Point(probed) => probed.surface,
        other => panic!("{other:?}"),
    };
    let ball = surface([0.5, 0.5]).unwrap();
    assert_eq!((ball.object.as_str(), ball.material.as_str()), ("near", "default"));
    assert!((ball.distance - 4.0).abs() < 1e-3 && (ball.position[2] - 4.0).abs() < 1e-3, "{ball:?}");
    assert!(ball.normal[2] < -0.999, "{ball:?}");
    let (file, bytes) = ball.written.unwrap();
    assert_eq!((file, &BALLS[bytes]), (0, "sphere(p - vec3(0, 0, 5), 1)"));
    // Half way down the field of view, the floor is seen at 45 / 2 degrees.
    let floor = surface([0.5, 0.9]).unwrap();
    assert!((floor.position[2] - 1.0 / 0.8).abs() < 1e-3, "{floor:?}");
    let (_, bytes) = floor.written.unwrap();
    assert_eq!(&BALLS[bytes], "y + 1");
    assert_eq!(surface([0.5, 0.1]), None);
    // Right in the frame is right in the scene.
    assert!(surface([0.75, 0.9]).unwrap().position[0] > 0.1);
}

#[test]
fn ray_statistics_have_the_aspect_of_the_frame_and_all_objects() {
    let scenery = scenery(BALLS);
    let Answer::RayStatistics(source, ray_statistics) =
        asked(&scenery, |prober, scenery| prober.request_ray_statistics(scenery))
    else {
        panic!("no ray statistics arrived");
    };
    assert_eq!(source, scenery.source);
    assert_eq!((ray_statistics.columns, ray_statistics.cells.len()), (COLUMNS, COLUMNS * COLUMNS / 2));
    assert!(
        ray_statistics.objects.iter().all(|object| object.rays > 0 && object.run > 0),
        "{:?}",
        ray_statistics.objects
    );
}
