mod constant;
mod joint;
mod mixed;
mod plan;
mod spline;
mod support;
mod tool;
