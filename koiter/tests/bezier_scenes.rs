//! Scenes with Bézier shells: what is refused, what they give, and that a saved run goes on to the same bits.
#![cfg(feature = "io")]

use std::time::Duration;

use koiter::Vec3;
use koiter::bezier::Drag;
use koiter::integrate::StepReport;
use koiter::io::Checkpoint;
use koiter::io::result::Totals;
use koiter::scene::{NoFiles, Scene, SceneError, SceneFile, Simulation};

/// A tube that is cut open, pulled apart and patched.
const VESSEL: &str = r#"
time = { end = 1.0, dt = 0.02 }
gravity = [0, 0, 0]
[[bezier_shell]]
name = "vessel"
mesh.cylinder = { radius = 0.01, height = 0.04, around = 12, along = 12 }
material = { young = 5e5, poisson = 0.4, density = 1100 }
thickness = 1e-3
damping = 20
surface.subdivide = 2
[[constraint]]
name = "foot"
shell = "vessel"
select.box = { max = [1, 1, -0.0199] }
clamp = true
[[constraint]]
name = "head"
shell = "vessel"
select.box = { min = [-1, -1, 0.0199] }
clamp = true
motion.translate = [[0, [0, 0, 0]], [0.2, [0, 0, 1e-3]]]
motion.rotate = { axis = [0, 0, 1], degrees = [[0, 0], [0.2, 10]] }
[[procedure]]
name = "incision"
at = 0.04
cut = { shell = "vessel", path = [[0.01, 0, -0.011], [0.01, 0, 0.011]] }
[[procedure]]
name = "hooks"
at = 0.04
open = { cut = "incision", force = 0.02, lift = 0.01, ramp = 0.06, until = 0.12 }
[[procedure]]
name = "patch"
at = 0.12
patch = { cut = "incision", width = 0.01, across = 4 }
[[probe]]
name = "head_height"
quantity = "position"
shell = "vessel"
select.box = { min = [-1, -1, 0.0199] }
axis = "z"
[contact]
enabled = false
"#;

/// A plate that a ball dents.
const PLATE: &str = r#"
time = { end = 0.4, dt = 0.02 }
gravity = [0, 0, 0]
[[bezier_shell]]
name = "plate"
mesh.grid = { size = [0.2, 0.2], cells = [6, 6] }
material = { young = 1e6, poisson = 0.3, density = 1000 }
thickness = 4e-3
contact_thickness = 4e-3
damping = 5
friction = 0.5
[[constraint]]
name = "rim"
shell = "plate"
select.boundary = 0
[[obstacle]]
name = "ball"
sphere = { radius = 0.03 }
translate = [0.01, 0, 0.034]
friction = 0.5
motion.translate = [[0, [0, 0, 0]], [0.4, [0, 0, -0.02]]]
[contact]
d_hat = 1e-3
kappa = 20.0
[[probe]]
name = "lowest"
quantity = "lowest"
shell = "plate"
[[probe]]
name = "push"
quantity = "reaction"
constraint = "rim"
axis = "z"
"#;

/// A sheet that a ball dents beside a cut, whose lips are pulled apart, let go and pressed together.
const SKIN: &str = r#"
time = { end = 0.8, dt = 0.02 }
gravity = [0, 0, 0]
[[bezier_shell]]
name = "skin"
mesh.grid = { size = [0.2, 0.1], cells = [10, 5] }
material = { young = 1e6, poisson = 0.3, density = 1000 }
thickness = 4e-3
damping = 20
[[constraint]]
name = "rim"
shell = "skin"
select.boundary = 0
clamp = true
[[obstacle]]
name = "ball"
sphere = { radius = 0.02 }
translate = [0.07, 0, -0.0205]
motion.translate = [[0, [0, 0, 0]], [0.2, [0, 0, 2e-3]]]
[contact]
d_hat = 2e-4
kappa = 20.0
[[procedure]]
name = "incision"
at = 0.2
cut = { shell = "skin", path = [[-0.06, 0, 0], [0.02, 0, 0]] }
[[procedure]]
name = "hooks"
at = 0.2
open = { cut = "incision", force = 0.2, ramp = 0.1, until = 0.4 }
[[procedure]]
name = "press"
at = 0.4
open = { cut = "incision", force = -0.05, ramp = 0.1, until = 0.8 }
"#;

fn build(text: &str, overrides: &[&str]) -> Result<Scene, SceneError> {
    let overrides: Vec<String> = overrides.iter().map(|o| (*o).to_owned()).collect();
    let file = SceneFile::parse("scene.toml", text, &overrides)?;
    Scene::build(&file, &NoFiles)
}

fn simulation(text: &str) -> Simulation {
    Simulation::new(build(text, &[]).unwrap().model).unwrap()
}

fn through_a_file(simulation: &Simulation) -> Checkpoint {
    let checkpoint = Checkpoint {
        version: String::new(),
        scene_text: String::new(),
        bodies: Vec::new(),
        snapshot: simulation.snapshot(),
        totals: Totals::default(),
    };
    Checkpoint::from_bytes(&checkpoint.to_bytes()).unwrap()
}

#[test]
fn a_run_from_any_checkpoint_has_the_same_bits() {
    for (text, steps) in [(VESSEL, 9), (PLATE, 6)] {
        let (mut through, mut paused) = (simulation(text), simulation(text));
        for _ in 0..steps {
            let report = through.step(0.02).unwrap();
            assert!(report.converged, "{:?}", report.diagnosis);
            let again = through_a_file(&paused);
            paused = simulation(text);
            paused.restore(&again.snapshot).unwrap();
            paused.step(0.02).unwrap();
        }
        assert_eq!(through.snapshot(), paused.snapshot());
        let mut wrong = through.snapshot();
        wrong.bezier.as_mut().unwrap().velocities.pop();
        assert!(through.restore(&wrong).is_err());
        assert_eq!(through.snapshot(), paused.snapshot());
    }
}

/// How far the lips of a cut are apart, each pair across the path, which is the x axis [m].
fn openings(simulation: &Simulation) -> Vec<f64> {
    let played = simulation.interaction(0.02).unwrap().dynamics;
    let rest = played.shell.rest_pose().positions;
    let now = &played.pose.positions;
    let pair = |left: usize| {
        let right = (left + 1..rest.len()).find(|right| rest[*right] == rest[left])?;
        Some(now[left].y - now[right].y)
    };
    (0..rest.len()).filter_map(pair).collect()
}

/// The lips of a cut sleep while they are closed and wake as they open; then they hold each other off, where without contact
/// they go through each other. A ball beside the cut is felt all the while, and a saved run goes on to the same bits.
#[test]
fn contact_goes_on_through_a_cut() {
    let (mut through, mut paused) = (simulation(SKIN), simulation(SKIN));
    let mut asleep = Vec::new();
    let measure = |report: &StepReport, name: &str| {
        let found = report.measures.iter().find(|m| m.0 == name);
        found.unwrap_or_else(|| panic!("{name} is measured")).1
    };
    for step in 1..=40 {
        let report = through.step(0.02).unwrap();
        assert!(report.converged, "{step}: {:?}", report.diagnosis);
        assert!(report.min_gap > 0.0, "{step}");
        asleep.push(measure(&report, "sleeping_pairs"));
        if step > 5 {
            assert!(measure(&report, "pushed_vertices") > 0.0, "{step}");
        }
        // Saved while pairs sleep and after.
        if [11, 14, 22].contains(&step) {
            paused = simulation(SKIN);
            paused.restore(&through_a_file(&through).snapshot).unwrap();
        } else if step > 11 {
            paused.step(0.02).unwrap();
        }
    }
    assert_eq!(through.snapshot(), paused.snapshot());
    assert!(asleep[..10].iter().all(|count| *count == 0.0), "{asleep:?}");
    assert!(
        asleep[10] > 20.0 && asleep[39] < 0.1 * asleep[10],
        "{asleep:?}"
    );
    // Pressed together the lips stay apart …
    let apart = openings(&through);
    assert!(
        apart.len() >= 6 && apart.iter().all(|gap| *gap > 0.0),
        "{apart:?}"
    );
    // … and without contact they do not.
    let mut alone = simulation(&SKIN.replace("[contact]", "[contact]\nenabled = false"));
    for _ in 0..40 {
        alone.step(0.02).unwrap();
    }
    let overlap = openings(&alone);
    assert!(overlap.iter().any(|gap| *gap < -5e-5), "{overlap:?}");
}

/// A vessel is cut, opened, patched and closed with contact, as without.
#[test]
fn contact_goes_on_through_a_patch() {
    let with = VESSEL.replace("enabled = false", "enabled = true");
    let (mut with, mut without) = (simulation(&with), simulation(VESSEL));
    for step in 1..=8 {
        let report = with.step(0.02).unwrap();
        assert!(report.converged && report.min_gap > 0.0, "{step}");
        without.step(0.02).unwrap();
    }
    let [a, b] = [&with, &without].map(|simulation| simulation.snapshot().bezier.unwrap().pose);
    // Nothing has touched anything. Without contact Newton's method stops at 1 mm/s times the step.
    for (x, y) in a.positions.iter().zip(&b.positions) {
        assert!((x - y).norm() < 2e-5, "{x} {y}");
    }
}

#[test]
fn frames_have_the_faces_there_are_and_procedures_leave_them_whole() {
    let mut simulation = simulation(VESSEL);
    let count = |simulation: &Simulation| {
        let parts = simulation.present_parts().unwrap();
        let vertices: usize = parts.iter().map(|part| part.num_vertices).sum();
        assert_eq!(simulation.display_positions().len(), vertices);
        let faces: usize = parts.iter().map(|part| part.faces.len()).sum();
        for (_, values) in simulation.face_fields() {
            assert_eq!(values.len(), faces);
            assert!(values.iter().all(|value| value.is_finite()));
        }
        (parts.len(), faces)
    };
    let whole = count(&simulation);
    assert_eq!(whole, (1, 2 * 12 * 12 * 4));
    for _ in 0..8 {
        simulation.step(0.02).unwrap();
    }
    let patched = count(&simulation);
    // Divided elements, and a patch of eight or more, of four triangles each; results have as many parts as at the start.
    assert_eq!(patched.0, 1);
    assert!(patched.1 > whole.1 + 4 * 8, "{patched:?}");
    // The upper end is held and has been moved.
    let head = &simulation.shell_positions(0)[12 * 12];
    assert!((head.z - 0.02 - 0.8e-3).abs() < 1e-12, "{head}");
    let energy = |name: &str| {
        let energies = simulation.energies();
        energies.iter().find(|(n, _)| n == name).unwrap().1
    };
    assert!(energy("elastic") > 0.0 && energy("kinetic") > 0.0);
}

#[test]
fn a_ball_dents_a_plate_and_the_rim_carries_it() {
    let scene = build(PLATE, &[]).unwrap();
    let mut simulation = Simulation::new(scene.model).unwrap();
    let mut pushed = 0.0;
    for _ in 0..20 {
        let report = simulation.step(0.02).unwrap();
        assert!(report.converged, "{:?}", report.diagnosis);
        pushed = report
            .measures
            .iter()
            .find(|m| m.0 == "pushed_vertices")
            .unwrap()
            .1;
    }
    assert!(pushed > 0.0);
    let [lowest, push] = [0, 1].map(|k| scene.probes[k].measure(&simulation)[0]);
    // The ball stands 16 mm below where it would touch; the barrier keeps up to a millimetre between.
    assert!((-0.0185..-0.0145).contains(&lowest), "{lowest}");
    // The plate pushes back: its rim is held down against nothing but the ball.
    assert!(push > 0.0, "{push}");
}

#[test]
fn a_roof_is_the_roof_of_the_bench() {
    let text = include_str!("../../scenes/scordelis-lo-bezier/scene.toml");
    // The table of benchmarks/bezier-shell: 1 %.
    for (element, expected) in [
        ("bezier", 0.1448),
        ("bezier-paper", 0.1195),
        ("dkt-andes", 0.1519),
    ] {
        let element = format!("bezier_shell.roof.element=\"{element}\"");
        let scene = build(text, &["resolution=tiny", &element]).unwrap();
        let mut simulation = Simulation::new(scene.model).unwrap();
        assert!(simulation.step(1.0).unwrap().converged);
        let sinks = -scene.probes[0].measure(&simulation)[0];
        assert!((sinks / expected - 1.0).abs() < 0.01, "{element}: {sinks}");
        // 90 an area of the quarter.
        let weight = 90.0 * 25.0 * 25.0 * 40f64.to_radians();
        let support = scene.probes[1].measure(&simulation)[0];
        // Symmetry planes carry nothing of it; facets of 5° are smaller than the cylinder by 3e-4.
        assert!((support / weight - 1.0).abs() < 1e-3, "{support} {weight}");
    }
}

#[test]
fn what_cannot_be_is_refused_where_it_stands() {
    let cases = [
        (
            VESSEL,
            "bezier_shell.vessel.thicknes=1",
            "bezier_shell.vessel.thicknes",
        ),
        (
            VESSEL,
            "bezier_shell.vessel.thickness=-1",
            "bezier_shell.vessel.thickness",
        ),
        (
            VESSEL,
            "bezier_shell.vessel.thickness=nan",
            "bezier_shell.vessel.thickness",
        ),
        (
            VESSEL,
            "bezier_shell.vessel.element=\"bezir\"",
            "bezier_shell.vessel.element",
        ),
        (
            VESSEL,
            "bezier_shell.vessel.damping=-1",
            "bezier_shell.vessel.damping",
        ),
        (
            VESSEL,
            "bezier_shell.vessel.surface.subdivide=0",
            "bezier_shell.vessel.surface.subdivide",
        ),
        (
            VESSEL,
            "bezier_shell.vessel.material.model=\"neo-hookean\"",
            "bezier_shell.vessel.material.model",
        ),
        (
            VESSEL,
            "constraint.foot.shell=\"vesel\"",
            "constraint.foot.shell",
        ),
        (VESSEL, "constraint.foot.from=0.1", "constraint.foot.from"),
        (VESSEL, "integrator=\"bdf2\"", "integrator"),
        (VESSEL, "procedure.hooks.at=-1", "procedure.hooks.at"),
        (VESSEL, "procedure.hooks.at=0.01", "procedure.hooks.at"),
        (
            VESSEL,
            "procedure.hooks.open.cut=\"incison\"",
            "procedure.hooks.open.cut",
        ),
        (
            VESSEL,
            "procedure.incision.cut.path=[[0.01,0,0]]",
            "procedure.incision.cut.path",
        ),
        // Beyond the end of the tube.
        (
            VESSEL,
            "procedure.incision.cut.path=[[0.01,0,0],[0.01,0,0.09]]",
            "procedure.incision.cut.path",
        ),
        (
            VESSEL,
            "procedure.patch.patch.width=0",
            "procedure.patch.patch.width",
        ),
        (
            VESSEL,
            "procedure.patch.patch.across=1",
            "procedure.patch.patch.across",
        ),
        (
            PLATE,
            "obstacle.ball.sphere.radius=-1",
            "obstacle.ball.sphere.radius",
        ),
    ];
    for (text, change, path) in cases {
        let error = build(text, &[change]).map(|_| ()).expect_err(change);
        assert_eq!(error.path, path, "{change}: {error}");
    }
    // A start that touches, a barrier as large as the triangles, a fine surface far away.
    for change in [
        "obstacle.ball.translate=[0.01,0,0.031]",
        "contact.d_hat=0.05",
        "bezier_shell.plate.surface.mesh={grid={size=[0.2,0.2],cells=[8,8]},translate=[0,0,1]}",
    ] {
        let scene = build(PLATE, &[change]).unwrap();
        assert!(Simulation::new(scene.model).is_err(), "{change}");
    }
}

#[test]
fn a_mesh_that_is_bound_to_a_shell_goes_with_it_and_is_divided_by_a_cut() {
    let fine =
        "bezier_shell.vessel.surface.mesh={cylinder={radius=0.01,height=0.04,around=40,along=40}}";
    let scene = build(VESSEL, &[fine]).unwrap();
    let mut simulation = Simulation::new(scene.model).unwrap();
    let faces = |simulation: &Simulation| -> Vec<usize> {
        let parts = simulation.present_parts().unwrap();
        parts.iter().map(|part| part.faces.len()).collect()
    };
    assert_eq!(faces(&simulation), [2 * 40 * 40]);
    for _ in 0..8 {
        simulation.step(0.02).unwrap();
    }
    let now = faces(&simulation);
    // Divided along 22 of 40 mm, a millimetre each, and a patch beside it.
    assert!(now[0] > 2 * 40 * 40 + 2 * 20 + 4 * 8, "{now:?}");
}

#[test]
fn shells_of_a_scene_can_be_dragged_and_do_not_go_through_obstacles() {
    let mut simulation = simulation(PLATE);
    simulation.step(0.02).unwrap();
    let mut played = simulation.interaction(0.02).unwrap();
    let shell = &played.dynamics.shell;
    let (_, point) = shell.nearest(&Vec3::new(0.01, 0.0, 0.0), |_| true).unwrap();
    // Upwards into the ball, whose lowest point stands 4 mm above the midsurface at the start.
    let target = Vec3::new(0.01, 0.0, 0.02);
    played.drags.push(Drag {
        point,
        target,
        stiffness: 50.0,
    });
    for _ in 0..40 {
        let report = played.frame(Duration::from_secs(10));
        assert!(!report.held, "{report:?}");
    }
    let contact = played.contact.as_ref().unwrap();
    assert!(!contact.forces(&played.dynamics.pose).is_empty());
    let centre = contact.obstacles()[0];
    let nearest = (contact.mapped().positions(&played.dynamics.pose).iter())
        .map(|x| (x - centre).norm())
        .fold(f64::INFINITY, f64::min);
    // The ball and half of the plate.
    assert!(nearest > 0.032, "{nearest}");
}

#[test]
fn a_cut_is_closed_to_what_it_was_and_two_strips_are_sewn_into_one() {
    let patch = "patch = { cut = \"incision\", width = 0.01, across = 4 }";
    let close = VESSEL.replace(patch, "close = { cut = \"incision\" }");
    assert_ne!(close, VESSEL);
    let mut simulation = simulation(&close);
    let mut elastic = Vec::new();
    for _ in 0..9 {
        let report = simulation.step(0.02).unwrap();
        assert!(report.converged, "{:?}", report.diagnosis);
        elastic.push(report.energies.iter().find(|e| e.0 == "elastic").unwrap().1);
    }
    // What the hooks had bent in six steps is straight again after the seventh; the upper end goes on to turn.
    assert!(
        elastic[6] < 0.9 * elastic[5] && elastic[7] > elastic[6],
        "{elastic:?}"
    );
    let strips = r#"
time = { end = 0.1, dt = 0.02 }
integrator = "quasi-static"
gravity = [0, 0, -9.81]
contact.enabled = false
[[bezier_shell]]
name = "left"
mesh.grid = { size = [0.1, 0.04], cells = [6, 3] }
material = { young = 1e7, poisson = 0.3, density = 1000 }
thickness = 2e-3
[[bezier_shell]]
name = "right"
mesh.grid = { size = [0.1, 0.04], cells = [6, 3] }
mesh.translate = [0.101, 0, 0]
material = { young = 1e7, poisson = 0.3, density = 1000 }
thickness = 1e-3
[[constraint]]
shell = "left"
select.box = { max = [-0.0499, 1, 1] }
clamp = true
[[constraint]]
shell = "right"
select.box = { min = [0.1509, -1, -1] }
clamp = true
[[procedure]]
name = "seam"
at = 0.0
sew = { first = { shell = "left", select = { box = { min = [0.0499, -1, -1] } } }, second = { shell = "right", select = { box = { max = [0.0511, 1, 1] } } }, reach = 2e-3 }
[[probe]]
name = "sag"
quantity = "displacement"
shell = "right"
select.nearest = [0.051, 0, 0]
axis = "z"
"#;
    let scene = build(strips, &[]).unwrap();
    let mut simulation = Simulation::new(scene.model).unwrap();
    let report = simulation.step(0.02).unwrap();
    assert!(report.converged, "{:?}", report.diagnosis);
    let sag = scene.probes[0].measure(&simulation)[0];
    assert!((-0.05..-1e-4).contains(&sag), "{sag}");
    // One shell: the edge of the left strip is that of the right one.
    let [left, right] = [0, 1].map(|shell| simulation.shell_positions(shell));
    assert_eq!(left[6], right[0]);
    let far = build(strips, &["procedure.seam.sew.reach=5e-4"]).unwrap();
    let refused = Simulation::new(far.model).unwrap().step(0.02).unwrap_err();
    assert!(refused.to_string().contains("'seam'"), "{refused}");
}
