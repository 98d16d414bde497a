use super::*;
use crate::mesh::generate::{GridDiagonals, grid};

fn setup(cells: usize) -> HeatedSetup {
    HeatedSetup {
        rest: grid(1.0, 1.0, cells, cells, GridDiagonals::Uniform).unwrap(),
        thickness: 1e-3,
        temperature: 300.0,
        ambient_temperature: 300.0,
        cooling_rate: 0.0,
        diffusivity: 0.0,
        diffusivity_factors: Vec::new(),
        exchange_rate: None,
        burning: BurningOptions::default(),
        loss_factors: Vec::new(),
        strength: f64::INFINITY,
    }
}

/// Burns for `seconds` under a hot strip about x = 0, on one side or on both.
fn burn(shell: &mut HeatedShell, sides: [bool; 2], seconds: f64) {
    let positions = shell.setup().rest.positions.clone();
    let strip = |x: &Vec3| f64::from(x.x.abs() < 0.11);
    let source = HeatSource {
        ball: None,
        temperature: 1000.0,
        rate: 25.0,
        intensity: positions.iter().map(strip).collect(),
    };
    let mut surround = |_: f64, sources: &mut [Vec<HeatSource>; 2]| {
        *sources = sides.map(|is_hot| if is_hot { vec![source.clone()] } else { vec![] });
    };
    for step in 0..(seconds / 0.01) as usize {
        let time = [0.01 * step as f64, 0.01];
        shell.burn(&positions, time, &mut surround).unwrap();
    }
}

#[test]
fn a_strip_that_burns_through_leaves_two_pieces() {
    let mut shell = HeatedShell::new(setup(20)).unwrap();
    burn(&mut shell, [true; 2], 0.5);
    let measures = shell.measures(&shell.setup().rest.positions);
    assert_eq!(measures.pieces, 2);
    // Five columns of vertices burn: four of cells between them, and of each beside them the share up to the level.
    assert!(
        measures.kept_area > 0.7 && measures.kept_area < 0.8,
        "{measures:?}"
    );
    assert_eq!(
        shell
            .faces_there()
            .iter()
            .filter(|is_there| !**is_there)
            .count(),
        160
    );
    // A saved state says all.
    let mut other = HeatedShell::new(setup(20)).unwrap();
    other.restore(shell.state()).unwrap();
    assert_eq!(other.surface().faces, shell.surface().faces);
    assert_eq!(other.faces_there(), shell.faces_there());
}

#[test]
fn what_is_heated_from_above_shrinks_above() {
    let mut shell = HeatedShell::new(setup(8)).unwrap();
    burn(&mut shell, [false, true], 0.1);
    let factors = shell.length_factors();
    assert!(
        factors
            .iter()
            .all(|[bottom, top]| *bottom == 1.0 && *top <= 1.0)
    );
    assert!(factors.iter().any(|[_, top]| *top < 0.9));
}

#[test]
fn everything_burnt_is_a_sensible_end() {
    let mut shell = HeatedShell::new(setup(4)).unwrap();
    let mut state = shell.state().clone();
    state.mass_ratios.fill(0.5);
    shell.restore(&state).unwrap();
    let measures = shell.measures(&shell.setup().rest.positions);
    assert_eq!((measures.kept_area, measures.pieces), (0.0, 0));
    assert_eq!(measures.highest_temperature, 0.0);
    burn(&mut shell, [true; 2], 0.1);
    assert!(shell.state().temperatures.iter().all(|t| t.is_finite()));
}

#[test]
fn a_crack_takes_the_face_that_is_stressed_most_and_leaves_its_neighbours() {
    let mut shell = HeatedShell::new(HeatedSetup {
        strength: 1e6,
        ..setup(4)
    })
    .unwrap();
    let mut stresses = vec![1.1e6; 32];
    stresses[7] = 1.3e6;
    stresses[31] = f64::NAN;
    shell.tear(&vec![0.9e6; 32]);
    assert!(shell.state().torn.is_empty());
    let count = shell.tear(&stresses);
    assert!(shell.state().torn.contains(&7));
    let mesh = &shell.setup().rest.mesh;
    let across = |edge: &crate::mesh::EdgeId| mesh.edge_faces()[edge.0 as usize];
    let beside = mesh.face_edges()[7].iter().flat_map(across).flatten();
    for FaceId(face) in beside.filter(|face| face.0 != 7) {
        assert!(!shell.state().torn.contains(&face));
    }
    assert_eq!(count, shell.state().torn.len());
    assert!(!shell.faces_there()[7]);
}

#[test]
fn states_of_other_shells_are_refused() {
    let mut shell = HeatedShell::new(setup(4)).unwrap();
    let sound = shell.state().clone();
    let changes: [fn(&mut HeatedState); 5] = [
        |state| state.temperatures.truncate(3),
        |state| state.temperatures[3] = f64::NAN,
        |state| state.mass_ratios[3] = 1.5,
        |state| state.torn = vec![99],
        |state| state.torn = vec![2, 1],
    ];
    for change in changes {
        let mut state = sound.clone();
        change(&mut state);
        assert!(shell.restore(&state).is_err());
        assert_eq!(shell.state(), &sound);
    }
}
