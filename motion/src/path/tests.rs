mod joint;
mod mixed;
mod support;
mod tool;
