//! Shells whose rest forms are prescribed: by numbers, by layers that grow, and against the two.

use koiter::Vec3;
use koiter::scene::{NoFiles, Scene, SceneFile, Simulation};

/// A strip that only its rest forms bend, held without force at three corners; `shell` are more keys of it.
fn relaxed(size: [f64; 2], cells: [usize; 2], shell: &str) -> Simulation {
    let [length, width] = size;
    let (x, y) = (0.5 * length, 0.5 * width);
    let text = format!(
        r#"
time = {{ end = 1.0, dt = 1.0 }}
integrator = "quasi-static"
gravity = [0, 0, 0]
contact.enabled = false
[[shell]]
name = "strip"
mesh.grid = {{ size = [{length}, {width}], cells = {cells:?}, diagonals = "checkerboard" }}
{shell}
[[constraint]]
shell = "strip"
select.nearest = [-{x}, -{y}, 0]
[[constraint]]
shell = "strip"
select.nearest = [-{x}, {y}, 0]
axes = "xz"
[[constraint]]
shell = "strip"
select.nearest = [{x}, -{y}, 0]
axes = "z"
"#
    );
    let file = SceneFile::parse("scene.toml", &text, &[]).unwrap();
    let scene = Scene::build(&file, &NoFiles).unwrap();
    let mut simulation = Simulation::new(scene.model).unwrap();
    let report = simulation.step(1.0).unwrap();
    assert!(report.converged, "{:?}", report.diagnosis);
    simulation
}

/// Curvature of the circle through the middles of the ends and of the strip [1/m]; positive if the middle is up.
fn curvature(simulation: &Simulation, length: f64) -> f64 {
    let positions = simulation.shell_positions(0);
    let start = &simulation.model().shells[0].rest_positions;
    let at = |x: f64| -> Vec3 {
        let distance = |v: &usize| (start[*v] - Vec3::new(x, 0.0, 0.0)).norm();
        let nearest = (0..start.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        positions[nearest.unwrap()]
    };
    let (left, right, middle) = (at(-0.5 * length), at(0.5 * length), at(0.0));
    let rise = middle - 0.5 * (left + right);
    let half_chord = 0.5 * (right - left).norm();
    2.0 * rise.z.signum() * rise.norm() / (rise.norm_squared() + half_chord * half_chord)
}

#[test]
fn a_flat_strip_relaxes_to_the_cylinder_it_is_told() {
    for model in ["bac", "dcs", "dso", "dkt"] {
        let shell = format!(
            "bending = \"{model}\"\nthickness = 1e-3\nrest_curvature = [5.0, 0.0]\n\
             material = {{ young = 1e7, poisson = 0.3, density = 1000 }}"
        );
        let simulation = relaxed([0.2, 0.05], [20, 6], &shell);
        let found = curvature(&simulation, 0.2);
        // A chord of 1/20 rad is shorter than its arc by 1e-4; a cylinder fits both forms, so nothing else resists.
        assert!((found / 5.0 - 1.0).abs() < 1e-3, "{model}: {found}");
        let energy: f64 = simulation.energies().iter().map(|(_, value)| value).sum();
        let unbent = 1e7 * 1e-9 / 12.0 / (1.0 - 0.09) * 0.5 * 25.0 * 0.2 * 0.05;
        assert!(energy < 1e-3 * unbent, "{model}: {energy} of {unbent}");
    }
}

/// `κ = 6 (ε₁ − ε₂)(1 + m)² / (h (3 (1 + m)² + (1 + m n)(m² + 1/(m n))))`, m = h₁/h₂, n = E₁/E₂: Timoshenko (1925).
#[test]
fn a_bimetal_strip_curls_as_timoshenko_says() {
    let (lower, upper, misfit) = ([4e-4, 6e9], [6e-4, 2e9], 2e-3);
    let (m, n, h) = (
        lower[0] / upper[0],
        lower[1] / upper[1],
        lower[0] + upper[0],
    );
    let expected = 6.0 * misfit * (1.0f64 + m).powi(2)
        / (h * (3.0 * (1.0 + m).powi(2) + (1.0 + m * n) * (m * m + 1.0 / (m * n))));
    let shell = format!(
        "[shell.material]\nmodel = \"layered\"\npoisson = 0.3\ndensity = 8000\nlayers = [\n\
         {{ thickness = {}, young = {} }},\n{{ thickness = {}, young = {}, growth = [{misfit}, {misfit}] }} ]",
        lower[0], lower[1], upper[0], upper[1]
    );
    // So narrow that its double curvature costs no stretching: w² κ / h = 0.09.
    let found = curvature(&relaxed([0.1, 0.006], [40, 2], &shell), 0.1);
    assert!((found / expected - 1.0).abs() < 0.01, "{found} {expected}");
}

#[test]
fn an_axis_turns_prescribed_curvature() {
    let shell = "thickness = 1e-3\nrest_curvature = [5.0, 0.0]\n\
                 material = { young = 1e7, poisson = 0.3, density = 1000, axis = [0, 1, 0] }";
    let found = curvature(&relaxed([0.2, 0.05], [20, 6], shell), 0.2);
    assert!(found.abs() < 1e-3, "{found}");
}

#[test]
fn a_prescribed_stretch_lengthens_a_strip() {
    // Not a tension field: what is too short for its rest length is slack, and need not grow.
    for model in ["st-venant-kirchhoff", "neo-hookean"] {
        let shell = format!(
            "thickness = 1e-3\nrest_stretch = [1.1, 0.9]\n\
             material = {{ model = \"{model}\", young = 1e7, poisson = 0.3, density = 1000 }}"
        );
        let simulation = relaxed([0.2, 0.05], [8, 2], &shell);
        let (low, high) = bounds(&simulation.shell_positions(0));
        assert!(
            (high.x - low.x - 0.22).abs() < 1e-8,
            "{model}: {}",
            high.x - low.x
        );
        assert!(
            (high.y - low.y - 0.045).abs() < 1e-8,
            "{model}: {}",
            high.y - low.y
        );
    }
}

fn bounds(points: &[Vec3]) -> (Vec3, Vec3) {
    let first = (points[0], points[0]);
    points
        .iter()
        .fold(first, |(low, high), x| (low.inf(x), high.sup(x)))
}
