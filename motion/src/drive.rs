//! Drives: friction that is estimated and fitted from telemetry, transmissions that flex, the controller that uses both, and
//! its rehearsal on a simulated arm.
//!
//! One joint with an elastic transmission, seen from its output side ("controlling a robot arm based on adaptive
//! friction", eq 1 to 14; q: output position, Θ: motor position over the gear ratio, Φ = Θ − q: deformation):
//!
//! ```text
//! τJ     = τE(Φ) + D·Φ̇               τE(Φ) = Σ kⱼ·Φ^(2j−1)
//! τJ     = M(q)·q̈ + C(q, q̇)·q̇ + g(q) + Fq + τext     the arm
//! τmotor = B·Θ̈ + τJ + FΘ             the motor; τmotor = Kτ·i
//! ```
//!
//! Everything is reflected to the output side: B = ξ²·I_m, τmotor = ξ·τ, Kτ = ξ·k_t. τext is what the arm exerts on its
//! surroundings: a wrench F that acts on the flange enters as τext = −Jᵀ·F.

mod adapt;
mod adaptation;
pub mod controller;
mod encoder;
pub mod estimate;
pub mod feedforward;
pub mod fit;
pub mod friction_change;
mod gains;
mod integrator;
pub mod log_hints;
mod loss;
mod plant;
pub mod reference;
pub mod rehearse;
mod series;
pub mod telemetry;
pub mod transmission;
