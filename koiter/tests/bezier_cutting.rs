//! Bézier shells that are cut and sewn: a tube of 2000 elements, paths at random.

use koiter::Vec3;
use koiter::bezier::{
    BezierError, BezierShell, Change, DeadLoad, Dynamics, ElementKind, MappedSurface, NewtonLimits,
    SeamAngle, Section, ShellOptions, Supports, SurfacePath, SurfacePoint, vertex_normals,
};
use koiter::mesh::generate::cylinder;

const AROUND: usize = 25;
const ALONG: usize = 40;

/// Uniform numbers in [0, 1): SplitMix64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn point(&mut self, elements: usize) -> SurfacePoint {
        let element = (self.next() * elements as f64) as usize;
        let (a, b) = (self.next().sqrt(), self.next());
        SurfacePoint {
            element,
            barycentric: [1.0 - a, a * (1.0 - b), a * b],
        }
    }
}

/// A vessel of 1 cm radius and 4 cm length.
fn tube() -> BezierShell {
    let surface = cylinder(0.01, 0.04, AROUND, ALONG).unwrap();
    let section = Section {
        youngs_modulus: 1e6,
        poissons_ratio: 0.4,
        thickness: 1e-3,
        density: 1000.0,
    };
    let options = ShellOptions {
        section,
        kind: ElementKind::Bezier,
        frame: None,
    };
    BezierShell::new(&surface, &vertex_normals(&surface), options).unwrap()
}

fn clamped_ends(shell: &BezierShell) -> Supports {
    let mut supports = Supports::none(shell.mesh().num_vertices());
    for (node, x) in shell.rest_pose().positions.iter().enumerate() {
        if x.z.abs() > 0.0199 {
            supports.clamp(node);
        }
    }
    supports
}

fn position(shell: &BezierShell, at: &SurfacePoint) -> Vec3 {
    let corners = shell.rest()[at.element].corners;
    (0..3).map(|c| corners[c] * at.barycentric[c]).sum()
}

/// Two points that a plane through both joins on the near side of the tube, away from its ends.
fn ends(random: &mut Random, shell: &BezierShell) -> [SurfacePoint; 2] {
    loop {
        let pair = [(); 2].map(|()| random.point(shell.elements().len()));
        let x = pair.each_ref().map(|p| position(shell, p));
        let angle = x[0].xy().angle(&x[1].xy());
        if angle < 1.2 && (x[0] - x[1]).norm() > 0.004 && x.iter().all(|x| x.z.abs() < 0.017) {
            return pair;
        }
    }
}

fn check(change: &Change, of: &BezierShell) {
    // Areas of parts add up, so masses do, to round-off of a thousand sums.
    assert!((change.shell.mass() / of.mass() - 1.0).abs() < 1e-12);
    let smallest = change
        .shell
        .elements()
        .iter()
        .map(|e| e.area())
        .fold(f64::INFINITY, f64::min);
    let of_tube = of.area() / of.elements().len() as f64;
    // An element that the path crosses is divided twice at most, each time at 0.2 of an edge or more.
    assert!(smallest > 0.03 * of_tube, "{smallest} {of_tube}");
}

/// One implicit step under weight.
fn step(shell: &BezierShell, supports: Supports) {
    let mut load = DeadLoad::none(shell.mesh().num_vertices());
    load.add_gravity(shell, Vec3::new(0.0, -9.81, 0.0));
    let mut moving = Dynamics::new(shell.clone(), supports);
    let edge = 1e-3;
    let outcome = moving
        .step(&mut [&mut load], 0.01, &NewtonLimits::for_edges(edge))
        .unwrap();
    assert!(outcome.converged, "{outcome:?}");
    assert!(moving.pose.is_finite() && moving.kinetic_energy() > 0.0);
}

#[test]
fn a_thousand_cuts_leave_shells_that_go_on_and_sewing_gives_back_what_was_cut() {
    let tube = tube();
    assert_eq!(tube.elements().len(), 2000);
    let rest = tube.rest_pose();
    let supports = clamped_ends(&tube);
    let mut random = Random(1);
    for number in 0..1000 {
        let [from, to] = ends(&mut random, &tube);
        let path = SurfacePath::between(&tube, &rest.positions, &from, &to).unwrap();
        assert!(path.nodes.len() >= 3, "{path:?}");
        let change = tube
            .cut(&path)
            .unwrap_or_else(|error| panic!("{number}: {error} {path:?}"));
        check(&change, &tube);
        // A slit inside: one more boundary, and a pair of vertices for each stop but the ends.
        assert_eq!(change.shell.mesh().boundary_loops().len(), 3, "{number}");
        assert_eq!(change.seam.len(), path.nodes.len() - 2);
        let pose = change.pose(&rest);
        let (sewn, after) = change
            .shell
            .sew(&change.seam, &pose, SeamAngle::Rest)
            .unwrap();
        check(&sewn, &tube);
        assert_eq!(sewn.shell.mesh().boundary_loops().len(), 2);
        assert!(sewn.shell.energy(&after).unwrap() < 1e-20);
        // A step takes as long as fifty cuts.
        if number % 100 == 0 {
            step(&change.shell, change.supports(&supports));
            step(&sewn.shell, sewn.supports(&change.supports(&supports)));
        }
    }
}

#[test]
fn cuts_upon_cuts_leave_a_shell_that_goes_on() {
    let mut shell = tube();
    let mut supports = clamped_ends(&shell);
    let mut random = Random(7);
    let mut cuts = 0;
    for _ in 0..40 {
        let [from, to] = ends(&mut random, &shell);
        let positions = shell.rest_pose().positions;
        // Paths end at the lips of earlier cuts.
        let change = match SurfacePath::between(&shell, &positions, &from, &to) {
            Ok(path) => match shell.cut(&path) {
                Ok(change) => change,
                Err(BezierError::Mesh(_) | BezierError::PathTooShort { .. }) => continue,
                Err(error) => panic!("{error}"),
            },
            Err(BezierError::PathLeavesSurface { .. }) => continue,
            Err(error) => panic!("{error}"),
        };
        assert!((change.shell.mass() / shell.mass() - 1.0).abs() < 1e-12);
        supports = change.supports(&supports);
        shell = change.shell;
        cuts += 1;
    }
    assert!(cuts >= 10, "{cuts}");
    step(&shell, supports);
}

#[test]
fn a_cut_from_the_rim_opens_under_pull_and_the_fine_surface_opens_with_it() {
    let tube = tube();
    let rest = tube.rest_pose();
    // The rim is at z = −0.02; the path runs up along the axis from its first vertices.
    let find = |z: f64| {
        let near = |f: &usize| {
            let center: Vec3 = tube.rest()[*f].corners.iter().sum::<Vec3>() / 3.0;
            (center - Vec3::new(0.01, 0.001, z)).norm()
        };
        (0..tube.elements().len())
            .min_by(|a, b| near(a).total_cmp(&near(b)))
            .unwrap()
    };
    let at = |element| SurfacePoint {
        element,
        barycentric: [1.0 / 3.0; 3],
    };
    let path =
        SurfacePath::between(&tube, &rest.positions, &at(find(-0.02)), &at(find(0.005))).unwrap();
    let change = tube.cut(&path).unwrap();
    assert_eq!(change.shell.mesh().boundary_loops().len(), 2);
    assert_eq!(change.seam.len(), path.nodes.len() - 1);
    let old = MappedSurface::subdivided(&tube, 4);
    let (fine, divided) = change.surface(&old);
    // Subdivided before the cut: triangles along 25 elements' length, a few each.
    assert!(divided > 10 && divided < 400, "{divided}");
    // Two more of each, but where the cut goes through a vertex.
    let more = fine.faces().len() - old.faces().len();
    assert!(more > divided && more <= 2 * divided, "{more} {divided}");
    let before = old.positions(&rest);
    let after = fine.positions(&change.pose(&rest));
    for (a, b) in before.iter().zip(&after) {
        // Divided elements have normals in between: another cubic, by less than the sagitta of a cell.
        assert!((a - b).norm() < 1e-4, "{a} {b}");
    }
    let area = |faces: &[[u32; 3]], x: &[Vec3]| -> f64 {
        let of = |f: &[u32; 3]| {
            let [a, b, c] = f.map(|v| x[v as usize]);
            0.5 * (b - a).cross(&(c - a)).norm()
        };
        faces.iter().map(of).sum()
    };
    // Nothing is missing along the cut, where a row of triangles left out would be 2e-3 of the tube.
    let areas = [area(old.faces(), &before), area(fine.faces(), &after)];
    assert!((areas[1] / areas[0] - 1.0).abs() < 2e-4, "{areas:?}");
    let fine = MappedSurface::subdivided(&change.shell, 2);
    let mut supports = Supports::none(change.shell.mesh().num_vertices());
    let mut load = DeadLoad::none(change.shell.mesh().num_vertices());
    for (node, x) in change.pose(&rest).positions.iter().enumerate() {
        if x.z > 0.0199 {
            supports.clamp(node);
        }
    }
    for [left, right] in &change.seam {
        load.add_force(*left as usize, Vec3::new(0.0, 0.002, 0.0));
        load.add_force(*right as usize, Vec3::new(0.0, -0.002, 0.0));
    }
    let mut moving = Dynamics::new(change.shell.clone(), supports);
    let outcome = moving
        .settle(&mut [&mut load], &NewtonLimits::for_edges(1e-3))
        .unwrap();
    assert!(outcome.converged, "{outcome:?}");
    let [left, right] = change.seam[0].map(|v| moving.pose.positions[v as usize]);
    assert!((left - right).norm() > 1e-4, "{}", (left - right).norm());
    assert!(
        fine.positions(&moving.pose)
            .iter()
            .all(|x| x.norm().is_finite())
    );
}

#[test]
fn paths_that_go_wrong_are_refused() {
    let tube = tube();
    let rest = tube.rest_pose();
    let at = |element| SurfacePoint {
        element,
        barycentric: [1.0 / 3.0; 3],
    };
    let between = |a, b| SurfacePath::between(&tube, &rest.positions, &at(a), &at(b));
    assert!(matches!(
        between(0, 5000),
        Err(BezierError::NoSuchElement { element: 5000, .. })
    ));
    // Within one element: nothing opens.
    let short = between(900, 900).unwrap();
    assert!(matches!(
        tube.cut(&short),
        Err(BezierError::PathTooShort { .. })
    ));
    let pose = tube.rest_pose();
    let refused = tube.sew(&[[3, 3]], &pose, SeamAngle::Rest).unwrap_err();
    assert!(matches!(
        refused,
        BezierError::NoSuchPair { pair: [3, 3], .. }
    ));
    // Neighbours: an element would lose a corner.
    let face = tube.mesh().faces()[0];
    let refused = tube
        .sew(&[[face[0], face[1]]], &pose, SeamAngle::Rest)
        .unwrap_err();
    assert!(matches!(refused, BezierError::Mesh(_)), "{refused}");
}
