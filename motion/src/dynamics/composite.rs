//! The mass matrix by composite rigid bodies (Walker and Orin 1982), in kernel frames.

use nalgebra::{Matrix3, Vector3};

use super::chain::{Body, Chain};
use super::rnea::Turn;

/// Everything from one joint outwards, taken as one rigid body.
#[derive(Clone, Copy)]
pub(crate) struct Composite {
    mass: f64,
    first: Vector3<f64>,
    second: Matrix3<f64>,
    turn: Turn<f64>,
}

impl Composite {
    pub(crate) fn zero() -> Self {
        Self {
            mass: 0.0,
            first: Vector3::zeros(),
            second: Matrix3::zeros(),
            turn: Turn::still(),
        }
    }

    fn add_body(&mut self, body: &Body) {
        let [xx, yy, zz, xy, xz, yz] = body.second;
        self.mass += body.mass;
        self.first += Vector3::from(body.first);
        self.second += Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    }
}

/// Rigid-body mass matrix M(q), row by row. `composites` is scratch with one entry a joint.
pub(crate) fn mass_matrix(chain: &Chain, q: &[f64], composites: &mut [Composite], matrix: &mut [f64]) {
    let count = chain.joints.len();
    let mut outer: Option<Composite> = None;
    for i in (0..count).rev() {
        let joint = &chain.joints[i];
        let mut here = Composite::zero();
        if let Some(body) = outer {
            here.mass = body.mass;
            here.first = body.first;
            here.second = body.second;
        }
        here.add_body(&joint.body);
        here.turn = Turn::new(joint, q[i]);
        composites[i] = here;

        // the same body about the origin of the frame before
        let p = Vector3::from(here.turn.origin(joint));
        let into_parent = |v: Vector3<f64>| Vector3::from(here.turn.into_parent(joint, v.into()));
        let half = Matrix3::from_columns(&[
            into_parent(here.second.column(0).into()),
            into_parent(here.second.column(1).into()),
            into_parent(here.second.column(2).into()),
        ])
        .transpose();
        let turned = Matrix3::from_columns(&[
            into_parent(half.column(0).into()),
            into_parent(half.column(1).into()),
            into_parent(half.column(2).into()),
        ]);
        let first = into_parent(here.first);
        outer = Some(Composite {
            mass: here.mass,
            first: first + p * here.mass,
            second: turned + first * p.transpose() + p * first.transpose() + p * p.transpose() * here.mass,
            turn: here.turn,
        });
    }
    for (j, body) in composites.iter().enumerate().take(count) {
        // force and moment that turn (or slide) the body at unit acceleration about (along) z of frame j
        let (mut force, mut moment) = if chain.joints[j].prismatic {
            ([0.0, 0.0, body.mass], [body.first.y, -body.first.x, 0.0])
        } else {
            let s = &body.second;
            (
                [-body.first.y, body.first.x, 0.0],
                [-s[(0, 2)], -s[(1, 2)], s[(0, 0)] + s[(1, 1)]],
            )
        };
        for i in (0..=j).rev() {
            let joint = &chain.joints[i];
            let entry = if joint.prismatic { force[2] } else { moment[2] };
            matrix[i * count + j] = entry;
            matrix[j * count + i] = entry;
            let turn = composites[i].turn;
            force = turn.into_parent(joint, force);
            let arm = super::rnea::cross(turn.origin(joint), force);
            moment = super::rnea::add(turn.into_parent(joint, moment), arm);
        }
    }
}
