//! Logs of drives, as loggers write them: CSV whose header says what a column is, or JSON lines of `Telemetry`.
//!
//! Columns go by the number of the joint (`q1 qd1 qdd1 tau1 i1 …`) or by its name (`JOINT.position JOINT.torque …`).
//! A cell that is empty or no number that is finite is a value that is missing.

use takt_client::v1;

use crate::{failure::Failure, render::csv::cells};

type Column = fn(&mut v1::TelemetryColumns) -> &mut Vec<f64>;

/// A quantity: its name after the joint's, and before the joint's number.
struct Quantity {
    name: &'static str,
    letters: &'static [&'static str],
    column: Column,
}

const QUANTITIES: [Quantity; 9] = [
    Quantity {
        name: "position",
        letters: &["q"],
        column: |joint| &mut joint.position,
    },
    Quantity {
        name: "velocity",
        letters: &["qd", "dq"],
        column: |joint| &mut joint.velocity,
    },
    Quantity {
        name: "acceleration",
        letters: &["qdd", "ddq"],
        column: |joint| &mut joint.acceleration,
    },
    Quantity {
        name: "torque",
        letters: &["tau"],
        column: |joint| &mut joint.torque,
    },
    Quantity {
        name: "motor_position",
        letters: &["theta"],
        column: |joint| &mut joint.motor_position,
    },
    Quantity {
        name: "motor_torque",
        letters: &["taum"],
        column: |joint| &mut joint.motor_torque,
    },
    Quantity {
        name: "motor_current",
        letters: &["i"],
        column: |joint| &mut joint.motor_current,
    },
    Quantity {
        name: "transmission_torque",
        letters: &["tauj"],
        column: |joint| &mut joint.transmission_torque,
    },
    Quantity {
        name: "external_torque",
        letters: &["tauext"],
        column: |joint| &mut joint.external_torque,
    },
];

const TIMES: [&str; 3] = ["t", "time", "time_s"];

/// Which cell of a row is what.
#[derive(Debug, Clone)]
pub(crate) struct Header {
    time: usize,
    /// Cell, joint, and the place in the list of quantities.
    columns: Vec<(usize, usize, usize)>,
    /// The robot's joints.
    joints: Vec<String>,
    /// Names of columns that mean nothing here.
    pub(crate) ignored: Vec<String>,
}

impl Header {
    /// Reads the first line of a log.
    pub(crate) fn read(line: &str, joints: &[String]) -> Result<Self, Failure> {
        let names = cells(line.trim_start_matches('\u{feff}').trim_end());
        let names: Vec<&str> = names.iter().map(|name| name.trim()).collect();
        let Some(time) = names.iter().position(|name| TIMES.contains(name)) else {
            let failure = Failure::usage("the log has no column of times");
            return Err(failure.hint(FORM));
        };
        let mut header = Self {
            time,
            columns: Vec::new(),
            joints: joints.to_vec(),
            ignored: Vec::new(),
        };
        for (cell, name) in names.iter().enumerate() {
            if cell == time {
                continue;
            }
            let Some((joint, quantity)) = meaning(name, joints)? else {
                header.ignored.push((*name).to_owned());
                continue;
            };
            if header.columns.iter().any(|&(_, j, q)| (j, q) == (joint, quantity)) {
                return Err(Failure::usage(format!("the log has two columns of {name}")));
            }
            header.columns.push((cell, joint, quantity));
        }
        if header.columns.is_empty() {
            let failure = Failure::usage("the log has no column of any joint of this robot");
            return Err(failure.hint(FORM).hint(joints_of(joints)));
        }
        Ok(header)
    }

    /// An empty block of samples.
    pub(crate) fn block(&self) -> v1::Telemetry {
        let joints = self.joints.iter().map(|joint| v1::TelemetryColumns {
            joint: joint.clone(),
            ..Default::default()
        });
        v1::Telemetry {
            time_s: Vec::new(),
            joints: joints.collect(),
        }
    }

    /// Adds a row to a block; `number` is that of its line.
    pub(crate) fn add(&self, line: &str, number: usize, block: &mut v1::Telemetry) -> Result<(), Failure> {
        let cells = cells(line.trim_end());
        let text = cells.get(self.time).map_or("", |cell| cell.trim());
        let Ok(time) = text.parse() else {
            return Err(Failure::usage(format!("line {number}: {text:?} is no time")));
        };
        let mut values = Vec::with_capacity(self.columns.len());
        for &(cell, ..) in &self.columns {
            values.push(value(cells.get(cell).map_or("", |cell| cell.trim()), number)?);
        }
        block.time_s.push(time);
        for (&(_, joint, quantity), value) in self.columns.iter().zip(values) {
            (QUANTITIES[quantity].column)(&mut block.joints[joint]).push(value);
        }
        Ok(())
    }
}

const FORM: &str = "the first line names the columns: a time (t, time or time_s), and by joint number q1 qd1 qdd1 tau1 \
                    i1 theta1 taum1 tauj1 tauext1 …, or by joint name elbow_joint.position elbow_joint.torque …";

fn joints_of(joints: &[String]) -> String {
    format!("this robot's joints are, in their order: {}", joints.join(", "))
}

/// Joint and quantity of a column; `None` where it is something else.
fn meaning(name: &str, joints: &[String]) -> Result<Option<(usize, usize)>, Failure> {
    if let Some((joint, quantity)) = name.rsplit_once('.') {
        let quantity = QUANTITIES.iter().position(|one| one.name == quantity);
        let joint = joints.iter().position(|known| known == joint);
        return Ok(joint.zip(quantity));
    }
    let letters = name.trim_end_matches(|character: char| character.is_ascii_digit());
    let Some(quantity) = QUANTITIES.iter().position(|one| one.letters.contains(&letters)) else {
        return Ok(None);
    };
    let Ok(number) = name[letters.len()..].parse::<usize>() else {
        return Ok(None);
    };
    let joint = number.checked_sub(1).filter(|joint| *joint < joints.len());
    let Some(joint) = joint else {
        let message = format!(
            "the log has a column {name}, the robot has {} joints, 1 to {0}",
            joints.len()
        );
        return Err(Failure::usage(message).hint(joints_of(joints)));
    };
    Ok(Some((joint, quantity)))
}

/// What is missing is NaN: the service skips and counts it.
fn value(text: &str, number: usize) -> Result<f64, Failure> {
    if text.is_empty() {
        return Ok(f64::NAN);
    }
    let message = || Failure::usage(format!("line {number}: {text:?} is no number"));
    text.parse().map_err(|_| message())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn joints() -> Vec<String> {
        ["base", "elbow.left"].map(str::to_owned).to_vec()
    }

    fn read(text: &str) -> Result<v1::Telemetry, Failure> {
        let mut lines = text.lines();
        let header = Header::read(lines.next().unwrap_or_default(), &joints())?;
        let mut block = header.block();
        for (index, line) in lines.enumerate() {
            header.add(line, index + 2, &mut block)?;
        }
        Ok(block)
    }

    #[test]
    fn columns_go_by_number_or_by_name() {
        let by_number = read("t,q1,q2,tau1,tau2,note\n0,1,2,3,4,x\n0.5,5,6,7,8,y\n").unwrap();
        let by_name =
            read("elbow.left.torque,time_s,base.position,elbow.left.position,base.torque\n4,0,1,2,3\n8,0.5,5,6,7\n");
        assert_eq!(by_number, by_name.unwrap());
        assert_eq!(by_number.joints[1].torque, [4.0, 8.0]);
        assert!(by_number.joints[0].velocity.is_empty());
    }

    #[test]
    fn what_is_missing_keeps_its_place() {
        let block = read("t,q1,qd1\n0,,1\n1,nan,\n2,3,4\n").unwrap();
        assert_eq!(block.joints[0].position.len(), 3);
        assert!(block.joints[0].position[1].is_nan() && block.joints[0].velocity[1].is_nan());
        assert_eq!(block.joints[0].position[2], 3.0);
    }

    #[test]
    fn mistakes_are_named_with_their_place() {
        for (text, part) in [
            ("q1,q2\n", "no column of times"),
            ("t,x,y\n", "no column of any joint"),
            ("t,q1,q3\n", "q3"),
            ("t,q1,base.position\n", "two columns"),
            ("t,q1\n0,1\n1,abc\n", "line 3: \"abc\""),
            ("t,q1\nsoon,1\n", "line 2: \"soon\""),
        ] {
            let said = read(text).unwrap_err().render(false);
            assert!(said.contains(part), "{text:?}: {said}");
        }
    }

    #[test]
    fn columns_that_mean_nothing_are_listed() {
        let header = Header::read("t,q1,temperature1,mode", &joints()).unwrap();
        assert_eq!(header.ignored, ["temperature1", "mode"]);
    }
}
