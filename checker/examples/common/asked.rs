//! What a long run is asked for.

use super::rich::with_rich_friction;
use super::robots::{self, Example};

/// The robots, with rich friction or not, and the other arguments.
pub(crate) fn asked_for() -> (Vec<Example>, Vec<String>) {
    let (rich, others): (Vec<_>, Vec<_>) = std::env::args()
        .skip(1)
        .partition(|argument| argument == "--rich-friction");
    let robots = robots::all();
    let robots = if rich.is_empty() {
        robots
    } else {
        with_rich_friction(robots)
    };
    (robots, others)
}
