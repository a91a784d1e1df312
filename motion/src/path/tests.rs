mod joint;
mod mixed;
mod plan;
mod support;
mod tool;
