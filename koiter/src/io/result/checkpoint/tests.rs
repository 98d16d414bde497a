use nalgebra::UnitQuaternion;

use super::*;
use crate::bezier::{ContactState, Pose};
use crate::contact::{Pair, PairKind};
use crate::scene::BezierState;

fn checkpoint() -> Checkpoint {
    Checkpoint {
        version: "0.1.0".into(),
        scene_text: "title = \"é\"\n".into(),
        bodies: vec![("cloth".into(), 7), ("ball".into(), u64::MAX)],
        snapshot: Snapshot {
            state: State {
                q: vec![0.1, -1e-300, 3.0],
                velocities: vec![0.0, -0.0, f64::MIN_POSITIVE],
                accelerations: vec![1.5, 0.0, -2.0],
                time: 1.0 / 3.0,
                step: 12,
                path: Some(PathPoint {
                    load_factor: -0.5,
                    arc_length: 1e-3,
                    increment: vec![0.25, 0.0, -1.0],
                }),
                memory: Memory::Before {
                    dt: 0.01,
                    q: vec![0.5],
                    velocities: vec![-0.5, 2.0],
                },
            },
            kappa: Some(1e5),
            turned: vec![7.5],
            share: 0.25,
            anchors: vec![Anchor {
                constraints: vec![2, 0],
                time: 0.5,
                q: vec![1.0, -0.0],
            }],
            rests: vec![RestState {
                curvature: vec![0.25, -3.5],
                flow: vec![0.5, 0.0],
                strain: vec![-0.125],
            }],
            angles: vec![vec![3.5, -0.25], vec![]],
            double_layers: vec![BurningState {
                positions: vec![Vec3::new(1.0, -2.0, 0.5); 2],
                velocities: vec![Vec3::zeros(), Vec3::x()],
                temperatures: vec![293.0, 506.5],
                mass_ratios: vec![1.0, 0.625],
            }],
            heated_shells: vec![HeatedState {
                temperatures: vec![293.0, 600.0],
                mass_ratios: vec![1.0, 0.75],
                torn: vec![3, 17],
            }],
            bezier: Some(BezierState {
                done: vec![pose(1)],
                pose: pose(2),
                velocities: vec![0.5; 12],
                couplings: vec![[0, 1]],
                contact: Some(ContactState {
                    kappa: 3.5,
                    obstacles: vec![Vec3::y()],
                    asleep: vec![Pair {
                        kind: PairKind::EdgeEdge,
                        vertices: [0, 1, 2, 7],
                    }],
                }),
            }),
            solver: WorkspaceHistory {
                changing_pairs: vec![[0, 1], [0, 7]],
                node_order: vec![2, 0, 1],
                entries_at_ordering: 99,
            },
        },
        totals: Totals {
            newton_iterations: 40,
            seconds_by_part: vec![("contact".into(), 0.25)],
            probes: vec![0.5, 2.5],
            ..Totals::default()
        },
    }
}

fn pose(nodes: usize) -> Pose {
    let turn = UnitQuaternion::from_scaled_axis(Vec3::new(0.3, -2.0, 0.1));
    Pose {
        positions: vec![Vec3::new(0.1, -2.5, 1e-300); nodes],
        rotations: vec![turn; nodes],
    }
}

#[test]
fn what_was_written_is_read_back() {
    let mut written = checkpoint();
    assert_eq!(
        Checkpoint::from_bytes(&written.to_bytes()).unwrap(),
        written
    );
    written.snapshot.kappa = None;
    written.snapshot.state.path = None;
    let implicit = Memory::Accelerated {
        stable: None,
        largest_kinetic: 0.25,
    };
    let explicit = Memory::Accelerated {
        stable: Some(StableStep {
            dt: 1e-4,
            found_for: 9e-5,
            age: 7,
            speed: 0.5,
            settings: vec![2.0, -1.0],
        }),
        largest_kinetic: 0.0,
    };
    for memory in [Memory::None, implicit, explicit] {
        written.snapshot.state.memory = memory;
        assert_eq!(
            Checkpoint::from_bytes(&written.to_bytes()).unwrap(),
            written
        );
    }
}

#[test]
fn every_cut_and_every_flipped_bit_is_noticed() {
    let good = checkpoint().to_bytes();
    for at in 0..good.len() {
        assert!(Checkpoint::from_bytes(&good[..at]).is_err(), "cut at {at}");
        for bit in 0..8 {
            let mut bad = good.clone();
            bad[at] ^= 1 << bit;
            assert!(Checkpoint::from_bytes(&bad).is_err(), "bit {bit} of {at}");
        }
    }
}

#[test]
fn lengths_are_not_trusted_even_under_an_honest_checksum() {
    let good = checkpoint().to_bytes();
    let end = good.len() - 4;
    let mut refused = 0;
    for at in 12..end {
        let mut bad = good.clone();
        let width = 8.min(end - at);
        bad[at..at + width].fill(0x7f);
        let checksum = crc32(&bad[..end]).to_le_bytes();
        bad[end..].copy_from_slice(&checksum);
        // Values may be anything; a length that does not fit must not be followed.
        refused += usize::from(Checkpoint::from_bytes(&bad).is_err());
    }
    assert!(refused > 50, "only {refused} refused");
}

#[test]
fn another_format_is_named() {
    let mut bytes = checkpoint().to_bytes();
    bytes[8] = 77;
    let error = Checkpoint::from_bytes(&bytes).unwrap_err().to_string();
    assert!(error.contains("version 77"), "{error}");
}
