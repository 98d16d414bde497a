//! A path by arc length ends where its load is reached, and goes on to the same end.

use std::fs;

use super::{Bench, EndState};

/// Two plates that lean against each other upside down, and are pushed up at the crease until they snap through.
const SCENE: &str = r#"title = "Path"
integrator = "arc-length"
time = { end = 100, dt = 0.5 }
gravity = [0, 0, 0]
contact.enabled = false
solver = { first_arc_length = 0.01, largest_arc_length = 0.02 }
output = { every_steps = 3, checkpoint_seconds = 0 }

[[shell]]
name = "plates"
material = { young = 1e6, poisson = 0.0, density = 1000.0 }
thickness = 1e-2
mesh.vee = { length = 0.5, width = 1.02, degrees = 157.38, along = 1, across = 2 }
rest = "mesh"

[[constraint]]
shell = "plates"
select.box = { min = [-9, -9, 0.19] }

[[constraint]]
shell = "plates"
select.box = { max = [9, 9, 0.01] }
axes = "xy"

[[load]]
name = "push"
shell = "plates"
select.box = { max = [9, 9, 0.01] }
force = [0, 0, 30]
scale = [[0, 0], [1, 1]]

[[probe]]
name = "load"
quantity = "load-factor"

[[probe]]
name = "crease"
quantity = "highest"
shell = "plates"
select.box = { max = [9, 9, 0.01] }
"#;

#[test]
fn a_path_ends_at_its_last_load_and_is_resumed_to_the_same_end() {
    let bench = Bench::new();
    fs::write(bench.path("scene.toml"), SCENE).unwrap();
    bench.finish("whole", &["--quiet"]);
    let whole = EndState::of(&bench.path("whole"));
    let loads: Vec<f64> = (whole.stats.iter())
        .map(|line| line["load_factor"].as_f64().unwrap())
        .collect();
    assert!(loads.len() < 200 && loads.last() == Some(&1.0), "{loads:?}");
    // It snapped through: the load fell on the way, and there the plates were not stable.
    let falls = loads.windows(2).filter(|pair| pair[1] < pair[0]).count();
    let unstable = whole.stats.iter().filter(|line| line["stable"] == false);
    assert!(falls > 3 && unstable.count() > 3, "{loads:?}");
    bench.finish("cut", &["--quiet", "--until", "5"]);
    bench.finish("cut", &["--quiet", "--resume"]);
    let cut = EndState::of(&bench.path("cut"));
    assert_eq!(cut.difference(&whole), None);
    // There is nothing left to do.
    bench.finish("cut", &["--quiet", "--resume"]);
    let again = EndState::of(&bench.path("cut"));
    assert_eq!(again.difference(&whole), None);
}
