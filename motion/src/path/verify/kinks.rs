//! Intervals end where the load of a joint's friction passes zero: there its torque has a kink, and is smooth on either side.

use super::{Examiner, PARTS};
use crate::curve::Side;
use crate::dynamics;
use crate::tolerance::KINK_FLOOR;
use crate::verify::kinks;

impl Examiner<'_> {
    /// Ends intervals where the load of a joint's friction passes zero; false where none does.
    pub(super) fn divide(&mut self, breaks: &mut Vec<f64>) -> bool {
        let Self {
            robot,
            timed,
            sweep,
            state,
            gravity,
            workspace,
            times,
            ..
        } = self;
        let floor = KINK_FLOOR
            * sweep
                .gravity
                .iter()
                .fold(0.0, |most: f64, gravity| most.max(gravity.abs()));
        let mut cuts = Vec::new();
        for (joint, drive) in robot.drives().iter().enumerate() {
            if drive.load_coulomb == 0.0 {
                continue;
            }
            let column = &sweep.gravity[sweep.column(joint)..];
            for (times, values) in times.chunks(PARTS + 1).zip(column.chunks(PARTS + 1)) {
                cuts.extend(kinks::zeros(times, &values[..times.len()], floor, &mut |time| {
                    state.set(timed.curve, timed.law, time, Side::After);
                    dynamics::gravity_torque(robot, workspace, &state.position, gravity);
                    gravity[joint]
                }));
            }
        }
        if cuts.is_empty() {
            return false;
        }
        breaks.extend(cuts);
        breaks.sort_by(f64::total_cmp);
        breaks.dedup();
        true
    }
}
