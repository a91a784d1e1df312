//! Forms of output. Everything here is a function of messages to text.

pub(crate) mod bench;
pub(crate) mod check;
pub(crate) mod confidence;
pub(crate) mod csv;
pub(crate) mod curves;
pub(crate) mod dynamics;
pub(crate) mod fit;
pub(crate) mod friction;
pub(crate) mod html;
pub(crate) mod html_path;
pub(crate) mod infeasible;
pub(crate) mod path;
pub(crate) mod plan;
pub(crate) mod rehearsal;
pub(crate) mod robot;
pub(crate) mod ros;
pub(crate) mod scale;
pub(crate) mod svg;
pub(crate) mod table;
pub(crate) mod terminal_plot;
pub(crate) mod words;

#[cfg(test)]
pub(crate) mod example;
