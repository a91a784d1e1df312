use nalgebra::{Isometry3, Matrix3, Matrix4, Vector3};
use proptest::prelude::*;

use super::read;
use crate::robot::bounds::MAX_JOINTS;
use crate::robot::chain::Chain;
use crate::robot::description::{DhConvention, DhLink};
use crate::robot::findings::Findings;
use crate::robot::rotation;
use crate::robot::spec::JointKind;

/// The matrices of the textbooks against our products of quaternions.
const TOLERANCE: f64 = 1e-14;

fn link(name: &str, prismatic: bool, [a, alpha, d, theta]: [f64; 4]) -> DhLink {
    DhLink {
        name: name.to_owned(),
        prismatic,
        a,
        alpha,
        d,
        theta,
        mass: 2.0,
        center_of_mass: Vector3::new(0.1, 0.2, 0.3),
        inertia: Matrix3::from_diagonal(&Vector3::new(0.02, 0.03, 0.04)),
    }
}

fn accepted(convention: DhConvention, links: &[DhLink]) -> (Chain, Vec<String>) {
    let mut findings = Findings::default();
    let chain = read(convention, links, &mut findings);
    findings.finish(chain).unwrap()
}

fn refused(links: &[DhLink]) -> Vec<String> {
    let mut findings = Findings::default();
    let chain = read(DhConvention::Standard, links, &mut findings);
    let errors = findings.finish(chain).unwrap_err();
    errors.iter().map(ToString::to_string).collect()
}

/// The row's matrix as the textbooks print it, its joint at `q`.
fn printed(convention: DhConvention, link: &DhLink, q: f64) -> Matrix4<f64> {
    let (theta, d) = if link.prismatic {
        (link.theta, link.d + q)
    } else {
        (link.theta + q, link.d)
    };
    let ((st, ct), (sa, ca), a) = (theta.sin_cos(), link.alpha.sin_cos(), link.a);
    match convention {
        DhConvention::Standard => Matrix4::new(
            ct,
            -st * ca,
            st * sa,
            a * ct,
            st,
            ct * ca,
            -ct * sa,
            a * st,
            0.0,
            sa,
            ca,
            d,
            0.0,
            0.0,
            0.0,
            1.0,
        ),
        DhConvention::Modified => Matrix4::new(
            ct,
            -st,
            0.0,
            a,
            st * ca,
            ct * ca,
            -sa,
            -d * sa,
            st * sa,
            ct * sa,
            ca,
            d * ca,
            0.0,
            0.0,
            0.0,
            1.0,
        ),
    }
}

/// Poses of all link bodies' centres of mass, and of the tip.
fn poses(chain: &Chain, q: &[f64]) -> (Vec<Vector3<f64>>, Matrix4<f64>) {
    let mut pose = Isometry3::identity();
    let mut centers = Vec::new();
    for (joint, q) in chain.joints.iter().zip(q) {
        let motion = match joint.kind {
            JointKind::Prismatic => Isometry3::translation(0.0, 0.0, *q),
            JointKind::Revolute | JointKind::Continuous => {
                rotation::pose(Vector3::zeros(), rotation::about(&joint.axis, *q))
            }
        };
        pose = pose * joint.parent_from_joint * motion;
        centers.push((pose * nalgebra::Point3::from(joint.link.center_of_mass)).coords);
    }
    (centers, (pose * chain.link_from_tip).to_homogeneous())
}

proptest! {
    #[test]
    fn both_conventions_are_those_of_the_textbooks(
        rows in prop::collection::vec(([-1.0..1.0_f64, -4.0..4.0, -1.0..1.0, -4.0..4.0], any::<bool>(), -3.0..3.0_f64), 1..7),
        is_standard in any::<bool>(),
    ) {
        let convention = if is_standard { DhConvention::Standard } else { DhConvention::Modified };
        let links: Vec<DhLink> = rows.iter().zip(0..).map(|((row, prismatic, _), i)| link(&format!("j{i}"), *prismatic, *row)).collect();
        let q: Vec<f64> = rows.iter().map(|(_, _, q)| *q).collect();
        let (chain, _) = accepted(convention, &links);
        let (centers, tip) = poses(&chain, &q);
        let mut expected = Matrix4::identity();
        for ((link, q), center) in links.iter().zip(&q).zip(centers) {
            expected *= printed(convention, link, *q);
            let expected_center = (expected * link.center_of_mass.push(1.0)).xyz();
            prop_assert!((center - expected_center).norm() < TOLERANCE * 10.0);
        }
        prop_assert!((tip - expected).amax() < TOLERANCE * 10.0);
    }
}

#[test]
fn the_inertia_of_a_standard_link_is_turned_into_its_joint() {
    let (chain, _) = accepted(
        DhConvention::Standard,
        &[link("j", false, [0.0, std::f64::consts::FRAC_PI_2, 0.0, 0.0])],
    );
    let inertia = chain.joints[0].link.inertia;
    assert!((inertia.diagonal() - Vector3::new(0.02, 0.04, 0.03)).norm() < 1e-15);
}

#[test]
fn links_without_mass_and_odd_ones_are_warned_of() {
    let mut links = [link("a", false, [0.0; 4]), link("b", true, [0.0; 4])];
    links[0].mass = 0.0;
    links[1].mass = 0.0;
    links[1].inertia = Matrix3::zeros();
    let (_, warnings) = accepted(DhConvention::Modified, &links);
    assert!(warnings[0].contains("link of joint \"a\": mass 0 with"), "{warnings:?}");
    assert!(
        warnings[1].contains("joint \"b\": the link that it moves has no mass"),
        "{warnings:?}"
    );
}

#[test]
fn every_number_out_of_bounds_is_named() {
    let mut links = [
        link("a", false, [0.0; 4]),
        link("a", false, [f64::NAN, f64::INFINITY, 1e6, -1e6]),
    ];
    links[0].name = String::new();
    links[1].mass = -1.0;
    links[1].center_of_mass.y = f64::NAN;
    links[1].inertia.m23 = 2e9;
    links[1].inertia.m32 = 2e9;
    assert_eq!(
        refused(&links),
        [
            "dh.links[0].name: must not be empty",
            "dh.links[1].a_m: NaN must be a finite number",
            "dh.links[1].alpha_rad: inf must be a finite number",
            "dh.links[1].d_m: 1000000.0 m must be at most 100000.0 m",
            "dh.links[1].theta_rad: -1000000.0 rad must be at least -100000.0 rad",
            "dh.links[1].mass_kg: -1.0 kg must be at least 0.0 kg",
            "dh.links[1].center_of_mass_m[1]: NaN must be a finite number",
            "dh.links[1].inertia_kg_m2[5]: 2000000000.0 kg m² must be at most 1000000000.0 kg m²",
        ]
    );
}

#[test]
fn the_number_of_links_is_bounded_and_names_are_unique() {
    assert_eq!(refused(&[]), ["dh.links: must have at least one link"]);
    let many: Vec<DhLink> = (0..=MAX_JOINTS)
        .map(|i| link(&format!("j{i}"), false, [0.0; 4]))
        .collect();
    assert_eq!(refused(&many), ["dh.links: 33 links must be at most 32"]);
    let twice = [link("j", false, [0.0; 4]), link("j", false, [0.0; 4])];
    assert_eq!(
        refused(&twice),
        ["dh.links[1].name: \"j\" is the name of dh.links[0] too"]
    );
}
