//! Logs of drives, as loggers write them: CSV whose header says what a column is, or JSON lines of `Telemetry`.
//!
//! Columns go by the number of the joint (`q1 qd1 qdd1 tau1 i1 …`) or by its name (`JOINT.position JOINT.torque …`).
//! A cell that is empty or no number that is finite is a value that is missing. Cells are parted by commas, or by semicolons or tabs
//! where the first line has them; numbers may then have a decimal comma. Times are in s, or in the unit that their column's name ends in.

use takt_client::v1;

use crate::{failure::Failure, render::csv};

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

/// Names of a column of times, and how much of a second its unit is.
const TIMES: [(&str, f64); 9] = [
    ("t", 1.0),
    ("time", 1.0),
    ("time_s", 1.0),
    ("t_ms", 1e-3),
    ("time_ms", 1e-3),
    ("t_us", 1e-6),
    ("time_us", 1e-6),
    ("t_ns", 1e-9),
    ("time_ns", 1e-9),
];

/// What stands between two cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Delimiter {
    Comma,
    /// Another one, so that a comma is a decimal one.
    Other(char),
}

impl Delimiter {
    /// That of a first line.
    fn of(line: &str) -> Self {
        let found = [';', '\t'].into_iter().find(|delimiter| line.contains(*delimiter));
        found.map_or(Self::Comma, Self::Other)
    }

    fn cells(self, line: &str) -> Vec<String> {
        match self {
            Self::Comma => csv::cells(line),
            Self::Other(delimiter) => line
                .split(delimiter)
                .map(|cell| cell.trim().trim_matches('"').to_owned())
                .collect(),
        }
    }

    /// A number; 1.234,5 is none, as nobody can know.
    fn number(self, text: &str) -> Option<f64> {
        match self {
            Self::Other(_) if text.contains(',') && !text.contains('.') => text.replacen(',', ".", 1).parse().ok(),
            Self::Comma | Self::Other(_) => text.parse().ok(),
        }
    }
}

/// Which cell of a row is what.
#[derive(Debug, Clone)]
pub(crate) struct Header {
    time: usize,
    /// Seconds in its unit.
    tick: f64,
    delimiter: Delimiter,
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
        let line = line.trim_start_matches('\u{feff}').trim_end();
        let delimiter = Delimiter::of(line);
        let names = delimiter.cells(line);
        let names: Vec<&str> = names.iter().map(|name| name.trim()).collect();
        let unit = |name: &&str| TIMES.iter().find(|(known, _)| known == name).map(|(_, tick)| *tick);
        let mut times = names.iter().enumerate();
        let Some((time, tick)) = times.find_map(|(cell, name)| Some((cell, unit(name)?))) else {
            let failure = Failure::usage("the log has no column of times");
            return Err(failure.hint(FORM));
        };
        let mut header = Self {
            time,
            tick,
            delimiter,
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
        header.check_names()?;
        Ok(header)
    }

    /// A column that is named like that of a joint, of a joint that this robot does not have, where one of its own has none.
    fn check_names(&self) -> Result<(), Failure> {
        for name in &self.ignored {
            let Some((joint, quantity)) = name.rsplit_once('.') else {
                continue;
            };
            let Some(quantity) = QUANTITIES.iter().position(|one| one.name == quantity) else {
                continue;
            };
            let has = |joint: &usize| self.columns.iter().any(|&(_, j, q)| (j, q) == (*joint, quantity));
            if (0..self.joints.len()).all(|joint| has(&joint)) {
                continue;
            }
            let failure = Failure::usage(format!(
                "the log has a column {name}, but this robot has no joint \"{joint}\""
            ));
            return Err(failure.hint(joints_of(&self.joints)));
        }
        Ok(())
    }

    /// What a log lacks that has no column at all of some joints: which have which, and which are missing.
    pub(crate) fn missing_joints(&self) -> Option<String> {
        let of = |joint: usize| {
            let columns = self.columns.iter().filter(|(_, one, _)| *one == joint);
            columns
                .map(|(.., quantity)| QUANTITIES[*quantity].letters[0])
                .collect::<Vec<_>>()
        };
        let (with, without): (Vec<usize>, Vec<usize>) =
            (0..self.joints.len()).partition(|joint| !of(*joint).is_empty());
        if without.is_empty() {
            return None;
        }
        let names = |joints: &[usize]| {
            let names = joints.iter().map(|joint| self.joints[*joint].as_str());
            names.collect::<Vec<_>>().join(", ")
        };
        // Joints with the same columns are one group.
        let mut groups: Vec<(Vec<&str>, Vec<usize>)> = Vec::new();
        for joint in with {
            let columns = of(joint);
            match groups.iter_mut().find(|(known, _)| *known == columns) {
                Some((_, joints)) => joints.push(joint),
                None => groups.push((columns, vec![joint])),
            }
        }
        let groups: Vec<String> = groups
            .iter()
            .map(|(columns, joints)| format!("{} of {}", columns.join(", "), names(joints)))
            .collect();
        Some(format!(
            "the log has {}; {} missing: {}",
            groups.join(", "),
            match without.len() {
                1 => "a joint is",
                _ => "joints are",
            },
            names(&without)
        ))
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
        let cells = self.delimiter.cells(line.trim_end_matches(['\r', '\n']));
        let text = cells.get(self.time).map_or("", |cell| cell.trim());
        let Some(time) = self.delimiter.number(text) else {
            return Err(Failure::usage(format!("line {number}: {text:?} is no time")));
        };
        let mut values = Vec::with_capacity(self.columns.len());
        for &(cell, ..) in &self.columns {
            let text = cells.get(cell).map_or("", |cell| cell.trim());
            // What is missing is NaN: the service skips and counts it.
            let value = if text.is_empty() {
                Some(f64::NAN)
            } else {
                self.delimiter.number(text)
            };
            values.push(value.ok_or_else(|| no_number(text, number, self.delimiter))?);
        }
        block.time_s.push(match self.tick.to_bits() == 1.0_f64.to_bits() {
            true => time,
            false => time * self.tick,
        });
        for (&(_, joint, quantity), value) in self.columns.iter().zip(values) {
            (QUANTITIES[quantity].column)(&mut block.joints[joint]).push(value);
        }
        Ok(())
    }
}

const FORM: &str = "the first line names the columns: a time (t, time or time_s; t_ms, t_us, t_ns in other units), and by joint number q1 qd1 qdd1 tau1 \
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

fn no_number(text: &str, number: usize, delimiter: Delimiter) -> Failure {
    let failure = Failure::usage(format!("line {number}: {text:?} is no number"));
    match delimiter {
        Delimiter::Other(_) if text.contains(',') && text.contains('.') => {
            failure.hint("write numbers with a point or a comma before the decimals, and without any between thousands")
        }
        Delimiter::Comma | Delimiter::Other(_) => failure,
    }
}

/// Values of a log that are missing or no numbers, by column: how many, and in which line the first is.
#[derive(Debug, Clone, Default)]
pub(crate) struct Missing {
    /// In the order of the joints and of the list of quantities.
    columns: std::collections::BTreeMap<(usize, usize), (u64, usize)>,
}

impl Missing {
    /// Looks at the row of a line, the last of a block.
    pub(crate) fn count(&mut self, header: &Header, block: &mut v1::Telemetry, line: usize) {
        for &(_, joint, quantity) in &header.columns {
            let last = (QUANTITIES[quantity].column)(&mut block.joints[joint]).last();
            if last.is_some_and(|value| !value.is_finite()) {
                self.columns.entry((joint, quantity)).or_insert((0, line)).0 += 1;
            }
        }
    }

    /// A sentence a column: `joint elbow, torque: 1204 values that are no numbers, the first in line 17`.
    pub(crate) fn sentences(&self, joints: &[String]) -> Vec<String> {
        let sentence = |(&(joint, quantity), &(count, line)): (&(usize, usize), &(u64, usize))| {
            let values = if count == 1 {
                "value that is no number"
            } else {
                "values that are no numbers"
            };
            format!(
                "joint {}, {}: {count} {values}, the first in line {line}",
                joints[joint], QUANTITIES[quantity].name
            )
        };
        self.columns.iter().map(sentence).collect()
    }
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
    fn other_delimiters_and_decimal_commas_are_read() {
        let plain = read("t,q1,tau1\n0,1.5,\n0.5,-2,3\n").unwrap();
        let same = |text: &str| {
            let block = read(text).unwrap();
            assert_eq!(block.time_s, plain.time_s, "{text}");
            assert_eq!(block.joints[0].position, plain.joints[0].position, "{text}");
            assert!(
                block.joints[0].torque[0].is_nan() && block.joints[0].torque[1] == 3.0,
                "{text}"
            );
        };
        same("t;q1;tau1\r\n0;1,5;\r\n0,5;-2;3\r\n");
        same("t\tq1\ttau1\n0\t1.5\t\n0.5\t-2\t3\n");
        same("\"t\";\"q1\";\"tau1\"\n0;1.5;\n0,5;-2,0;3\n");
        same("t_ms,q1,tau1\n0,1.5,\n500,-2,3\n");
        let said = read("t;q1\n0;1.234,5\n").unwrap_err().render(false);
        assert!(said.contains("line 2") && said.contains("thousands"), "{said}");
    }

    #[test]
    fn a_joint_that_the_robot_does_not_have_is_named_with_those_it_has() {
        let said = read("t,base.position,wrist.position\n").unwrap_err().render(false);
        for part in ["wrist.position", "no joint \"wrist\"", "base, elbow.left"] {
            assert!(said.contains(part), "{part}: {said}");
        }
        // a gripper beside all joints is no mistake
        let header = Header::read("t,q1,q2,gripper.position", &joints()).unwrap();
        assert_eq!(header.ignored, ["gripper.position"]);
    }

    #[test]
    fn what_is_missing_is_counted_with_its_first_line() {
        let header = Header::read("t,q1,tau2", &joints()).unwrap();
        let (mut block, mut missing) = (header.block(), Missing::default());
        for (line, text) in [(2, "0,1,1"), (3, "1,nan,"), (7, "2,1,inf")] {
            header.add(text, line, &mut block).unwrap();
            missing.count(&header, &mut block, line);
        }
        assert_eq!(
            missing.sentences(&joints()),
            [
                "joint base, position: 1 value that is no number, the first in line 3",
                "joint elbow.left, torque: 2 values that are no numbers, the first in line 3"
            ]
        );
    }

    #[test]
    fn joints_without_any_column_are_named_beside_those_that_have_some() {
        let missing = |line: &str| Header::read(line, &joints()).unwrap().missing_joints();
        assert_eq!(
            missing("t,q1,qd1,tau1").unwrap(),
            "the log has q, qd, tau of base; a joint is missing: elbow.left"
        );
        assert_eq!(missing("t,q1,tau1,q2"), None, "the service names what one lacks");
    }

    #[test]
    fn columns_that_mean_nothing_are_listed() {
        let header = Header::read("t,q1,temperature1,mode", &joints()).unwrap();
        assert_eq!(header.ignored, ["temperature1", "mode"]);
    }
}
