//! Recursive Newton-Euler: joint torques of a state, and gravity's part of them.
//!
//! Per link, in its own kernel frame, with Ω = [ω̇]× + [ω]×[ω]×:
//!
//! - outward: ω, ω̇ from the link before; acceleration of the origin a = Rᵀ(a₋ + Ω₋ p), where the base accelerates by −g;
//! - force on the link F = m a + Ω h, moment about its origin N = h × a + ∫ r × Ωr dm, with h = ∫ r dm;
//! - inward: F₋ += R F, N₋ += R N + p × R F; the joint's torque is N_z (revolute) or its force F_z (prismatic).
//!
//! Luh, Walker and Paul 1980; the moment through second moments, as Khalil and Kleinfinger 1987 count products.

use super::chain::{Chain, ChainJoint};
use crate::scalar::Real;

/// What the inward pass needs of a link.
#[derive(Clone, Copy)]
pub(crate) struct LinkWrench<R> {
    pub(crate) turn: Turn<R>,
    force: [R; 3],
    moment: [R; 3],
    /// Gravity's part of both.
    weight: [R; 3],
    weight_moment: [R; 3],
}

/// Rotation of a joint: cosine and sine of its angle, and how far it slid.
#[derive(Clone, Copy)]
pub(crate) struct Turn<R> {
    cos: R,
    sin: R,
    slide: R,
}

impl<R: Real> LinkWrench<R> {
    pub(crate) fn zero(zero: R) -> Self {
        Self {
            turn: Turn::zero(zero),
            force: [zero; 3],
            moment: [zero; 3],
            weight: [zero; 3],
            weight_moment: [zero; 3],
        }
    }
}

impl Turn<f64> {
    /// No rotation.
    pub(crate) fn still() -> Self {
        Self {
            cos: 1.0,
            sin: 0.0,
            slide: 0.0,
        }
    }
}

impl<R: Real> Turn<R> {
    pub(crate) fn zero(zero: R) -> Self {
        Self {
            cos: zero,
            sin: zero,
            slide: zero,
        }
    }

    #[inline(always)]
    pub(crate) fn new(joint: &ChainJoint, q: R) -> Self {
        if joint.prismatic {
            let (sin, cos) = q.splat(joint.zero_angle).sine_cosine();
            return Self { cos, sin, slide: q };
        }
        let (sin, cos) = (q + joint.zero_angle).sine_cosine();
        Self {
            cos,
            sin,
            slide: q.splat(0.0),
        }
    }

    /// A vector of the frame before, seen from this one: Rᵀ v.
    #[inline(always)]
    pub(crate) fn into_link(self, joint: &ChainJoint, v: [R; 3]) -> [R; 3] {
        let y = v[1] * joint.cos_alpha + v[2] * joint.sin_alpha;
        let z = v[2] * joint.cos_alpha - v[1] * joint.sin_alpha;
        [self.cos * v[0] + self.sin * y, self.cos * y - self.sin * v[0], z]
    }

    /// A vector of this frame, seen from the one before: R v.
    #[inline(always)]
    pub(crate) fn into_parent(self, joint: &ChainJoint, v: [R; 3]) -> [R; 3] {
        let x = self.cos * v[0] - self.sin * v[1];
        let y = self.sin * v[0] + self.cos * v[1];
        [
            x,
            y * joint.cos_alpha - v[2] * joint.sin_alpha,
            y * joint.sin_alpha + v[2] * joint.cos_alpha,
        ]
    }

    /// A force and its moment about this frame's origin, seen from the frame before, about that one's origin.
    #[inline(always)]
    pub(crate) fn wrench_into_parent(self, joint: &ChainJoint, force: [R; 3], moment: [R; 3]) -> ([R; 3], [R; 3]) {
        let force = self.into_parent(joint, force);
        let moment = self.into_parent(joint, moment);
        (force, add(moment, cross(self.origin(joint), force)))
    }

    /// Origin of this frame in the one before.
    #[inline(always)]
    pub(crate) fn origin(self, joint: &ChainJoint) -> [R; 3] {
        let p = joint.origin;
        if joint.prismatic {
            return [
                self.slide.splat(p[0]),
                self.slide * -joint.sin_alpha + p[1],
                self.slide * joint.cos_alpha + p[2],
            ];
        }
        [self.slide.splat(p[0]), self.slide.splat(p[1]), self.slide.splat(p[2])]
    }
}

/// What a joint's drive must give of a force and moment on its link.
#[inline(always)]
pub(crate) fn along_axis<R: Real>(joint: &ChainJoint, force: [R; 3], moment: [R; 3]) -> R {
    if joint.prismatic { force[2] } else { moment[2] }
}

// Kernels have no closures: one would be compiled without the instructions of the kernel that it stands in.

#[inline(always)]
pub(crate) fn add<R: Real>(a: [R; 3], b: [R; 3]) -> [R; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
pub(crate) fn cross<R: Real>(a: [R; 3], b: [R; 3]) -> [R; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// h × a for a constant h.
#[inline(always)]
pub(crate) fn cross_constant<R: Real>(h: [f64; 3], a: [R; 3]) -> [R; 3] {
    [
        a[2] * h[1] - a[1] * h[2],
        a[0] * h[2] - a[2] * h[0],
        a[1] * h[0] - a[0] * h[1],
    ]
}

/// The matrix Ω = [ω̇]× + [ω]×[ω]×, row by row, and the differences of its diagonal that moments need.
#[derive(Clone, Copy)]
pub(crate) struct Omega<R> {
    xx: R,
    yy: R,
    zz: R,
    xy: R,
    yx: R,
    xz: R,
    zx: R,
    yz: R,
    zy: R,
    zz_yy: R,
    xx_zz: R,
    yy_xx: R,
}

impl<R: Real> Omega<R> {
    #[inline(always)]
    pub(crate) fn new(w: [R; 3], wd: [R; 3]) -> Self {
        let zero = w[0].splat(0.0);
        let (x2, y2, z2) = (w[0] * w[0], w[1] * w[1], w[2] * w[2]);
        let (xy, xz, yz) = (w[0] * w[1], w[0] * w[2], w[1] * w[2]);
        Self {
            xx: zero - (y2 + z2),
            yy: zero - (x2 + z2),
            zz: zero - (x2 + y2),
            xy: xy - wd[2],
            yx: xy + wd[2],
            xz: xz + wd[1],
            zx: xz - wd[1],
            yz: yz - wd[0],
            zy: yz + wd[0],
            zz_yy: z2 - y2,
            xx_zz: x2 - z2,
            yy_xx: y2 - x2,
        }
    }

    /// Ω v.
    #[inline(always)]
    pub(crate) fn times(&self, v: [R; 3]) -> [R; 3] {
        [
            self.xx * v[0] + self.xy * v[1] + self.xz * v[2],
            self.yx * v[0] + self.yy * v[1] + self.yz * v[2],
            self.zx * v[0] + self.zy * v[1] + self.zz * v[2],
        ]
    }

    /// Ω v for a constant v.
    #[inline(always)]
    pub(crate) fn times_constant(&self, v: [f64; 3]) -> [R; 3] {
        [
            self.xx * v[0] + self.xy * v[1] + self.xz * v[2],
            self.yx * v[0] + self.yy * v[1] + self.yz * v[2],
            self.zx * v[0] + self.zy * v[1] + self.zz * v[2],
        ]
    }

    /// ∫ r × Ωr dm from the second moments xx yy zz xy xz yz.
    #[inline(always)]
    pub(crate) fn moment(&self, s: [f64; 6]) -> [R; 3] {
        [
            self.zy * s[1] - self.yz * s[2] + self.zz_yy * s[5] + (self.zx * s[3] - self.yx * s[4]),
            self.xz * s[2] - self.zx * s[0] + self.xx_zz * s[4] + (self.xy * s[5] - self.zy * s[3]),
            self.yx * s[0] - self.xy * s[1] + self.yy_xx * s[3] + (self.yz * s[4] - self.xz * s[5]),
        ]
    }
}

/// Rigid-body torques of one state, and gravity's part of them where `WITH_GRAVITY`.
///
/// All slices have one entry a joint. `links` is scratch.
#[inline(always)]
pub(crate) fn rnea<R: Real, const WITH_GRAVITY: bool>(
    chain: &Chain,
    q: &[R],
    qd: &[R],
    qdd: &[R],
    links: &mut [LinkWrench<R>],
    torque: &mut [R],
    gravity_torque: &mut [R],
) {
    let Some(&first) = q.first() else { return };
    let zero = first.splat(0.0);
    let mut w = [zero; 3];
    let mut wd = [zero; 3];
    let mut a = [
        first.splat(-chain.gravity[0]),
        first.splat(-chain.gravity[1]),
        first.splat(-chain.gravity[2]),
    ];
    let mut up = a;
    let mut omega = Omega::new(w, wd);
    let states = q.iter().zip(qd).zip(qdd);
    for ((joint, link), ((&q, &qd), &qdd)) in chain.joints.iter().zip(links.iter_mut()).zip(states) {
        let turn = Turn::new(joint, q);
        if joint.prismatic {
            a = turn.into_link(joint, add(a, omega.times(turn.origin(joint))));
            w = turn.into_link(joint, w);
            wd = turn.into_link(joint, wd);
            omega = Omega::new(w, wd);
            // Coriolis 2 ω × z q̇, and z q̈
            let twice = qd + qd;
            a = [a[0] + w[1] * twice, a[1] - w[0] * twice, a[2] + qdd];
        } else {
            a = turn.into_link(joint, add(a, omega.times_constant(joint.origin)));
            let turned = turn.into_link(joint, w);
            let turning = turn.into_link(joint, wd);
            w = [turned[0], turned[1], turned[2] + qd];
            wd = [
                turning[0] + turned[1] * qd,
                turning[1] - turned[0] * qd,
                turning[2] + qdd,
            ];
            omega = Omega::new(w, wd);
        }
        let body = &joint.body;
        let inertial = omega.times_constant(body.first);
        link.turn = turn;
        link.force = [
            a[0] * body.mass + inertial[0],
            a[1] * body.mass + inertial[1],
            a[2] * body.mass + inertial[2],
        ];
        link.moment = add(cross_constant(body.first, a), omega.moment(body.second));
        if WITH_GRAVITY {
            up = turn.into_link(joint, up);
            link.weight = [up[0] * body.mass, up[1] * body.mass, up[2] * body.mass];
            link.weight_moment = cross_constant(body.first, up);
        }
    }

    let mut force = [zero; 3];
    let mut moment = [zero; 3];
    let mut weight = [zero; 3];
    let mut weight_moment = [zero; 3];
    let torques = torque.iter_mut().zip(gravity_torque.iter_mut());
    for ((joint, link), (torque, gravity_torque)) in chain.joints.iter().zip(links.iter()).zip(torques).rev() {
        force = add(force, link.force);
        moment = add(moment, link.moment);
        *torque = along_axis(joint, force, moment);
        (force, moment) = link.turn.wrench_into_parent(joint, force, moment);
        if WITH_GRAVITY {
            weight = add(weight, link.weight);
            weight_moment = add(weight_moment, link.weight_moment);
            *gravity_torque = along_axis(joint, weight, weight_moment);
            (weight, weight_moment) = link.turn.wrench_into_parent(joint, weight, weight_moment);
        }
    }
}
