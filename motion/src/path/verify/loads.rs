//! What the drives carry: their torques at the samples, split by how they scale with speed, and where the arm is held.

use super::channels::Channels;
use super::{Examiner, PARTS, Tightest};
use crate::curve::Side;
use crate::dynamics;
use crate::tolerance::PATH_AT_REST;
use crate::verify::{Point, overrides};

impl Examiner<'_> {
    /// Completes the rigid bodies' torques by the drives', and keeps what slower overrides need.
    pub(super) fn add_torques(&mut self, samples: usize) {
        let channels = self.channels.count();
        let limits = self.timed.limits;
        let mut points = Vec::new();
        for (joint, drive) in self.robot.drives().iter().enumerate() {
            for sample in 0..samples {
                let entry = self.sweep.column(joint) + sample;
                let (velocity, acceleration) = (self.sweep.velocity[entry], self.sweep.acceleration[entry]);
                let gravity = self.sweep.gravity[entry];
                let point = Point {
                    joint,
                    time: self.timed.begin + self.times[sample],
                    segment: 0,
                    dynamic: self.sweep.torque[entry] - gravity + drive.armature * acceleration + drive.drag(velocity),
                    viscous: drive.viscous * velocity,
                    still: gravity + drive.coulomb(self.directions[entry], gravity),
                    gravity,
                };
                let torque = point.torque(1.0);
                self.values[sample * channels + Channels::torque(joint)] = torque;
                let demand = &mut self.examined.demands[joint];
                if torque.abs() > demand.peak_torque.abs() {
                    (demand.peak_torque, demand.time) = (torque, point.time);
                }
                demand.peak_velocity = demand.peak_velocity.max(velocity.abs());
                demand.peak_power = demand.peak_power.max((torque * velocity).abs());
                let before = sample % (PARTS + 1) != 0;
                if before {
                    let step = self.times[sample] - self.times[sample - 1];
                    let last = self.values[(sample - 1) * channels + Channels::torque(joint)];
                    // Simpson's rule would need the middle; at eleven samples the trapezoid is as true as it need be
                    demand.torque_squared += 0.5 * step * (torque * torque + last * last);
                }
                points.push(point);
            }
        }
        // a joint's limit may differ from stretch to stretch: the tightest one is taken for all
        let tightest = |joint: usize| {
            let stretches = limits.stretches.iter();
            stretches
                .filter_map(|stretch| stretch.joints[joint].torque)
                .fold(f64::INFINITY, f64::min)
        };
        let worst = overrides::tightest(points.iter(), &tightest);
        if let Some(worst) = worst
            && worst.ratio.is_finite()
            && self.worst.as_ref().is_none_or(|known| worst.ratio > known.ratio)
        {
            self.worst = Some(worst);
        }
    }

    /// Looks at the arm held still where the path begins and ends, without the help of friction.
    pub(super) fn hold(&mut self) {
        let duration = self.timed.law.duration();
        let limits = self.timed.limits;
        let slow = PATH_AT_REST * self.timed.curve.length();
        for (time, side) in [(0.0, Side::After), (duration, Side::Before)] {
            self.state.set(self.timed.curve, self.timed.law, time, side);
            // a path at constant speed is timed by itself: there it is the joints that rest
            let rests = self.state.velocity.iter().all(|velocity| *velocity == 0.0);
            if self.timed.law.at(time).velocity * duration > slow && !rests {
                continue;
            }
            let s = self.state.s;
            dynamics::gravity_torque(self.robot, &mut self.workspace, &self.state.position, &mut self.torque);
            let stretch = &limits.stretches[limits.stretch_at(s, side)];
            for joint in 0..self.robot.joint_count() {
                let channel = Channels::torque(joint);
                if let Some(limit) = self.channels.limit(channel, stretch) {
                    self.keep(channel, limit, (self.torque[joint], time, s));
                }
            }
        }
    }

    /// A torque by how it scales with speed.
    pub(super) fn split(&mut self, tightest: &Tightest) -> Option<Point> {
        let joint = tightest.joint?;
        let [_, smooth, _] = self.torques_at(joint, tightest.time - self.timed.begin);
        dynamics::gravity_torque(self.robot, &mut self.workspace, &self.state.position, &mut self.gravity);
        let gravity = self.gravity[joint];
        let drive = self.robot.drives()[joint];
        let velocity = self.state.velocity[joint];
        if tightest.value == gravity {
            // held still: no speed makes it less
            return Some(Point {
                joint,
                time: tightest.time,
                segment: 0,
                dynamic: 0.0,
                viscous: 0.0,
                still: tightest.value,
                gravity: tightest.value,
            });
        }
        let viscous = drive.viscous * velocity;
        // which way it acts, the torque says itself: where the joint turns back just there, it does either
        let coulomb = tightest.value - smooth;
        Some(Point {
            joint,
            time: tightest.time,
            segment: 0,
            dynamic: tightest.value - coulomb - viscous - gravity,
            viscous,
            still: gravity + coulomb,
            gravity,
        })
    }
}
