//! The example robots with drives that rub with their load and with the speed squared, too.

use takt_checker::draw::{self, Draw};
use takt_motion::robot::Robot;

use super::robots::Example;

/// The same robots with such drives.
pub(crate) fn with_rich_friction(robots: Vec<Example>) -> Vec<Example> {
    let draw = &mut Draw::seeded(11);
    let rich = |example: Example| {
        let spec = draw::with_rich_friction(draw, example.robot.spec().clone());
        let robot = Robot::new(spec, example.robot.warnings().to_vec());
        Example {
            robot: robot.unwrap_or_else(|wrong| panic!("{}: {wrong:?}", example.name)),
            ..example
        }
    };
    robots.into_iter().map(rich).collect()
}
