//! Constraints in time: windows, release, twist, compression, clamps that turn.
#![cfg(feature = "serde")]

use koiter::Vec3;
use koiter::scene::{NoFiles, Scene, SceneFile, Simulation};

const STRIP: &str = r#"
time = { end = 1.0, dt = 0.1 }
gravity = [0, 0, 0]
contact.enabled = false

[[shell]]
name = "strip"
mesh.grid = { size = [0.4, 0.1], cells = [8, 2] }
material = { young = 1e6, poisson = 0.3, density = 1000 }
thickness = 1e-3
"#;

fn simulation(text: &str) -> Simulation {
    let file = SceneFile::parse("scene.toml", text, &[]).unwrap();
    let scene = Scene::build(&file, &NoFiles).unwrap();
    Simulation::new(scene.model).unwrap()
}

fn advance(simulation: &mut Simulation, steps: usize) {
    for _ in 0..steps {
        let report = simulation.step(0.1).unwrap();
        assert!(report.converged, "step {}", report.step);
    }
}

fn positions(text: &str, steps: usize) -> Vec<Vec3> {
    let mut simulation = simulation(text);
    advance(&mut simulation, steps);
    simulation.shell_positions(0)
}

/// The whole strip, held for a while.
fn all_held(window: &str) -> String {
    format!(
        "{STRIP}[[constraint]]\nshell = \"strip\"\nselect.all = true\n{window}\n\
         motion.translate = [[0, [0, 0, 0]], [1, [0, 0, 2]]]\n"
    )
}

#[test]
fn what_is_released_goes_on_with_its_velocity() {
    let mut simulation = simulation(&all_held("until = 0.5"));
    let start = simulation.shell_positions(0);
    advance(&mut simulation, 5);
    advance(&mut simulation, 5);
    for (x, start) in simulation.shell_positions(0).iter().zip(&start) {
        // Free flight at 2 m/s; Newton's tolerance is 1 mm/s.
        assert!((x - start - Vec3::new(0.0, 0.0, 2.0)).norm() < 1e-4);
    }
}

#[test]
fn what_begins_later_holds_things_where_they_are_and_makes_the_rest_of_its_motion() {
    let text = all_held("from = 0.5").replace("[0, 0, 0]\ncontact", "[0, 0, -9.81]\ncontact");
    let mut simulation = simulation(&text);
    let start = simulation.shell_positions(0)[0];
    advance(&mut simulation, 5);
    let fallen = simulation.shell_positions(0)[0] - start;
    // Implicit Euler falls g dt² n (n + 1) / 2 in n steps.
    assert!((fallen.z + 9.81 * 0.01 * 15.0).abs() < 1e-9, "{fallen}");
    assert_eq!(simulation.reaction(0), Vec3::zeros());
    advance(&mut simulation, 5);
    let lifted = simulation.shell_positions(0)[0] - start - fallen;
    // Exact: the vertex is prescribed, up to the rounding of times.
    assert!(
        (lifted - Vec3::new(0.0, 0.0, 1.0)).norm() < 1e-12,
        "{lifted}"
    );
    assert!(simulation.reaction(0).z > 0.0);
}

/// A strip whose left end turns by a right angle about its own edge: only a clamp can turn the rest.
fn turned(bending: &str, window: &str) -> String {
    let named = format!("name = \"strip\"\nbending = \"{bending}\"");
    let text = STRIP.replace("name = \"strip\"", &named);
    format!(
        "{text}\n[[constraint]]\nshell = \"strip\"\nselect.box = {{ max = [-0.2, 1, 1] }}\nclamp = true\n{window}\n\
         motion.rotate = {{ axis = [0, 1, 0], through = [-0.2, 0, 0], degrees = [[0, 0], [1, 90]] }}\n"
    )
    .replace("contact", "integrator = \"quasi-static\"\ncontact")
}

#[test]
fn a_clamp_that_turns_turns_its_directors() {
    for bending in ["bac", "dcs", "dkt"] {
        for x in positions(&turned(bending, ""), 10) {
            // Without a load the strip is rigid: it ends in the plane x = −0.2, hanging down.
            assert!((x.x + 0.2).abs() < 1e-5, "{bending}: {x}");
            assert!((-0.4 - 1e-5..1e-5).contains(&x.z), "{bending}: {x}");
        }
    }
}

#[test]
fn a_clamp_that_begins_later_turns_by_what_is_left() {
    let held = "[[constraint]]\nshell = \"strip\"\nselect.box = { max = [-0.2, 1, 1] }\nclamp = true\nuntil = 0.5\n";
    let half = std::f64::consts::FRAC_PI_4;
    let expected = [-0.2 + 0.4 * half.cos(), -0.4 * half.sin()];
    for bending in ["bac", "dkt"] {
        let text = turned(bending, "from = 0.5\n") + held;
        let tip = positions(&text, 10)[8];
        assert!((tip.x - expected[0]).abs() < 1e-5, "{bending}: {tip}");
        assert!((tip.z - expected[1]).abs() < 1e-5, "{bending}: {tip}");
    }
}

#[test]
fn ends_are_twisted_and_pushed_together_by_schedules() {
    let end = |name: &str, side: &str, degrees: f64| {
        format!(
            "[[constraint]]\nname = \"{name}\"\nshell = \"strip\"\nselect.box = {{ {side} = [{}0.2, {}1, {}1] }}\nclamp = true\n\
             motion.rotate = {{ axis = [1, 0, 0], degrees = [[0, 0], [1, {degrees}]] }}\n\
             motion.scale = {{ along = [1, 0, 0], factor = [[0, 1], [1, 0.9]] }}\n",
            if side == "max" { "-" } else { "" },
            if side == "max" { "" } else { "-" },
            if side == "max" { "" } else { "-" },
        )
    };
    let text = STRIP.replace("contact", "integrator = \"quasi-static\"\ncontact");
    let text = text + &end("left", "max", -45.0) + &end("right", "min", 45.0);
    let mut simulation = simulation(&text);
    let start = simulation.shell_positions(0);
    advance(&mut simulation, 10);
    let ends = simulation.shell_positions(0);
    let mut seen = 0;
    for (x, start) in ends.iter().zip(&start).filter(|(_, s)| s.x.abs() > 0.199) {
        let turned = start.y * std::f64::consts::FRAC_1_SQRT_2;
        let expected = Vec3::new(0.9 * start.x, turned, turned * start.x.signum());
        assert!((x - expected).norm() < 1e-12, "{x} for {expected}");
        seen += 1;
    }
    assert_eq!(seen, 6);
    // Compressed, the strip resists: the left end is pushed to the right.
    assert!(simulation.reaction(0).x > 0.0);
}

#[test]
fn loads_and_gravity_that_ramp_give_the_impulse_under_their_schedule() {
    let ramp = "[[0.2, 0], [0.7, 1], [0.8, 0]]";
    let load = |keys: &str| {
        let named = format!("[[load]]\nname = \"push\"\nshell = \"strip\"\nscale = {ramp}\n");
        format!("{STRIP}{named}{keys}\n")
    };
    // 0.12 N each, on 0.04 m² and 0.04 kg with an edge of 1 m.
    let cases = [
        load("force_per_area = [0, 0, 3]"),
        load("select.all = true\nforce = [0, 0, 0.12]"),
        load("select.boundary = 0\nforce_per_length = [0, 0, 0.12]"),
        STRIP
            .replace("[0, 0, 0]", "[0, 0, 3]")
            .replace("contact", &format!("gravity_scale = {ramp}\ncontact")),
    ];
    for text in cases {
        let mut simulation = simulation(&text);
        advance(&mut simulation, 10);
        let velocities = simulation.shell_velocities(0);
        let masses = simulation.masses().iter().step_by(3);
        let momentum: f64 = velocities.iter().zip(masses).map(|(v, m)| m * v.z).sum();
        // The sum of dt times the factors at the ends of steps is 0.3 s; Newton's tolerance is 1 mm/s.
        assert!(
            (momentum - 0.12 * 0.3).abs() < 0.04 * 1e-3,
            "{momentum} N s with\n{text}"
        );
    }
}
