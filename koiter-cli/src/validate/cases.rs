//! The cases: scenes and values of `benchmarks/`.

use super::case::{Case, Question, Side};

macro_rules! benchmark {
    ($file:literal) => {
        include_str!(concat!("../../../benchmarks/", $file))
    };
}

const PLATE: Case = Case {
    name: "",
    title: "",
    scene: benchmark!("square-plate/scene.toml"),
    set: &[],
    cells_key: "shell.plate.mesh.grid.cells",
    levels: &[&[24, 24], &[48, 48], &[96, 96]],
    question: Question::End(&[]),
    table: benchmark!("square-plate/reference.csv"),
    tolerance: 0.01,
    by_extrapolation: false,
};

const POINT: [&str; 2] = [
    "load.pressure.scale=[[0.0, 0.0]]",
    "load.point.scale=[[0.0, 1.0]]",
];

const FREQUENCIES: Case = Case {
    scene: benchmark!("plate-frequencies/scene.toml"),
    levels: &[&[16, 16], &[32, 32], &[64, 64]],
    table: benchmark!("plate-frequencies/reference.csv"),
    ..PLATE
};

/// Held along the edge at x = −L/2.
const ROOT: &str = "constraint.rim.select={ box = { max = [-0.49999, 1.0, 1.0] } }";
const CLAMPED: &str = "constraint.rim.clamp=true";

const ROOF: Case = Case {
    scene: benchmark!("scordelis-lo-roof/scene.toml"),
    table: benchmark!("scordelis-lo-roof/reference.csv"),
    cells_key: "shell.roof.mesh.panel.cells",
    levels: &[&[16, 16], &[32, 32], &[64, 64]],
    tolerance: 0.03,
    by_extrapolation: true,
    ..PLATE
};

const HEMISPHERE: Case = Case {
    scene: benchmark!("pinched-hemisphere/scene.toml"),
    cells_key: "shell.shell.mesh.cap.rings",
    tolerance: 0.03,
    by_extrapolation: true,
    ..PLATE
};

const STRIP: Case = Case {
    scene: benchmark!("euler-strip/scene.toml"),
    table: benchmark!("euler-strip/loads.csv"),
    cells_key: "shell.strip.mesh.grid.cells",
    levels: &[&[12, 2], &[24, 4], &[48, 8]],
    ..PLATE
};

const LARGE: Case = Case {
    cells_key: "shell.strip.mesh.grid.cells",
    levels: &[&[20, 2], &[40, 4], &[80, 8]],
    tolerance: 0.03,
    ..PLATE
};

/// All of them, in the order of the table.
pub(super) const CASES: &[Case] = &[
    Case {
        name: "plate-supported-pressure",
        title: "square plate, simply supported, under pressure: w D / (q a⁴)",
        question: Question::End(&[("centre", -1.0, "supported_pressure")]),
        ..PLATE
    },
    Case {
        name: "plate-supported-point",
        title: "square plate, simply supported, under a force at its centre: w D / (P a²)",
        set: &POINT,
        question: Question::End(&[("centre", -1.0, "supported_point")]),
        ..PLATE
    },
    Case {
        name: "plate-clamped-pressure",
        title: "square plate, clamped, under pressure: w D / (q a⁴)",
        set: &[CLAMPED],
        question: Question::End(&[("centre", -1.0, "clamped_pressure")]),
        ..PLATE
    },
    Case {
        name: "plate-clamped-point",
        title: "square plate, clamped, under a force at its centre: w D / (P a²)",
        set: &[CLAMPED, POINT[0], POINT[1]],
        question: Question::End(&[("centre", -1.0, "clamped_point")]),
        ..PLATE
    },
    Case {
        name: "frequencies-supported",
        title: "square plate, simply supported: ω a² √(ρ h / D)",
        question: Question::Vibration {
            skipped: 0,
            plate: "SSSS",
        },
        ..FREQUENCIES
    },
    Case {
        name: "frequencies-clamped",
        title: "square plate, clamped: ω a² √(ρ h / D)",
        set: &[CLAMPED],
        question: Question::Vibration {
            skipped: 0,
            plate: "CCCC",
        },
        ..FREQUENCIES
    },
    Case {
        name: "frequencies-cantilever",
        title: "square plate, clamped at one side: ω a² √(ρ h / D)",
        set: &[CLAMPED, ROOT],
        question: Question::Vibration {
            skipped: 0,
            plate: "CFFF",
        },
        ..FREQUENCIES
    },
    Case {
        name: "frequencies-free",
        title: "square plate, free (NAFEMS FV12): ω a² √(ρ h / D)",
        // Held along x at one point, which bending does not notice; five motions without resistance are left.
        set: &[
            "constraint.rim.select={ nearest = [0.0, 0.0, 0.0] }",
            "constraint.rim.axes=x",
        ],
        question: Question::Vibration {
            skipped: 5,
            plate: "FFFF",
        },
        ..FREQUENCIES
    },
    Case {
        name: "frequencies-cantilever-2",
        title: "plate twice as long as wide, clamped at its short side: ω L² √(ρ h / D)",
        set: &[CLAMPED, ROOT, "shell.plate.mesh.grid.size=[1.0, 0.5]"],
        levels: &[&[16, 8], &[32, 16], &[64, 32]],
        question: Question::Vibration {
            skipped: 0,
            plate: "cantilever-2",
        },
        ..FREQUENCIES
    },
    Case {
        name: "frequencies-cantilever-5",
        title: "plate five times as long as wide, clamped at its short side: ω L² √(ρ h / D)",
        set: &[CLAMPED, ROOT, "shell.plate.mesh.grid.size=[1.0, 0.2]"],
        levels: &[&[20, 4], &[40, 8], &[80, 16]],
        question: Question::Vibration {
            skipped: 0,
            plate: "cantilever-5",
        },
        ..FREQUENCIES
    },
    Case {
        name: "euler-hinged",
        title: "Euler's strip, hinged at both ends: P L² / (π² B)",
        question: Question::Buckling("hinged-hinged"),
        ..STRIP
    },
    Case {
        name: "euler-clamped-free",
        title: "Euler's strip, clamped at one end: P L² / (π² B)",
        set: &[
            "constraint.left.clamp=true",
            "constraint.right.select={ box = { max = [0.0, 1.0, 1.0] } }",
        ],
        question: Question::Buckling("clamped-free"),
        ..STRIP
    },
    Case {
        name: "euler-clamped-hinged",
        title: "Euler's strip, clamped and hinged: P L² / (π² B)",
        set: &["constraint.left.clamp=true"],
        question: Question::Buckling("clamped-hinged"),
        ..STRIP
    },
    Case {
        name: "euler-postbuckling",
        title: "Euler's strip beyond buckling, hinged at both ends: lengths over L",
        question: Question::Path {
            load: "load over the buckling load",
            unit: "L",
            probes: &[
                ("end", -1.0, 0.0, Side::Known, "end_shortening"),
                ("middle", 1.0, 0.0, Side::Either, "middle_deflection"),
            ],
        },
        table: benchmark!("euler-strip/postbuckling.csv"),
        ..STRIP
    },
    Case {
        name: "heavy-elastica",
        title: "a clamped strip under its own weight, Γ up to 100: lengths over L",
        scene: benchmark!("heavy-elastica/scene.toml"),
        table: benchmark!("heavy-elastica/elastica.csv"),
        question: Question::Path {
            load: "load Γ = ρ g h L³ / B",
            unit: "L",
            probes: &[
                ("tip.z", -1.0, 0.0, Side::Known, "drop"),
                ("tip.x", 1.0, 1.0, Side::Known, "reach"),
            ],
        },
        tolerance: 0.01,
        ..LARGE
    },
    Case {
        name: "roof-original",
        title: "Scordelis–Lo roof on diaphragms: displacements up and down",
        question: Question::End(&[
            ("edge", -1.0, "original_edge"),
            ("crown", 1.0, "original_crown_up"),
        ]),
        ..ROOF
    },
    Case {
        name: "roof-clamped",
        title: "Scordelis–Lo roof, clamped: displacements up and down",
        set: &[
            "constraint.near_end.axes=xyz",
            "constraint.near_end.clamp=true",
            "constraint.far_end.axes=xyz",
            "constraint.far_end.clamp=true",
        ],
        question: Question::End(&[
            ("edge", -1.0, "clamped_edge"),
            ("crown", 1.0, "clamped_crown_up"),
        ]),
        ..ROOF
    },
    Case {
        name: "hemisphere-linear",
        title: "pinched hemisphere, small displacements: at a force, P = 2",
        set: &[
            "integrator=linear-static",
            "time.dt=1.0",
            "load.right.force=[2.0, 0.0, 0.0]",
            "load.left.force=[-2.0, 0.0, 0.0]",
            "load.back.force=[0.0, -2.0, 0.0]",
            "load.front.force=[0.0, 2.0, 0.0]",
        ],
        question: Question::End(&[("outward", 1.0, "linear")]),
        table: benchmark!("pinched-hemisphere/reference.csv"),
        levels: &[&[16], &[32], &[64]],
        ..HEMISPHERE
    },
    Case {
        name: "hemisphere-large",
        title: "pinched hemisphere, large displacements (Sze 3.4): P up to 400",
        tolerance: 0.015,
        question: Question::Path {
            load: "force over 400 N",
            unit: "m",
            probes: &[
                ("outward", 1.0, 0.0, Side::Known, "outward"),
                ("inward", -1.0, 0.0, Side::Known, "inward"),
            ],
        },
        table: benchmark!("pinched-hemisphere/large.csv"),
        levels: &[&[8], &[16], &[32]],
        ..HEMISPHERE
    },
    Case {
        name: "cantilever-shear",
        title: "cantilever under end shear (Sze 3.1): tip displacements",
        scene: benchmark!("cantilever-end-shear/scene.toml"),
        table: benchmark!("cantilever-end-shear/reference.csv"),
        tolerance: 0.005,
        question: Question::Path {
            load: "force over 4 N",
            unit: "m",
            probes: &[
                ("tip.x", -1.0, 0.0, Side::Known, "end_shortening"),
                ("tip.z", 1.0, 0.0, Side::Known, "end_deflection"),
            ],
        },
        ..LARGE
    },
    Case {
        name: "cantilever-moment",
        title: "cantilever under an end moment, up to a circle (Sze 3.2): tip displacements",
        scene: benchmark!("cantilever-end-moment/scene.toml"),
        table: benchmark!("cantilever-end-moment/reference.csv"),
        tolerance: 0.005,
        question: Question::Path {
            load: "moment over 2π E I / L",
            unit: "m",
            probes: &[
                ("tip.x", -1.0, 0.0, Side::Known, "end_shortening"),
                ("tip.z", 1.0, 0.0, Side::Known, "end_deflection"),
            ],
        },
        ..LARGE
    },
];
