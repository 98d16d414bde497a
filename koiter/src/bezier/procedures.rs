//! Two procedures of surgery, played from their beginning to their end: a vessel that is opened and widened with a patch, and
//! a head that is pushed out through the neck of a bag.
//!
//! Golembiovsky and Duriez (2012), sections 5.4 and 5.5, whose geometry comes from patients; here it is generated.

use super::surface_path::SurfacePath;
use super::{
    BezierError, BezierShell, ContactOptions, DeadLoad, Dynamics, ElementKind, MappedContact,
    MappedSurface, MovingObstacle, NewtonLimits, Pose, SeamAngle, Section, ShellOptions, Supports,
    SurfacePoint, vertex_normals,
};
use crate::Vec3;
use crate::mesh::generate::{cylinder, icosphere, spherical_cap};
use crate::mesh::{Surface, SurfaceOptions};

/// What can be seen at a moment.
#[derive(Clone, Debug, Default)]
pub struct Stage {
    /// Fine surface of the shell.
    pub shell: (Vec<Vec3>, Vec<[u32; 3]>),
    /// Obstacle, if there is one.
    pub obstacle: (Vec<Vec3>, Vec<[u32; 3]>),
    /// What is being done.
    pub caption: String,
}

/// What a procedure came to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Account {
    /// Elements at the end.
    pub elements: usize,
    /// Steps.
    pub steps: usize,
    /// Steps that were not solved to their tolerance.
    pub unconverged: usize,
    /// Iterations of Newton's method.
    pub iterations: usize,
    /// Most vertices of the fine surface that were pushed at once.
    pub most_contacts: usize,
    /// What changed: of the vessel its greatest girth over that of before, of the bag its largest stretch of the neck.
    pub widening: f64,
}

impl Account {
    fn add(&mut self, outcome: &super::NewtonOutcome) {
        self.steps += 1;
        self.iterations += outcome.iterations;
        self.unconverged += usize::from(!outcome.converged);
    }
}

/// Radius and length of the vessel [m].
const RADIUS: f64 = 0.01;
const LENGTH: f64 = 0.04;
const AROUND: usize = 24;
const ALONG: usize = 32;

/// Tissue of a vessel.
const VESSEL: Section = Section {
    youngs_modulus: 5e5,
    poissons_ratio: 0.4,
    thickness: 1e-3,
    density: 1100.0,
};

fn tissue(section: Section) -> ShellOptions {
    ShellOptions {
        section,
        kind: ElementKind::Bezier,
        frame: None,
    }
}

/// A vessel is cut open along its length, its lips are pulled apart, and a patch is sewn in.
///
/// # Errors
/// As those of the parts of the procedure: with these numbers there are none.
pub fn vessel(show: &mut dyn FnMut(&Stage)) -> Result<Account, BezierError> {
    let surface = cylinder(RADIUS, LENGTH, AROUND, ALONG).expect("the vessel is a proper tube");
    let shell = BezierShell::new(&surface, &vertex_normals(&surface), tissue(VESSEL))?;
    let mut supports = Supports::none(surface.positions.len());
    for (node, x) in surface.positions.iter().enumerate() {
        if x.z.abs() > 0.499 * LENGTH {
            supports.clamp(node);
        }
    }
    let mut moving = Dynamics::new(shell, supports);
    moving.damping = 20.0;
    let mut account = Account::default();
    present(&moving, "vessel", show);

    let path = incision(&moving.shell, &moving.pose)?;
    let cut = moving.shell.cut(&path)?;
    moving = moving.changed(&cut, None);
    let mut pull = DeadLoad::none(moving.pose.len());
    for [left, right] in &cut.seam {
        // Outwards and to either side of the x axis, where the cut is.
        pull.add_force(*left as usize, Vec3::new(0.01, -0.02, 0.0));
        pull.add_force(*right as usize, Vec3::new(0.01, 0.02, 0.0));
    }
    for step in 1..=40 {
        let mut load = pull.scaled(f64::min(1.0, f64::from(step) / 20.0));
        advance(
            &mut moving,
            &mut [&mut load],
            "incision",
            &mut account,
            show,
        )?;
    }

    let (patch, pairs) = patch(&moving, &cut.seam, &path)?;
    let both = moving.shell.beside(&patch)?;
    let pose = moving.pose.followed_by(&patch.rest_pose());
    let supports = (moving.supports.clone()).with_free(patch.mesh().num_vertices());
    let damping = moving.damping;
    moving = Dynamics::at(both, supports, pose);
    moving.damping = damping;
    for _ in 0..6 {
        present(&moving, "patch", show);
    }
    let (sewn, pose) = moving.shell.sew(&pairs, &moving.pose, SeamAngle::Current)?;
    moving = moving.changed(&sewn, Some(pose));
    for _ in 0..60 {
        advance(&mut moving, &mut [], "suture", &mut account, show)?;
    }
    account.elements = moving.shell.elements().len();
    account.widening = girth(&moving, 0.0) / girth_of(&surface);
    Ok(account)
}

/// From a quarter to three quarters of the length, on the side of +x.
fn incision(shell: &BezierShell, pose: &Pose) -> Result<SurfacePath, BezierError> {
    let at = |z: f64| {
        let target = Vec3::new(RADIUS, 0.0, z);
        let distance = |element: &usize| {
            let corners = shell.rest()[*element].corners;
            ((corners[0] + corners[1] + corners[2]) / 3.0 - target).norm()
        };
        let element = (0..shell.elements().len())
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .expect("a shell has elements");
        SurfacePoint {
            element,
            barycentric: [1.0 / 3.0; 3],
        }
    };
    SurfacePath::between(
        shell,
        &pose.positions,
        &at(-0.3 * LENGTH),
        &at(0.3 * LENGTH),
    )
}

/// Elements of the patch from lip to lip.
const ACROSS: usize = 6;
/// Width of the patch in its middle [m].
const PATCH_WIDTH: f64 = 0.014;

/// A lens that fits the cut, flat and in front of it, and which of its vertices belong to which of the lips.
fn patch(
    moving: &Dynamics,
    seam: &[[u32; 2]],
    path: &SurfacePath,
) -> Result<(BezierShell, Vec<[u32; 2]>), BezierError> {
    let ends = [path.nodes.first(), path.nodes.last()].map(|node| match node {
        Some(super::PathNode::Vertex(v)) => *v,
        _ => unreachable!("a path ends at vertices"),
    });
    let first = moving.pose.len() as u32;
    let height = |v: u32| moving.pose.positions[v as usize].z;
    let front = RADIUS + 0.006;
    let mut positions = vec![Vec3::new(front, 0.0, height(ends[0]))];
    let mut pairs = vec![[ends[0], first]];
    let rows = seam.len();
    for (row, [left, right]) in seam.iter().enumerate() {
        let part = (row + 1) as f64 / (rows + 1) as f64;
        let width = PATCH_WIDTH * (std::f64::consts::PI * part).sin().sqrt();
        let z = 0.5 * (height(*left) + height(*right));
        let start = first + positions.len() as u32;
        for column in 0..=ACROSS {
            let y = width * (column as f64 / ACROSS as f64 - 0.5);
            positions.push(Vec3::new(front, y, z));
        }
        pairs.extend([[*left, start], [*right, start + ACROSS as u32]]);
    }
    pairs.push([ends[1], first + positions.len() as u32]);
    positions.push(Vec3::new(front, 0.0, height(ends[1])));
    let vertex = |row: usize, column: usize| (1 + row * (ACROSS + 1) + column) as u32;
    let last = positions.len() as u32 - 1;
    let mut faces = Vec::new();
    for column in 0..ACROSS {
        faces.push([0, vertex(0, column + 1), vertex(0, column)]);
        faces.push([last, vertex(rows - 1, column), vertex(rows - 1, column + 1)]);
        for row in 0..rows - 1 {
            let [a, b] = [vertex(row, column), vertex(row, column + 1)];
            let [c, d] = [vertex(row + 1, column + 1), vertex(row + 1, column)];
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    let surface = Surface::new(positions, faces, SurfaceOptions::default())?;
    let normals = vec![Vec3::x(); surface.positions.len()];
    Ok((
        BezierShell::new(&surface, &normals, *moving.shell.options())?,
        pairs,
    ))
}

/// Length of the outline of the tube at a height, of the fine surface [m].
fn girth(moving: &Dynamics, height: f64) -> f64 {
    let mapped = MappedSurface::subdivided(&moving.shell, 2);
    outline(&mapped.positions(&moving.pose), mapped.faces(), height)
}

fn girth_of(surface: &Surface) -> f64 {
    outline(&surface.positions, surface.mesh.faces(), 0.0)
}

/// Length of the section of a surface by a plane of constant z [m].
fn outline(positions: &[Vec3], faces: &[[u32; 3]], height: f64) -> f64 {
    // A hair beside the plane: vertices in it would be counted twice or not at all.
    let height = height + 1e-7;
    let mut length = 0.0;
    for face in faces {
        let x = face.map(|v| positions[v as usize]);
        let crossings: Vec<Vec3> = (0..3)
            .filter_map(|c| {
                let (a, b) = (x[c], x[(c + 1) % 3]);
                let t = (height - a.z) / (b.z - a.z);
                ((a.z > height) != (b.z > height)).then(|| a + (b - a) * t)
            })
            .collect();
        if let [a, b] = crossings[..] {
            length += (b - a).norm();
        }
    }
    length
}

fn present(moving: &Dynamics, caption: &str, show: &mut dyn FnMut(&Stage)) {
    let mapped = MappedSurface::subdivided(&moving.shell, 3);
    show(&Stage {
        shell: (mapped.positions(&moving.pose), mapped.faces().to_vec()),
        obstacle: (Vec::new(), Vec::new()),
        caption: caption.to_owned(),
    });
}

/// One step of 20 ms.
fn advance(
    moving: &mut Dynamics,
    others: &mut [&mut dyn super::Potential],
    caption: &str,
    account: &mut Account,
    show: &mut dyn FnMut(&Stage),
) -> Result<(), BezierError> {
    let edge = (moving.shell.area() / moving.shell.elements().len() as f64).sqrt();
    let limits = NewtonLimits {
        tolerance: 1e-4 * edge,
        ..NewtonLimits::for_edges(edge)
    };
    account.add(&moving.step(others, 0.02, &limits)?);
    present(moving, caption, show);
    Ok(())
}

/// The bag: half axes of an ellipsoid [m], and the angle from its top to its neck [°].
const BAG: [f64; 3] = [0.09, 0.09, 0.13];
const NECK_DEGREES: f64 = 155.0;
const RINGS: usize = 8;
/// Radius of the head [m]: the neck is 38 mm wide.
const HEAD: f64 = 0.045;

/// Muscle of a bag.
const MUSCLE: Section = Section {
    youngs_modulus: 1e5,
    poissons_ratio: 0.4,
    thickness: 6e-3,
    density: 1050.0,
};

/// Way of the head, and of a step [m].
const WAY: f64 = 0.24;
const STEPS: usize = 120;

/// A head is pushed out of a bag through its neck, which is narrower.
///
/// # Errors
/// As those of [`Dynamics::step`].
pub fn head(show: &mut dyn FnMut(&Stage)) -> Result<Account, BezierError> {
    let mut surface = spherical_cap(1.0, NECK_DEGREES.to_radians(), None, RINGS)
        .expect("the bag is a proper cap");
    let axes = Vec3::from(BAG);
    for x in &mut surface.positions {
        x.component_mul_assign(&axes);
    }
    let normal = |x: &Vec3| x.component_div(&axes.component_mul(&axes));
    let normals: Vec<Vec3> = surface.positions.iter().map(normal).collect();
    let shell = BezierShell::new(&surface, &normals, tissue(MUSCLE))?;
    let mut supports = Supports::none(surface.positions.len());
    for (node, x) in surface.positions.iter().enumerate() {
        if x.z > 0.8 * BAG[2] {
            supports.clamp(node);
        }
    }
    let mut moving = Dynamics::new(shell, supports);
    moving.damping = 20.0;
    let ball = icosphere(HEAD, 3).expect("the head is a proper ball");
    let start = ball.positions.clone();
    let faces = ball.mesh.faces().to_vec();
    let obstacle = MovingObstacle {
        name: "head".to_owned(),
        surface: ball,
        offset: 0.0,
    };
    let options = ContactOptions {
        d_hat: 2e-3,
        // Over the gap of the barrier this is a pressure of kappa / d̂: some times what the neck can press with.
        kappa: 40.0,
        offset: 0.5 * MUSCLE.thickness,
    };
    let mapped = MappedSurface::subdivided(&moving.shell, 2);
    let mut contact = MappedContact::new(mapped, &[obstacle], &moving.pose, options);
    let mut account = Account {
        elements: moving.shell.elements().len(),
        ..Account::default()
    };
    let neck = neck_length(&surface, &moving.pose);
    for step in 1..=STEPS {
        let down = Vec3::new(0.0, 0.0, -WAY * step as f64 / STEPS as f64);
        let towards: Vec<Vec3> = start.iter().map(|x| x + down).collect();
        follow(&mut moving, &mut contact, &towards, &mut account)?;
        let forces = contact.forces(&moving.pose).len();
        account.most_contacts = account.most_contacts.max(forces);
        account.widening = account
            .widening
            .max(neck_length(&surface, &moving.pose) / neck);
        show(&Stage {
            shell: (
                contact.mapped().positions(&moving.pose),
                contact.mapped().faces().to_vec(),
            ),
            obstacle: (contact.obstacles().to_vec(), faces.clone()),
            caption: format!("{forces} vertices in contact"),
        });
    }
    Ok(account)
}

/// Moves the head as far as it may go before the bag has given way, until it has arrived: twenty parts are the most.
fn follow(
    moving: &mut Dynamics,
    contact: &mut MappedContact,
    towards: &[Vec3],
    account: &mut Account,
) -> Result<(), BezierError> {
    let edge = (moving.shell.area() / moving.shell.elements().len() as f64).sqrt();
    let limits = NewtonLimits {
        tolerance: 1e-3 * edge,
        ..NewtonLimits::for_edges(edge)
    };
    for _ in 0..20 {
        let fraction = contact.move_obstacles(&moving.pose, towards);
        account.add(&moving.step(&mut [contact], 0.02, &limits)?);
        if fraction == 1.0 {
            break;
        }
    }
    Ok(())
}

/// Length of the boundary of the bag [m].
fn neck_length(surface: &Surface, pose: &Pose) -> f64 {
    let loops = surface.mesh.boundary_loops();
    let rim = &loops[0];
    let at = |k: usize| pose.positions[rim[k % rim.len()].0 as usize];
    (0..rim.len()).map(|k| (at(k + 1) - at(k)).norm()).sum()
}
