//! What a picture must show, whatever the look.

use koiter_render::{
    Background, Bounds, Camera, CameraView, ColorBy, ColorMap, FieldView, Ground, Image, PartView,
    Quality, RenderError, RenderOptions, Rgb, Scene, render,
};

/// A unit square in the plane y = 0, facing the front view.
const SQUARE: [[f64; 3]; 4] = [
    [-0.5, 0.0, -0.5],
    [0.5, 0.0, -0.5],
    [0.5, 0.0, 0.5],
    [-0.5, 0.0, 0.5],
];
const FACES: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

fn camera(positions: &[[f64; 3]], view: CameraView) -> Camera {
    Camera::fit_points(positions.iter().copied(), view, 1.0)
}

fn options(positions: &[[f64; 3]], view: CameraView) -> RenderOptions {
    let background = Background::plain(Rgb::WHITE);
    RenderOptions {
        background,
        quality: Quality::Film,
        ..RenderOptions::new(96, 96, camera(positions, view))
    }
}

fn scene<'a>(positions: &'a [[f64; 3]], ground: Ground) -> Scene<'a> {
    Scene {
        parts: vec![PartView {
            color: Rgb::RED,
            ..PartView::shell(positions, &FACES)
        }],
        ground,
    }
}

/// Sum of the three components.
fn brightness(image: &Image, column: u32, row: u32) -> u32 {
    image
        .pixel(column, row)
        .unwrap()
        .iter()
        .map(|&c| u32::from(c))
        .sum()
}

/// A sheet of (n + 1)² vertices with waves, over the unit square.
fn waves(n: u32) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    for j in 0..=n {
        for i in 0..=n {
            let (x, y) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
            positions.push([x, y, 0.1 * (12.0 * x + 3.0 * y).sin()]);
            if i < n && j < n {
                let a = j * (n + 1) + i;
                faces.extend([[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]);
            }
        }
    }
    (positions, faces)
}

#[test]
fn a_red_square_covers_the_pixels_it_should() {
    for (quality, samples) in [(Quality::Film, 1), (Quality::Still, 3)] {
        let options = RenderOptions {
            quality,
            samples,
            ..options(&SQUARE, CameraView::Front)
        };
        let image = render(&scene(&SQUARE, Ground::None), &options).unwrap();
        let corners = SQUARE.map(|p| options.camera.project(p, 96, 96).unwrap());
        let (left, right) = (corners[0][0], corners[1][0]);
        let (top, bottom) = (corners[2][1], corners[0][1]);
        for row in 0..96 {
            for column in 0..96 {
                let inside =
                    |v: u32, low: f64, high: f64| f64::from(v) >= low && f64::from(v) + 1.0 <= high;
                let outside =
                    |v: u32, low: f64, high: f64| f64::from(v) + 1.0 <= low || f64::from(v) >= high;
                let [r, g, b] = image.pixel(column, row).unwrap();
                if inside(column, left, right) && inside(row, top, bottom) {
                    assert!(
                        r > 60 && r > g + 30 && r > b + 30,
                        "({column}, {row}): {r} {g} {b}"
                    );
                } else if outside(column, left, right) || outside(row, top, bottom) {
                    assert_eq!([r, g, b], [255; 3], "({column}, {row})");
                }
            }
        }
    }
}

#[test]
fn a_sheet_casts_a_shadow_on_the_ground_and_open_ground_is_the_background() {
    let sheet = [
        [-0.5, -0.5, 0.4],
        [0.5, -0.5, 0.4],
        [0.5, 0.5, 0.4],
        [-0.5, 0.5, 0.4],
    ];
    // Seen from far enough above that the ground around is in the picture.
    let view = CameraView::Orbit {
        azimuth: 0.0,
        elevation: 40.0,
        zoom: 0.4,
    };
    let options = options(&sheet, view);
    let with_ground = render(&scene(&sheet, Ground::At(0.0)), &options).unwrap();
    let [x, y] = options.camera.project([0.3, 0.1, 0.0], 96, 96).unwrap();
    let mut darkest = u32::MAX;
    for row in y as u32 - 4..y as u32 + 20 {
        for column in x as u32 - 6..x as u32 + 14 {
            let [r, g, b] = with_ground.pixel(column, row).unwrap();
            let is_grey = r.abs_diff(b) < 20 && r.abs_diff(g) < 20;
            darkest = darkest.min(if is_grey {
                brightness(&with_ground, column, row)
            } else {
                u32::MAX
            });
        }
    }
    assert!(darkest < 3 * 215, "the darkest grey is {darkest}");
    assert_eq!(with_ground.pixel(0, 95), Some([255; 3]));
    let shadowless = RenderOptions {
        shadow: 0.0,
        ambient_occlusion: 0.0,
        ..options
    };
    let image = render(&scene(&sheet, Ground::At(0.0)), &shadowless).unwrap();
    let grey = image
        .bytes()
        .chunks_exact(3)
        .filter(|p| p[0] < 250 && p[0].abs_diff(p[2]) < 20)
        .count();
    assert_eq!(grey, 0);
}

#[test]
fn the_bytes_do_not_depend_on_the_number_of_threads() {
    let (positions, faces) = waves(60);
    let heights: Vec<f64> = positions.iter().map(|p| p[2]).collect();
    let field = Some(FieldView::PerVertex(&heights));
    let scene = Scene {
        parts: vec![PartView {
            field,
            ..PartView::shell(&positions, &faces)
        }],
        ground: Ground::At(-0.2),
    };
    let color = ColorBy::field("height", "m", ColorMap::CoolWarm);
    let options = RenderOptions {
        color,
        wireframe: true,
        ..options(&positions, CameraView::Iso)
    };
    let with_threads = |count| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(count)
            .build()
            .unwrap();
        pool.install(|| render(&scene, &options).unwrap())
    };
    assert_eq!(with_threads(1), with_threads(2));
}

#[test]
fn a_field_brings_its_colours_and_a_legend() {
    let values = [0.0, 1.0];
    let mut scene = scene(&SQUARE, Ground::None);
    scene.parts[0].field = Some(FieldView::PerFace(&values));
    let plain = RenderOptions {
        width: 320,
        height: 200,
        ..options(&SQUARE, CameraView::Front)
    };
    let color = ColorBy::field("strain", "", ColorMap::Viridis);
    let image = render(
        &scene,
        &RenderOptions {
            color,
            ..plain.clone()
        },
    )
    .unwrap();
    // Yellow is at the upper end of the bar, violet at the lower, both right of everything else.
    let is_yellow = |[r, g, b]: [u8; 3]| r > 200 && g > 200 && b < 90;
    let is_violet = |[r, g, b]: [u8; 3]| b > 60 && g < 40 && r < 90;
    let rows_with = |test: &dyn Fn([u8; 3]) -> bool| {
        let rows = (0..200)
            .filter(|&row| (270..320).any(|column| test(image.pixel(column, row).unwrap())));
        rows.collect::<Vec<u32>>()
    };
    let (yellow, violet) = (rows_with(&is_yellow), rows_with(&is_violet));
    assert!(!yellow.is_empty() && !violet.is_empty() && yellow.iter().max() < violet.iter().min());
    let without = render(&scene, &plain).unwrap();
    assert!(
        (0..200).all(|row| (270..320).all(|column| without.pixel(column, row) == Some([255; 3])))
    );
}

#[test]
fn a_caption_appears_in_the_lower_left_corner() {
    let caption = Some("t = 1.20 s".to_owned());
    let options = RenderOptions {
        caption,
        ..options(&SQUARE, CameraView::Front)
    };
    let narrow = [
        [-0.01, 0.0, -0.5],
        [0.01, 0.0, -0.5],
        [0.01, 0.0, 0.5],
        [-0.01, 0.0, 0.5],
    ];
    let image = render(&scene(&narrow, Ground::None), &options).unwrap();
    let dark = (76..96).any(|row| (0..40).any(|column| brightness(&image, column, row) < 450));
    assert!(dark);
}

#[test]
fn what_cannot_be_drawn_is_an_error() {
    let options = options(&SQUARE, CameraView::Front);
    assert_eq!(
        render(&Scene::default(), &options),
        Err(RenderError::EmptyScene)
    );
    for bad in [f64::NAN, f64::INFINITY] {
        let mut positions = SQUARE;
        positions[2][1] = bad;
        let error = render(&scene(&positions, Ground::None), &options).unwrap_err();
        assert!(
            matches!(
                error,
                RenderError::PositionNotFinite {
                    part: 0,
                    vertex: 2,
                    ..
                }
            ),
            "{error}"
        );
    }
    let error = render(&scene(&SQUARE, Ground::At(f64::NAN)), &options).unwrap_err();
    assert!(matches!(error, RenderError::Option { .. }));
}

#[test]
fn odd_scenes_are_drawn_without_panic() {
    let point = [[1.0; 3]; 4];
    let huge = SQUARE.map(|p| p.map(|x| 1e12 * x));
    let tiny = SQUARE.map(|p| p.map(|x| 1e-12 * x));
    let enormous = SQUARE.map(|p| p.map(|x| f64::MAX * x));
    for positions in [point, huge, tiny, enormous] {
        for view in [
            CameraView::Front,
            CameraView::Side,
            CameraView::Top,
            CameraView::Iso,
        ] {
            let options = RenderOptions {
                wireframe: true,
                ..options(&positions, view)
            };
            render(&scene(&positions, Ground::At(positions[0][2])), &options).unwrap();
            // A camera for another scene, with this one around or behind it.
            let elsewhere = camera(&[[0.3; 3], [0.4; 3]], view);
            render(
                &scene(&positions, Ground::At(9.0)),
                &RenderOptions {
                    camera: elsewhere,
                    ..options
                },
            )
            .unwrap();
        }
    }
}

#[test]
fn the_default_view_shows_the_scene_in_the_middle() {
    let mut bounds = Bounds::EMPTY;
    SQUARE.iter().for_each(|&p| bounds.include(p));
    let camera = Camera::fit(&bounds, CameraView::default(), 1.0);
    let image = render(
        &scene(&SQUARE, Ground::None),
        &RenderOptions {
            camera,
            ..options(&SQUARE, CameraView::Iso)
        },
    );
    let [r, g, _] = image.unwrap().pixel(48, 48).unwrap();
    assert!(r > g);
}

#[test]
fn what_leaves_the_picture_does_not_change_the_light_in_it() {
    let (positions, faces) = waves(40);
    let options = options(&positions, CameraView::Front);
    let sheet = PartView::shell(&positions, &faces);
    let away = SQUARE.map(|[x, y, z]| [x - 40.0, y + 30.0, z + 5.0]);
    let parts = vec![sheet, PartView::shell(&away, &FACES)];
    let alone = render(
        &Scene {
            parts: vec![sheet],
            ground: Ground::At(-0.2),
        },
        &options,
    )
    .unwrap();
    let both = render(
        &Scene {
            parts,
            ground: Ground::At(-0.2),
        },
        &options,
    )
    .unwrap();
    let differences = alone
        .bytes()
        .iter()
        .zip(both.bytes())
        .map(|(a, b)| a.abs_diff(*b));
    // The centre moved by 20 units: coordinates are rounded to 2e-6, and a ray in hundreds falls on the other side.
    let sum: u32 = differences.map(u32::from).sum();
    assert!(sum < alone.bytes().len() as u32 / 20, "{sum}");
}
