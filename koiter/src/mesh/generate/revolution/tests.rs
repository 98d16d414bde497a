use super::*;

/// Checks that no vertex appears twice in space and that every normal makes a positive product with `outward`.
fn assert_outward(surface: &Surface, outward: impl Fn(Vec3) -> Vec3) {
    for f in 0..surface.mesh.num_faces() {
        let [a, b, c] = surface.corners(f);
        let normal = (b - a).cross(&(c - a));
        assert!(normal.dot(&outward((a + b + c) / 3.0)) > 0.0, "face {f}");
    }
    let (welded, _) = crate::mesh::repair::weld(&surface.positions, surface.mesh.faces());
    assert_eq!(welded.len(), surface.positions.len());
}

fn radial(x: Vec3) -> Vec3 {
    Vec3::new(x.x, x.y, 0.0)
}

/// Inscribed polygons lose area in the second order: the error must fall by about 4 when the resolution doubles.
fn assert_second_order(exact: f64, area: impl Fn(usize) -> f64) {
    let errors = [8, 16, 32].map(|n| exact - area(n));
    for (coarse, fine) in [(errors[0], errors[1]), (errors[1], errors[2])] {
        assert!(
            fine > 0.0 && (3.3..4.6).contains(&(coarse / fine)),
            "errors {errors:?}"
        );
    }
}

#[test]
fn disc_has_six_rings_squared_faces_up() {
    let surface = disc(2.0, 5).unwrap();
    assert_eq!(surface.mesh.num_faces(), 150);
    assert_eq!(surface.mesh.euler_characteristic(), 1);
    assert_eq!(*surface.positions.last().unwrap(), Vec3::zeros());
    assert_outward(&surface, |_| Vec3::z());
    assert!(
        surface.min_angle().to_degrees() > 29.9,
        "{}",
        surface.min_angle().to_degrees()
    );
    assert_second_order(PI, |n| disc(1.0, n).unwrap().area());
}

#[test]
fn cylinder_is_an_open_tube() {
    let surface = cylinder(0.5, 2.0, 12, 7).unwrap();
    assert_eq!(surface.mesh.num_faces(), 168);
    assert_eq!(surface.mesh.euler_characteristic(), 0);
    assert_eq!(surface.mesh.boundary_loops().len(), 2);
    assert_outward(&surface, radial);
    let (low, high) = surface.bounding_box();
    assert_eq!((low.z, high.z), (-1.0, 1.0));
    assert_second_order(TAU, |n| cylinder(1.0, 1.0, n, 2).unwrap().area());
}

#[test]
fn solid_cylinder_encloses_its_volume() {
    let surface = solid_cylinder(1.0, 2.0, 64).unwrap();
    assert_eq!(surface.mesh.euler_characteristic(), 2);
    assert!(surface.mesh.boundary_loops().is_empty());
    let polygon = 32.0 * (TAU / 64.0).sin();
    assert!((surface.signed_volume() - 2.0 * polygon).abs() < 1e-13);
}

#[test]
fn cone_ends_in_an_apex_or_a_hole() {
    let pointed = cone(1.0, 1.0, None, 24, 6).unwrap();
    assert_eq!(pointed.mesh.euler_characteristic(), 1);
    assert_eq!(*pointed.positions.last().unwrap(), Vec3::z());
    let open = cone(1.0, 1.0, Some(0.25), 24, 6).unwrap();
    assert_eq!(open.mesh.euler_characteristic(), 0);
    for surface in [&pointed, &open] {
        assert_outward(surface, |x| radial(x) + Vec3::z());
    }
    assert_second_order(PI * 2f64.sqrt(), |n| {
        cone(1.0, 1.0, None, 4 * n, n).unwrap().area()
    });
}

#[test]
fn spherical_cap_covers_its_part_of_the_sphere() {
    let cap = spherical_cap(2.0, 1.0, None, 6).unwrap();
    assert_eq!(cap.mesh.euler_characteristic(), 1);
    let hemisphere = spherical_cap(1.0, PI / 2.0, Some(18f64.to_radians()), 8).unwrap();
    assert_eq!(hemisphere.mesh.euler_characteristic(), 0);
    assert!(
        hemisphere.positions[0].z.abs() < 1e-15,
        "the rim comes first"
    );
    let almost_sphere = spherical_cap(1.0, 3.0, None, 20).unwrap();
    for surface in [&cap, &hemisphere, &almost_sphere] {
        assert_outward(surface, |x| x);
        assert!(
            surface.min_angle().to_degrees() > 20.0,
            "{}",
            surface.min_angle().to_degrees()
        );
    }
    let exact = TAU * (1.0 - 1f64.cos());
    assert_second_order(exact, |n| spherical_cap(1.0, 1.0, None, n).unwrap().area());
}

#[test]
fn torus_is_closed_with_one_hole() {
    let surface = torus(1.0, 0.25, 24, 12).unwrap();
    assert_eq!(surface.mesh.euler_characteristic(), 0);
    assert!(surface.mesh.boundary_loops().is_empty());
    assert_outward(&surface, |x| x - radial(x).normalize());
    let exact = TAU * TAU * 0.25;
    assert_second_order(exact, |n| torus(1.0, 0.25, 2 * n, n).unwrap().area());
}

#[test]
fn impossible_shapes_are_refused_with_the_value() {
    let message = |result: Result<Surface, GeneratorError>| result.unwrap_err().to_string();
    assert!(message(disc(0.0, 3)).contains("radius of the disc"));
    assert!(message(cylinder(1.0, 1.0, 2, 1)).contains("around must be at least 3, but it is 2"));
    assert!(
        message(cone(1.0, 1.0, Some(2.0), 6, 1))
            .contains("between 0 and 1 (exclusive), but it is 2")
    );
    assert!(message(spherical_cap(1.0, 4.0, None, 3)).contains("polar angle"));
    assert!(message(spherical_cap(1.0, 1.0, Some(1.5), 3)).contains("hole"));
    assert!(message(spherical_cap(1.0, 1.0, None, usize::MAX)).contains("coarser"));
    assert!(message(torus(1.0, 1.0, 6, 6)).contains("minor radius"));
    // Found by damaged scenes: both took all memory.
    assert!(message(spherical_cap(1.0, 1.0 + 1e-14, Some(1.0), 1)).contains("coarser"));
    assert!(cone(1e308, 1.0, Some(0.1), 6, 2).is_err());
}
