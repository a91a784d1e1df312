mod joint;
mod plan;
mod mixed;
mod support;
mod tool;
